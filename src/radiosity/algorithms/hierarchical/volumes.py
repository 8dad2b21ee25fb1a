"""Links of which an end is a cluster: volumetric exchange, after F. Sillion, "A unified hierarchical algorithm for global
illumination with scattering volumes and object clusters", IEEE Transactions on Visualization and Computer Graphics 1(3), 1995.

Seen from direction w, a cluster shows the area a(w) = sum A_i max(n_i w, 0) of its sides. Ends apart by d exchange
A_r F_rs = a_r(w) a_s(-w) / (pi d²), times the share of lines between their sides that meet nothing on their way, which is how
their sides hide each other, too. Ends that are not apart exchange what lines between their sides find. All sides of a receiver
get the same irradiance, whatever way they face: the largest difference that this can make is the link's spread.
"""

from dataclasses import dataclass

import numpy as np

from ...patches import elements
from ...patches.clusters import Clusters
from ...tracing.geometry import Geometry
from ...tracing.visibility import Polygons, kernel_means, mixed
from .links import Links
from .parameters import Hierarchical

GOLDEN = (5**0.5 - 1) / 2


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


def volumetric(
    clusters: Clusters, geometry: Geometry | None, parameters: Hierarchical, receiver: np.ndarray, source: np.ndarray
) -> tuple[Links, int]:
    """Return links for pairs of which an end is a cluster, and the number of rays. Pairs that cannot see each other have none."""
    one, other = Ends.of(clusters, receiver), Ends.of(clusters, source)
    way = other.centre - one.centre
    ahead = (_height(way, one) > -other.radius) & (_height(-way, other) > -one.radius)
    one, other, way = one.take(ahead), other.take(ahead), way[ahead]
    distance = np.linalg.norm(way, axis=1)
    around = one.radius + other.radius
    apart = distance > around
    square = np.maximum(distance, around) ** 2
    way = way / np.maximum(distance, 1e-300)[:, None]
    shown = one.shown(clusters, way), other.shown(clusters, -way)
    factor = shown[0] * shown[1] / (np.pi * square * one.area)
    share, rays = np.ones(len(factor)), 0
    if geometry is not None and len(factor):
        rays = len(factor) * parameters.rays
        whole, seen, closer = _sampled(clusters, geometry, parameters, one, other)
        factor = factor * np.maximum(closer * square, 1)
        share = np.divide(seen, whole, out=np.zeros(len(whole)), where=whole > 0)
        near = ~apart & (share > 0)
        factor[near] = (seen * other.area / np.pi / np.maximum(share, 1e-300))[near]
    factor = np.minimum(factor, np.minimum(1, other.area / one.area))
    spread = _spread(clusters, one, other, shown, (distance, around), factor, share, parameters)
    return Links(one.number, other.number, factor * share, spread), rays


def _height(way: np.ndarray, end: Ends) -> np.ndarray:
    """Return how far in front of the plane of an end a point lies, (m,); infinite for clusters, which have no plane."""
    return np.where(end.cluster >= 0, np.inf, np.einsum("mi,mi->m", way, end.normal))


def _spread(clusters, one: Ends, other: Ends, shown, reach, factor, share, parameters: Hierarchical) -> np.ndarray:
    """Return a bound of the difference of a point's factor from the link's."""
    distance, around = reach
    turned = np.minimum(around / np.maximum(distance, 1e-300), 1)  # how far directions between points of the two may differ
    most = other.most_shown(clusters)
    facing = shown[1] + turned * np.maximum(most - shown[1], 0)
    cosine = np.where(one.cluster >= 0, 1, shown[0] / one.area)
    cosine = cosine + turned * (1 - cosine)
    nearest = np.maximum(distance - one.radius, 0)
    high = np.maximum(cosine * facing / (np.pi * nearest**2 + facing + 1e-300), factor)
    if parameters.refinement == "brightness-factor":
        clear = hidden = high
    else:
        low = np.where(one.cluster >= 0, 0, factor * (1 - turned) ** 2)
        clear = np.maximum(high - factor, factor - low)
        hidden = np.where(share > 0, np.maximum(high - factor * share, factor * share), high)
    value = np.where(share >= 1, clear, hidden)
    return np.where(share > 0, value, value / (parameters.rays + 2))


def _sampled(
    clusters: Clusters, geometry: Geometry, parameters: Hierarchical, one: Ends, other: Ends
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return means of cos cos' / r² over points of ends, of all points and of those that see each other, (m,) 1/m² each.

    The third is the mean of 1 / r² over middles of what was drawn: nearby pairs count for more than the middles of both ends.
    """
    (whole, seen), ends = sampled(clusters, geometry, (parameters.rays, parameters.seed), one, other)
    between = ends[0].corners.mean(axis=1) - ends[1].corners.mean(axis=1)
    least = (0.25 * (one.radius + other.radius)) ** 2
    closer = (1 / np.maximum((between**2).sum(axis=1).reshape(len(least), -1), least[:, None])).mean(axis=1)
    return whole, seen, closer


def sampled(
    clusters: Clusters,
    geometry: Geometry,
    lines: tuple[int, int],
    one: Ends,
    other: Ends,
    stream: int = 0,
    reach: np.ndarray | None = None,
) -> tuple[np.ndarray, list[Polygons]]:
    """Return means of cos cos' / r² over points of m pairs of ends, (2, m) 1/m²: of all points and of those that see each other.

    The polygons that were drawn come with them, (m * rays) of each end.

    Args:
        lines: rays of a pair, and the seed.
        stream: other lines of the same pairs.
        reach: what sides of ``other`` are drawn in proportion to, as in `Clusters.drawn`.
    """
    (rays, seed), m = lines, len(one.number)
    key = mixed(one.number.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15) + other.number.astype(np.uint64))
    if stream:
        key = mixed(key + np.uint64(stream))
    lane = np.arange(rays)
    starts = [(mixed(key + np.uint64(i)) >> np.uint64(11)).astype(float) / 2**53 for i in (1, 2)]
    numbers = (lane + starts[0][:, None]) / rays, (lane * GOLDEN + starts[1][:, None]) % 1
    ends = [_drawn(clusters, one, numbers[0], None), _drawn(clusters, other, numbers[1], reach)]
    salts = mixed(key)[:, None] + lane.astype(np.uint64)
    means = kernel_means(geometry, ends[1], ends[0], 1, (seed,), salts.ravel())[0]
    transmittance = geometry.scene.transmittance
    if transmittance is not None:  # receivers are solid parts alone, and sides of clusters are drawn by them already
        receiver, source = (1 - transmittance[end.face] for end in ends)
        means[1] /= receiver * np.where(np.repeat(other.cluster >= 0, rays), source, 1)
    return means.reshape(2, m, rays).mean(axis=2), ends


def _drawn(clusters: Clusters, end: Ends, number: np.ndarray, reach: np.ndarray | None) -> Polygons:
    """Return polygons of ends, (m * rays): sides drawn from clusters, and elements themselves."""
    tree, whole = clusters.hierarchy, end.cluster >= 0
    corners, face = np.empty((*number.shape, 4, 3)), np.empty(number.shape, np.int64)
    side = clusters.drawn(np.broadcast_to(end.cluster[whole, None], number[whole].shape), number[whole], reach)
    corners[whole], face[whole] = clusters.corners[side], tree.side_face[side]
    corners[~whole] = elements.corners(tree, end.number[~whole])[:, None]
    face[~whole] = tree.face(end.number[~whole])[:, None]
    return Polygons(corners.reshape(-1, 4, 3), face.ravel())
