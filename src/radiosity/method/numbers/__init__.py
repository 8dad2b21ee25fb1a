"""Which points of the unit cube? A new sequence is one new file and one line in each table."""

from importlib import import_module

from .base import DIMENSIONS, WORDS, AbstractNumbers

NUMBERS = {
    "halton": "halton:Halton",
    "random": "random:Random",
}

__all__ = ["DIMENSIONS", "NUMBERS", "WORDS", "AbstractNumbers", "make"]


def make(name: str) -> AbstractNumbers:
    """The sequence called ``name``. Its module is imported here, since it imports Dr.Jit."""
    module, cls = NUMBERS[name].split(":")
    return getattr(import_module(f".{module}", __package__), cls)()
