"""How a luminaire shares its light among directions: a table of luminous intensities."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class Web:
    """Intensities of half planes C and angles gamma, the type C of CIE 121 and of IES LM-63.

    Gamma is the angle from the luminaire's first axis (down, for one that hangs); C turns about it. Between the entries of the
    table the intensity is linear in both angles.

    Attributes:
        planes: (n_planes,) float64, degrees, ascending from 0 to 360, both in the table; one entry: the same in all planes.
        gamma: (n_gamma,) float64, degrees, ascending; the intensity is zero outside of them.
        intensity: (n_planes, n_gamma) float64, cd or W/sr, or any unit in proportion.
    """

    planes: np.ndarray
    gamma: np.ndarray
    intensity: np.ndarray

    @cached_property
    def flux(self) -> float:
        """The integral of the intensity over all directions, lm or W."""
        return self.flux_below(180.0)

    def flux_below(self, gamma: float) -> float:
        """Return the integral of the intensity over the directions up to an angle, degrees; lm or W."""
        whole, degrees = self._mean_over_planes(), self.gamma
        if gamma < degrees[-1]:
            inside = degrees < gamma
            whole = np.append(whole[inside], np.interp(gamma, degrees, whole, left=0))
            degrees = np.append(degrees[inside], gamma)
        if len(degrees) < 2:
            return 0.0
        low, high = np.radians(degrees[:-1]), np.radians(degrees[1:])
        slope = np.diff(whole) / (high - low)
        # the integral of (a + s (g - low)) sin g from low to high
        parts = whole[:-1] * np.cos(low) - whole[1:] * np.cos(high) + slope * (np.sin(high) - np.sin(low))
        return float(2 * np.pi * parts.sum())

    def at(self, plane: np.ndarray, gamma: np.ndarray) -> np.ndarray:
        """Return intensities in directions, (n,) in the table's unit; C and gamma, (n,) degrees."""
        rows = np.stack([np.interp(gamma, self.gamma, row, left=0, right=0) for row in self.intensity])
        if len(self.planes) == 1:
            return rows[0]
        plane, each = plane % 360, np.arange(len(gamma))
        low = np.clip(np.searchsorted(self.planes, plane, side="right") - 1, 0, len(self.planes) - 2)
        part = (plane - self.planes[low]) / (self.planes[low + 1] - self.planes[low])
        return (1 - part) * rows[low, each] + part * rows[low + 1, each]

    def _mean_over_planes(self) -> np.ndarray:
        if len(self.planes) == 1:
            return self.intensity[0]
        middle = (self.intensity[1:] + self.intensity[:-1]) / 2
        return (middle * np.diff(self.planes)[:, None]).sum(axis=0) / 360.0
