"""Ends of links, elements or clusters, as volumes: spheres that hold them, and the areas that they show."""

from dataclasses import dataclass

import numpy as np

from ...patches import elements
from ...patches.clusters import Clusters


@dataclass(frozen=True, eq=False)
class Ends:
    """Ends of links, elements or clusters.

    Attributes:
        number: (m,) int64.
        cluster: (m,) int64, the number among clusters, -1 for elements.
        centre, radius: of a sphere that holds each end, (m, 3) and (m,) float64, metres.
        normal: (m, 3) float64, 0 for clusters.
        area: (m,) float64, m².
    """

    number: np.ndarray
    cluster: np.ndarray
    centre: np.ndarray
    radius: np.ndarray
    normal: np.ndarray
    area: np.ndarray

    @staticmethod
    def of(clusters: Clusters, number: np.ndarray) -> "Ends":
        tree, count = clusters.hierarchy, len(clusters.hierarchy)
        cluster = np.where(number >= count, number - count, -1)
        whole = cluster >= 0
        centre, radius, normal, area = np.zeros((len(number), 3)), np.zeros(len(number)), np.zeros((len(number), 3)), 0.0 * number
        centres, radii = clusters.spheres
        centre[whole], radius[whole], area[whole] = (x[cluster[whole]] for x in (centres, radii, clusters.area))
        corners = elements.corners(tree, number[~whole])
        centre[~whole] = corners.mean(axis=1)
        radius[~whole] = np.linalg.norm(corners - centre[~whole][:, None], axis=2).max(axis=1)
        normal[~whole], area[~whole] = elements.normal(tree, number[~whole]), elements.area(tree, number[~whole])
        return Ends(number, cluster, centre, radius, normal, area)

    def take(self, rows: np.ndarray) -> "Ends":
        """Return some of the ends (indices or mask)."""
        return Ends(*(value[rows] for value in vars(self).values()))

    def shown(self, clusters: Clusters, way: np.ndarray) -> np.ndarray:
        """Return the area that each end shows to a direction, (m,) m². Of clusters it is that of the clamped cosine's first three
        terms in Legendre polynomials, 1/4 + x/2 + 5/32 (3x² - 1): the largest error is 0.1 of the sides' area."""
        first, second = clusters.moments
        one, two = first[self.cluster], second[self.cluster]
        quadratic = np.einsum("mi,mij,mj->m", way, two, way)
        volume = self.area / 4 + np.einsum("mi,mi->m", one, way) / 2 + 5 / 32 * (3 * quadratic - self.area)
        flat = self.area * np.einsum("mi,mi->m", self.normal, way)
        return np.maximum(np.where(self.cluster >= 0, volume, flat), 0)

    def most_shown(self, clusters: Clusters) -> np.ndarray:
        """Return a bound of the area that each end shows to any direction, (m,) m²."""
        turned = np.linalg.norm(clusters.moments[0][self.cluster], axis=1)
        volume = np.minimum((self.area + turned) / 2, np.pi * self.radius**2)
        return np.where(self.cluster >= 0, volume, self.area)
