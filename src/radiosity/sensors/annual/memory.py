"""The memory that a year of daylight takes, beyond scene and patches: of all of it, and of a unit of lines on a worker.

The figures are peaks of fresh processes (docs/annual-daylight.md says how far off they were).
"""

from dataclasses import dataclass

from .coefficients import counts_of
from .gathering import AT_ONCE

FIXED = 40e6  # bytes: kernels, and what lines need of a few patches
FACE = 800  # bytes a face, for the BVH and the hit records
LINE = 50  # bytes a line of a launch, while its hits are counted
PAIR = 12  # bytes a receiver and a patch that its lines hit
TABLES = 16  # bytes a receiver and sky patch: what cosine lines and shadow rays bring
HOURS = 32  # bytes a sensor and replicate, and hour of those that are summed up together
LIKELY = 2048  # lines of each kind of a sensor in a replicate, where they follow from an error


@dataclass(frozen=True)
class YearSizes:
    """What the memory of a year follows from.

    Attributes:
        sensors, planes: how many there are; a cylindrical sensor has several planes.
        patches, faces, sky: patches and faces of the scene, and patches of the sky.
        replicates: independent runs.
        each: lines of each kind of a sensor in a replicate; None where they follow from an error.
        hours: those that are kept, and those that are summed up together.
    """

    sensors: int
    planes: int
    patches: int
    faces: int
    sky: int
    replicates: int
    each: float | None = None
    hours: tuple[int, int] = (0, 0)

    def replicate(self) -> float:
        """Return the bytes of the lines of one replicate."""
        pairs = sum(min(lanes * self.patches, lanes * count) for lanes, count in self._lines())
        return TABLES * self.sky * (self.patches + self.planes) + PAIR * pairs

    def unit(self, lines: float) -> float:
        """Return the bytes of so many lines of a replicate while they are traced, and of what they bring."""
        return LINE * min(AT_ONCE, lines) + 3 * TABLES * self.sky * max(self.patches, self.planes)

    def whole(self) -> float:
        """Return the bytes of a year on this machine."""
        n, keeps, (kept, together) = self.sensors, self.replicates, self.hours
        of_results = keeps * n * (4.0 * self.patches + 32 * self.sky) + 4.0 * n * kept
        lines = max(lanes * count for lanes, count in self._lines())
        reflections = 24 * min(n, 256) * self.patches + 2 * PAIR * self._pairs_of_patches()
        passing = max(self.unit(lines), reflections, HOURS * keeps * n * together)
        return FIXED + FACE * self.faces + keeps * self.replicate() + of_results + passing

    def on_worker(self, lines: float) -> float:
        """Return the bytes of one replicate and a unit of so many lines on a worker that has the scene."""
        return FIXED + self.replicate() + self.unit(lines)

    def _lines(self) -> list[tuple[int, float]]:
        """Return the receivers of each kind, and the lines of each."""
        each = LIKELY if self.each is None else self.each
        return [(self.patches if patches else self.planes, count) for patches, count in counts_of(int(each))]

    def _pairs_of_patches(self) -> float:
        return min(float(self.patches) ** 2, float(self.patches) * self._lines()[0][1])
