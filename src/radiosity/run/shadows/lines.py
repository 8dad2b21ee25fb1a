"""Shadow lines: borders of shadows along which a mesh gains by cuts, best first.

Halves of faces follow a border that runs along an edge of the face. Across others they need small patches everywhere along it. A
cut along the border spares them, if its penumbra is narrow for its length: then patches beside it can be long, too.
"""

import numpy as np

from ...patches.contact import convex
from ...patches.contact.cutting import SHORT, Line
from ...patches.contact.flat_face import SQUARE
from ...patches.halves import BRIGHT
from ...scene.model import Scene
from .borders import Borders, borders
from .falls import falls
from .lights import strongest
from .receivers import Receivers
from .sight import Sight

LONG = 3.0  # times the width of the penumbra, or the patch's size: shorter lines are left to the pilots
APART = 0.5  # of a patch's size: a line so near to a better one is left out
ASLANT = 1.0  # of a patch's size: lines that leave the direction of an edge of the face by less are left to the pilots
LEAST = 10.0  # times what a patch gains on average: lines that gain less are left out


def shadow_lines(scene: Scene, patches: int, device: str = "auto") -> list[Line]:
    """Return the lines where shadows of strong lamps end, those first that gain most.

    Args:
        patches: how many patches there are to be: their size says which lines matter.
    """
    size = float(np.sqrt(scene.area.sum() / patches))
    lights, receivers = strongest(scene), Receivers.of(scene, size)
    sight = Sight.of(scene, device)
    if not lights or not len(receivers.face) or not len(sight.faces):
        return []
    found, light = borders(scene, sight, receivers, lights)
    rows, uv, length = _within(scene, receivers, found, size)
    if not len(rows):
        return []
    found = Borders(found.side[rows], found.light[rows], found.ends[rows])
    fall, whole = falls(scene, sight, receivers, lights, found, uv, size)
    sharp = np.minimum(np.divide(fall, whole, out=np.zeros_like(fall), where=whole > 0), 1.0)
    reflected = receivers.reflectance * receivers.mean(light)
    square = receivers.reflectance**2 * receivers.mean(light**2)
    area = scene.area[receivers.face]
    bright = reflected * scene.area.sum() / max(float(reflected @ area), 1e-300)
    weight = (1 / (1 + (bright / BRIGHT) ** 2) * receivers.reflectance**2)[found.side]
    gain = weight * fall * whole * length * size / 6
    gain *= (sharp * length > LONG * size) & (_aslant(scene, receivers.face[found.side], uv) > ASLANT * size)
    least = LEAST * float(square @ area) / patches**2
    order = [row for row in np.argsort(-gain, kind="stable") if gain[row] > least]
    face = receivers.face[found.side]
    return [Line(int(face[row]), uv[row], float(length[row])) for row in _apart(scene, face, uv, order, APART * size)]


def _within(scene: Scene, receivers: Receivers, found: Borders, size: float):
    """Return which lines are long enough within their faces, their ends in face coordinates (m, 2, 2), and lengths in metres."""
    origin, first, second = scene.frames
    rows, ends, lengths = [], [], []
    for row, side in enumerate(found.side):
        face = receivers.face[side]
        to_face = np.linalg.pinv(np.stack([first[face], second[face]], axis=1))
        uv = (found.ends[row] - origin[face]) @ to_face.T
        within = convex.inside(SQUARE if scene.is_quad[face] else SQUARE[[0, 1, 3]], uv[0], uv[1], 1e-9)
        if within is not None:
            step = within[1] - within[0]
            length = float(np.linalg.norm(step[0] * first[face] + step[1] * second[face]))
            if length > SHORT * size:
                rows.append(row)
                ends.append(np.array(within))
                lengths.append(length)
    return np.array(rows, np.int64), np.array(ends).reshape(-1, 2, 2), np.array(lengths)


def _aslant(scene: Scene, face: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Return how far lines reach across the edges of their faces, metres: the less of both edges, (m,)."""
    _, first, second = (part[face] for part in scene.frames)
    width = scene.area[face] * np.where(scene.is_quad[face], 1, 2)
    step = np.abs(uv[:, 1] - uv[:, 0])  # a step across the second edge is the first coordinate's, times the height over it
    return np.minimum(step[:, 0] * width / np.linalg.norm(second, axis=1), step[:, 1] * width / np.linalg.norm(first, axis=1))


def _apart(scene: Scene, face: np.ndarray, uv: np.ndarray, order: list, near: float) -> list[int]:
    """Return rows in their order, but for lines that run beside one before them."""
    origin, first, second = scene.frames
    taken: dict[int, list] = {}
    result = []
    for row in order:
        at = int(face[row])
        ends = origin[at] + uv[row][:, :1] * first[at] + uv[row][:, 1:] * second[at]
        points = np.stack([ends[0], ends.mean(axis=0), ends[1]])
        before = taken.setdefault(at, [])
        if not any(_beside(points, other, near) for other in before):
            before.append(ends)
            result.append(int(row))
    return result


def _beside(points: np.ndarray, ends: np.ndarray, near: float) -> bool:
    """Return whether ends and middle of a line lie near another one, and its middle beside it."""
    step = ends[1] - ends[0]
    length = float(np.linalg.norm(step))
    offset = points - ends[0]
    along = offset @ (step / length)
    height = np.sqrt(np.maximum((offset**2).sum(axis=1) - along**2, 0))
    return bool(height.max() < near and -near < along[1] < length + near)
