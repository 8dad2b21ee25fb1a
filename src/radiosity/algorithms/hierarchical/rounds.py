"""Rounds of hierarchical radiosity: refine, solve, and refine for that solution, with ever smaller epsilon (multigridding)."""

from dataclasses import dataclass

import numpy as np

from ...patches import Hierarchy, Patches
from ...patches.clusters import grow
from ...tracing.geometry import Geometry
from .exchange import Exchange
from .last import last
from .levels import Levels
from .links import Links
from .making import Maker, Told
from .oracle import Oracle, Radiosity
from .parameters import Hierarchical
from .refine import refined
from .roots import root_pairs

ROUGH = 1e-3  # tolerance of solutions that links are refined for


@dataclass(frozen=True)
class Pass:
    """One solution with given links.

    Attributes:
        epsilon: the epsilon of its links.
        links: the number of links.
        change: the largest change of a radiosity since the pass before, over the largest radiosity of its band.
    """

    epsilon: float
    links: int
    change: float


class Rounds:
    """A solution that each round makes better; arguments as in `solve.solve_hierarchical`.

    Attributes:
        complete: the number of complete rounds.
        irradiance: (n_patches, n_bands) float64, with the links so far.
        links: the links, sorted; before the first round, links between whole sides are made.
        history: every pass.
    """

    def __init__(self, patches: Patches, geometry: Geometry | None, parameters: Hierarchical, told: Told):
        self.hierarchy, self.parameters, self.told = Hierarchy(patches), parameters, told
        self.clusters = grow(self.hierarchy) if parameters.clustered(len(self.hierarchy.side_face)) else None
        self.levels = Levels(self.hierarchy, self.clusters)
        self.oracle = Oracle(self.levels, parameters)
        self.maker = Maker(geometry if parameters.rays else None, self.hierarchy, parameters, told, self.clusters)
        self.emission, self.reflectance = patches.emission, patches.reflectance
        self.irradiance, self.history, self.complete = np.zeros_like(self.emission), [], 0
        self.links = Links.none()

    @property
    def done(self) -> bool:
        return self.complete == len(self.parameters.rounds)

    def advance(self) -> None:
        """Make the next round. If ``told`` ends it with an exception, its work is lost, and it may be called again."""
        epsilon = self.parameters.rounds[self.complete]
        links = Links.joined([self.maker.make(*self._first_pairs())]) if self.complete == 0 else self.links
        irradiance, history, new = self.irradiance, list(self.history), True
        while new:
            before = self.emission + self.reflectance * irradiance
            links, new = refined(links, self.oracle, self.maker, Radiosity.of(self.levels, before), epsilon)
            if new or not history:
                irradiance = self._solved(links, irradiance, ROUGH)
                change = _change(before, self.emission + self.reflectance * irradiance)
                history.append(Pass(epsilon, len(links), change))
        if self.complete + 1 == len(self.parameters.rounds):
            links = last(self.levels, self.maker, links, self.levels.pull(self.emission + self.reflectance * irradiance))
            irradiance = self._solved(links, irradiance, self.parameters.tolerance)
        self.links, self.irradiance, self.history = links, irradiance, history
        self.complete += 1

    def restore(self, links: Links, irradiance: np.ndarray, history: list[Pass], complete: int) -> None:
        """Go on from the links and the irradiance after a number of complete rounds."""
        self.links, self.irradiance, self.history, self.complete = links, irradiance, history, complete

    def _first_pairs(self) -> tuple[np.ndarray, np.ndarray]:
        """Return receivers and sources of the first links: all whole sides, or the whole scene with itself."""
        if self.clusters is None:
            return root_pairs(self.hierarchy, self.told)
        root = np.array([len(self.hierarchy)])
        return root, root

    def _solved(self, links: Links, begin: np.ndarray, tolerance: float) -> np.ndarray:
        return Exchange(self.levels, links).solve(self.emission, self.reflectance, begin, tolerance, self.told)


def _change(before: np.ndarray, after: np.ndarray) -> float:
    largest = after.max(axis=0)
    return float((np.abs(after - before).max(axis=0) / np.where(largest > 0, largest, 1)).max())
