"""The experiments: each module has a title, arms and scenes, and the paper's claims about its results."""

from importlib import import_module

EXPERIMENTS = {
    1: "order",
    2: "lines",
    3: "equation",
    4: "numbers",
    5: "beyond",
    6: "baselines",
    7: "bases",
    8: "quadrature",
    9: "sorted",
}


def module(number: int):
    """Return the module of an experiment."""
    return import_module(f".{EXPERIMENTS[number]}", __package__)
