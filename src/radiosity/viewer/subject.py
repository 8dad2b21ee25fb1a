"""What the viewer shows: a solution, or a scene that is not solved yet, with the quantities that each has."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..errors import MethodError, OutputError
from ..image import quantity as of_solutions
from ..image import tone
from ..image.output import require_results
from ..image.quantity import Quantity
from ..patches import Patches
from ..scene import Scene
from ..solution import Solution
from ..solution.intervals import QUANTITIES, Whole, of_patches

LEVEL = 0.95  # of intervals
ARRIVALS, LINES = "arrivals", "lines that hit the patch"
OF_SCENES = {"reflectance": "reflectance", "emission": "emission"}


@dataclass(frozen=True, eq=False)
class Subject:
    """The patches to show, and their solution; None: they are not solved yet."""

    patches: Patches
    solution: Solution | None = None

    @staticmethod
    def of(what: "Solution | Patches | Scene") -> "Subject":
        """Return the subject of a solution, of patches, or of a scene, which is cut as `solve` would cut it.

        Raises:
            MethodError: it is none of them.
            OutputError: the solution has no results yet.
        """
        if isinstance(what, Solution):
            require_results(what)
            return Subject(what.patches, what)
        if isinstance(what, Scene):
            from ..patches import subdivide

            return Subject(subdivide(what))
        if isinstance(what, Patches):
            return Subject(what)
        raise MethodError(f"view takes a Solution, a Scene or Patches, not {type(what).__name__}; load a file with load_solution")

    def interval(self, patch: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Return the ends of 95 % intervals of a patch's radiosity and irradiance, (n_bands,) each; none before it is solved."""
        if self.solution is None:
            return {}
        ends = {name: of_patches(self.solution, LEVEL, name, np.array([patch]), self._whole) for name in QUANTITIES}
        return {name: (low[0], high[0]) for name, (low, high) in ends.items()}

    @cached_property
    def _whole(self) -> Whole | None:
        return None if self.solution is None else Whole.of(self.solution)

    @property
    def names(self) -> dict[str, str]:
        """The quantities that there are, and what they are in words."""
        if self.solution is None:
            names = dict(OF_SCENES)
        else:
            known = dict(of_solutions.NAMES)
            if not self.patches.scene.photometric:
                del known["luminance"]
            counted = {} if self.solution.by_own_lines or self.solution.by_baseline else {ARRIVALS: LINES}
            names = known | counted | OF_SCENES
        return names | ({} if self.patches.scene.transmittance is None else {"transmittance": "transmittance"})

    def quantity(self, name: str, band: str | None = None, *, single: bool = False) -> Quantity:
        """Return a quantity; arguments are those of `radiosity.image.quantity.choose`.

        Raises:
            OutputError: there is no such quantity here, or no such band.
        """
        if name not in self.names:
            why = "" if self.solution is not None else " before the scene is solved (radiosity solve)"
            raise OutputError(f"there is no quantity '{name}'{why}; there are {', '.join(self.names)}")
        bands = tuple(str(one) for one in self.patches.scene.bands)
        if band is not None and band not in bands:
            raise OutputError(f"band '{band}' does not exist; known are {', '.join(bands)}")
        patches = self.patches
        own = np.zeros(len(patches), bool)
        if name == ARRIVALS and self.solution is not None:
            return Quantity(np.asarray(self.solution.arrivals, np.float64)[:, None], LINES, "lines", ("all",), own)
        if name == "transmittance":
            return Quantity(patches.transmittance[:, None], name, "1", ("all",), own)
        if name not in OF_SCENES:
            return of_solutions.choose(self.solution, name, band, single=single)
        values, unit = np.asarray(getattr(patches, name), np.float64), "1" if name == "reflectance" else patches.scene.unit
        if band is not None:
            at = bands.index(band)
            return Quantity(values[:, at : at + 1], name if len(bands) == 1 else f"{name}, {band}", unit, (band,), own)
        if single and len(bands) > 1:
            mean = "bands weighted as the eye does" if len(bands) == 3 else "mean of the bands"
            return Quantity(tone.luminance(values)[:, None], f"{name}, {mean}", unit, ("all",), own)
        return Quantity(values, name, unit, bands, own)
