"""Which points of the unit cube? A new sequence is one new file and one line in the table."""

from dataclasses import dataclass
from importlib import import_module
from typing import Any

from ...errors import MethodError
from .base import DIMENSIONS, WORDS, AbstractNumbers


@dataclass(frozen=True)
class Points:
    """A sequence, or a sequence that is scrambled.

    Attributes:
        maker: the module, and what in it makes the points.
        of: the sequence that is scrambled; empty for a sequence as it is defined.
        scrambling: how.
    """

    maker: str
    of: str = ""
    scrambling: str = "none"


# By the names that reports and files have. A sequence is chosen by `numbers` and `scrambling`; these names are taken as well.
NUMBERS = {
    "faure": Points("faure:faure"),
    "generalized-faure": Points("generalized_faure:generalized_faure", of="faure", scrambling="linear"),
    "halton": Points("halton:Halton"),
    "niederreiter": Points("niederreiter:niederreiter"),
    "random": Points("random:Random"),
    "scrambled-halton": Points("scrambled_halton:ScrambledHalton", of="halton", scrambling="permuted-digits"),
    "sobol": Points("sobol:sobol"),
}

__all__ = ["DIMENSIONS", "NUMBERS", "WORDS", "AbstractNumbers", "Points", "make", "name_of", "parts_of", "ready"]


def parts_of(name: str) -> tuple[str, str]:
    """The sequence and the scrambling that a name stands for."""
    points = NUMBERS[name]
    return points.of or name, points.scrambling


def name_of(sequence: str, scrambling: str) -> str:
    """The name of a sequence that is scrambled, or not.

    Raises:
        MethodError: the sequence has no such scrambling.
    """
    names = {parts_of(name)[1]: name for name in NUMBERS if parts_of(name)[0] == sequence}
    if scrambling not in names:
        others = [name for name in NUMBERS if NUMBERS[name].scrambling == scrambling]
        raise MethodError(
            f"scrambling '{scrambling}' is not for numbers '{sequence}', which take {', '.join(names)}; it is for "
            f"{', '.join(NUMBERS[name].of for name in others)}"
        )
    return names[scrambling]


def make(name: str) -> AbstractNumbers:
    """The points called ``name``. Their module is imported here, since it imports Dr.Jit."""
    module, maker = NUMBERS[name].maker.split(":")
    return getattr(import_module(f".{module}", __package__), maker)()


def ready(name: str, types: Any) -> AbstractNumbers:
    """The points called ``name`` with their tables on the device of Dr.Jit's array ``types``: kernels may ask for them."""
    numbers = make(name)
    numbers.prepare(types)
    return numbers
