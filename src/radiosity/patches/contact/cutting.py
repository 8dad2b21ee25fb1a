"""The scene whose faces are cut along contact lines.

Where a box stands on a floor, the floor beneath it is dark and the floor beside it is not. A patch that lies on both sides of the
line would average them: light leaks under the box. So a face is cut, with straight cuts from rim to rim of what is cut already,
along the lines where other faces touch or pierce it, or end just in front of it; the longest ones first. Before all others come
outlines of lamps just in front of a face: such a lamp lights the part that it covers, and a patch that is covered in part would
give that light back from its open part.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...scene.model import Back, Scene
from ...scene.split import bent, split
from ..subdivide import subdivide
from . import convex
from .flat_face import SQUARE, Flat, Pieces
from .lines import NEAR, Boxes, contact_lines, faces_beside, near_lamps

THIN = 1e-4  # of a patch's size: thinner strips are not cut off
SHORT = 0.5  # of a patch's size: shorter lines are left to finer patches, but for those of lamps
LARGE = 4.0  # patches: smaller faces are not cut, but for lamps
SMALL = 0.05  # of a patch's size: shorter lines of lamps are left out


@dataclass(frozen=True, eq=False)
class Line:
    """A line to cut a face along: the face, its ends in face coordinates (2, 2), length in metres, and whether it is a lamp's."""

    face: int
    ends: np.ndarray
    length: float
    of_lamp: bool = False


def cut_at_contacts(
    scene: Scene,
    patches: int,
    most: int,
    sizes: np.ndarray | None = None,
    *,
    near: float = NEAR,
    shadows: Sequence[Line] = (),
    more: int = 0,
) -> Scene:
    """Return the scene cut along its contact lines, and along edges of shadows.

    Args:
        patches: how many patches there are to be: their size says which lines matter.
        most: the largest number of faces that cuts may add.
        sizes: (n_faces,) metres, of the patches of each face, which say what is near; default: of so many even patches.
        near: of a patch's size: outlines of what is nearer to a side that radiates are contact lines.
        shadows: lines of shadows, best first; contact lines come before them.
        more: the largest number of patches that cuts along shadows may add; lines that would add too many are left out.
    """
    size = float(np.sqrt(scene.area.sum() / patches))
    lines = _lines(scene, size, subdivide(scene, about=patches).sizes if sizes is None else sizes, near)
    faces = {face: Pieces(Flat(scene, face)) for face in {line.face for line in (*lines, *shadows)}}
    added = 0
    for line in lines:
        if added >= most:
            break
        added += faces[line.face].cut(line.ends, THIN * size)
    for line in shadows:
        sides = 2 if scene.back[line.face] == Back.RADIATES else 1
        more -= sides * faces[line.face].cut_at_shadow(line.ends, THIN * size, more // sides)
    cut = {face: pieces for face, pieces in faces.items() if len(pieces.polygons) > 1}
    return _rebuilt(scene, cut) if cut else scene


def _lines(scene: Scene, size: float, sizes: np.ndarray, near: float) -> list[Line]:
    """Return the contact lines that matter, those of lamps first, then the longest first.

    Args:
        size: metres, of the mean patch. sizes: (n_faces,) metres, of the patches of each face, which say what is near.
    """
    boxes, result = Boxes.of(scene), []
    _, first, second = scene.frames
    faces = np.flatnonzero(((scene.area > LARGE * size**2) | near_lamps(boxes, sizes)) & ~bent(scene))
    for face, others in zip(faces, faces_beside(boxes, faces, sizes[faces]), strict=True):
        outline = SQUARE if scene.is_quad[face] else SQUARE[[0, 1, 3]]
        found = contact_lines(scene, boxes, int(face), others, sizes[face], near)
        least = np.where(found.of_lamps, SMALL, SHORT) * size
        steps = (found.ends[:, 1] - found.ends[:, 0]) @ np.stack([first[face], second[face]])
        long = np.linalg.norm(steps, axis=1) > (1 - 1e-9) * least  # most lines are too short before they are cut off at the rim
        for line, of_lamp in zip(found.ends[long], found.of_lamps[long].tolist(), strict=True):
            within = convex.inside(outline, line[0], line[1], 1e-9)
            if within is not None:
                step = within[1] - within[0]
                length = float(np.linalg.norm(step[0] * first[face] + step[1] * second[face]))
                if length > (SMALL if of_lamp else SHORT) * size and (of_lamp or scene.area[face] > LARGE * size**2):
                    result.append(Line(int(face), np.array(within), length, of_lamp))
    return sorted(result, key=lambda line: (not line.of_lamp, -round(line.length, 9), line.face))


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
