"""Light of clusters by direction: what links take from clusters, and how the sides of clusters share what links bring.

A side with normal n shows the share max(n w, 0) of its area to direction w. In place of that stand three terms in Legendre
polynomials, with an error of at most 0.1:

    c(x) = 3/32 + x/2 + 15/32 x²,  x = n w.

So the light that a cluster sends in any direction follows from ten sums over its sides, of power times 1, n and n nᵀ. The other
way round, ten sums over links, of what they bring times 1, w and w wᵀ, say what each side gets. A side that faces a source gets
more than one that faces away, and a lamp lights what is in front of it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .levels import Levels
from .links import Links
from .volumes import Ends

CONSTANT, LINEAR, SQUARE = 3 / 32, 1 / 2, 15 / 32
TERMS = 10
LEAST = 1e-3  # share of its area: a cluster that shows less answers as if it showed as much


@dataclass(frozen=True, eq=False)
class Directed:
    """The links of which an end is a cluster, and whose ends are apart.

    Attributes:
        levels: the values of all elements.
        sending, answering: (k,) and (l,) int64, numbers of links whose source is a cluster, and whose receiver is one.
        cluster, terms: (k,) int64 and (k, 10) float64: of sources, their numbers among clusters, and the terms of c for the
            direction from the source to the receiver, over the area that the source shows.
        answers, into: the same of receivers, times their areas, for the direction from the receiver to the source, (l,), (l, 10).
    """

    levels: Levels
    sending: np.ndarray
    cluster: np.ndarray
    terms: np.ndarray
    answering: np.ndarray
    answers: np.ndarray
    into: np.ndarray

    @staticmethod
    def of(levels: Levels, links: Links) -> "Directed | None":
        """Return them; None where there are no clusters."""
        clusters, count = levels.clusters, len(levels.hierarchy)
        if clusters is None:
            return None
        rows = np.flatnonzero(np.maximum(links.receiver, links.source) >= count)
        one, other = Ends.of(clusters, links.receiver[rows]), Ends.of(clusters, links.source[rows])
        way = other.centre - one.centre
        distance = np.linalg.norm(way, axis=1)
        way /= np.maximum(distance, 1e-300)[:, None]
        found = []
        for end, towards in ((other, -way), (one, way)):
            some = np.flatnonzero((end.cluster >= 0) & (distance > one.radius + other.radius))
            at, direction = end.take(some), towards[some]
            shown = np.maximum(at.shown(clusters, direction), LEAST * at.area)
            found += [rows[some], at.cluster, terms(direction) / shown[:, None]]
        found[5] *= clusters.area[found[4]][:, None]
        return Directed(levels, *found)

    @cached_property
    def _sides(self) -> np.ndarray:
        """The products of normals that go with the terms, of each side, (n_sides, 10)."""
        assert self.levels.clusters is not None
        return products(self.levels.clusters.normal)

    def sent(self, links: Links, mean: np.ndarray) -> np.ndarray:
        """Return the radiosity of the source of each link as its receiver sees it, (m, n_bands) W/m² or lm/m².

        Args:
            mean: (n_elements, n_bands) means over elements.
        """
        clusters, result = self.levels.clusters, mean[links.source]
        assert clusters is not None
        power = mean[self.levels.hierarchy.first[:-1]] * clusters.side_area[:, None]
        for band in range(mean.shape[1]):
            sums = clusters.sums(power[:, band, None] * self._sides)
            result[self.sending, band] = np.maximum(np.einsum("kt,kt->k", self.terms, sums[self.cluster]), 0)
        return result

    def answered(self, brought: np.ndarray) -> np.ndarray:
        """Return the irradiance of whole sides from links to clusters, (n_sides, n_bands).

        Args:
            brought: (m, n_bands) irradiance that each link brings.
        """
        clusters = self.levels.clusters
        assert clusters is not None
        result = np.empty((len(clusters.side_parent), brought.shape[1]))
        for band in range(brought.shape[1]):
            values = self.into * brought[self.answering, band, None]
            sums = np.stack([np.bincount(self.answers, weights=value, minlength=len(clusters)) for value in values.T], axis=1)
            for some in clusters.below:
                sums[some] += sums[clusters.parent[some]]
            result[:, band] = np.maximum((self._sides * sums[clusters.side_parent]).sum(axis=1), 0)
        return result


def terms(direction: np.ndarray) -> np.ndarray:
    """Return the terms of c for unit directions, (m, 10), that go with `products` of normals."""
    weights = np.array([CONSTANT, *[LINEAR] * 3, *[SQUARE] * 3, *[2 * SQUARE] * 3])
    return products(direction) * weights


def products(vector: np.ndarray) -> np.ndarray:
    """Return 1, x, y, z, x², y², z², xy, xz and yz of vectors, (m, 10)."""
    x, y, z = vector.T
    return np.stack([np.ones_like(x), x, y, z, x * x, y * y, z * z, x * y, x * z, y * z], axis=1)
