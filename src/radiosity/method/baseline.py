"""Baselines: methods that form the matrix F, row by row or in links, to compare with. They have axes of their own."""

from dataclasses import asdict, dataclass, fields

from ..errors import MethodError
from .option import documented
from .options import BASELINE, choices
from .schemes import SCHEMES

OF_PAIR, OF_PATCH = 16, 4096  # default samples of a pair, and of a patch

CHOICES = choices(BASELINE)
USED = {scheme: tuple(name for name, option in BASELINE.items() if scheme in option.schemes) for scheme in SCHEMES}


@documented(BASELINE)
@dataclass(frozen=True)
class Baseline:
    """One method that forms the matrix.

    Raises:
        MethodError: a value that does not exist, or a choice that the scheme makes no use of.

    Example:
        >>> print(rd.Baseline(scheme="full-matrix", solver="jacobi"))
        full-matrix/polygons/jacobi
    """

    scheme: str = "full-matrix"
    factors: str = "polygons"
    solver: str = "gauss-seidel"
    reciprocal: bool = False
    resolution: int = 64
    rotated: bool = True
    samples: int | None = None
    ambient: bool = False
    overshooting: bool = False
    epsilon: float = 1e-5
    refinement: str = "brightness-factor"

    def __post_init__(self):
        for name, option in BASELINE.items():
            option.check(getattr(self, name))
        if self.resolution % 2:
            raise MethodError(f"resolution is {self.resolution}; it must be even, since a side of a hemicube has half the rows")
        unused = [name for name in self._given if name != "scheme" and name not in USED[self.scheme]]
        if unused:
            raise MethodError(f"{', '.join(unused)}: not a choice of {self.scheme}, which has {', '.join(USED[self.scheme])}")
        if self.factors != "hemicube" and {"resolution", "rotated"} & set(self._given):
            raise MethodError(f"resolution, rotated: not of factors '{self.factors}', but of hemicubes; take --factors hemicube")
        if self.factors == "hemicube" and self.samples is not None:
            raise MethodError("samples: a hemicube has as many lines as pixels; give its resolution")

    @property
    def _given(self) -> list[str]:
        """The names of options that differ from the default."""
        return [field.name for field in fields(self) if getattr(self, field.name) != field.default]

    @property
    def choices(self) -> dict:
        """All choices by their names, as files hold them."""
        return asdict(self)

    @property
    def lines_of_pair(self) -> int:
        """The number of lines between two patches or elements, which find how much of one the other sees."""
        return self.samples or OF_PAIR

    @property
    def lines_of_patch(self) -> int:
        """The number of lines of a patch, where factors come from lines."""
        return self.samples or OF_PATCH

    @property
    def needs_powers_of_two(self) -> bool:
        """True where patches must be the leaves of quadtrees (`radiosity.subdivide`)."""
        return self.scheme == "hierarchical"

    @property
    def order(self) -> str:
        """The order that the ladder of stages asks for, as of a `Method`."""
        return self.scheme

    @property
    def machine(self) -> str:
        """The algorithm that runs it, a name of `algorithms.table.ALGORITHMS`."""
        return self.scheme

    def __str__(self) -> str:
        parts = [self.scheme]
        if self.scheme == "hierarchical":
            parts += [self.refinement, f"epsilon={self.epsilon:g}"]
        else:
            parts += [self.factors]
        if self.scheme == "full-matrix":
            parts += [self.solver]
        if self.factors == "hemicube":
            parts += [f"resolution={self.resolution}"] + ([] if self.rotated else ["aligned"])
        parts += [f"samples={self.samples}"] if self.samples else []
        return "/".join([*parts, *(name for name in ("reciprocal", "ambient", "overshooting") if getattr(self, name))])
