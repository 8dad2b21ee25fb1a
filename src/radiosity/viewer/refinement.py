"""Finer triangles where a page would show wrong colours between their corners.

A page interpolates the colours that meshes are given, and then maps tones. So between two corners it shows another colour than
that of the interpolated value. Edges in whose middle the difference can be seen are halved, in both triangles that share them.
"""

from collections.abc import Callable

import numpy as np

from ..image.tone import srgb
from . import tone_mapping
from .mesh import Triangles

DIFFERENCE = 1.5 / 255  # of display values: what is left between corners
ALIKE = 5 / 255  # of display values: between colours that differ by less, no difference of more than about two levels arises
SAMPLES = (0.25, 0.5, 0.75)  # places on an edge where colours are compared
ROUNDS = 7  # of halving: an edge becomes at most 128 pieces
MOST = 300_000  # triangles: more of them are so small that they are left as they are


def refined(triangles: Triangles, linear: Callable[[np.ndarray], np.ndarray]) -> Triangles:
    """Return triangles whose colours are right along their edges.

    Args:
        triangles: to show.
        linear: the linear colours, (n, 3), of values (n, n_bands).
    """
    fresh = np.arange(len(triangles.corners))
    for _ in range(ROUNDS):
        rows, edge, ends = _unlike(triangles, fresh, linear)
        wrong = _wrong(triangles.values[ends[0]], triangles.values[ends[1]], linear)
        if not wrong.any():
            return triangles
        middle = np.full((len(fresh), 3), -1)
        number = np.where(wrong, len(triangles.vertices) + np.cumsum(wrong) - 1, -1)
        middle[rows] = np.where(edge >= 0, number[edge], -1)
        triangles, fresh = _halved(triangles, fresh, middle, ends[:, wrong])
    return triangles


def _unlike(
    triangles: Triangles, rows: np.ndarray, linear: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return edges whose ends differ in colour, of some of the triangles.

    Returns:
        Which of ``rows`` have such edges, (k,); the number of each of their edges, (k, 3), -1 where it is none of them; and the
        vertices at the ends of the edges, (2, n).
    """
    corners = triangles.corners[rows]
    shown = np.empty((len(triangles.vertices), 3))
    used = _used(corners, len(shown))
    shown[used] = srgb(linear(triangles.values[used]))
    far = np.stack([np.abs(shown[corners[:, i]] - shown[corners[:, (i + 1) % 3]]).max(axis=1) > ALIKE for i in range(3)], axis=1)
    some = np.flatnonzero(far.any(axis=1))
    pairs = np.sort(corners[some][:, [[0, 1], [1, 2], [2, 0]]], axis=2)[far[some]]
    key, place = np.unique(pairs[:, 0].astype(np.int64) * len(shown) + pairs[:, 1], return_inverse=True)
    edge = np.full((len(some), 3), -1)
    edge[far[some]] = place
    return some, edge, np.stack([key // len(shown), key % len(shown)])


def _used(corners: np.ndarray, count: int) -> np.ndarray:
    flags = np.zeros(count, bool)
    flags[corners] = True
    return np.flatnonzero(flags)


def _wrong(first: np.ndarray, second: np.ndarray, linear: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Return which edges, with values (n, n_bands) at their ends, show wrong colours between them, (n,) bool."""
    one, other = tone_mapping.before(linear(first)), tone_mapping.before(linear(second))
    result = np.zeros(len(one), bool)
    for share in SAMPLES:
        shown = tone_mapping.after(one + share * (other - one))
        meant = linear(first + share * (second - first))
        result |= np.abs(srgb(shown) - srgb(meant)).max(axis=1) > DIFFERENCE
    return result


def _halved(triangles: Triangles, rows: np.ndarray, middle: np.ndarray, ends: np.ndarray) -> tuple[Triangles, np.ndarray]:
    """Return triangles with some edges halved, and the numbers of those that are new.

    Args:
        rows: (k,) triangles with edges to halve; others have none.
        middle: (k, 3) the new vertex in the middle of the edges that leave corners 0, 1, 2; -1 where an edge stays.
        ends: (2, n) vertices between which the new ones lie.
    """
    vertices = np.concatenate([triangles.vertices, triangles.vertices[ends].mean(axis=0)])
    values = np.concatenate([triangles.values, triangles.values[ends].mean(axis=0)])
    count = (middle >= 0).sum(axis=1)
    kept = np.ones(len(triangles.corners), bool)
    kept[rows[count > 0]] = False
    corners, patch = [triangles.corners[kept]], [triangles.patch[kept]]
    for halves, template in TEMPLATES.items():
        here = np.flatnonzero(count == halves)
        # turned so that its halved edges come first, in the order of the template
        split = middle[here] >= 0
        if halves == 1:
            turn = np.argmax(split, axis=1)
        elif halves == 2:
            turn = (np.argmin(split, axis=1) + 1) % 3
        else:
            turn = np.zeros(len(here), int)
        order = (turn[:, None] + np.arange(3)) % 3
        six = np.concatenate(
            [np.take_along_axis(triangles.corners[rows[here]], order, axis=1), np.take_along_axis(middle[here], order, axis=1)],
            axis=1,
        )
        corners += [six[:, list(part)] for part in template]
        patch += [triangles.patch[rows[here]]] * len(template)
    made = Triangles(vertices, values, np.concatenate(corners), np.concatenate(patch))
    return made, np.arange(int(kept.sum()), len(made.corners))


TEMPLATES = {  # number of halved edges: parts, of corners 0, 1, 2 and the middles 3 (of edge 0-1), 4 (1-2), 5 (2-0)
    1: ((0, 3, 2), (3, 1, 2)),
    2: ((3, 1, 4), (0, 3, 4), (0, 4, 2)),
    3: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
}
