"""The scene whose faces are cut along contact lines.

Where a box stands on a floor, the floor beneath it is dark and the floor beside it is not. A patch that lies on both sides of the
line would average them: light leaks under the box. So a face is cut, with straight cuts from rim to rim of what is cut already,
along the lines where other faces touch or pierce it; the longest ones first.
"""

import numpy as np

from ...scene.model import Scene
from ...scene.split import bent, split
from . import convex
from .lines import Boxes, contact_lines

THIN = 1e-4  # of a patch's size: thinner strips are not cut off
SHORT = 0.5  # of a patch's size: shorter lines are left to finer patches
LARGE = 4.0  # patches: smaller faces are not cut
SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


def cut_at_contacts(scene: Scene, patches: int, most: int) -> Scene:
    """Return the scene cut along its contact lines.

    Args:
        patches: how many patches there are to be: their size says which lines matter.
        most: the largest number of faces that cuts may add.
    """
    size = float(np.sqrt(scene.area.sum() / patches))
    lines = _lines(scene, size)
    polygons: dict[int, list] = {}
    frames = {face: _Flat(scene, face) for face in {face for _, face, _ in lines}}
    added = 0
    for _, face, line in lines:
        if added >= most:
            break
        pieces = polygons.setdefault(face, [frames[face].outline])
        cut = [part for piece in pieces for part in _cut(piece, frames[face].plane(line), size)]
        added += len(cut) - len(pieces)
        polygons[face] = cut
    cut = {face: pieces for face, pieces in polygons.items() if len(pieces) > 1}
    return _rebuilt(scene, cut, frames) if cut else scene


def _lines(scene: Scene, size: float) -> list[tuple[float, int, np.ndarray]]:
    """Return length, face and ends of the contact lines that matter, the longest first."""
    boxes, result = Boxes.of(scene), []
    _, first, second = scene.frames
    for face in np.flatnonzero((scene.area > LARGE * size**2) & ~bent(scene)):
        outline = SQUARE if scene.is_quad[face] else SQUARE[[0, 1, 3]]
        for line in contact_lines(scene, boxes, int(face)):
            within = convex.inside(outline, line[0], line[1], 1e-9)
            if within is not None:
                step = within[1] - within[0]
                length = float(np.linalg.norm(step[0] * first[face] + step[1] * second[face]))
                if length > SHORT * size:
                    result.append((length, int(face), np.array(within)))
    return sorted(result, key=lambda entry: (-round(entry[0], 9), entry[1]))


class _Flat:
    """A face in its own plane, in metres: cuts are straight there as in face coordinates, and distances are true."""

    def __init__(self, scene: Scene, face: int):
        _, first, second = (edge[face] for edge in scene.frames)
        axis = first / np.linalg.norm(first)
        across = np.cross(scene.normal[face], axis)
        self.axes = np.array([[first @ axis, first @ across], [second @ axis, second @ across]])
        self.outline = self.plane(SQUARE if scene.is_quad[face] else SQUARE[[0, 1, 3]])

    def plane(self, uv: np.ndarray) -> np.ndarray:
        return uv @ self.axes

    def face(self, points: np.ndarray) -> np.ndarray:
        return np.clip(points @ np.linalg.inv(self.axes), 0.0, 1.0)


def _cut(piece: np.ndarray, line: np.ndarray, size: float) -> list[np.ndarray]:
    """Return a polygon, or the two parts of it where a segment passes through it."""
    one, two = line
    within = convex.inside(piece, one, two, THIN * size)
    if within is None:
        return [piece]
    along = (two - one) / np.hypot(*(two - one))
    parts = convex.cut(piece, one, along, THIN * size)
    return [piece] if parts is None else list(parts)


def _rebuilt(scene: Scene, polygons: dict[int, list], frames: dict[int, _Flat]) -> Scene:
    """Return the scene with some faces in parts, in the order of the faces."""
    found: list[tuple[int, np.ndarray, int]] = []  # face, corners, region
    region = 0
    for face in range(scene.n_faces):
        outline = SQUARE if scene.is_quad[face] else SQUARE[[0, 1, 3, 3]]
        for polygon in polygons.get(face, [None]):
            for part in [outline] if polygon is None else map(frames[face].face, convex.parts(polygon)):
                found.append((face, part if len(part) == 4 else part[[0, 1, 2, 2]], region))
            region += 1
    face, corners, regions = zip(*found, strict=True)
    return split(scene, np.array(face), np.array(corners), np.array(regions))
