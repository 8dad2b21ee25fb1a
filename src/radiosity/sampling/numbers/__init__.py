"""Which points of the unit cube? A new sequence is one new file and one line in the table."""

from importlib import import_module
from typing import Any

from ...errors import MethodError
from .base import DIMENSIONS, WORDS, AbstractNumbers

# By the names that reports and files have: the module, and what in it makes the points
NUMBERS = {
    "faure": "faure:faure",
    "generalized-faure": "generalized_faure:generalized_faure",
    "halton": "halton:Halton",
    "niederreiter": "niederreiter:niederreiter",
    "random": "random:Random",
    "scrambled-halton": "scrambled_halton:ScrambledHalton",
    "sobol": "sobol:sobol",
}
# Those of them that are a scrambled sequence: which, and how. `Method` has the two as choices of their own.
SCRAMBLED = {"generalized-faure": ("faure", "linear"), "scrambled-halton": ("halton", "permuted-digits")}
NONE = "none"

__all__ = ["DIMENSIONS", "NUMBERS", "SCRAMBLED", "WORDS", "AbstractNumbers", "make", "name_of", "parts_of", "ready"]


def parts_of(name: str) -> tuple[str, str]:
    """The sequence and the scrambling that a name stands for."""
    return SCRAMBLED.get(name, (name, NONE))


def name_of(sequence: str, scrambling: str) -> str:
    """The name of a sequence that is scrambled, or not.

    Raises:
        MethodError: the sequence has no such scrambling.
    """
    names = {how: name for name in NUMBERS for of, how in [parts_of(name)] if of == sequence}
    if scrambling not in names:
        others = ", ".join(of for of, how in SCRAMBLED.values() if how == scrambling)
        raise MethodError(
            f"scrambling '{scrambling}' is not for numbers '{sequence}', which take {', '.join(names)}; it is for {others}"
        )
    return names[scrambling]


def make(name: str) -> AbstractNumbers:
    """The points called ``name``. Their module is imported here, since it imports Dr.Jit."""
    module, maker = NUMBERS[name].split(":")
    return getattr(import_module(f".{module}", __package__), maker)()


def ready(name: str, types: Any) -> AbstractNumbers:
    """The points called ``name`` with their tables on the device of Dr.Jit's array ``types``: kernels may ask for them."""
    numbers = make(name)
    numbers.prepare(types)
    return numbers
