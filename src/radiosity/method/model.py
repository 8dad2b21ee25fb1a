"""A method is a choice on four axes (Bekaert, Cools, Willems, "An empirical comparison of Monte Carlo radiosity algorithms")."""

from dataclasses import dataclass

from ..errors import MethodError
from ..sampling.numbers import NUMBERS
from .combinations import machine
from .equation import EQUATIONS
from .estimator import ABSORPTIONS, ESTIMATORS
from .lines import LINES
from .order import ORDERS
from .randomisation import RANDOMISATIONS

AXES = {"equation": tuple(EQUATIONS), "lines": tuple(LINES), "order": tuple(ORDERS), "numbers": tuple(NUMBERS)}
CHOICES = AXES | {
    "randomisation": tuple(RANDOMISATIONS),
    "estimator": tuple(ESTIMATORS),
    "absorption": ("auto", *ABSORPTIONS),
}


@dataclass(frozen=True)
class Method:
    """One algorithm.

    Attributes:
        equation: where does a particle leave a patch it hit?
        lines: what carries it?
        order: which line is fired next?
        numbers: which points of the unit cube?
        randomisation: "by-patch" or "shared": do patches share the shift that moves a sequence? Random numbers have none: each
            patch has its own in any case. What does not begin at patches (global lines, fractional absorption) shares it, too.
        estimator: what is scored?
        absorption: how does a walk end? "auto" is "rounded" where patches can round, else "drawn".
        first_shot: global lines: the share of all lines that sends the lights' own power by local lines first; 0 is none.
        control_variate: iterations: a constant radiosity is taken out of what lines carry, and put back exactly.
        warm_up: regular iterations: begin with incremental ones, whose bias is small.
        reconstruction: "patches" counts what lands on each; "local-linear" fits planes to the landings about each point.
        coherent: trace lines in packets of like directions with Embree's coherent flag. Faster where a patch fires 50 000 lines
            and more in a sweep, but at an exact tie of two faces the winner depends on the packet: outside contract 2.

    Raises:
        MethodError: a value that does not exist, or a combination that makes no sense.

    Example:
        >>> method = rd.Method(order="depth-first", numbers="sobol")
        >>> print(method)
        discrete/local/depth-first/sobol
    """

    equation: str = "discrete"
    lines: str = "local"
    order: str = "breadth-first"
    numbers: str = "halton"
    randomisation: str = "by-patch"
    estimator: str = "collision"
    absorption: str = "auto"
    first_shot: float = 0.0
    control_variate: bool = False
    warm_up: bool = False
    reconstruction: str = "patches"
    coherent: bool = False

    def __post_init__(self):
        for choice, known in CHOICES.items():
            value = getattr(self, choice)
            if value not in known:
                raise MethodError(f"{choice} '{value}' does not exist; known are {', '.join(known)}")
        machine(self)

    @property
    def needs_powers_of_two(self) -> bool:
        """Patches of any cut will do."""
        return False

    @property
    def machine(self) -> str:
        """The process that runs it, a name of `algorithms.table.ALGORITHMS`."""
        return machine(self)

    def __str__(self) -> str:
        extras = [self.randomisation] if self.randomisation != "by-patch" else []
        extras += [] if self.estimator == "collision" else [self.estimator]
        extras += [] if self.absorption == "auto" else [self.absorption]
        extras += [f"first-shot={self.first_shot:g}"] if self.first_shot else []
        extras += [self.reconstruction] if self.reconstruction != "patches" else []
        extras += [name.replace("_", "-") for name in ("control_variate", "warm_up", "coherent") if getattr(self, name)]
        return "/".join([*(getattr(self, axis) for axis in AXES), *extras])
