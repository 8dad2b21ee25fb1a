"""Contact lines: where other faces touch or pierce a face, or lie just in front of it, in its coordinates."""

from dataclasses import dataclass

import numpy as np

from ...scene.box_pairs import box_pairs
from ...scene.model import Back, Scene
from ...scene.precision import EPSILON

TOUCHES = 8 * EPSILON  # of the largest number that places a plane: what is nearer touches it
NEAR = 0.02  # of a patch's size: what is nearer hides a part of a patch as if it touched it
NEAR_LAMP = 0.2  # likewise, of what emits towards the patch
PARALLEL = 0.9  # cosine between a lamp and such a patch, at least: light of others spreads


@dataclass(frozen=True, eq=False)
class Boxes:
    """The faces of a scene with boxes about them.

    Attributes:
        corners: (n_faces, 4, 3) metres; a triangle repeats its last corner.
        low, high: (n_faces, 3) the corners of the boxes.
        touch: (n_faces,) metres, the distance at which other faces touch.
        shines: (2, n_faces) bool, whether fronts and backs emit.
    """

    corners: np.ndarray
    low: np.ndarray
    high: np.ndarray
    touch: np.ndarray
    shines: np.ndarray

    @staticmethod
    def of(scene: Scene) -> "Boxes":
        """Return those of a scene."""
        corners = scene.vertices[np.where(scene.faces < 0, scene.faces[:, 2:3], scene.faces)]
        reach = np.maximum(np.abs(corners - scene.centre).max(axis=(1, 2)), scene.plane_reach)
        shines = np.stack([(light > 0).any(axis=1) for light in (scene.emission, scene.back_emission)])
        shines[1] &= scene.back == Back.RADIATES
        return Boxes(corners, corners.min(axis=1), corners.max(axis=1), TOUCHES * reach, shines)


@dataclass(frozen=True, eq=False)
class ContactLines:
    """Lines of a face.

    Attributes:
        ends: (m, 2, 2) face coordinates. They may leave the face or lie on its rim.
        of_lamps: (m,) bool: light from just in front of the face ends there.
    """

    ends: np.ndarray
    of_lamps: np.ndarray


def faces_beside(boxes: Boxes, faces: np.ndarray, sizes: np.ndarray) -> list[np.ndarray]:
    """Return the numbers of the faces that may touch each of some faces, or lie just in front of it, in order.

    Args:
        faces: (n,) their numbers. sizes: (n,) metres, of their patches.
    """
    if not len(faces):
        return []
    margin = np.maximum(boxes.touch[faces], NEAR_LAMP * sizes)[:, None]
    pairs = box_pairs((boxes.low[faces] - margin, boxes.high[faces] + margin), (boxes.low, boxes.high))
    row, other = (np.concatenate(part) for part in zip(*pairs, strict=True))
    row, other = row[faces[row] != other], other[faces[row] != other]
    order = np.lexsort((other, row))
    return np.split(other[order], np.searchsorted(row[order], np.arange(1, len(faces))))


def contact_lines(scene: Scene, boxes: Boxes, face: int, others: np.ndarray, size: float = 0.0) -> ContactLines:
    """Return the contact lines of a face.

    Args:
        others: the faces that `faces_beside` found.
        size: metres, of a patch. Outlines of faces that are nearer than `NEAR` of it are contact lines, too, if they lie in front
            of a side that radiates.
    """
    corners = boxes.corners[others]
    origin, first, second = (edge[face] for edge in scene.frames)
    height = (corners - origin) @ scene.normal[face]
    height = np.where(np.abs(height) <= np.maximum(boxes.touch[face], boxes.touch[others])[:, None], 0.0, height)
    to_face = np.linalg.pinv(np.stack([first, second], axis=1))
    flat = (corners - origin) @ to_face.T  # (m, 4, 2)
    touches, lamp = height == 0, _shines_at(scene, boxes, face, others, height)
    near = _near(scene, face, height, np.where(lamp, NEAR_LAMP, NEAR) * size)
    lines, of_lamps = [], []
    for edge in range(4):
        after = (edge + 1) % 4
        rows = (touches[:, edge] & touches[:, after]) | (near[:, edge] & near[:, after])
        lines.append(np.stack([flat[:, edge], flat[:, after]], axis=1)[rows])
        of_lamps.append((lamp & near[:, edge])[rows])
    ends, lamps, through = np.concatenate(lines), np.concatenate(of_lamps), _piercing(flat, height)
    keep = (ends[:, 0] != ends[:, 1]).any(axis=1) & (~lamps | _single(ends, lamps))
    return ContactLines(np.concatenate([ends[keep], through]), np.concatenate([lamps[keep], np.zeros(len(through), bool)]))


def _single(ends: np.ndarray, some: np.ndarray) -> np.ndarray:
    """Return which of some lines no other one of them equals, (m,) bool: two faces of one lamp share inner edges."""
    rows, result = np.flatnonzero(some), np.zeros(len(ends), bool)
    order = np.lexsort((ends[rows, :, 1], ends[rows, :, 0]), axis=1)
    lines = np.take_along_axis(ends[rows], order[:, :, None], axis=1).reshape(-1, 4).round(9)
    _, number, count = np.unique(lines, axis=0, return_inverse=True, return_counts=True)
    result[rows] = count[number.ravel()] == 1
    return result


def _near(scene: Scene, face: int, height: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Return which corners of faces lie just in front of a side that radiates, (m, 4) bool; those of faces that go through it
    do not: light ends where they do."""
    front = (height >= 0).all(axis=1)
    some = front | ((height <= 0).all(axis=1) & (scene.back[face] == Back.RADIATES))
    return some[:, None] & (height != 0) & (np.abs(height) <= reach[:, None])


def _shines_at(scene: Scene, boxes: Boxes, face: int, others: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Return which of the other faces are parallel to a face and emit towards its plane, (m,) bool."""
    along = (scene.normal[others] @ scene.normal[face]) * np.sign(height.sum(axis=1))  # below zero: the front looks at the face
    return np.where(along < 0, boxes.shines[0, others], boxes.shines[1, others]) & (np.abs(along) > PARALLEL)


def _piercing(flat: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Return the lines along which faces pass through the plane, (k, 2, 2)."""
    some = np.flatnonzero((height.min(axis=1) < 0) & (height.max(axis=1) > 0))
    flat, height = flat[some], height[some]
    after, flat_after = np.roll(height, -1, axis=1), np.roll(flat, -1, axis=1)
    crosses = height * after < 0
    share = np.divide(height, height - after, out=np.zeros_like(height), where=crosses)
    points = np.concatenate([flat, flat + share[:, :, None] * (flat_after - flat)], axis=1)
    on = np.concatenate([height == 0, crosses], axis=1)
    result = np.empty((len(some), 2, 2))
    for row in range(len(some)):
        ends = points[row][on[row]]
        result[row] = ends[0], ends[np.argmax(((ends - ends[0]) ** 2).sum(axis=1))]
    return result


def near_lamps(boxes: Boxes, sizes: np.ndarray) -> np.ndarray:
    """Return the faces that are nearer to the box of one that emits than lamps count, (n_faces,) bool; itself left out.

    Args:
        sizes: (n_faces,) metres, of the patches of each face.
    """
    lamps, result = np.flatnonzero(boxes.shines.any(axis=0)), np.zeros(len(boxes.low), bool)
    reach = NEAR_LAMP * sizes[:, None]
    for face, lamp in box_pairs((boxes.low - reach, boxes.high + reach), (boxes.low[lamps], boxes.high[lamps])):
        result[face[lamps[lamp] != face]] = True
    return result
