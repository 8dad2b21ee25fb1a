"""The model of a solution: radiosity, irradiance and their errors for every patch, energy balance, and provenance."""

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from ..errors import MethodError
from ..hooks import HOOKS
from ..patches.bases import CONSTANT, Basis, of_size
from ..patches.model import Patches
from ..patches.polynomials import Polynomials
from . import intervals, means
from .brief import brief
from .errors import relative_error_of
from .sides import Sides, sides_of


@dataclass(frozen=True, eq=False, repr=False)
class Solution:
    """Radiosity, irradiance and their errors for every patch; `radiosity.solve` returns one.

    Attributes:
        patches: the patches solved for.
        irradiance: (n_patches, n_bands) float64, W/m² or lm/m²; of a pane it includes what goes through.
        irradiance_standard_error: the same shape; NaN (unknown) without replicates. With density estimation it includes the size
            of the bias: it is the root of the sum of both squares.
        arrivals: (n_patches,) int64, the hit count of each patch, all replicates together. 0: no line reached it, so its value is
            unknown, and the standard error is that of one hit.
        rays: lines traced in all.
        seconds: wall time.
        quanta: N of each replicate; ``solve(..., quanta=N)`` repeats the run bit for bit.
        replicates: number of randomised runs.
        escaped: (n_bands,) float64, power that left the scene, W or lm.
        books: the energy balance, one dict a band: emitted, rounding, absorbed, escaped, lost (W or lm); and closes (bool): their
            sums agree to the last unit as whole numbers, before they became powers.
        status: "complete", "interrupted", "not reached" (the error asked for, within its limit or what counters hold) or a reason
            for the early end.
        provenance: scene hash, method, seed, versions.
        state: arrays from which a run continues.
        surface_power: (2, replicates, n_surfaces, n_bands) float64, W or lm: what the patches of each surface receive, and what
            they reflect, in each replicate. None in files of older versions.
        side_power: (2, replicates, 2 n_surfaces, n_bands) float64, the same powers for front and back of each surface in turn.
            None where no back radiates, and in files of older versions.
        warnings: what the run warned of; on the command line also what reading the scene did. Empty in files of older versions.
        irradiance_coefficients: (n_patches, n_bands, K - 1) float64, in the unit of the irradiance: the coefficients after the
            mean of its polynomial on each patch, where the method's basis has K functions (`basis`); else None.
        irradiance_coefficients_standard_error: the same shape; NaN (unknown) without replicates.
        side_bias: (2 n_surfaces, n_bands) float64, W or lm: by how much what the front and the back of each surface receive may
            be off in all replicates alike, which they do not show. None where the method states no bias.

    Example:
        >>> solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=2), rays=10_000)
        >>> low, high = solution.surface_interval(0.95)  # of the mean irradiance of each surface
        >>> low.shape, bool((low < high).all())
        ((9, 1), True)
    """

    patches: Patches
    irradiance: np.ndarray
    irradiance_standard_error: np.ndarray
    arrivals: np.ndarray
    rays: int
    seconds: float
    quanta: int
    replicates: int
    books: tuple[dict, ...]
    status: str
    provenance: dict
    state: dict = field(default_factory=dict)
    surface_power: np.ndarray | None = None
    side_power: np.ndarray | None = None
    warnings: tuple[str, ...] = ()
    irradiance_coefficients: np.ndarray | None = None
    irradiance_coefficients_standard_error: np.ndarray | None = None
    side_bias: np.ndarray | None = None

    @cached_property
    def radiosity(self) -> np.ndarray:
        """The radiosity, emission plus reflectance times irradiance, (n_patches, n_bands) float64.

        A diffusing pane adds its diffuse transmittance times the irradiance of its other side.
        What goes straight on through a pane is no radiosity of the pane: lines carry it from where it comes from.
        """
        return self.patches.emission + self.patches.scatter.of(self.irradiance)

    @cached_property
    def standard_error(self) -> np.ndarray:
        """The standard error of the radiosity, (n_patches, n_bands) float64; zero on black patches, NaN where unknown.

        On a diffusing pane the errors of both sides are added: it is never too small, and at most 1.4 times too large where they
        do not depend on each other.
        """
        return self.patches.scatter.error_of(self.irradiance_standard_error)

    @property
    def basis(self) -> Basis:
        """The basis of the light on patches."""
        found = self.irradiance_coefficients
        return CONSTANT if found is None else of_size(found.shape[2] + 1)

    @cached_property
    def radiosity_coefficients(self) -> np.ndarray | None:
        """The coefficients after the mean of the radiosity on each patch, (n_patches, n_bands, K - 1); None with constants."""
        return None if self.irradiance_coefficients is None else self.patches.scatter.of_moments(self.irradiance_coefficients)

    def at(self, patch: np.ndarray, u: np.ndarray, v: np.ndarray, quantity: str = "radiosity") -> np.ndarray:
        """Return the light at points of patches, (m, n_bands): of polynomials the value there, else that of the patch.

        Args:
            patch: (m,) numbers of patches.
            u, v: (m,) coordinates of the points along the first and second edge of their faces, 0 to 1.
            quantity: "radiosity" or "irradiance".

        Raises:
            MethodError: another quantity.
        """
        if quantity not in ("radiosity", "irradiance"):
            raise MethodError(f"quantity '{quantity}' is not known at points; known are radiosity, irradiance")
        mean, others = getattr(self, quantity), getattr(self, f"{quantity}_coefficients")
        if others is None:
            return mean[patch]
        return Polynomials(self.patches, self.basis, mean, others).at(np.asarray(patch), np.asarray(u), np.asarray(v))

    @property
    def bands(self) -> tuple[str, ...]:
        """Names of the scene's bands."""
        return self.patches.scene.bands

    @property
    def unit(self) -> str:
        """Unit of radiosity, W/m² or lm/m²."""
        return self.patches.scene.unit

    @property
    def irradiance_unit(self) -> str:
        """Unit of irradiance: W/m², or lx where the scene is photometric."""
        return self.patches.scene.irradiance_unit

    @property
    def escaped(self) -> np.ndarray:
        """The power that left the scene, (n_bands,) float64, W or lm."""
        return np.array([book["escaped"] for book in self.books])

    @cached_property
    def few(self) -> np.ndarray:
        """The patches that few lines hit, (n_patches,) bool: with fewer than `intervals.FEW` a standard error is unreliable.

        `interval` goes up to a bound from their number there. False where lines pass on both sides (`Back.OPEN`), and everywhere
        for baselines, which do not count lines.
        """
        return intervals.few_of(self)

    @cached_property
    def of_whole(self) -> intervals.Whole:
        """What intervals of patches take from the whole solution."""
        return intervals.Whole.of(self)

    @cached_property
    def sides(self) -> Sides:
        """The sides of two-sided surfaces that light reached, and the rows of tables; see `solution.sides.Sides`."""
        return sides_of(self)

    @property
    def signed(self) -> bool:
        """True where lines take power away as well as bring it: there was a control variate, or they carry polynomials."""
        choices = self.provenance.get("choices", {})
        iterated = choices.get("equation") == "discrete" and self.basis.size > 1
        return bool(choices.get("control_variate")) or iterated

    @property
    def by_own_lines(self) -> bool:
        """True where each patch is measured by lines that leave it: `arrivals` says nothing of light that came."""
        return self.provenance.get("choices", {}).get("order") == "gather"

    @property
    def by_baseline(self) -> bool:
        """True where a method that forms the matrix solved it."""
        return "scheme" in self.provenance.get("choices", {})

    def interval(
        self, level: float = 0.95, quantity: str = "radiosity", rows: np.ndarray | slice = slice(None)
    ) -> tuple[np.ndarray, np.ndarray]:
        """The ends of intervals that hold the true value with probability ``level``, lower and upper, (n_patches, n_bands) each.

        They are Student's intervals over replicates, in the solution's unit. Where `few` lines hit they go up to a bound from
        their number. They are NaN where unknown: without replicates.

        Args:
            quantity: "radiosity" or "irradiance".
            rows: the patches that are asked for: their numbers, or a slice.

        Raises:
            MethodError: another quantity, or a level outside (0, 1).
        """
        return intervals.of_patches(self, level, quantity, rows)

    def surface_interval(self, level: float = 0.95, quantity: str = "irradiance") -> tuple[np.ndarray, np.ndarray]:
        """The intervals of the area mean over each surface, (n_surfaces, n_bands) each; arguments are those of `interval`.

        A side that no line reached, such as the outside of a room, is left out (`sides`).
        """
        return means.of_surfaces(self, level, quantity)

    def scene_interval(self, level: float = 0.95, quantity: str = "irradiance") -> tuple[np.ndarray, np.ndarray]:
        """The interval of the area mean over the whole scene, (n_bands,) each, without sides that no line reached."""
        return means.of_scene(self, level, quantity)

    @cached_property
    def error(self) -> float:
        """The relative error of the scene; NaN without replicates.

        It is the area-weighted RMS of the standard error of B - E over that of B - E, the largest of the bands. Where nothing
        reflects, it is the relative error of the irradiance.
        """
        return self._relative(slice(None))

    def _relative(self, rows: np.ndarray | slice) -> float:
        if self.by_baseline and not self.irradiance_standard_error[rows].any():
            return float("nan")
        patches = self.patches.solid
        return relative_error_of(patches.scatter, self.irradiance, self.irradiance_standard_error, patches.area, rows)

    @property
    def history(self) -> np.ndarray:
        """The steps of a baseline, and what was left after them, (k, 2) float64. Empty for methods without such steps.

        - full-matrix: iterations, and the largest residual over the largest radiosity
        - progressive: shots, and unshot over emitted power
        - hierarchical: passes, and the largest change over the largest radiosity
        """
        return np.asarray(self.state.get("history", np.zeros((0, 2))))

    @property
    def indicated(self) -> np.ndarray | None:
        """The errors of irradiance that the links of hierarchical radiosity may add up to, (n_patches, n_bands) W/m² or lm/m².

        They are far above the true error: see docs/hierarchical.md. NaN with the refinement brightness-factor, which gives no
        error. None for other methods, and before the last round is complete.
        """
        return self.state.get("indicated")

    def surface_table(self) -> list[dict]:
        """The table of surfaces: a row for each surface, or for each side that light reached.

        It has area, means, errors, and the power balance in W or lm; see `solution.table.surface_table`.
        """
        from .table import surface_table

        return surface_table(self)

    def __repr__(self) -> str:
        """The solution in five lines."""
        return brief(self)

    def _repr_html_(self) -> str:
        """The solution in five lines as HTML for notebooks, with the table of surfaces."""
        from .frames import html

        return html(self)

    def to_dataframe(self):
        """Return a pandas DataFrame with a row for each patch: the columns of a .csv file, with units in their names.

        Raises:
            OutputError: pandas is not installed.
        """
        from .frames import to_dataframe

        return to_dataframe(self)

    def to_xarray(self):
        """Return an xarray Dataset.

        Over patch and band it has radiosity, irradiance, their standard errors and 95 % intervals, reflectance and emission. Over
        patch it has surface, side, area, centroid, normal and arrivals. Units are attributes.

        Raises:
            OutputError: xarray is not installed.
        """
        from .frames import to_xarray

        return to_xarray(self)

    def report(self) -> str:
        """Return a summary in plain text."""
        from .report import report

        return report(self)

    def save(self, path) -> None:
        """Write an NPZ file that `radiosity.load_solution` reads."""
        from .saving import save

        save(self, Path(path))

    def export(self, path, **options) -> None:
        """Write .glb, .ply, .vtp, .csv, .png, .exr or .npz by the path's suffix; see `radiosity.image.export`."""
        HOOKS["export"](self, path, **options)
