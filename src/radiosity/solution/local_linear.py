"""Local linear density estimation: irradiance at points from the power that hits cells (B. Walter, P. M. Hubbard, P. Shirley and
D. P. Greenberg, "Global illumination using local linear density estimation", ACM Transactions on Graphics 16(3), 1997).

About each point x of a flat region a plane is fitted to power over area, weighted by a kernel K: with t = x_q - x the place of
hit q of power phi_q, E(x) = sum_q phi_q K(t) [1 0 0] M^-1 [1 t], M = integral of K(t) [1 t]^T [1 t] over the region. M is
integrated over the region up to its rim: this removes the bias at boundaries, which a kernel alone has. Hits are first binned to
the region's cells, which are smaller than the kernel, and each integral becomes a sum over cells.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..patches.model import Patches

WIDTH = 0.5  # bandwidth over the root of a region's area, times hits^(1/6)
FLAT = 1e-4  # normals and offsets that agree to this, relative to the scene, are one plane
CORNER = 4  # cells about a vertex
BEYOND = 1.1  # reach of a kernel over the distance of the last of these cells
SINGULAR = 1e-9  # limit of M's determinant, in units of the kernel's width, below which cells about the point lie on one line


@dataclass(frozen=True, eq=False)
class Regions:
    """Flat regions: patches of one surface and one plane, facing one way.

    Attributes:
        patches: all patches.
        of: (n_patches,) int64, the region of each patch.
    """

    patches: Patches
    of: np.ndarray

    @staticmethod
    def find(patches: Patches) -> "Regions":
        """Return the regions of patches, by their surfaces, normals and distances to the origin."""
        low, high = patches.scene.bounds
        size = float((high - low).max()) or 1.0
        offset = np.einsum("ij,ij->i", patches.normal, patches.centroid - (low + high) / 2) / size
        keys = np.column_stack([patches.surface, np.rint(np.column_stack([patches.normal, offset]) / FLAT)])
        return Regions(patches, np.unique(keys, axis=0, return_inverse=True)[1].ravel())

    @property
    def count(self) -> int:
        """Number of regions."""
        return int(self.of.max()) + 1

    @cached_property
    def area(self) -> np.ndarray:
        """The area of each region, (count,) m²."""
        return np.bincount(self.of, self.patches.area, self.count)

    @cached_property
    def members(self) -> list[np.ndarray]:
        """The patches of each region."""
        order = np.argsort(self.of, kind="stable")
        return np.split(order, np.cumsum(np.bincount(self.of, minlength=self.count))[:-1])

    def bandwidth(self, arrivals: np.ndarray) -> np.ndarray:
        """The bandwidth of each region, (count,) metres.

        It falls as hits^(-1/6): bias squared and variance fall alike.
        """
        landed = np.maximum(np.bincount(self.of, arrivals, self.count), 1)
        return WIDTH * np.sqrt(self.area) * landed ** (-1 / 6)

    def plane(self, region: int, points: np.ndarray) -> np.ndarray:
        """The coordinates of points in a region's plane, (m, 2) metres."""
        normal = self.patches.normal[self.members[region][0]]
        first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
        first /= np.linalg.norm(first)
        return points @ np.column_stack([first, np.cross(normal, first)])


def weights(regions: Regions, arrivals: np.ndarray, points: np.ndarray, of: np.ndarray, *, least: int = 1, planes: bool = True):
    """The sparse matrix W, (m, n_patches): W times power over area of the patches is the estimate at m points.

    Each point lies in the plane of its region. Rows sum to one.

    Args:
        arrivals: (n_patches,) hits of the run, which set the bandwidth.
        points: (m, 3) metres.
        of: (m,) the number of each point's region.
        least: the least number of cells that a kernel reaches: 1 about their centres, where a cell larger than the kernel stands
            alone; at vertices `CORNER`, since a plane needs three.
        planes: fit planes; else take the kernel's means, whose weights are not negative.
    """
    from scipy.sparse import csr_matrix
    from scipy.spatial import KDTree

    rows, columns, values = [], [], []
    width = regions.bandwidth(arrivals)
    order = np.argsort(of, kind="stable")
    for region, at in enumerate(np.split(order, np.cumsum(np.bincount(of, minlength=regions.count))[:-1])):
        members = regions.members[region]
        if not len(at):
            continue
        cells = regions.plane(region, regions.patches.centroid[members])
        here = regions.plane(region, points[at])
        tree = KDTree(cells)
        nearest = tree.query(here, min(least, len(members)))[0].reshape(len(at), -1)[:, -1]
        reach = np.maximum(width[region], nearest * BEYOND + 1e-300)
        lists = tree.query_ball_point(here, reach)
        row = np.repeat(np.arange(len(at)), [len(found) for found in lists])
        column = np.concatenate([np.asarray(found, np.int64) for found in lists])
        of_kernel = _fit if planes else _mean
        value = of_kernel((cells[column] - here[row]) / reach[row, None], regions.patches.area[members[column]], row, len(at))
        rows.append(at[row])
        columns.append(members[column])
        values.append(value)
    shape = (len(points), len(regions.patches))
    return csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)


def _kernel(t: np.ndarray, area: np.ndarray) -> np.ndarray:
    return area * np.maximum(1 - (t * t).sum(axis=1), 1e-6)


def _mean(t: np.ndarray, area: np.ndarray, row: np.ndarray, m: int) -> np.ndarray:
    """The weight of each cell of each row in the kernel's mean."""
    kernel = _kernel(t, area)
    return kernel / np.bincount(row, kernel, m)[row]


def _fit(t: np.ndarray, area: np.ndarray, row: np.ndarray, m: int) -> np.ndarray:
    """The weight of each cell of each row in the plane fitted at t = 0; the kernel's mean where cells lie on a line."""
    kernel = _kernel(t, area)

    def total(values):
        return np.bincount(row, values, m)

    s, u, v = total(kernel), total(kernel * t[:, 0]), total(kernel * t[:, 1])
    uu, uv, vv = total(kernel * t[:, 0] ** 2), total(kernel * t[:, 0] * t[:, 1]), total(kernel * t[:, 1] ** 2)
    minors = uu * vv - uv * uv, uv * v - u * vv, u * uv - uu * v  # minors of M's first row
    determinant = s * minors[0] + u * minors[1] + v * minors[2]
    planar = determinant > SINGULAR * s**3
    scale = np.where(planar, 1 / np.where(planar, determinant, 1), 0)
    a, b, c = (np.where(planar, minor * scale, default) for minor, default in zip(minors, (1 / s, 0, 0), strict=True))
    return kernel * (a[row] + b[row] * t[:, 0] + c[row] * t[:, 1])
