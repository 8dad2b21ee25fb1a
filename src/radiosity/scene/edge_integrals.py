"""Integrals of p dy - q dx (see `image_tables`) along straight edges, cut where they pass from one cell to the next."""

import numpy as np

from .image_tables import Tables

STRAIGHT = 1e-6  # texels: edges that leave an axis by less are taken to be along it
LONG = 8.0  # cells: from here on edges along y are looked up in sums over rows
AT_ONCE = 1 << 18  # segments
GAUSS = (0.5 - 0.5 / np.sqrt(3), 0.5 + 0.5 / np.sqrt(3))  # exact for the cubics along an edge through a bilinear cell


def crossings(tables: Tables, start: np.ndarray, edge: np.ndarray) -> np.ndarray:
    """Return the number of lines between cells that each edge must be cut at, along axes that repeat, (m,) float64.

    Args:
        start, edge: (m, 2) texel coordinates of the starts of edges, and the vectors along them.
    """
    x, y, dx, dy = _own(tables, start, edge)
    down, flat = _along_axes(dx, dy)
    axes = ((axis, one, by) for axis, one, by in ((tables.x, x, dx), (tables.y, y, dy)) if axis.period)
    return np.where(down | flat, 0.0, sum(axis.lines(one, one + by)[1] for axis, one, by in axes))


def along_edges(tables: Tables, start: np.ndarray, edge: np.ndarray) -> np.ndarray:
    """Return the integral along each edge, in square texels, (n_bands, m) float64."""
    x, y, dx, dy = _own(tables, start, edge)
    down, flat = _along_axes(dx, dy)
    result = np.zeros((len(tables.mean), len(x)))
    at = np.flatnonzero(down)
    if len(at):
        middle, ends = x[at] + dx[at] / 2, (y[at], y[at] + dy[at])
        for band in range(len(result)):
            result[band, at] = tables.down(band, middle, ends[1]) - tables.down(band, middle, ends[0])
    at = np.flatnonzero(flat & ~down)
    if len(at):
        middle = y[at] + dy[at] / 2
        row, top = tables.y.cell(middle)
        for band in range(len(result)):
            result[band, at] = -tables.q(band, row)(middle - top) * dx[at]
    at = np.flatnonzero(~(down | flat))
    lines = [axis.lines(one[at], one[at] + by[at]) for axis, one, by in ((tables.x, x, dx), (tables.y, y, dy))]
    ends = np.cumsum(1 + lines[0][1] + lines[1][1])
    begin = 0
    while begin < len(at):
        end = max(begin + 1, int(np.searchsorted(ends, (ends[begin - 1] if begin else 0) + AT_ONCE, side="right")))
        part = at[begin:end]
        result[:, part] = _cut(tables, x[part], y[part], dx[part], dy[part], [[n[begin:end] for n in both] for both in lines])
        begin = end
    return result / (tables.x.scale * tables.y.scale)


def _own(tables: Tables, start: np.ndarray, edge: np.ndarray):
    """The starts in own coordinates, moved near the origin where the axis repeats, and the edges."""
    x, y = tables.x.own(start[:, 0]), tables.y.own(start[:, 1])
    x, y = (at % axis.period if axis.period else at for at, axis in ((x, tables.x), (y, tables.y)))
    return x, y, edge[:, 0] * tables.x.scale, edge[:, 1] * tables.y.scale


def _along_axes(dx: np.ndarray, dy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return which edges along y are long, and which edges are along x, (m,) bool each."""
    wide, high = np.abs(dx), np.abs(dy)
    return (wide < STRAIGHT) & (high > LONG), (high == 0) | ((high < STRAIGHT) & (wide > LONG))


def _cut(tables: Tables, x, y, dx, dy, lines) -> np.ndarray:
    """Return the integrals along edges that are cut at these lines, (n_bands, m)."""
    count = len(x)
    keys = [np.arange(count, dtype=np.float64)]  # the edge's number, and how far along it a segment begins
    for (first, number), start, by in zip(lines, (x, y), (dx, dy), strict=True):
        number = number.astype(np.int64)
        edge = np.repeat(np.arange(count), number)
        line = first[edge] + np.arange(len(edge)) - np.repeat(np.cumsum(number) - number, number)
        keys.append(edge + np.clip((line - start[edge]) / by[edge], 0, 1))
    key = np.sort(np.concatenate(keys))
    edge = np.minimum(key.astype(np.int64), count - 1)
    begin = key - edge
    last = np.append(edge[1:] != edge[:-1], True)
    length = np.where(last, 1.0, np.append(begin[1:], 1.0)) - begin
    x, y, dx, dy = x[edge], y[edge], dx[edge], dy[edge]
    middle = begin + length / 2
    (column, left), (row, top) = tables.x.cell(x + middle * dx), tables.y.cell(y + middle * dy)
    at = row * tables.width + column
    total = np.zeros((len(tables.mean), len(key)))
    points = GAUSS if tables.linear else (0.5,)
    places = [(x + (begin + point * length) * dx - left, y + (begin + point * length) * dy - top) for point in points]
    for band in range(len(total)):
        p, q = tables.p(band, at), tables.q(band, row)
        total[band] = sum(p(u, v) * dy - q(v) * dx for u, v in places)
    total *= length / len(points)
    return np.stack([np.bincount(edge, values, count) for values in total])
