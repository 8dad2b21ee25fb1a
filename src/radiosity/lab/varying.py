"""Errors of light that is a polynomial on each patch, on coarse meshes, against light on a mesh that is much finer."""

from dataclasses import dataclass

import numpy as np

from ..algorithms.table import make
from ..device.backend import choose
from ..method import Method
from ..patches import Patches, subdivide
from ..patches.bases import BASES
from ..patches.nesting import parents
from ..patches.polynomials import Polynomials
from ..problem.model import Problem
from ..run.snapshot import Snapshot
from ..run.solve import solve
from ..scene import load_scene
from ..tracing.geometry import Geometry

EACH = 40  # lines of a patch at least: below that even stored lines are not all traced


@dataclass(frozen=True, eq=False)
class Truth:
    """Light on a fine mesh.

    Attributes:
        patches: the fine patches.
        light: (n_patches, n_bands) irradiance.
        noise: the same shape, its standard error.
    """

    patches: Patches
    light: np.ndarray
    noise: np.ndarray

    @staticmethod
    def of(name: str, cells: int, lines: float, seed: int) -> "Truth":
        """Solve a scene with its faces cut into cells x cells."""
        found = solve(subdivide(load_scene(name), cells=cells), "gather", rays=lines, seed=seed)
        return Truth(found.patches, found.irradiance, found.irradiance_standard_error)

    @property
    def own(self) -> float:
        """The relative error of the truth itself."""
        area, rho = self.patches.area, self.patches.reflectance
        return float(np.sqrt((area @ (rho * self.noise) ** 2).sum() / (area @ (rho * self.light) ** 2).sum()))

    def errors(self, coarse: Patches, basis: str, moments: np.ndarray) -> np.ndarray:
        """Return the RMS error of reflected light over the area, relative to that of the light, of each replicate, (replicates,).

        The noise of the truth is taken out.

        Args:
            coarse: patches whose cells are made of fine ones.
            moments: (replicates, n_coarse, n_bands, K) coefficients of irradiance.
        """
        fine, parent = self.patches, parents(self.patches, coarse)
        column, row, inverted = fine.place
        face, quad = fine.face, fine.scene.is_quad[fine.face]
        middle = np.where(quad, 0.5, np.where(inverted, 2 / 3, 1 / 3))
        u, v = (column + middle) / fine.columns[face], (row + middle) / fine.rows[face]
        light = Polynomials(coarse, BASES[basis], moments[0, ..., 0], moments[0, ..., 1:])
        functions = BASES[basis].at(*light.place(parent, u, v), quad)
        area, rho, found = fine.area, fine.reflectance, []
        for one in moments:
            apart = np.einsum("nbk,nk->nb", one[parent], functions) - self.light
            found.append((area @ (rho**2 * (apart**2 - self.noise**2))).sum())
        return np.sqrt(np.maximum(found, 0.0) / (area @ (rho * self.light) ** 2).sum())


@dataclass(frozen=True, eq=False)
class Curve:
    """The error of a basis on a mesh.

    Attributes:
        basis: its name.
        patches: their number.
        lines: (k,) of one replicate.
        errors: (replicates, k).
    """

    basis: str
    patches: int
    lines: np.ndarray
    errors: np.ndarray


def curve(truth: Truth, cells: int, basis: str, rungs: list[int], replicates: int, seed: int) -> Curve:
    """Run a gather up a ladder of lines.

    Args:
        cells: each face has cells x cells patches.
        rungs: lines of a replicate; those with fewer than `EACH` lines a patch are left out.
    """
    coarse = subdivide(truth.patches.scene, cells=cells)
    problem = Problem.of(coarse)
    algorithm = make(Geometry(coarse, choose("cpu")), problem, Method(order="gather", basis=basis), seed, replicates)
    lines, errors = [], []
    for rung in (rung for rung in rungs if rung >= EACH * len(coarse)):
        algorithm.advance(rung, lambda lines: None)
        snapshot = Snapshot(problem, algorithm.tally, algorithm.capture(), replicates)
        lines.append(snapshot.lines / replicates)
        errors.append(truth.errors(coarse, basis, snapshot.moments()))
    return Curve(basis, len(coarse), np.array(lines), np.array(errors).T)
