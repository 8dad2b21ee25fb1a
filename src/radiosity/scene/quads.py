"""The merge of two triangles, which a file format made of one flat parallelogram, to one face."""

from dataclasses import dataclass, fields, replace

import numpy as np

from ..pieces import of_pieces
from .arrays import PARALLEL_TOLERANCE
from .bends import tolerance
from .matching import matched
from .measures import Vectors, length, minus
from .model import Scene
from .one_row import is_one_row
from .paint import Paint
from .shared_edges import shared_edges
from .twins import Cells, mostly_alike
from .welded import welded

SIZE = 1 << 14  # pairs at a time
TURNED = ((0, 1, 2), (1, 2, 0), (2, 0, 1))  # corners: the same, the next, the one after that


def sound_and_merged(scene: Scene) -> Scene:
    """Leave faces without area out, see `Scene.without_degenerate_faces`, and join triangles, see `merge_triangles`."""
    cells = _cells(scene)  # before, since faces are measured for both
    sound = scene.without_degenerate_faces()
    return merge_triangles(sound, cells if sound is scene else _cells(sound))


def merge_triangles(scene: Scene, cells: Cells | None = None) -> Scene:
    """Join pairs of triangles of one surface, equal in every value, that share the diagonal of a parallelogram.

    Pairs that follow each other in the file come first, then those whose diagonal is longest against their edges,
    so that a regular grid becomes rectangles. Only coplanar pairs with equal orientation qualify.

    Args:
        cells: of the faces, which are used up; None: all edges are looked at.
    """
    pairs = _pairs(scene, cells)
    if not len(pairs.cost):
        return scene
    one, two, shared = pairs.one >> 2, pairs.two >> 2, (pairs.one & 3, pairs.two & 3)
    chosen = matched(one, two, shared, pairs.cost, scene.n_faces)
    if not len(chosen):
        return scene
    one, two, shared = one[chosen], two[chosen], (shared[0][chosen], shared[1][chosen])
    keep, gone = np.minimum(one, two), np.maximum(one, two)
    a, b, c = (scene.faces[one, (shared[0] + i) % 3] for i in (0, 1, 2))  # diagonal a-b, apex c
    quads = np.column_stack([c, a, scene.faces[two, (shared[1] + 2) % 3], b])
    merged = scene
    for name in ("reflectance_paint", "emission_paint"):
        paint = getattr(scene, name)
        if paint is not None:
            merged = replace(merged, **{name: _merge_paint(paint, one, two, (shared[0] + 2) % 3, shared[1], keep)})
    kept = np.ones(scene.n_faces, bool)
    kept[gone] = False
    result = merged.take(kept)
    result.faces[np.cumsum(kept)[keep] - 1] = quads  # a copy, which nobody has seen yet
    return result


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Pairs of triangles that are the halves of a parallelogram.

    Attributes:
        one, two: (m,) four times the face of each, plus the corner where its edge begins. The first one runs through the edge
            from the end that is lower by x, then y, then z.
        cost: (m,) the best pairs have the least.
    """

    one: np.ndarray
    two: np.ndarray
    cost: np.ndarray


def _cells(scene: Scene) -> Cells | None:
    """Return the cells of a scene's faces, and measure these; None where that is not worthwhile."""
    if not scene.n_faces or mostly_alike(scene.vertices, scene.faces, PARALLEL_TOLERANCE):
        return None
    cells = Cells.empty(scene.n_faces, PARALLEL_TOLERANCE)
    scene.measure(cells.put)
    return cells


def _pairs(scene: Scene, cells: Cells | None) -> _Pairs:
    """Return the pairs of a scene, of one surface and with equal values."""
    triangle = np.flatnonzero(~scene.is_quad) if scene.is_quad.any() else None
    corners, surface = scene.faces[:, :3], scene.surface
    if triangle is not None:
        corners, surface, cells = corners[triangle], surface[triangle], cells and cells.take(triangle)
    place = welded(scene.vertices)
    edges = shared_edges(scene.vertices, corners, surface, scene.measures, PARALLEL_TOLERANCE, place, cells)
    if triangle is not None:
        edges = tuple(4 * triangle[edge >> 2] + (edge & 3) for edge in edges)
    axes, vertex = [np.ascontiguousarray(axis) for axis in scene.vertices.T], scene.faces.ravel()

    def at(edge: np.ndarray, turn: int) -> Vectors:
        corner = vertex.take((edge & ~3) + np.take(TURNED[turn], edge & 3))
        return [axis.take(corner) for axis in axes]

    def judged(part: slice) -> _Pairs:
        one, two = edges[0][part], edges[1][part]
        turn = _lower(at(two, 0), at(one, 0))
        one, two = np.where(turn, two, one), np.where(turn, one, two)
        a, b, c, d = at(one, 0), at(one, 1), at(one, 2), at(two, 2)  # diagonal a-b, apices c and d
        edge = np.maximum(length(minus(a, c)), length(minus(b, c)))
        off = [a + b - c - d for a, b, c, d in zip(a, b, c, d, strict=True)]
        fits = length(off) <= PARALLEL_TOLERANCE * edge
        faces, shared = (one >> 2, two >> 2), (one & 3, two & 3)
        fits &= _equal_rows(scene, *faces)
        for paint in (scene.reflectance_paint, scene.emission_paint):
            if paint is not None:
                fits &= _same_paint(paint, *faces, shared)
        cost = -length(minus(a, b)) / np.maximum(edge, 1e-300)
        cost = np.where(np.abs(faces[0] - faces[1]) == 1, cost - 10.0, cost)
        return _Pairs(one[fits], two[fits], cost[fits])

    found = [_Pairs(edges[0][:0], edges[1][:0], np.zeros(0)), *of_pieces(judged, len(edges[0]), SIZE)]
    return _Pairs(*(np.concatenate([getattr(some, field.name) for some in found]) for field in fields(_Pairs)))


def _lower(one: Vectors, two: Vectors) -> np.ndarray:
    """Return which points are lower than others by x, of equal ones by y, then by z, (m,) bool."""
    result = one[2] < two[2]
    for axis in (1, 0):
        result = (one[axis] < two[axis]) | ((one[axis] == two[axis]) & result)
    return result


def _equal_rows(scene: Scene, one, two) -> np.ndarray:
    same = np.ones(len(one), bool)
    values = (scene.back, scene.reflectance, scene.emission, scene.back_reflectance, scene.back_emission)
    for value in (*values, scene.transmittance, scene.refractive_index, scene.diffuse_transmittance):
        if value is not None and not is_one_row(value):
            equal = value[one] == value[two]
            same &= equal if equal.ndim == 1 else equal.all(axis=1)
    return same


def _corners(values, one, two, shared):
    """Values at a, b, c of the first triangle and b', a', d of the second."""
    rows = [values[one, (shared[0] + i) % 3] for i in (0, 1, 2)]
    return rows + [values[two, (shared[1] + i) % 3] for i in (0, 1, 2)]


def _same_paint(paint: Paint, one, two, shared) -> np.ndarray:
    same = paint.image[one] == paint.image[two]
    for values, used in ((paint.uv, paint.image[one] >= 0), (paint.color, np.ones(len(one), bool))):
        a, b, c, b_two, a_two, d = _corners(values, one, two, shared)
        largest = np.max([np.abs(x).max(axis=1, initial=0) for x in (a, b, c, d)], axis=0)
        scale = 1e-5 * (1 + largest) if values is paint.color else tolerance(np.ptp([a, b, c, d], axis=0).max(axis=1), largest)
        affine = np.abs(a + b - c - d).max(axis=1, initial=0) <= scale
        equal = (np.abs(a - a_two).max(axis=1, initial=0) <= scale) & (np.abs(b - b_two).max(axis=1, initial=0) <= scale)
        same &= ~used | affine & equal
    return same


def _merge_paint(paint: Paint, one, two, first_corner, second_corner, keep) -> Paint:
    uv, color = paint.uv.copy(), paint.color.copy()
    for values, source in ((uv, paint.uv), (color, paint.color)):
        c, a, b = (source[one, (first_corner + i) % 3] for i in range(3))
        d = source[two, (second_corner + 2) % 3]
        values[keep] = np.stack([c, a, d, b], axis=1)
    return replace(paint, uv=uv, color=color)
