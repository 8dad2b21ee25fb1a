"""The scene whose faces are cut along contact lines.

Where a box stands on a floor, the floor beneath it is dark and the floor beside it is not. A patch that lies on both sides of the
line would average them: light leaks under the box. So a face is cut, with straight cuts from rim to rim of what is cut already,
along the lines where other faces touch or pierce it, or end just in front of it; the longest ones first. Before all others come
outlines of lamps just in front of a face: such a lamp lights the part that it covers, and a patch that is covered in part would
give that light back from its open part.
"""

from dataclasses import dataclass

import numpy as np

from ...scene.model import Scene
from ...scene.split import bent, split
from ..subdivide import subdivide
from . import convex
from .lines import Boxes, contact_lines, faces_beside, near_lamps

THIN = 1e-4  # of a patch's size: thinner strips are not cut off
SHORT = 0.5  # of a patch's size: shorter lines are left to finer patches, but for those of lamps
LARGE = 4.0  # patches: smaller faces are not cut, but for lamps
SMALL = 0.05  # of a patch's size: shorter lines of lamps are left out
SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


def cut_at_contacts(scene: Scene, patches: int, most: int, sizes: np.ndarray | None = None) -> Scene:
    """Return the scene cut along its contact lines.

    Args:
        patches: how many patches there are to be: their size says which lines matter.
        most: the largest number of faces that cuts may add.
        sizes: (n_faces,) metres, of the patches of each face, which say what is near; default: of so many even patches.
    """
    size = float(np.sqrt(scene.area.sum() / patches))
    lines = _lines(scene, size, subdivide(scene, about=patches).sizes if sizes is None else sizes)
    faces = {face: Pieces(_Flat(scene, face)) for face in {line.face for line in lines}}
    added = 0
    for line in lines:
        if added >= most:
            break
        added += faces[line.face].cut(line.ends, THIN * size)
    cut = {face: pieces for face, pieces in faces.items() if len(pieces.polygons) > 1}
    return _rebuilt(scene, cut) if cut else scene


@dataclass(frozen=True, eq=False)
class _Line:
    """A contact line that matters: its face, ends in face coordinates, length in metres, and whether it is that of a lamp."""

    face: int
    ends: np.ndarray
    length: float
    of_lamp: bool


def _lines(scene: Scene, size: float, sizes: np.ndarray) -> list[_Line]:
    """Return the contact lines that matter, those of lamps first, then the longest first.

    Args:
        size: metres, of the mean patch. sizes: (n_faces,) metres, of the patches of each face, which say what is near.
    """
    boxes, result = Boxes.of(scene), []
    _, first, second = scene.frames
    faces = np.flatnonzero(((scene.area > LARGE * size**2) | near_lamps(boxes, sizes)) & ~bent(scene))
    for face, others in zip(faces, faces_beside(boxes, faces, sizes[faces]), strict=True):
        outline = SQUARE if scene.is_quad[face] else SQUARE[[0, 1, 3]]
        found = contact_lines(scene, boxes, int(face), others, sizes[face])
        for line, of_lamp in zip(found.ends, found.of_lamps.tolist(), strict=True):
            within = convex.inside(outline, line[0], line[1], 1e-9)
            if within is not None:
                step = within[1] - within[0]
                length = float(np.linalg.norm(step[0] * first[face] + step[1] * second[face]))
                if length > (SMALL if of_lamp else SHORT) * size and (of_lamp or scene.area[face] > LARGE * size**2):
                    result.append(_Line(int(face), np.array(within), length, of_lamp))
    return sorted(result, key=lambda line: (not line.of_lamp, -round(line.length, 9), line.face))


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


class Pieces:
    """The pieces of a face so far, with boxes about them, so that a line looks only at pieces near it."""

    def __init__(self, flat: _Flat):
        self.flat = flat
        self.polygons = [flat.outline]
        self.boxes = _box(flat.outline)[None]

    def cut(self, ends: np.ndarray, least: float) -> int:
        """Cut the pieces that a segment passes through, and return how many more there are.

        Args:
            ends: (2, 2) face coordinates. least: metres; shorter parts of the segment, and thinner strips, do not count.
        """
        line = self.flat.plane(ends)
        low, high = _box(line)
        near = np.flatnonzero(((self.boxes[:, 0] <= high) & (self.boxes[:, 1] >= low)).all(axis=1))
        added = 0
        for row in (near[::-1]).tolist():
            two = _cut(self.polygons[row], line, least)
            if two is not None:
                self.polygons[row : row + 1] = two
                self.boxes = np.concatenate([self.boxes[:row], [_box(part) for part in two], self.boxes[row + 1 :]])
                added += 1
        return added

    def parts(self) -> list[list[np.ndarray]]:
        """Return the triangles and parallelograms of each piece, in face coordinates."""
        return [[self.flat.face(part) for part in convex.parts(polygon)] for polygon in self.polygons]


def _box(points: np.ndarray) -> np.ndarray:
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _cut(piece: np.ndarray, line: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the two parts of a polygon where a segment passes through it, or None."""
    one, two = line
    if convex.inside(piece, one, two, least) is None:
        return None
    return convex.cut(piece, one, (two - one) / np.hypot(*(two - one)), least)


def _rebuilt(scene: Scene, cut: dict[int, Pieces]) -> Scene:
    """Return the scene with some faces in parts, in the order of the faces."""
    found: list[tuple[int, np.ndarray, int]] = []  # face, corners, region
    region = 0
    for face in range(scene.n_faces):
        outline = SQUARE if scene.is_quad[face] else SQUARE[[0, 1, 3, 3]]
        for parts in cut[face].parts() if face in cut else [[outline]]:
            for part in parts:
                found.append((face, part if len(part) == 4 else part[[0, 1, 2, 2]], region))
            region += 1
    face, corners, regions = zip(*found, strict=True)
    return split(scene, np.array(face), np.array(corners), np.array(regions))
