"""Number sequences: points of the unit cube. A new sequence is one new file and one line in each table."""

from importlib import import_module
from typing import Any

from .base import DIMENSIONS, WORDS, AbstractNumbers

NUMBERS = {
    "faure": "faure:faure",
    "generalized-faure": "generalized_faure:generalized_faure",
    "halton": "halton:Halton",
    "niederreiter": "niederreiter:niederreiter",
    "random": "random:Random",
    "scrambled-halton": "scrambled_halton:ScrambledHalton",
    "sobol": "sobol:sobol",
}

__all__ = ["DIMENSIONS", "NUMBERS", "WORDS", "AbstractNumbers", "make", "ready"]


def make(name: str) -> AbstractNumbers:
    """Return the sequence called ``name``. Its module is imported here, since it imports Dr.Jit."""
    module, maker = NUMBERS[name].split(":")
    return getattr(import_module(f".{module}", __package__), maker)()


def ready(name: str, types: Any) -> AbstractNumbers:
    """Return the sequence called ``name``, ready for kernels: its tables are on the device of Dr.Jit's array ``types``."""
    numbers = make(name)
    numbers.prepare(types)
    return numbers
