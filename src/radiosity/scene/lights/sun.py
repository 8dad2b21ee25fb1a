"""A sun: light from one direction."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...errors import SceneError
from ..habits import warn
from .axes import check_place, sky_axes, towards, unit

DIAMETER = 0.533  # degrees, of the sun as seen from the Earth


@dataclass(frozen=True, eq=False)
class Sun:
    """Light from a small disc of equal radiance, as far away as the stars.

    Attributes:
        name: of the light.
        direction: (3,) float64, of unit length, towards the sun.
        irradiance: (n_bands,) float64, W/m² or lm/m², on a plane that is perpendicular to the direction.
        diameter: degrees, of the disc; 0: parallel light.
        photometric: its irradiance is in lm/m², not W/m².

    Example:
        >>> rd.sun(90_000, altitude=90, azimuth=0).irradiance.tolist()
        [90000.0]
    """

    name: str
    direction: np.ndarray
    irradiance: np.ndarray
    diameter: float = DIAMETER
    photometric: bool = True


def sun(
    irradiance: ArrayLike,
    *,
    altitude: float | None = None,
    azimuth: float | None = None,
    direction: ArrayLike | None = None,
    diameter: float = DIAMETER,
    photometric: bool = True,
    up: ArrayLike | str = "z",
    north: ArrayLike | None = None,
    name: str = "sun",
) -> Sun:
    """Return a sun, a disc of equal radiance as far away as the stars.

    Args:
        irradiance: lm/m² (or W/m²) on a plane that is perpendicular to its light: one number, or one for each band.
        altitude, azimuth: degrees above the horizon, and from north through east.
        direction: instead, towards the sun.
        diameter: degrees, of the disc; 0: parallel light.
        photometric: the irradiance is in lm/m². False: W/m².
        up, north: where up and north are in the scene, see `sky_axes`.
        name: of the light.

    Raises:
        SceneError: a value out of range, or neither a direction nor an altitude and azimuth.

    Example:
        >>> rd.sun(80_000, altitude=30, azimuth=180).direction.round(3).tolist()
        [0.0, -0.866, 0.5]
    """
    values = np.atleast_1d(np.asarray(irradiance, np.float64))
    if values.ndim != 1 or not np.isfinite(values).all() or (values < 0).any():
        raise SceneError(f"sun '{name}': irradiance must be 0 or more (it is {irradiance})")
    if not 0 <= diameter < 180:
        raise SceneError(f"sun '{name}': diameter must be 0 or more and below 180 degrees (it is {diameter})")
    if direction is not None:
        if altitude is not None or azimuth is not None:
            raise SceneError(f"sun '{name}': direction and altitude, azimuth exclude each other; give one")
        return Sun(name, unit(f"sun '{name}': direction", direction), values, diameter, photometric)
    if altitude is None or azimuth is None:
        raise SceneError(f"sun '{name}': give its direction, or its altitude and azimuth in degrees")
    check_place(f"sun '{name}'", altitude, azimuth)
    if altitude < 0:
        warn(f"sun '{name}': it is {-altitude:.1f} degrees below the horizon, and its light comes from below; leave it out")
    return Sun(name, towards(sky_axes(up, north), altitude, azimuth), values, diameter, photometric)
