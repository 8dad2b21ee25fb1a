"""The axes of a sky: where north, east and up are in a scene, and the directions of altitudes and azimuths."""

import numpy as np
from numpy.typing import ArrayLike

from ...errors import SceneError

UP = {"z": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)), "y": ((0.0, 1.0, 0.0), (0.0, 0.0, -1.0))}  # up, and north unless it is given


def sky_axes(up: ArrayLike | str = "z", north: ArrayLike | None = None) -> np.ndarray:
    """Return the unit directions of north, east and up, (3, 3) float64.

    Args:
        up: "z" or "y", or a direction.
        north: a direction; what of it points up does not count. Default: y where z is up, and -z where y is up (so that x is
            east in both).

    Raises:
        SceneError: a direction is no direction, or north points up or down, or none is given where ``up`` is a direction.
    """
    upward = up_of(up)
    if north is None and not isinstance(up, str):
        raise SceneError(f"north is missing: where up is a direction ({list(upward)}), give north as one, too")
    level = unit("north", UP[str(up)][1] if north is None else north)
    level = level - (level @ upward) * upward
    if np.linalg.norm(level) < 1e-6:
        raise SceneError(f"north: the direction {np.asarray(north).tolist()} points up or down; give a level one")
    level /= np.linalg.norm(level)
    return np.stack([level, np.cross(level, upward), upward])


def up_of(up: ArrayLike | str) -> np.ndarray:
    """Return the unit direction that is up, (3,), of "z", "y" or a direction.

    Raises:
        SceneError: it is something else.
    """
    if not isinstance(up, str):
        return unit("up", up)
    if up not in UP:
        raise SceneError(f"up: it is '{up}'; give 'z' or 'y', or a direction such as [0, 0, 1]")
    return np.array(UP[up][0])


def unit(what: str, direction: ArrayLike) -> np.ndarray:
    """Return a direction of unit length, (3,) float64.

    Raises:
        SceneError: it has not three finite numbers, or no length.
    """
    values = np.asarray(direction, np.float64)
    if values.shape != (3,) or not np.isfinite(values).all() or not np.linalg.norm(values) > 0:
        raise SceneError(f"{what}: expected a direction of three numbers, not all 0 (it is {np.asarray(direction).tolist()})")
    scaled = values / np.abs(values).max()
    return scaled / np.linalg.norm(scaled)


def towards(axes: np.ndarray, altitude: float, azimuth: float) -> np.ndarray:
    """Return the direction of an altitude above the horizon and an azimuth from north through east, degrees, (3,)."""
    height, turn = np.radians([altitude, azimuth])
    return np.cos(height) * (np.cos(turn) * axes[0] + np.sin(turn) * axes[1]) + np.sin(height) * axes[2]


def place_of(axes: np.ndarray, direction: np.ndarray) -> tuple[float, float]:
    """Return the altitude and azimuth of a direction of unit length, degrees."""
    north, east, up = axes @ direction
    return float(np.degrees(np.arcsin(np.clip(up, -1, 1)))), float(np.degrees(np.arctan2(east, north)) % 360)


def check_place(what: str, altitude: float, azimuth: float) -> None:
    """Refuse an altitude or azimuth out of range.

    Raises:
        SceneError: it is.
    """
    if not (-90 <= altitude <= 90 and -360 <= azimuth <= 360):
        raise SceneError(
            f"{what}: altitude must lie in -90 to 90 degrees, and azimuth, from north through east, in -360 to 360 "
            f"(they are {altitude}, {azimuth})"
        )


def radians(place: tuple[float, float]) -> tuple[float, float]:
    """Return an altitude and azimuth in radians."""
    altitude, azimuth = np.radians(place)
    return float(altitude), float(azimuth)


def told(place: tuple[float, float]) -> str:
    """Return where the sun is, for reports."""
    return f"sun at {place[0]:.1f} degrees, azimuth {place[1]:.1f}"
