"""A method is a choice on four axes (Bekaert, Cools, Willems, "An empirical comparison of Monte Carlo radiosity algorithms")."""

from dataclasses import dataclass

from ..errors import MethodError
from .equation import EQUATIONS
from .lines import LINES
from .numbers import NUMBERS
from .order import ORDERS

AXES = {"equation": tuple(EQUATIONS), "lines": tuple(LINES), "order": tuple(ORDERS), "numbers": tuple(NUMBERS)}


@dataclass(frozen=True)
class Method:
    """One algorithm.

    Attributes:
        equation: where does a particle leave a patch it hit?
        lines: what carries it?
        order: which line is fired next?
        numbers: which points of the unit cube?
        coherent: trace lines in packets of like directions with Embree's coherent flag. Faster where patches fire
            thousands of lines, but at an exact tie of two faces the winner depends on the packet: outside contract 2.

    Raises:
        MethodError: a value that does not exist, or a combination that makes no sense.
    """

    equation: str = "discrete"
    lines: str = "local"
    order: str = "breadth-first"
    numbers: str = "halton"
    coherent: bool = False

    def __post_init__(self):
        for axis, known in AXES.items():
            value = getattr(self, axis)
            if value not in known:
                raise MethodError(f"{axis} '{value}' does not exist; known are {', '.join(known)}")
        if self.coherent and self.numbers != "halton":
            raise MethodError(f"coherent firing needs strata of the Halton sequence, not '{self.numbers}' numbers; leave one out")
        if self.coherent and self.order != "breadth-first":
            raise MethodError(f"coherent firing needs whole sweeps, not order '{self.order}'; take breadth-first")

    def __str__(self) -> str:
        return "/".join(getattr(self, axis) for axis in AXES) + ("/coherent" if self.coherent else "")
