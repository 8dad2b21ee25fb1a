"""Texels: the point of a surface that each texel of an atlas stands for.

A texel whose middle lies in a triangle stands for that point. One beside a chart, which a viewer's interpolation between texels
still reads, stands for the nearest point of the chart's edge. All others are padding, and take the value of the nearest texel.
"""

from dataclasses import dataclass

import numpy as np

from .atlas import Atlas

BESIDE = 1.5  # texels from a chart within which interpolation reads a texel: the diagonal of one, and some more
MARGIN = 0.1  # texels from the edges of faces to points: at the very edge a point may lie in what stands there
GOLDEN = 0.6180339887498949  # spreads points over a texel
AT_ONCE = 1 << 20  # pairs of texels and triangles


@dataclass(frozen=True, eq=False)
class Texels:
    """Texels that stand for a point.

    Attributes:
        row, column: (n,) int64 on the page, in rows.
        triangle: (n,) int64.
        place: (n, 2) float64, face coordinates.
        inside: (n,) bool, the middle lies in the triangle.
    """

    row: np.ndarray
    column: np.ndarray
    triangle: np.ndarray
    place: np.ndarray
    inside: np.ndarray

    def __len__(self) -> int:
        return len(self.row)

    @staticmethod
    def of(atlas: Atlas) -> "Texels":
        """Return the texels of an atlas, row by row. Of several triangles a texel takes the nearest, of equal ones the first."""
        page = atlas.width * atlas.height
        nearest, owner = np.full(page, np.inf), np.full(page, -1, np.int64)
        weights = np.zeros((page, 3))
        for triangle, column, row in _candidates(atlas):
            found, shares = _nearest(atlas.places[triangle], np.stack([column, row], axis=1) + 0.5)
            near = np.flatnonzero(found <= BESIDE**2)
            texel = (row * atlas.width + column)[near]
            order = np.lexsort((triangle[near], found[near], texel))
            first = order[np.flatnonzero(np.diff(texel[order], prepend=-1))]
            better = first[found[near[first]] < nearest[texel[first]]]
            at, pick = texel[better], near[better]
            nearest[at], owner[at], weights[at] = found[pick], triangle[pick], shares[pick]
        own = np.flatnonzero(owner >= 0)
        place = np.einsum("mk,mkc->mc", weights[own], atlas.triangles.place[owner[own]])
        place = _within(atlas, owner[own], place)
        return Texels(own // atlas.width, own % atlas.width, owner[own], place, nearest[own] == 0)


def points_of(atlas: Atlas, texels: Texels, count: int) -> list[np.ndarray]:
    """Return face coordinates of ``count`` points spread over each texel, (n, 2) each; texels beside a chart keep theirs.

    A texel then has the mean over its square, so that edges of shadows are smooth.
    """
    step, inside, found = _steps(atlas), np.flatnonzero(texels.inside), []
    triangle = texels.triangle[inside]
    for k in range(count):
        offset = np.array([(k + 0.5) / count, (k * GOLDEN + 0.5) % 1]) - 0.5
        there = texels.place.copy()
        there[inside] = _within(atlas, triangle, there[inside] + offset @ step[triangle])
        found.append(there)
    return found


def _steps(atlas: Atlas) -> np.ndarray:
    """Return the steps of face coordinates for a texel right and a texel down, (m, 2, 2), of each triangle."""
    first, second = (atlas.places[:, i] - atlas.places[:, 0] for i in (1, 2))
    edges, place = np.stack([first, second], axis=1), atlas.triangles.place
    flat = np.abs(np.linalg.det(edges)) > 0
    ways = np.stack([place[:, i] - place[:, 0] for i in (1, 2)], axis=1)
    step = np.zeros((len(edges), 2, 2))
    step[flat] = np.linalg.solve(edges[flat], ways[flat])
    return step


def _within(atlas: Atlas, triangle: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Return face coordinates, (n, 2), moved into their faces: `MARGIN` from edges, where another face may stand.

    Args:
        triangle: (n,) of each.
    """
    step = _steps(atlas)
    steps = np.concatenate([-step.sum(axis=2, keepdims=True), step], axis=2)  # of the three shares of a triangle's corners
    margin = np.minimum(MARGIN * np.linalg.norm(steps, axis=1), 0.3)[triangle]
    quad = np.clip(place, margin[:, 1:], 1 - margin[:, 1:])
    shares = np.maximum(np.column_stack([1 - place.sum(axis=1), place]), margin)
    is_quad = atlas.triangles.scene.is_quad[atlas.triangles.face[triangle]]
    return np.where(is_quad[:, None], quad, (shares / shares.sum(axis=1, keepdims=True))[:, 1:])


def _candidates(atlas: Atlas):
    """Yield triangles and the texels in their boxes, as numbers, columns and rows, in the order of triangles."""
    low = np.floor(atlas.places.min(axis=1) - BESIDE - 0.5).astype(np.int64)
    high = np.ceil(atlas.places.max(axis=1) + BESIDE + 0.5).astype(np.int64)
    low, high = np.maximum(low, 0), np.minimum(high, [atlas.width, atlas.height])
    of_row, line = _counted(high[:, 1] - low[:, 1])  # a line of texels of a triangle's box
    wide = (high - low)[of_row, 0]
    ends = np.searchsorted(np.cumsum(wide), np.arange(1, int(wide.sum()) // AT_ONCE + 2) * AT_ONCE, side="right")
    begin = 0
    for end in np.unique(np.append(np.maximum(ends, 1), len(wide))):
        entry, step = _counted(wide[begin:end])
        triangle = of_row[begin:end][entry]
        yield triangle, low[triangle, 0] + step, low[triangle, 1] + line[begin:end][entry]
        begin = end


def _counted(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return each number as often as its count says, and 0, 1, 2 and so on within it."""
    number = np.repeat(np.arange(len(counts)), counts)
    return number, np.arange(len(number)) - np.repeat(np.cumsum(counts) - counts, counts)


def _nearest(corners: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the squared distance of points, (n,), from their triangles, (n, 3, 2), and the shares of the corners, (n, 3), at
    the nearest point."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    double = _cross(b - a, c - a)
    area = np.where(double == 0, 1.0, double)
    shares = np.stack([_cross(c - b, points - b), _cross(a - c, points - c), _cross(b - a, points - a)], axis=1) / area[:, None]
    inside = (shares >= 0).all(axis=1) & (double != 0)
    distance = np.where(inside, 0.0, np.inf)
    shares = np.where(inside[:, None], shares, 0.0)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        edge = corners[:, j] - corners[:, i]
        square = np.einsum("ij,ij->i", edge, edge)
        t = np.einsum("ij,ij->i", points - corners[:, i], edge) / np.where(square == 0, 1.0, square)
        t = np.clip(t, 0, 1)
        gap = points - corners[:, i] - t[:, None] * edge
        apart = np.einsum("ij,ij->i", gap, gap)
        nearer = np.flatnonzero(apart < distance)
        distance[nearer] = apart[nearer]
        shares[nearer] = 0.0
        shares[nearer, i], shares[nearer, j] = 1 - t[nearer], t[nearer]
    shares[double == 0] = 1 / 3  # one that is a point on the page: its middle
    return distance, shares


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
