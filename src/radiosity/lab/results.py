"""The results of an experiment."""

from dataclasses import dataclass, field

import numpy as np

from . import slopes
from .measure import Series
from .slopes import Slope


@dataclass(frozen=True, eq=False)
class Results:
    """Series of every arm on every scene.

    Attributes:
        series: by (scene, arm).
        reference_error: relative, of the reference of (scene, equation).
    """

    series: dict[tuple[str, str], Series]
    reference_error: dict[tuple[str, str], float] = field(default_factory=dict)

    def slope(self, scene: str, arm: str) -> Slope:
        """Return the slope of the area-weighted error over the last two decades."""
        found = self.series[scene, arm]
        return slopes.fit(found.lines, found.area_weighted)

    def last(self, scene: str, arm: str) -> float:
        """Return the area-weighted RMS error at the end, over replicates."""
        return float(slopes.mean_error(self.series[scene, arm].area_weighted)[-1])

    def ratio(self, scene: str, one: str, other: str) -> tuple[float, float]:
        """Return the error of one arm divided by another's at the end, and the factor within which it is known."""
        return slopes.ratio(self.series[scene, one].area_weighted, self.series[scene, other].area_weighted)

    def equal(self, scene: str, one: str, other: str) -> bool:
        """Return whether two arms have equal errors, to the last bit."""
        a, b = self.series[scene, one], self.series[scene, other]
        return np.array_equal(a.area_weighted, b.area_weighted) and np.array_equal(a.lines, b.lines)
