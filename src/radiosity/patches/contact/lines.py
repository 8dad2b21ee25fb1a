"""Contact lines: where other faces touch or pierce a face, in its coordinates."""

from dataclasses import dataclass

import numpy as np

from ...scene.model import Scene
from ...scene.precision import EPSILON

NEAR = 8 * EPSILON  # of the largest number that places a plane: what is nearer touches it


@dataclass(frozen=True, eq=False)
class Boxes:
    """The faces of a scene with boxes about them.

    Attributes:
        corners: (n_faces, 4, 3) metres; a triangle repeats its last corner.
        low, high: (n_faces, 3) the corners of the boxes.
        near: (n_faces,) metres, the distance at which other faces touch.
    """

    corners: np.ndarray
    low: np.ndarray
    high: np.ndarray
    near: np.ndarray

    @staticmethod
    def of(scene: Scene) -> "Boxes":
        """Return those of a scene."""
        corners = scene.vertices[np.where(scene.faces < 0, scene.faces[:, 2:3], scene.faces)]
        reach = np.maximum(np.abs(corners - scene.centre).max(axis=(1, 2)), scene.plane_reach)
        return Boxes(corners, corners.min(axis=1), corners.max(axis=1), NEAR * reach)


def contact_lines(scene: Scene, boxes: Boxes, face: int) -> np.ndarray:
    """Return the contact lines of a face, (m, 2, 2): both ends in face coordinates. They may leave the face or lie on its rim."""
    margin = boxes.near[face]
    beside = (boxes.low <= boxes.high[face] + margin).all(axis=1) & (boxes.high >= boxes.low[face] - margin).all(axis=1)
    beside[face] = False
    others = np.flatnonzero(beside)
    corners = boxes.corners[others]
    origin, first, second = (edge[face] for edge in scene.frames)
    height = (corners - origin) @ scene.normal[face]
    height = np.where(np.abs(height) <= np.maximum(margin, boxes.near[others])[:, None], 0.0, height)
    to_face = np.linalg.pinv(np.stack([first, second], axis=1))
    flat = (corners - origin) @ to_face.T  # (m, 4, 2)
    lines = []
    for edge in range(4):
        after = (edge + 1) % 4
        lines.append(np.stack([flat[:, edge], flat[:, after]], axis=1)[(height[:, edge] == 0) & (height[:, after] == 0)])
    return np.concatenate([*lines, _piercing(flat, height)])


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
