"""Tables of intensities that are checked, and unfolded to all planes C where a file gives a half or a quarter of them."""

from itertools import pairwise

import numpy as np

from ...errors import SceneError
from .web import Web

NOISE = 0.01  # of the largest intensity: negative values of this size are taken as zero, and told
LEAST, LARGEST = 1e-12, 1e15  # cd; no lamp is outside
SAME = 1e-6  # degrees between angles that are one


def checked_angles(angles: list[float], what: str, low: float, high: float, source: str) -> np.ndarray:
    """Return angles in degrees as an array.

    Raises:
        SceneError: they do not ascend, or lie outside of low to high.
    """
    for one, other in pairwise(angles):
        if not other > one:
            raise SceneError(f"{source}: {what} do not ascend: {one:g} is followed by {other:g}")
    for angle in (angles[0], angles[-1]):
        if not low - SAME <= angle <= high + SAME:
            raise SceneError(
                f"{source}: {what} are {angles[0]:g} to {angles[-1]:g}; they must lie in {low:g} to {high:g} degrees"
            )
    return np.clip(np.array(angles, np.float64), low, high)


def checked_intensities(table: np.ndarray, angles: tuple[np.ndarray, np.ndarray], source: str, notes: list[str]) -> np.ndarray:
    """Return a table, (n_planes, n_angles), that has no negative values; small ones become zero, with a note.

    Raises:
        SceneError: one is large, or all are zero.
    """
    if not table.max() > LEAST:
        raise SceneError(f"{source}: all intensities are zero, or below {LEAST:g} cd: the luminaire sends no light")
    if not np.abs(table).max() < LARGEST:
        raise SceneError(f"{source}: an intensity is {np.abs(table).max():g} cd; those of {LARGEST:g} and more are not believed")
    if table.min() < 0:
        plane, row = np.unravel_index(np.argmin(table), table.shape)
        text = f"the intensity at plane {angles[0][plane]:g}, angle {angles[1][row]:g} is {table.min():g} cd"
        if table.min() < -NOISE * table.max():
            raise SceneError(f"{source}: {text}; intensities must not be negative")
        notes.append(f"{(table < 0).sum()} negative intensities are taken as zero ({text})")
    return np.maximum(table, 0.0)


def unfolded(planes: np.ndarray, gamma: np.ndarray, table: np.ndarray, source: str, notes: list[str]) -> Web:
    """Return a web of all planes from 0 to 360, from those that a file gives: one, 0 to 90, 0 to 180, 90 to 270 or 0 to 360.

    Raises:
        SceneError: the planes are others.
    """
    if len(planes) == 1:
        return Web(np.zeros(1), gamma, table)
    low, high = float(planes[0]), float(planes[-1])
    if _same(low, 0) and _same(high, 90):
        planes, table = _mirrored(planes, table, 90)
        low, high = 0.0, 180.0
    if _same(low, 0) and _same(high, 180):
        planes, table = _mirrored(planes, table, 180)
    elif _same(low, 90) and _same(high, 270):  # alike on both sides of the plane of 90 and 270
        planes, table = _turned_back(planes, table)
    elif _same(low, 0) and 180 < high < 360 - SAME:
        notes.append(f"the planes end at {high:g} degrees; the first plane, at 0, is taken as that of 360, too")
        planes, table = np.append(planes, 360.0), np.concatenate([table, table[:1]])
    elif not (_same(low, 0) and _same(high, 360)):
        raise SceneError(
            f"{source}: its planes reach from {low:g} to {high:g} degrees; known are one plane, 0 to 90, 0 to 180, 90 to 270 and "
            "0 to 360"
        )
    if not np.allclose(table[0], table[-1], rtol=1e-3, atol=1e-3 * table.max()):
        notes.append("the intensities at the planes 0 and 360 differ; each is taken as it is")
    planes = planes.copy()
    planes[0], planes[-1] = 0.0, 360.0
    return Web(planes, gamma, table)


def _same(one: float, other: float) -> bool:
    return abs(one - other) <= SAME


def _mirrored(planes: np.ndarray, table: np.ndarray, last: float) -> tuple[np.ndarray, np.ndarray]:
    """Return planes and rows from 0 to twice the last plane, alike on both sides of it."""
    return np.append(planes, 2 * last - planes[-2::-1]), np.concatenate([table, table[-2::-1]])


def _turned_back(planes: np.ndarray, table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return planes and rows from 0 to 360, from those of 90 to 270: plane C is plane 180 - C, too."""
    left = (planes > 90 + SAME) & (planes < 180 - SAME)
    right = (planes > 180 + SAME) & (planes < 270 - SAME)
    end = _row_at(planes, table, 180.0)  # of 0 and 360, too
    new = [[0.0], 180 - planes[left][::-1], planes, 540 - planes[right][::-1], [360.0]]
    return np.concatenate(new), np.concatenate([end, table[left][::-1], table, table[right][::-1], end])


def _row_at(planes: np.ndarray, table: np.ndarray, plane: float) -> np.ndarray:
    """Return the row of a plane, (1, n_gamma), interpolated where the table has none."""
    return np.array([[np.interp(plane, planes, column) for column in table.T]])
