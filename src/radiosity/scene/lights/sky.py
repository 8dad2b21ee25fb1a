"""A sky: the radiance that lines see which leave the scene."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Sky:
    """Radiance of all directions, as a table that is linear in both angles between its entries.

    Attributes:
        name: of the light.
        radiance: (n_elevations, n_azimuths, n_bands) float64, W/(m² sr) or cd/m². Elevations are evenly spaced from -90 to 90
            degrees, both in the table; azimuths evenly from 0 to 360, 360 not in the table. Azimuth 0 is along ``axes[0]``.
        axes: (3, 3) float64, rows of unit length: the directions of azimuth 0, of azimuth 90 (both at the horizon), and up.
        kind: what the table was made of, for reports.
    """

    name: str
    radiance: np.ndarray
    axes: np.ndarray
    kind: str = ""
