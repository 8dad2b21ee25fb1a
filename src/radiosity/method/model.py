"""A method is a choice on four axes (Bekaert, Cools, Willems, "An empirical comparison of Monte Carlo radiosity algorithms")."""

from dataclasses import dataclass

from .combinations import machine
from .option import documented
from .options import METHOD, choices

CHOICES = choices(METHOD)
AXES = {axis: CHOICES[axis] for axis in ("equation", "lines", "order", "numbers")}


@documented(METHOD)
@dataclass(frozen=True)
class Method:
    """One algorithm that traces lines.

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
        for name, option in METHOD.items():
            option.check(getattr(self, name))
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
