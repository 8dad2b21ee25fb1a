"""Skies of standards: uniform, and those of the CIE (docs/daylight.md)."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from ...errors import SceneError
from ..habits import warn
from .axes import check_place, place_of, radians, sky_axes, told
from .cie import CLEAR, GENERAL, NO_SUN, general, intermediate, overcast
from .sky import Sky
from .sky_table import ROWS, sky_of
from .sun import Sun

NAMED = ("overcast", "clear", "intermediate")


def uniform_sky(
    horizontal: float,
    *,
    ground: float = 0.0,
    suns: Iterable[Sun] = (),
    photometric: bool = True,
    up: ArrayLike | str = "z",
    north: ArrayLike | None = None,
    name: str = "sky",
) -> Sky:
    """Return a sky that has the same radiance everywhere.

    Args:
        horizontal: lm/m² (or W/m²) on a horizontal plane: pi times the radiance.
        ground: share of what falls on the horizontal that the ground below the horizon reflects.
        suns: their light falls on the ground, too.
        photometric: horizontal is in lm/m². False: W/m².
        up, north: where up and north are in the scene, see `sky_axes`.
        name: of the light.

    Raises:
        SceneError: a value out of range.

    Example:
        >>> sky = rd.uniform_sky(10_000)
        >>> sky.horizontal.tolist()
        [10000.0]
    """
    return sky_of(
        name, lambda altitude, azimuth: np.ones(1), sky_axes(up, north), horizontal, ground, suns, "uniform", photometric, 2, 1
    )


def cie_sky(
    kind: str | int,
    horizontal: float,
    *,
    sun: tuple[float, float] | None = None,
    ground: float = 0.0,
    suns: Iterable[Sun] = (),
    photometric: bool = True,
    up: ArrayLike | str = "z",
    north: ArrayLike | None = None,
    name: str = "sky",
) -> Sky:
    """Return a sky of the CIE.

    Args:
        kind: "overcast", "clear" or "intermediate"; or 1 to 15, a type of the general sky (ISO 15469).
        horizontal: lm/m² (or W/m²) on a horizontal plane, by the sky alone.
        sun: altitude and azimuth of the sun, degrees. Skies that depend on it need it, also where it sends no light itself.
        ground: share of what falls on the horizontal that the ground below the horizon reflects.
        suns: their light falls on the ground, too. Without ``sun``, the first of them says where the sun is.
        photometric: horizontal is in lm/m². False: W/m².
        up, north: where up and north are in the scene, see `sky_axes`.
        name: of the light.

    Raises:
        SceneError: there is no such sky, or a value is out of range.

    Example:
        >>> sky = rd.cie_sky("overcast", 10_000)
        >>> horizon, zenith = sky.at([[1, 0, 0], [0, 0, 1]])[:, 0]
        >>> round(float(zenith / horizon), 6)
        3.0
    """
    axes, suns = sky_axes(up, north), tuple(suns)
    if kind == "overcast":
        return sky_of(name, overcast, axes, horizontal, ground, suns, "CIE overcast", photometric, 2, 1)
    number = CLEAR if kind == "clear" else kind
    if isinstance(number, bool) or (kind not in NAMED and number not in GENERAL):
        raise SceneError(f"sky '{name}': there is no CIE sky {kind!r}; known are {', '.join(NAMED)}, and 1 to {len(GENERAL)}")
    if number in NO_SUN:
        return sky_of(
            name,
            general(int(number), (0.0, 0.0)),
            axes,
            horizontal,
            ground,
            suns,
            f"CIE general, type {number}",
            photometric,
            ROWS,
            1,
        )
    place = place_of(axes, suns[0].direction) if sun is None and suns else sun
    if place is None:
        raise SceneError(f"sky '{name}': the CIE sky {kind!r} depends on the sun; give its altitude and azimuth, sun=(40, 180)")
    check_place(f"sky '{name}'", *place)
    if place[0] < 0:
        warn(f"sky '{name}': the sun is {-place[0]:.1f} degrees below the horizon, for which the CIE's formulas are not made")
    relative = intermediate(radians(place)) if kind == "intermediate" else general(int(number), radians(place))
    called = f"CIE {kind}" if kind in NAMED else f"CIE general, type {number}"
    return sky_of(name, relative, axes, horizontal, ground, suns, f"{called}, {told(place)}", photometric)
