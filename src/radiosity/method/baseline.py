"""What Monte Carlo radiosity is set against: methods that form the matrix F, row by row or in links, with axes of their own."""

from dataclasses import dataclass, fields

from ..errors import MethodError

SCHEMES = {
    "full-matrix": "all form factors first, then the equation is solved",
    "progressive": "the patch with the most unshot power shoots next, along a row of form factors made for it",
    "hierarchical": "links between elements of all sizes, refined where they would err",
}
FACTORS = {
    "polygons": "exact form factors of polygons, times the share of lines between two patches that nothing stops",
    "hemicube": "item buffers of the five faces of a hemicube on the middle of each patch",
    "lines": "local lines from each patch, counted where they land",
}
REFINEMENTS = {
    "brightness-factor": "a link is cut where radiosity times form factor times area is large (Hanrahan et al. 1991)",
    "error-radiance": "a link is cut where its estimated error of radiosity is large (Bekaert and Willems 1996)",
    "error-power": "a link is cut where its estimated error of power is large (Bekaert and Willems 1996)",
}
SOLVERS = ("jacobi", "gauss-seidel", "southwell", "conjugate-gradients")  # of factors.solvers
MOST_RESOLUTION, MOST_SAMPLES = 2048, 65535
OF_PAIR, OF_PATCH = 16, 4096  # samples by default

ROWS = ("factors", "resolution", "rotated", "samples")
USED = {
    "full-matrix": (*ROWS, "solver", "reciprocal"),
    "progressive": (*ROWS, "ambient", "overshooting"),
    "hierarchical": ("samples", "epsilon", "refinement"),
}
CHOICES = {"scheme": tuple(SCHEMES), "factors": tuple(FACTORS), "solver": SOLVERS, "refinement": tuple(REFINEMENTS)}


@dataclass(frozen=True)
class Baseline:
    """One method that forms the matrix.

    Attributes:
        scheme: how the equation is solved.
        factors: where form factors come from.
        solver: full-matrix: what solves the equation.
        reciprocal: full-matrix: make A_i F_ij symmetric, and rows sum to what does not escape.
        resolution: hemicube: pixels along an edge of its top, an even number.
        rotated: hemicube: turned about the normal of each patch by a random angle of its own.
        samples: lines of a pair of patches or elements (polygons, links), or of a patch (lines); None: 16, or 4096.
        ambient: progressive: add an estimate of the light not shot yet, the same on all patches.
        overshooting: progressive: shoot a part of the light that is still to come, too.
        epsilon: hierarchical: links whose error exceeds this share of what the scene emits are refined; see docs/hierarchical.md.
        refinement: hierarchical: which links are cut.

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
        for choice, known in CHOICES.items():
            if getattr(self, choice) not in known:
                raise MethodError(f"{choice} '{getattr(self, choice)}' does not exist; known are {', '.join(known)}")
        for name, most in (("resolution", MOST_RESOLUTION), ("samples", MOST_SAMPLES)):
            value = getattr(self, name)
            if name == "samples" and value is None:
                continue
            if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
                raise MethodError(f"{name} is {value!r}; it must be a whole number from 1 to {most}")
        if self.resolution % 2:
            raise MethodError(f"resolution is {self.resolution}; it must be even, since a side of a hemicube has half the rows")
        if isinstance(self.epsilon, bool) or not isinstance(self.epsilon, int | float) or not 0 < self.epsilon < 1:
            raise MethodError(f"epsilon is {self.epsilon!r}; it must be a number above 0 and below 1")
        unused = [name for name in self._given if name != "scheme" and name not in USED[self.scheme]]
        if unused:
            raise MethodError(f"{', '.join(unused)}: not a choice of {self.scheme}, which has {', '.join(USED[self.scheme])}")
        if self.factors != "hemicube" and {"resolution", "rotated"} & set(self._given):
            raise MethodError(f"resolution, rotated: not of factors '{self.factors}', but of hemicubes; take --factors hemicube")
        if self.factors == "hemicube" and self.samples is not None:
            raise MethodError("samples: a hemicube has as many lines as pixels; give its resolution")

    @property
    def _given(self) -> list[str]:
        """Names of what differs from the default."""
        return [field.name for field in fields(self) if getattr(self, field.name) != field.default]

    @property
    def lines_of_pair(self) -> int:
        """Of two patches or elements, to find how much of one the other sees."""
        return self.samples or OF_PAIR

    @property
    def lines_of_patch(self) -> int:
        """With factors by lines."""
        return self.samples or OF_PATCH

    @property
    def needs_powers_of_two(self) -> bool:
        """Patches must be the leaves of quadtrees (`radiosity.subdivide`)."""
        return self.scheme == "hierarchical"

    @property
    def order(self) -> str:
        """As a `Method` has one: the ladder of stages goes by it."""
        return self.scheme

    @property
    def machine(self) -> str:
        """The process that runs it, a name of `algorithms.table.ALGORITHMS`."""
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
