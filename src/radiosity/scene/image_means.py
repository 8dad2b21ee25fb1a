"""Means of an image over footprints: parallelograms and triangles in texture coordinates."""

import numpy as np

from .edge_integrals import along_edges, crossings
from .image_tables import Tables, coarser
from .repeats import folded
from .sampler import Sampler

THIN = 1e-4  # texels: what is narrower is taken to be so wide
AT_ONCE = 1 << 24  # texels times bands of an image of which tables are made at a time
CROSSINGS = (1 << 10, 1 << 14)  # lines between cells that an edge may cross, least and most; longer edges take larger texels
ALL_CROSSINGS = 1 << 24  # what the edges of one call share
NARROW = 8  # footprints are at least so many of those larger texels wide


class ImageMeans:
    """The means of one image, (height, width, n_bands), with its sampler.

    Means are exact, but for footprints over thousands of texels whose edges do not lie along the axes: texels at their rim
    count by the means of larger ones, which errs by less than 0.1 %.
    """

    def __init__(self, image: np.ndarray, sampler: Sampler):
        self.n_bands = image.shape[2]
        self.image = image[:, :, :1] if _is_grey(image) else image
        self.sampler = sampler
        self._known: dict[int, Tables] = {}

    def over(self, origin: np.ndarray, first: np.ndarray, second: np.ndarray, *, triangles: bool) -> np.ndarray:
        """Return means over footprints, (m, n_bands) float64.

        Args:
            origin, first, second: (m, 2) a corner and the two edges from it, in texture coordinates.
            triangles: True where footprints are halves of parallelograms.
        """
        height, width = self.image.shape[:2]
        origin = np.column_stack([origin[:, 0] * width, (1 - origin[:, 1]) * height])
        first, second = (edge * (width, -height) for edge in (first, second))
        origin, first, second, area = _widened(origin, first, second, 1 / 3 if triangles else 0.5)
        if triangles:
            starts, edges = [origin, origin + first, origin + second], [first, second - first, -second]
        else:
            starts = [origin, origin + first, origin + first + second, origin + second]
            edges = [first, second, -first, -second]
        total = np.zeros((len(origin), self.image.shape[2]))
        start, edge, owner = np.concatenate(starts), np.concatenate(edges), np.tile(np.arange(len(origin)), len(starts))
        across = np.abs(area)[owner] / np.maximum(np.linalg.norm(edge, axis=1), 1e-300)
        start, edge, weight, which, level = self._followed(start, edge, across)
        owner = owner[which]
        for scale in np.unique(level):
            at = np.flatnonzero(level == scale)
            for band, found in enumerate(along_edges(self._tables(int(scale)), start[at], edge[at])):
                total[:, band] += np.bincount(owner[at], found * weight[at], len(origin))
        total = self._tables(0).mean + total / (area * (0.5 if triangles else 1.0))[:, None]
        return np.broadcast_to(np.clip(total, 0, None), (len(total), self.n_bands))

    def _followed(self, start: np.ndarray, edge: np.ndarray, across: np.ndarray):
        """Edges as `folded` gives them, but for its last, and the logarithm of the factor by which texels are larger for each.

        The factor is 1 where an edge crosses few texels. What edges that come back to a place leave out there is left out each
        time, so they keep more.

        Args:
            start, edge: (m, 2) texel coordinates.
            across: (m,) texels, the footprints' widths.
        """
        tables = self._tables(0)
        most = np.clip(ALL_CROSSINGS // len(start), *CROSSINGS)
        wanted = np.ceil(np.log2(np.maximum(crossings(tables, start, edge) / most, 1)))
        weight, which, run = np.ones(len(start)), np.arange(len(start)), np.full(len(start), np.inf)
        if tables.x.period and tables.y.period:
            start, edge, weight, which, run = folded(start, edge, (tables.x.period, tables.y.period), across)
        largest = np.floor(np.log2(np.maximum(np.minimum(across / NARROW, np.sqrt(run)), 1)))
        needed = np.ceil(np.log2(np.maximum(crossings(tables, start, edge) / CROSSINGS[1], 1)))
        return start, edge, weight, which, np.maximum(np.minimum(wanted, largest)[which], needed).astype(np.int64)

    def _tables(self, level: int) -> Tables:
        level = min(level, max(self.image.shape[:2]).bit_length())
        if level not in self._known:
            if level == 0:
                self._known[0] = Tables(self.image, self.sampler)
            else:
                image, scale = coarser(self.image, self.sampler, 2**level)
                self._known[level] = Tables(image, Sampler(self.sampler.wrap, "nearest"), scale)
        return self._known[level]


def bands_at_once(image: np.ndarray) -> list[slice]:
    """The bands of an image in groups whose tables fit into memory together."""
    if _is_grey(image):
        return [slice(None)]  # one band may stand for all that a scene has
    n, together = image.shape[2], max(1, AT_ONCE // (image.shape[0] * image.shape[1]))
    return [slice(i, min(i + together, n)) for i in range(0, n, together)]


def _is_grey(image: np.ndarray) -> bool:
    return bool((image == image[:, :, :1]).all())


def _widened(origin, first, second, centre: float):
    """Footprints with an area: edges that are (nearly) parallel, or without a length, as if their smaller singular value were
    `THIN`. The centre of a footprint stays where it is. Also twice a triangle's signed area, or a parallelogram's."""
    area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    longest = np.maximum(np.linalg.norm(first, axis=1), np.linalg.norm(second, axis=1))
    thin = np.flatnonzero(np.abs(area) < 2 * THIN * np.maximum(longest, THIN))
    if len(thin):
        u, size, v = np.linalg.svd(np.stack([first[thin], second[thin]], axis=1))
        edges = (u * np.maximum(size, THIN)[:, None, :]) @ v
        origin, first, second = origin.copy(), first.copy(), second.copy()
        origin[thin] += centre * (first[thin] + second[thin] - edges[:, 0] - edges[:, 1])
        first[thin], second[thin] = edges[:, 0], edges[:, 1]
        area[thin] = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
    return origin, first, second, area
