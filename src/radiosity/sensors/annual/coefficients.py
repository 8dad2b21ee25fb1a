"""Daylight coefficients: what sensors get from each sky patch of radiance 1, straight and reflected."""

from dataclasses import dataclass

import numpy as np

from ...algorithms.gather.packets import Packets
from ...patches.scatter import Scatter
from ...problem.model import Problem
from ...sampling.streams import Purpose, Seed
from ...scene.lights.sky_patches import SkyPatches
from ...scene.photopic import PHOTOPIC
from ...tracing.geometry import Geometry
from ..model import Sensors
from ..receivers import Receivers
from .gathering import Gathering
from .reflections import weights
from .sunlight import Sunlight

OF_PATCHES = 0.25  # lines of a patch for a line of a sensor
IN_PANES = 16  # rays of a sensor to a sun, in each replicate, where panes let some through
PATCHES = (Purpose.YEAR_PATCHES, Purpose.YEAR_PATCHES_SHADOW)
SENSORS = (Purpose.YEAR_SENSORS, Purpose.YEAR_SENSORS_SHADOW)


@dataclass(frozen=True, eq=False)
class Setup:
    """What the lines of a year follow from, besides the scene.

    Attributes:
        sensors: where.
        seed: of the first replicate.
        sky, axes: the sky's patches and directions, see `Bins`.
    """

    sensors: Sensors
    seed: Seed
    sky: SkyPatches
    axes: np.ndarray

    def replicate(self, geometry: Geometry, problem: Problem, number: int) -> "Replicate":
        """Return a replicate without lines.

        Args:
            problem: whose only light is a sky of radiance 1.
        """
        geometry.prepare()
        seed = Seed(self.seed.value, self.seed.first_replicate + number)
        return Replicate(geometry, problem, self.sensors, seed, self.sky, self.axes)


class Replicate:
    """The lines of one replicate, and what they say so far."""

    def __init__(self, geometry: Geometry, problem: Problem, sensors: Sensors, seed: Seed, sky: SkyPatches, axes: np.ndarray):
        """Make it without lines.

        Args:
            problem: whose only light is a sky of radiance 1.
            axes: of the sky, see `Bins`.
        """
        grey = problem.scalar
        self.problem = problem
        self.places, self.weights = np.zeros(0, np.int64), np.zeros((len(sensors), 0), np.float32)  # of patches that count
        self.receivers = Receivers(geometry, 1, sensors=sensors, seed=seed)
        self.patches = Gathering.of(Packets(geometry, 1), grey, seed, PATCHES, sky, axes)
        self.sensors = Gathering.of(self.receivers, grey, seed, SENSORS, sky, axes)

    def of(self, *, patches: bool) -> Gathering:
        """Return the lines of patches, or those of sensors."""
        return self.patches if patches else self.sensors

    def advance(self, each: int) -> int:
        """Trace until each sensor has so many lines of both kinds; return the number of new lines."""
        return sum(self.of(patches=kind).advance(count, count) for kind, count in counts_of(each))

    def coefficients(self) -> tuple[np.ndarray, np.ndarray]:
        """Return what sensors get from each sky patch of radiance 1, straight and reflected, (n_sensors, n_sky_patches) each."""
        seen, factors = self.receivers.mean_of_planes(self.sensors.shares()), self.patches.shares()
        parts = (np.float32(share) * weights(seen, factors, one) for share, one in photopic_scatters(self.problem))
        of_patches = np.sum(list(parts), axis=0)
        seen_at_all = np.flatnonzero(of_patches.any(axis=0))
        self.places, self.weights = self.patches.lines.packets.place[seen_at_all], of_patches[:, seen_at_all]
        straight = self.receivers.mean_of_planes(self.sensors.from_sky())
        return straight, of_patches @ self.patches.from_sky()

    def behind(self) -> np.ndarray:
        """Return the share of each sensor's cosine lines that met absorbing backs, (n_sensors,)."""
        return self.receivers.mean_of_planes(self.sensors.lost[:, None])[:, 0] / max(self.sensors.counts[0], 1)

    def suns(self, towards: np.ndarray, first: int) -> tuple[np.ndarray, np.ndarray]:
        """Return what sensors get of a unit of normal irradiance by each sun, straight and reflected, (n_sensors, n_suns) each.

        Args: see `Sunlight.shares`.
        """
        straight, lit = (self.sunlight(patches=kind).shares(towards, first) for kind in (False, True))
        return self.of_suns(straight, lit)

    def sunlight(self, *, patches: bool, places: np.ndarray | None = None) -> Sunlight:
        """Return the rays to suns: those of sensors, or those of patches.

        Args:
            places: of the patches that are asked; None: of those that sensors see, by the lines so far.
        """
        if patches:
            return Sunlight(self.patches.of_suns, self.places if places is None else places)
        return Sunlight(self.sensors.of_suns, self.receivers.place, 1 if self.receivers.geometry.panes is None else IN_PANES)

    def of_suns(self, straight: np.ndarray, lit: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what sensors get by each sun, straight and reflected, from what rays of sensors and patches brought."""
        return self.receivers.mean_of_planes(straight.T), self.weights @ lit.T


def counts_of(each: int) -> list[tuple[bool, int]]:
    """Return the lines of a patch (True) and of a sensor (False), of each kind, where sensors have so many."""
    return [(True, max(int(each * OF_PATCHES), 2)), (False, each)]


def photopic_scatters(problem: Problem) -> list[tuple[float, Scatter]]:
    """Return what patches send on of what they receive, in groups of bands, and the share of white light of each."""
    scatter, groups = problem.groups.scatter, problem.groups.index
    shares = np.bincount(groups, PHOTOPIC if len(groups) > 1 else None, problem.groups.n_groups)
    return [(float(share), scatter.column(group)) for group, share in enumerate(shares)]


@dataclass(frozen=True, eq=False)
class Coefficients:
    """Daylight coefficients of sensors: what each gets from each sky patch of radiance 1, replicates apart.

    Attributes:
        straight, reflected: (replicates, n_sensors, n_sky_patches) float64, sr; the last patch is the ground.
    """

    straight: np.ndarray
    reflected: np.ndarray

    @property
    def whole(self) -> np.ndarray:
        """Both together."""
        return self.straight + self.reflected
