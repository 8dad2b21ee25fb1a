"""Means of painted values over the cells of faces: base value times image times corner colours, at most the limit.

The limit holds for each texel times the base value and the face's brightest corner; where there is no image, for each point. So
means do not depend on the size of the cells. Where an image and colours both vary, or texture coordinates are not linear
over a parallelogram, cells are cut finer, and each part is taken with its own colour.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields

import numpy as np

from ..pieces import PIECE, pieces
from ..scene.image_means import ImageMeans, bands_at_once
from ..scene.paint import Paint, between
from ..scene.ramp import mean_below
from . import cells

FINEST = (32, 128)  # parts along the edge of a cell where there are many parts, and where there are few
ALL_PARTS = 1 << 20  # this number is many
BENT_PARTS = 16  # where texture coordinates are not linear
BENT = 1e-4  # of their extent over a face: coordinates that differ less from linear ones are linear


@dataclass(frozen=True, eq=False)
class Grid:
    """Cells of faces.

    Attributes:
        owner: (m,) int, the face of each cell, among the faces in use.
        column, row, inverted: (m,) the places of the cells.
        columns, rows: (m,) numbers of columns and rows of their faces.
        is_quad: (m,) bool.
    """

    owner: np.ndarray
    column: np.ndarray
    row: np.ndarray
    inverted: np.ndarray
    columns: np.ndarray
    rows: np.ndarray
    is_quad: np.ndarray

    def take(self, which) -> "Grid":
        return Grid(*(getattr(self, field.name)[which] for field in fields(self)))

    def finer(self, times: int) -> "Grid":
        """Return the grid with each cell in times x times parts, one after another."""
        whole = self.take(np.repeat(np.arange(len(self.owner)), times * times))
        part = np.tile(np.arange(times * times), len(self.owner))
        column, row, inverted = cells.place(part, np.full(len(part), times), whole.is_quad)
        turned = whole.inverted  # parts of an inverted triangle are numbered from its own corner backwards
        column = np.where(turned, (whole.column + 1) * times - 1 - column, whole.column * times + column)
        row = np.where(turned, (whole.row + 1) * times - 1 - row, whole.row * times + row)
        return Grid(whole.owner, column, row, inverted ^ turned, whole.columns * times, whole.rows * times, whole.is_quad)

    @property
    def middle(self) -> tuple[np.ndarray, np.ndarray]:
        """Return face coordinates of the centroids."""
        offset = np.where(self.is_quad, 0.5, np.where(self.inverted, 2 / 3, 1 / 3))
        return (self.column + offset) / self.columns, (self.row + offset) / self.rows


def cell_means(paint: Paint, base: np.ndarray, columns: np.ndarray, rows: np.ndarray, is_quad: np.ndarray) -> np.ndarray:
    """Return the mean over each cell, (n_cells, n_bands) float64, face by face.

    Args:
        paint: of n faces.
        base: (n, n_bands) values that the paint multiplies.
        columns, rows, is_quad: (n,) how the faces are cut.
    """
    count = cells.count(columns, rows)
    first = np.concatenate([[0], np.cumsum(count)])
    result = np.empty((first[-1], base.shape[1]))
    for image, texels, weight, faces in _groups(paint, base):
        all_cells, owners = _ranges(first[faces], count[faces]), np.repeat(faces, count[faces])
        for bands in [slice(None)] if texels is None else bands_at_once(texels):
            means = None if texels is None else ImageMeans(texels[:, :, bands], paint.sampler(image))
            color = paint.color[:, :, bands]
            for part in pieces(len(all_cells)):
                cell, owner = all_cells[part], owners[part]
                place = cells.place(cell - first[owner], columns[owner], is_quad[owner])
                grid = Grid(owner, *place, columns[owner].astype(np.int64), rows[owner].astype(np.int64), is_quad[owner])
                if means is None:
                    result[cell] = _of_colors(paint, weight, grid)
                else:
                    result[cell, bands] = _of_image(means, paint.uv, color, weight[:, bands], grid)
    return result


def _ranges(first: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Return ranges of whole numbers, one after another: ``count`` numbers from each ``first`` on."""
    return np.arange(count.sum()) + np.repeat(first - (np.cumsum(count) - count), count)


def _groups(paint: Paint, base: np.ndarray) -> Iterator[tuple[int, np.ndarray | None, np.ndarray, np.ndarray]]:
    """Yield an image (or -1), its texels as they are or limited, the factor of colours, (n, n_bands), and the faces."""
    top = paint.color.max(axis=1).astype(np.float64)
    peak = base * top
    for image in np.unique(paint.image):
        faces = np.flatnonzero(paint.image == image)
        if image < 0:
            yield -1, None, base, faces
            continue
        texels = paint.images[image]
        bright = (peak[faces] * texels.max(axis=(0, 1)) > paint.limit).any(axis=1)
        if not bright.all():
            yield int(image), texels, base, faces[~bright]
        if bright.any():
            values, kind = np.unique(peak[faces[bright]], axis=0, return_inverse=True)
            shares = np.where(top > 0, 1 / np.where(top > 0, top, 1), 0)
            for number, value in enumerate(values):
                yield int(image), np.minimum(texels * value, paint.limit), shares, faces[bright][kind.ravel() == number]


def _of_colors(paint: Paint, weight: np.ndarray, grid: Grid) -> np.ndarray:
    """Return means of colours times weights, limited where faces are painted."""
    color, limit = paint.color, paint.limit
    result = between(color[grid.owner], grid.is_quad, *grid.middle) * weight[grid.owner]
    bright = (color[grid.owner].max(axis=1) * weight[grid.owner] > limit).any(axis=1)
    over = np.flatnonzero(bright & paint.painted[grid.owner])
    if len(over):
        some = grid.take(over)
        at = cells.corners(some.column, some.row, some.inverted, some.columns, some.rows, some.is_quad)
        value = [between(color[some.owner], some.is_quad, *at[:, i].T) * weight[some.owner] for i in range(4)]
        halves = [mean_below(np.stack([value[i] for i in half], axis=1), limit) for half in ((0, 1, 2), (0, 2, 3))]
        result[over] = np.where(some.is_quad[:, None], (halves[0] + halves[1]) / 2, halves[0])
    return result


def _of_image(means: ImageMeans, uv: np.ndarray, color: np.ndarray, weight: np.ndarray, grid: Grid) -> np.ndarray:
    """Return means of an image times colours times weights."""
    owner = grid.owner
    result = np.empty((len(owner), weight.shape[1]))
    parts = _parts(uv, color, grid)
    for times in np.unique(parts):
        chosen = np.flatnonzero(parts == times)
        step = max(1, PIECE // int(times) ** 2)
        for begin in range(0, len(chosen), step):
            some = chosen[begin : begin + step]
            finer = grid.take(some).finer(int(times))
            value = _over_cells(means, uv, finer) * between(color[finer.owner], finer.is_quad, *finer.middle)
            result[some] = value.reshape(len(some), -1, value.shape[1]).mean(axis=1) * weight[owner[some]]
    return result


def _parts(at: np.ndarray, colors: np.ndarray, grid: Grid) -> np.ndarray:
    """Return the number of parts of each cell's edges, (m,) int, a power of two.

    With so many, each part has nearly one colour and linear texture coordinates.
    """
    color, uv = (_steps(values[grid.owner].astype(np.float64), grid.is_quad) for values in (colors, at))
    top = np.maximum(colors[grid.owner].max(axis=1), 1e-30)
    across = (np.abs(color[0]) + np.abs(color[2])) / top / grid.columns[:, None]
    along = (np.abs(color[1]) + np.abs(color[2])) / top / grid.rows[:, None]
    finest = int(np.clip(np.sqrt(ALL_PARTS / max(len(grid.owner), 1)), *FINEST))
    wanted = 2 * finest * np.maximum(across, along).max(axis=1)  # cells whose colours vary by half are cut into the finest parts
    extent, rounding = np.maximum(np.abs(uv[0]), np.abs(uv[1])).max(axis=1), 1e-6 * np.abs(at[grid.owner]).max(axis=(1, 2))
    bent = np.abs(uv[2]).max(axis=1) > BENT * extent + rounding
    wanted = np.where(bent, np.maximum(wanted, BENT_PARTS), wanted)
    return 2 ** np.ceil(np.log2(np.clip(wanted, 1, finest))).astype(np.int64)


def _steps(corners: np.ndarray, is_quad: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return how corner values grow along a face's first and second edge, and along both together."""
    one, two, three, four = np.moveaxis(corners, 1, 0)
    quad = is_quad[:, None]
    return two - one, np.where(quad, four, three) - one, np.where(quad, one - two + three - four, 0)


def _over_cells(means: ImageMeans, uv: np.ndarray, grid: Grid) -> np.ndarray:
    """Return means of an image over cells, whose edges in texture coordinates are those at their centroids."""
    corners = uv[grid.owner].astype(np.float64)
    u, v = grid.middle
    middle = between(corners, grid.is_quad, u, v)
    first, second, both = _steps(corners, grid.is_quad)
    sign = np.where(grid.inverted, -1, 1)
    first = (first + both * v[:, None]) * (sign / grid.columns)[:, None]
    second = (second + both * u[:, None]) * (sign / grid.rows)[:, None]
    result = np.empty((len(u), means.n_bands))
    for triangles, centre in ((False, 1 / 2), (True, 1 / 3)):
        at = np.flatnonzero(grid.is_quad != triangles)
        if len(at):
            origin = middle[at] - centre * (first[at] + second[at])
            result[at] = means.over(origin, first[at], second[at], triangles=triangles)
    return result
