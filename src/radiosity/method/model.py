"""A method is a choice on four axes (Bekaert, Cools, Willems, "An empirical comparison of Monte Carlo radiosity algorithms")."""

from dataclasses import asdict, dataclass, field

from ..errors import MethodError
from ..sampling.numbers import name_of, parts_of
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
    scrambling: str | None = field(default=None, kw_only=True)  # becomes "none" when it is made with None
    randomisation: str = "by-patch"
    padding: str = field(default="shuffled", kw_only=True)
    estimator: str = "collision"
    absorption: str = "auto"
    first_shot: float = 0.0
    control_variate: bool = False
    warm_up: bool = False
    reconstruction: str = "patches"
    basis: str = "constant"
    refine_lines: float = 0.0
    coherent: bool | str = False

    def __post_init__(self):
        for name, option in METHOD.items():
            option.check(getattr(self, name))
        sequence, scrambling = parts_of(self.numbers)
        if sequence != self.numbers and self.scrambling not in (None, scrambling):
            raise MethodError(
                f"numbers '{self.numbers}' are {sequence} with scrambling '{scrambling}', not '{self.scrambling}'; take numbers "
                f"'{sequence}', or leave scrambling out"
            )
        name = name_of(sequence, self.scrambling or scrambling)
        object.__setattr__(self, "numbers", sequence)
        object.__setattr__(self, "scrambling", None if name == sequence else self.scrambling or scrambling)
        machine(self)

    @property
    def needs_powers_of_two(self) -> bool:
        """True where patches must be the leaves of a hierarchy."""
        return self.refine_lines > 0

    @property
    def machine(self) -> str:
        """The algorithm that runs it, a name of `algorithms.table.ALGORITHMS`."""
        return machine(self)

    @property
    def points(self) -> str:
        """The name of the sequence as it is scrambled, in `sampling.numbers.NUMBERS`."""
        return name_of(self.numbers, self.scrambling or "none")

    @property
    def choices(self) -> dict:
        """All choices by their names, as files hold them: the scrambling is in the name of the numbers."""
        return {name: value for name, value in asdict(self).items() if name != "scrambling"} | {"numbers": self.points}

    def __str__(self) -> str:
        extras = [self.randomisation] if self.randomisation != "by-patch" else []
        extras += [self.padding] if self.padding != "shuffled" else []
        extras += [] if self.estimator == "collision" else [self.estimator]
        extras += [] if self.absorption == "auto" else [self.absorption]
        extras += [f"first-shot={self.first_shot:g}"] if self.first_shot else []
        extras += [self.reconstruction] if self.reconstruction != "patches" else []
        extras += [self.basis] if self.basis != "constant" else []
        extras += [f"refine-lines={self.refine_lines:g}"] if self.refine_lines else []
        extras += [name.replace("_", "-") for name in ("control_variate", "warm_up") if getattr(self, name)]
        extras += ["coherent" if self.coherent is True else f"coherent={self.coherent}"] if self.coherent else []
        return "/".join([self.equation, self.lines, self.order, self.points, *extras])
