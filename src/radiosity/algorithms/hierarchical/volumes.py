"""Links of which an end is a cluster: volumetric exchange, after F. Sillion, "A unified hierarchical algorithm for global
illumination with scattering volumes and object clusters", IEEE Transactions on Visualization and Computer Graphics 1(3), 1995.

Seen from direction w, a cluster shows the area a(w) = sum A_i max(n_i w, 0) of its sides. Ends apart by d exchange
A_r F_rs = a_r(w) a_s(-w) / (pi d²), times the share of lines between their sides that meet nothing on their way, which is how
their sides hide each other, too. Ends that are not apart exchange what lines between their sides find. All sides of a receiver
get the same irradiance, whatever way they face: the largest difference that this can make is the link's spread.
"""

import numpy as np

from ...patches.clusters import Clusters
from ...tracing.geometry import Geometry
from .ends import Ends
from .links import Links
from .parameters import Hierarchical
from .sampled import drawn


def volumetric(
    clusters: Clusters,
    geometry: Geometry | None,
    parameters: Hierarchical,
    receiver: np.ndarray,
    source: np.ndarray,
    reach: np.ndarray | None = None,
) -> tuple[Links, int]:
    """Return links for pairs of which an end is a cluster, and the number of rays. Pairs that cannot see each other have none.

    Args:
        reach: what sides of sources are drawn in proportion to, as in `Clusters.drawn`.
    """
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
        whole, seen, closer = _sampled(clusters, geometry, parameters, one, other, reach)
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
    clusters: Clusters, geometry: Geometry, parameters: Hierarchical, one: Ends, other: Ends, reach: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return means of cos cos' / r² over points of ends, of all points and of those that see each other, (m,) 1/m² each.

    The third is the mean of 1 / r² over middles of what was drawn: nearby pairs count for more than the middles of both ends.
    """
    lines = drawn(clusters, geometry, (parameters.rays, parameters.seed), one, other, reach=reach)
    middles = lines.middles(clusters, one, other)
    square = ((middles[0] - middles[1]) ** 2).sum(axis=2)
    least = (0.25 * (one.radius + other.radius)) ** 2
    return lines.whole.mean(axis=1), lines.seen.mean(axis=1), (1 / np.maximum(square, least[:, None])).mean(axis=1)
