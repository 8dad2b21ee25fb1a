"""A sky: the radiance that lines see which leave the scene."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class Sky:
    """Radiance of all directions, as a table.

    Between its entries the radiance is linear in azimuth and in the sine of the elevation, so that integrals of the table are
    exact. A sky that is linear in the sine of the elevation, as that of CIE's overcast sky is, needs two rows above the horizon.

    Attributes:
        name: of the light.
        radiance: (n_elevations, n_azimuths, n_bands) float64, W/(m² sr) or cd/m². The first half of the rows has elevations
            evenly spaced from -90 to 0 degrees, just below the horizon; the second half from 0, just above it, to 90: radiance
            may change at once at the horizon. Azimuths are evenly spaced from 0 to 360, 360 not in the table. Azimuth 0 is along
            ``axes[0]``.
        axes: (3, 3) float64, rows of unit length: the directions of azimuth 0, of azimuth 90 (both at the horizon), and up.
        kind: what the table was made of, for reports.
        photometric: its radiance is in cd/m², not W/(m² sr).
    """

    name: str
    radiance: np.ndarray
    axes: np.ndarray
    kind: str = ""
    photometric: bool = True

    @cached_property
    def sines(self) -> np.ndarray:
        """The sine of the elevation of each row, (n_elevations,)."""
        return row_sines(len(self.radiance))

    @cached_property
    def flux(self) -> np.ndarray:
        """The integral of the radiance over all directions, (n_bands,) W/m² or lm/m²."""
        row = self.radiance.mean(axis=1)
        return np.pi * (np.diff(self.sines)[:, None] * (row[1:] + row[:-1])).sum(axis=0)

    @cached_property
    def horizontal(self) -> np.ndarray:
        """Irradiance of a horizontal plane that looks up, and sees no ground, (n_bands,) W/m² or lm/m²."""
        half = len(self.sines) // 2
        return horizontal_weights(2 * half)[half:] @ self.radiance[half:].mean(axis=1)

    def at(self, directions: np.ndarray) -> np.ndarray:
        """Return the radiance that lines of directions see, (..., 3) of unit length, as (..., n_bands)."""
        along, aside, up = (directions @ axis for axis in self.axes)
        rows, columns = self.radiance.shape[:2]
        half = rows // 2
        elevation = np.arcsin(np.clip(up, -1, 1)) * ((half - 1) / (np.pi / 2))
        low = np.where(
            up >= 0,
            half + np.clip(np.floor(elevation), 0, half - 2),
            np.clip(np.floor(elevation) + half - 1, 0, half - 2),
        ).astype(np.int64)
        t = ((up - self.sines[low]) / (self.sines[low + 1] - self.sines[low]))[..., None]
        place = np.arctan2(aside, along) / (2 * np.pi) % 1 * columns
        left = np.floor(place).astype(np.int64) % columns
        s, right = (place % columns - left)[..., None], (left + 1) % columns
        lower = (1 - s) * self.radiance[low, left] + s * self.radiance[low, right]
        upper = (1 - s) * self.radiance[low + 1, left] + s * self.radiance[low + 1, right]
        return (1 - t) * lower + t * upper


def row_sines(rows: int) -> np.ndarray:
    """Return the sines of the elevations of a table's rows."""
    up = np.sin(np.linspace(0, np.pi / 2, rows // 2))
    return np.concatenate([-up[::-1], up])


def horizontal_weights(rows: int) -> np.ndarray:
    """Return weights w of a table's rows: a plane that looks up receives the sum of w times the mean radiance of each row.

    Rows below the horizon have weights as well: their sum is what a plane that looks down receives, negative.
    """
    sines = row_sines(rows)
    low, high = sines[:-1], sines[1:]
    weights = np.zeros(rows)
    # the integrals of (1 - t) z and t z over a strip, 2 pi dz, where z goes from low to high as t from 0 to 1
    weights[:-1] += np.pi / 3 * (high - low) * (2 * low + high)
    weights[1:] += np.pi / 3 * (high - low) * (low + 2 * high)
    return weights
