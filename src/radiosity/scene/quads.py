"""The merge of two triangles, which a file format made of one flat parallelogram, to one face."""

from dataclasses import replace

import numpy as np

from .arrays import PARALLEL_TOLERANCE
from .bends import tolerance
from .model import Scene
from .paint import Paint

ROUNDS = 16  # most rounds of mutual best matching; meshes need two or three


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
    p = scene.vertices
    edge = np.maximum(np.linalg.norm(p[a] - p[c], axis=1), np.linalg.norm(p[b] - p[c], axis=1))
    fits = np.linalg.norm(p[a] + p[b] - p[c] - p[d], axis=1) <= PARALLEL_TOLERANCE * edge
    fits &= _equal_rows(scene, one, two)
    for paint in (scene.reflectance_paint, scene.emission_paint):
        if paint is not None:
            fits &= _same_paint(paint, one, two, shared)
    one, two = one[fits], two[fits]
    quads = np.column_stack([c, a, d, b])[fits]
    first_corner = ((shared[0] + 2) % 3)[fits]
    diagonal = np.linalg.norm(p[a] - p[b], axis=1)[fits]
    cost = -diagonal / np.maximum(edge[fits], 1e-300)
    cost = np.where(np.abs(one - two) == 1, cost - 10.0, cost)
    chosen = _match(one, two, cost, scene.n_faces)
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


def _candidates(scene: Scene):
    """Pairs of triangles of one surface with one edge in common, run in opposite directions."""
    triangle = np.flatnonzero(~scene.is_quad)
    _, welded = np.unique(scene.vertices + 0.0, axis=0, return_inverse=True)
    corners = welded.ravel()[scene.faces[triangle, :3]]
    start = corners.ravel()
    end = np.roll(corners, -1, axis=1).ravel()
    face = np.repeat(triangle, 3)
    corner = np.tile(np.arange(3), len(triangle))
    surface = scene.surface[face]
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.lexsort((start, surface, high, low))
    same = (
        (low[order][1:] == low[order][:-1]) & (high[order][1:] == high[order][:-1]) & (surface[order][1:] == surface[order][:-1])
    )
    group = np.concatenate([[0], np.cumsum(~same)])
    pair = np.flatnonzero(same & (np.bincount(group)[group[1:]] == 2))
    left, right = order[pair], order[pair + 1]
    opposite = (start[left] == end[right]) & (start[left] != end[left])
    left, right = left[opposite], right[opposite]
    return face[left], face[right], (corner[left], corner[right])


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


def _match(one, two, cost, n) -> np.ndarray:
    """Greedy matching by rounds: a pair is taken where it is the best of both its triangles."""
    order = np.lexsort((np.maximum(one, two), np.minimum(one, two), np.round(cost, 6)))
    taken = np.zeros(n, bool)
    chosen: list[np.ndarray] = []
    for _ in range(ROUNDS):
        order = order[~(taken[one[order]] | taken[two[order]])]
        if len(order) == 0:
            break
        best = np.full(n, len(one))
        rank = np.arange(len(order))
        np.minimum.at(best, one[order], rank)
        np.minimum.at(best, two[order], rank)
        mutual = order[(best[one[order]] == rank) & (best[two[order]] == rank)]
        taken[one[mutual]] = taken[two[mutual]] = True
        chosen.append(mutual)
    return np.concatenate(chosen) if chosen else np.zeros(0, np.int64)
