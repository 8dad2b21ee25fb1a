"""Tables of skies from formulas, of the horizontal irradiance that is asked for."""

from collections.abc import Callable, Iterable

import numpy as np

from ...errors import SceneError
from .sky import Sky, horizontal_weights
from .sun import Sun

ROWS, COLUMNS = 91, 360  # of the upper half: a degree. See docs/daylight.md for what this changes

Relative = Callable[[np.ndarray, np.ndarray], np.ndarray]


def sky_of(
    name: str,
    relative: Relative,
    axes: np.ndarray,
    horizontal: float,
    ground: float,
    suns: Iterable[Sun],
    kind: str,
    photometric: bool = True,
    rows: int = ROWS,
    columns: int = COLUMNS,
) -> Sky:
    """Return a sky whose table has exactly this horizontal irradiance, above a ground that reflects it.

    Args:
        relative: radiance, in any unit in proportion, of altitudes, (rows, 1), and azimuths from north through east, (columns,),
            both rad. What is below zero counts as zero.
        axes: see `axes.sky_axes`.
        horizontal: W/m² or lm/m², by the sky alone.
        ground: share of the horizontal irradiance that the ground reflects, the same in all directions.
        suns: their light falls on the ground, too.
        kind: what the sky is, for reports.
        photometric: the unit is lm/m².

    Raises:
        SceneError: a value out of range, or the formula gives no light at all.
    """
    if not (np.isfinite(horizontal) and horizontal >= 0):
        raise SceneError(f"sky '{name}': horizontal must be 0 or more, W/m² or lm/m² (it is {horizontal})")
    if not 0 <= ground <= 1:
        raise SceneError(f"sky '{name}': ground is the reflectance below the horizon, 0 to 1 (it is {ground})")
    altitude, azimuth = np.linspace(0, np.pi / 2, rows)[:, None], np.arange(columns) * (2 * np.pi / columns)
    upper = np.broadcast_to(np.maximum(relative(altitude, azimuth), 0), (rows, columns))
    received = float(horizontal_weights(2 * rows)[rows:] @ upper.mean(axis=1))
    if not (np.isfinite(received) and received > 0):
        raise SceneError(f"sky '{name}': its formula gives no light from anywhere ({kind}); take another type of sky")
    upper = upper * (horizontal / received)
    direct = sum(float(sun.irradiance.mean()) * max(float(sun.direction @ axes[2]), 0.0) for sun in suns)
    below = np.full_like(upper, ground * (horizontal + direct) / np.pi)
    return Sky(name, np.concatenate([below, upper])[..., None], axes, kind, photometric)
