"""The merge of two triangles, which a file format made of one flat parallelogram, to one face."""

from dataclasses import replace

import numpy as np

from .arrays import PARALLEL_TOLERANCE
from .bends import tolerance
from .matching import matched
from .measures import length, minus
from .model import Scene
from .paint import Paint
from .shared_edges import shared_edges
from .welded import welded


def merge_triangles(scene: Scene) -> Scene:
    """Join pairs of triangles of one surface, equal in every value, that share the diagonal of a parallelogram.

    Pairs that follow each other in the file come first, then those whose diagonal is longest against their edges,
    so that a regular grid becomes rectangles. Only coplanar pairs with equal orientation qualify.
    """
    one, two, shared = _candidates(scene)
    if len(one) == 0:
        return scene
    a, b, c = (scene.faces[one, (shared[0] + i) % 3] for i in (0, 1, 2))  # diagonal a-b, apex c
    d = scene.faces[two, (shared[1] + 2) % 3]
    at_a, at_b, at_c, at_d = ([axis[corner] for axis in np.ascontiguousarray(scene.vertices.T)] for corner in (a, b, c, d))
    edge = np.maximum(length(minus(at_a, at_c)), length(minus(at_b, at_c)))
    off = [a + b - c - d for a, b, c, d in zip(at_a, at_b, at_c, at_d, strict=True)]
    fits = length(off) <= PARALLEL_TOLERANCE * edge
    fits &= _equal_rows(scene, one, two)
    for paint in (scene.reflectance_paint, scene.emission_paint):
        if paint is not None:
            fits &= _same_paint(paint, one, two, shared)
    one, two = one[fits], two[fits]
    quads = np.column_stack([c, a, d, b])[fits]
    first_corner = ((shared[0] + 2) % 3)[fits]
    diagonal = length(minus(at_a, at_b))[fits]
    cost = -diagonal / np.maximum(edge[fits], 1e-300)
    cost = np.where(np.abs(one - two) == 1, cost - 10.0, cost)
    chosen = matched(one, two, (shared[0][fits], shared[1][fits]), cost, scene.n_faces)
    if not len(chosen):
        return scene
    keep, gone = np.minimum(one, two)[chosen], np.maximum(one, two)[chosen]
    faces = scene.faces.copy()
    faces[keep] = quads[chosen]
    merged = replace(scene, faces=faces)
    for name in ("reflectance_paint", "emission_paint"):
        paint = getattr(scene, name)
        if paint is not None:
            merged = replace(
                merged,
                **{name: _merge_paint(paint, one[chosen], two[chosen], first_corner[chosen], shared[1][fits][chosen], keep)},
            )
    kept = np.ones(scene.n_faces, bool)
    kept[gone] = False
    return merged.take(kept)


def _candidates(scene: Scene) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """Return pairs of triangles of one surface with one edge in common, and for both the corner where that edge begins.

    The first one runs through the edge from the end that is lower by x, then y, then z.
    """
    triangle = np.flatnonzero(~scene.is_quad) if scene.is_quad.any() else None
    corners, surface = scene.faces[:, :3], scene.surface
    if triangle is not None:
        corners, surface = corners[triangle], surface[triangle]
    if (number := welded(scene.vertices)) is not None:
        corners = number[corners]
    edges = shared_edges(scene.vertices, corners, surface, scene.measures, PARALLEL_TOLERANCE)
    begin = corners[edges[0] >> 2, edges[0] & 3]
    end = corners[edges[1] >> 2, edges[1] & 3]
    turn = _lower(scene.vertices[end], scene.vertices[begin])
    one, two = np.where(turn, edges[1], edges[0]), np.where(turn, edges[0], edges[1])
    rows = [edge >> 2 if triangle is None else triangle[edge >> 2] for edge in (one, two)]
    return rows[0], rows[1], (one & 3, two & 3)


def _lower(one: np.ndarray, two: np.ndarray) -> np.ndarray:
    """Return which points, (m, 3), are lower than others by x, of equal ones by y, then by z."""
    result = one[:, 2] < two[:, 2]
    for axis in (1, 0):
        result = (one[:, axis] < two[:, axis]) | ((one[:, axis] == two[:, axis]) & result)
    return result


def _equal_rows(scene: Scene, one, two) -> np.ndarray:
    same = scene.back[one] == scene.back[two]
    for value in (scene.reflectance, scene.emission, scene.back_reflectance, scene.back_emission):
        same &= (value[one] == value[two]).all(axis=1)
    if scene.transmittance is not None:
        same &= scene.transmittance[one] == scene.transmittance[two]
    if scene.refractive_index is not None:
        same &= scene.refractive_index[one] == scene.refractive_index[two]
    if scene.diffuse_transmittance is not None:
        same &= (scene.diffuse_transmittance[one] == scene.diffuse_transmittance[two]).all(axis=1)
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
