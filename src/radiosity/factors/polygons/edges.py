"""The integral of ln r over pairs of straight edges.

The inner integral is elementary. Where the edges are parallel, also shared or partly shared, so is the outer one. Elsewhere the
outer one is a Gauss rule on pieces of the shorter edge. As a function of the place s on that edge's line, the inner integral has
branch points. Two are where the other edge's ends project to, as far into the complex plane as the ends are from the line. One is
at the foot of the common perpendicular. A piece is fine when all of these are well outside it. Otherwise it is cut, geometrically
towards the branch point, so that corners that touch, T junctions and narrow gaps need only a few pieces more.
"""

from dataclasses import dataclass

import numpy as np

from .short_axes import lengths

NODES = 10
CLEAR = 1.6  # half lengths from a piece's middle to the next branch point: the error is below 2.8^-20 of the inner integral
CUT = 0.25  # of a piece that ends at a branch point: it is cut here, and the rest is clear
LEAST = 1e-5  # of an edge: shorter pieces are not cut. The integrand is like s ln s there, so they hold 1e-10 or so
PARALLEL = 1e-9  # sine of an angle
TINY = 1e-300
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(NODES)


@dataclass(frozen=True, eq=False)
class Edges:
    """Straight edges.

    Attributes:
        begin, direction: (m, 3), directions of unit length.
        length: (m,).
    """

    begin: np.ndarray
    direction: np.ndarray
    length: np.ndarray

    @staticmethod
    def of(begin: np.ndarray, end: np.ndarray) -> "Edges":
        """Make edges from their ends, which must differ."""
        length = lengths(end - begin)
        return Edges(begin, (end - begin) / length[:, None], length)

    def take(self, rows: np.ndarray) -> "Edges":
        return Edges(self.begin[rows], self.direction[rows], self.length[rows])


def where(mask: np.ndarray, one: Edges, other: Edges) -> Edges:
    """Return ``one`` where the mask is true, else ``other``."""
    wide = mask[:, None]
    return Edges(
        np.where(wide, one.begin, other.begin),
        np.where(wide, one.direction, other.direction),
        np.where(mask, one.length, other.length),
    )


def logarithm(one: Edges, other: Edges) -> np.ndarray:
    """Return the double integrals of ln r over m pairs of edges, (m,)."""
    shorter = one.length <= other.length
    one, other = where(shorter, one, other), where(shorter, other, one)
    sine = lengths(np.cross(one.direction, other.direction))
    result, parallel = np.empty(len(sine)), sine < PARALLEL
    for rows, integral in ((np.flatnonzero(parallel), _parallel), (np.flatnonzero(~parallel), _oblique)):
        result[rows] = integral(one.take(rows), other.take(rows))
    return result


def _parallel(one: Edges, other: Edges) -> np.ndarray:
    """Integrate by the second antiderivative of ln sqrt(x² + h²), x along the edges and h the distance of their lines."""
    way = one.begin - other.begin
    along = np.einsum("mx,mx->m", way, other.direction)
    square = np.maximum(((way - along[:, None] * other.direction) ** 2).sum(axis=1), 0)
    height = np.sqrt(square)
    end = along + one.length * np.sign(np.einsum("mx,mx->m", one.direction, other.direction))

    def twice(x):
        return (x * x - square) / 4 * np.log(np.maximum(x * x + square, TINY)) - 0.75 * x * x + height * x * np.arctan2(x, height)

    total = twice(end) - twice(along) - twice(end - other.length) + twice(along - other.length)
    return total * np.sign(end - along)


def _oblique(one: Edges, other: Edges) -> np.ndarray:
    place, depth = _branch_points(one, other)
    result, least = np.zeros(len(one.length)), LEAST * one.length
    row, low, high = np.arange(len(result)), np.zeros(len(result)), one.length
    while len(row):
        middle, half = (low + high) / 2, (high - low) / 2
        away = np.hypot(place[row] - middle[:, None], depth[row])
        worst = away.argmin(axis=1)
        nearest = np.arange(len(row))
        fine = (away[nearest, worst] >= CLEAR * half) | (2 * half <= least[row])
        done = np.flatnonzero(fine)
        result += _gauss(one, other, row[done], middle[done], half[done], len(result))
        rest = np.flatnonzero(~fine)
        row, low, high = row[rest], low[rest], high[rest]
        at = place[row, worst[rest]]
        inside = (at > low + CUT / 4 * (high - low)) & (at < high - CUT / 4 * (high - low))
        graded = np.where(at - low < high - at, low + CUT * (high - low), high - CUT * (high - low))
        cut = np.where(inside, at, graded)
        row, low, high = np.concatenate([row, row]), np.concatenate([low, cut]), np.concatenate([cut, high])
    return result


def _branch_points(one: Edges, other: Edges) -> tuple[np.ndarray, np.ndarray]:
    """Return real and imaginary part of the three branch points on lines ``one``, (m, 3) each."""
    way = other.begin - one.begin
    begin, slope = (np.einsum("mx,mx->m", x, one.direction) for x in (way, other.direction))
    end = begin + slope * other.length
    ends = (way, way + other.direction * other.length[:, None])
    depth = [lengths(w - x[:, None] * one.direction) for w, x in zip(ends, (begin, end), strict=True)]
    normal = np.cross(one.direction, other.direction)
    square = (normal**2).sum(axis=1)
    foot = np.einsum("mx,mx->m", np.cross(way, other.direction), normal) / square
    across = np.einsum("mx,mx->m", np.cross(way, one.direction), normal) / square
    inside = (across > -0.25 * other.length) & (across < 1.25 * other.length)  # elsewhere the branch is nearly cancelled
    gap = np.where(inside, np.abs(np.einsum("mx,mx->m", way, normal)) / square, np.inf)
    return np.stack([begin, end, foot], axis=1), np.stack([*depth, gap], axis=1)


def _gauss(one: Edges, other: Edges, row, middle, half, size: int) -> np.ndarray:
    """Return sums over pieces, (size,); each piece is of the edge in its row."""
    result = np.zeros(size)
    if len(row):
        way, direction, length = one.begin[row] - other.begin[row], other.direction[row], other.length[row]
        steps = middle[:, None] + half[:, None] * POINTS
        slope = np.einsum("mx,mx->m", one.direction[row], direction)
        along = np.einsum("mx,mx->m", way, direction)[:, None] + slope[:, None] * steps
        # the part of the way at right angles to the other edge, as a vector: no cancellation where it is short
        flat = way - np.einsum("mx,mx->m", way, direction)[:, None] * direction
        rise = one.direction[row] - slope[:, None] * direction
        square = sum((flat[:, x, None] + rise[:, x, None] * steps) ** 2 for x in range(3))
        height = np.sqrt(square)

        def once(x):
            return x * (np.log(np.maximum(x * x + square, TINY)) / 2 - 1) + height * np.arctan2(x, height)

        values = (once(along) - once(along - length[:, None])) @ WEIGHTS
        result = np.bincount(row, weights=values * half, minlength=size)
    return result
