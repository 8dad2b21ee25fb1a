"""How a luminaire is turned: the directions of C = 0, of C = 90, and of gamma = 0."""

import numpy as np
from numpy.typing import ArrayLike

from ...errors import SceneError

HANGING = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, -1]])  # aimed down; seen from above, C runs counterclockwise from x to y
STRAIGHT = 1e-12  # of a length: shorter is nothing


def frame(direction: ArrayLike, rotate: float, along: ArrayLike | None, what: str) -> np.ndarray:
    """Return the axes of a luminaire that is aimed in a direction, (3, 3).

    One that hangs, aimed along -z, has C = 0 along x and C = 90 along y. It is tilted from there by the shortest turn; straight
    up, about x.

    Args:
        direction: of gamma = 0, of any length.
        rotate: degrees by which it is then turned about this direction, from C = 0 towards C = 90.
        along: a direction in whose half plane C = 0 lies, instead of x as it is tilted; None: that.
        what: names the luminaire in messages.

    Raises:
        SceneError: a direction is none, or both are parallel.
    """
    aim = _unit(direction, "direction", what)
    if along is None:
        axes = HANGING @ _shortest_turn(HANGING[2], aim).T
    else:
        side = _unit(along, "along", what)
        across = side - aim * (side @ aim)
        if np.linalg.norm(across) < 1e-6:
            raise SceneError(f"{what}: along is {list(side)}, parallel to its direction; C = 0 must lie across it")
        across /= np.linalg.norm(across)
        axes = np.stack([across, np.cross(across, aim), aim])
    if not np.isfinite(rotate):
        raise SceneError(f"{what}: rotate is {rotate}; expected degrees")
    cosine, sine = np.cos(np.radians(rotate)), np.sin(np.radians(rotate))
    return np.stack([cosine * axes[0] + sine * axes[1], cosine * axes[1] - sine * axes[0], axes[2]])


def point(value: ArrayLike, key: str, what: str) -> np.ndarray:
    """Return three finite numbers as (3,) float64.

    Raises:
        SceneError: they are others.
    """
    try:
        array = np.asarray(value, np.float64)
    except (TypeError, ValueError):
        array = np.zeros(0)
    if array.shape != (3,) or not np.isfinite(array).all() or np.abs(array).max() > 1e18:
        raise SceneError(f"{what}: {key} is {value!r}; expected three numbers")
    return array


def _unit(value: ArrayLike, key: str, what: str) -> np.ndarray:
    array = point(value, key, what)
    length = np.linalg.norm(array)
    if not length > STRAIGHT:
        raise SceneError(f"{what}: {key} is {array.tolist()}, which is no direction")
    return array / length


def _shortest_turn(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the rotation, (3, 3), that turns a unit vector into another by the shortest way; by 180 degrees about x."""
    cosine, axis = float(one @ other), np.cross(one, other)
    if cosine < -1 + 1e-12:
        return np.diag([1.0, -1, -1])
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + cross + cross @ cross / (1 + cosine)
