"""Sky patches: parts of the sky of about the same solid angle, and the ground as one more.

- P. R. Tregenza, "Subdivision of the sky hemisphere for luminance measurements", Lighting Research & Technology 19(1), 1987,
  13-14: 145 patches in seven rows and a cap.
- C. F. Reinhart, S. Herkel, "The simulation of annual daylight illuminance distributions", Energy and Buildings 32(2), 2000,
  167-187: each patch but the cap in 2 x 2, which makes 577.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...errors import MethodError

TREGENZA = (30, 30, 24, 24, 18, 12, 6)  # patches of each row, from the horizon up; above them is the cap
PARTS = {145: 1, 577: 2}  # patches, and into how many a patch of Tregenza is cut along altitude, and along azimuth
SAMPLES = 4  # along altitude and azimuth of each patch, in means


@dataclass(frozen=True)
class SkyPatches:
    """A subdivision of the sky. The first patch of each row lies about north; the ground is the last one of all.

    Attributes:
        parts: 1: Tregenza's 145 patches. 2: Reinhart's 577.
    """

    parts: int

    @staticmethod
    def of(number: int) -> "SkyPatches":
        """Return the subdivision with so many patches.

        Raises:
            MethodError: there is none.
        """
        if number not in PARTS:
            raise MethodError(f"sky_patches is {number!r}; there are subdivisions of {' and '.join(map(str, PARTS))} patches")
        return SkyPatches(PARTS[number])

    def __len__(self) -> int:
        """The number of patches, the ground included."""
        return int(self.starts[-1]) + 2

    @property
    def step(self) -> float:
        """The height of a row, rad; the cap has half of it about the zenith."""
        return np.pi / 2 / (len(TREGENZA) * self.parts + 0.5)

    @cached_property
    def counts(self) -> np.ndarray:
        """The patches of each row without the cap, (n_rows,) int64."""
        return np.repeat(np.array(TREGENZA) * self.parts, self.parts)

    @cached_property
    def starts(self) -> np.ndarray:
        """The first patch of each row, and the cap, (n_rows + 1,) int64."""
        return np.concatenate([[0], np.cumsum(self.counts)])

    @cached_property
    def rows(self) -> np.ndarray:
        """The row of each patch of the sky, (n - 1,) int64; the cap is the last one."""
        return np.repeat(np.arange(len(self.counts) + 1), [*self.counts, 1])

    @cached_property
    def _edges(self) -> np.ndarray:
        """Sines of the altitudes between rows, (n_rows + 2,)."""
        return np.sin(np.append(np.arange(len(self.counts) + 1) * self.step, np.pi / 2))

    @cached_property
    def horizontal(self) -> np.ndarray:
        """What each patch of radiance 1 gives a horizontal plane, (n,) sr; the sky's sum is pi, and the ground gives nothing."""
        each = np.pi * np.diff(self._edges**2) / np.append(self.counts, 1)
        return np.append(each[self.rows], 0.0)

    @cached_property
    def solid_angle(self) -> np.ndarray:
        """The solid angle of each patch, (n,) sr; that of the ground is 2 pi."""
        each = 2 * np.pi * np.diff(self._edges) / np.append(self.counts, 1)
        return np.append(each[self.rows], 2 * np.pi)

    @cached_property
    def samples(self) -> tuple[np.ndarray, np.ndarray]:
        """Altitudes and azimuths, rad, of points of each patch of the sky, (n - 1, `SAMPLES`²) each: of equal solid angles."""
        shares = (np.arange(SAMPLES) + 0.5) / SAMPLES
        along, around = (axis.ravel() for axis in np.meshgrid(shares, shares))
        low, high = self._edges[self.rows, None], self._edges[self.rows + 1, None]
        count = np.append(self.counts, 1)[self.rows, None]
        place = np.arange(len(self.rows))[:, None] - self.starts[self.rows, None]
        return np.arcsin(low + along * (high - low)), (place + around - 0.5) * (2 * np.pi / count)

    def number(self, altitude: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
        """Return the patch of each direction, int64, from altitudes above the horizon and azimuths, rad."""
        row = np.minimum((np.maximum(altitude, 0) / self.step).astype(np.int64), len(self.counts))
        count = np.append(self.counts, 1)[row]
        column = np.floor(azimuth / (2 * np.pi) * count + 0.5).astype(np.int64) % count
        return np.where(altitude < 0, len(self) - 1, self.starts[row] + column)
