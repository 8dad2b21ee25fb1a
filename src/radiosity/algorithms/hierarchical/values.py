"""Values of links with clusters from lines of their own, once no link is divided any more.

A link that looks dark by chance is kept, and one that looks bright by chance is divided, so the lines that judge a link say too
little of those that are kept. Lines that had no say in that are right in the mean. Each line that comes through becomes a link
from the side that it found, since sides of a cluster shine unlike each other; F of a link is the sum over lines of

    1 / n  G / pi / (p + G / pi),      G = cos cos' / r².

Half of the lines lead to points of the source. Three quarters of those are drawn by the power that leaves sides j, the others
by area: p = 3/4 B_j / sum of B A + 1/4 / A_s. The other half leave the receiver by the cosine law, whose density is G / pi, and
count where they hit the source (E. Veach, L. Guibas, "Optimally combining sampling techniques for Monte Carlo rendering",
SIGGRAPH 1995: the balance heuristic).
So no line counts for more than 1 / n, however near the two are. Ends far from each other have lines of the first kind alone.
"""

from dataclasses import dataclass

import numpy as np

from ...patches.clusters import Clusters
from ...tracing.drawn_lines import cosine_lines
from ...tracing.geometry import Geometry
from ...tracing.visibility import mixed
from .ends import Ends
from .links import Links
from .sampled import by_power, drawn

STREAM = 1  # lines of these numbers judge no link
FAR = 2.5  # radii of both ends: those farther apart have no lines by the cosine law


@dataclass(frozen=True, eq=False)
class Values:
    """Links that lines found.

    Attributes:
        links: from the sides or elements that lines found; their spread is their factor.
        row: (m,) int64, the link that each of them is a part of.
        rays: the number of rays.
    """

    links: Links
    row: np.ndarray
    rays: int

    @staticmethod
    def joined(parts: list["Values"]) -> "Values":
        """Return those of all parts, one after the other."""
        row = np.concatenate([np.zeros(0, np.int64), *(part.row for part in parts)])
        links = Links.appended([Links.none(), *(part.links for part in parts)])
        return Values(links, row, sum(part.rays for part in parts))


def valued(clusters: Clusters, geometry: Geometry, lines: tuple[int, int], links: Links, shine: np.ndarray) -> Values:
    """Return what lines find of links of which an end is a cluster.

    Args:
        lines: rays of a link, of each kind, and the seed.
        shine: (n_sides,) float64, the radiosity of sides, W/m² or lm/m², summed over bands.
    """
    one, other = Ends.of(clusters, links.receiver), Ends.of(clusters, links.source)
    reach = clusters.summed(shine * clusters.side_area)
    found = drawn(clusters, geometry, lines, one, other, STREAM, reach)
    density = _density(clusters, geometry, other, shine, reach)
    distance = np.linalg.norm(other.centre - one.centre, axis=1)
    near = (distance < FAR * (one.radius + other.radius)) & (not geometry.some_backs_pass)
    row, lane = np.nonzero(found.seen > 0)
    side = found.source[row, lane]
    kernel = found.whole[row, lane] / np.pi
    share = found.seen[row, lane] / found.whole[row, lane] / _solid(clusters, geometry, other)[row]
    parts = [(row, side, share * kernel / (density(row, side) + np.where(near[row], kernel, 0)))]
    rays = found.seen.size
    if near.any():
        rows = np.flatnonzero(near)
        patch, back = cosine_lines(geometry, found.table, found.receivers[rows], mixed(found.keys[rows] + np.uint64(1)), lines[1])
        row, lane, side = _within(clusters, other.take(rows), patch)
        kernel = back[row, lane] / np.pi
        parts.append((rows[row], side, kernel / (density(rows[row], side) + kernel)))
        rays += patch.size
    row, side, factor = (np.concatenate(column) for column in zip(*parts, strict=True))
    source = np.where(side >= 0, clusters.hierarchy.first[side], links.source[row])
    return _summed(links.receiver, row, source, factor / lines[0], rays)


def _density(clusters: Clusters, geometry: Geometry, other: Ends, shine: np.ndarray, reach: np.ndarray):
    """Return a function of links and sides (-1: the source is an element): the density of points, 1/m²."""
    total = np.maximum(reach[clusters.end[other.cluster]] - reach[clusters.begin[other.cluster]], 1e-300)
    share = np.where(other.cluster >= 0, by_power(clusters, other.cluster, reach), 0)
    even = (1 - share) / (other.area * _solid(clusters, geometry, other))

    def density(row: np.ndarray, side: np.ndarray) -> np.ndarray:
        return share[row] * shine[side] / total[row] + even[row]

    return density


def _solid(clusters: Clusters, geometry: Geometry, end: Ends) -> np.ndarray:
    """Return the share of elements that stops lines; 1 for clusters, (m,)."""
    through = geometry.scene.transmittance
    if through is None:
        return np.ones(len(end.number))
    whole = end.cluster >= 0
    return np.where(whole, 1, 1 - through[clusters.hierarchy.face(np.where(whole, 0, end.number))])


def _within(clusters: Clusters, other: Ends, patch: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return rows and columns of the lines that hit their source, and the sides that they hit (-1: the source is an element)."""
    tree = clusters.hierarchy
    row, lane = np.nonzero(patch < len(tree.patches))
    hit = patch[row, lane]
    side = np.searchsorted(tree.side_patch, hit, side="right") - 1
    cluster, place = other.cluster[row], clusters.place[side]
    inside = (cluster >= 0) & (place >= clusters.begin[cluster]) & (place < clusters.end[cluster])
    flat = np.flatnonzero(cluster < 0)
    flat = flat[tree.side(other.number[row[flat]]) == side[flat]]
    element, wanted = tree.leaf(hit[flat]), other.number[row[flat]]
    while (above := element > wanted).any():  # parents come before their children
        element[above] = tree.parent(element[above])
    inside[flat] = element == wanted
    side = np.where(cluster >= 0, side, -1)
    return row[inside], lane[inside], side[inside]


def _summed(receivers: np.ndarray, row: np.ndarray, source: np.ndarray, factor: np.ndarray, rays: int) -> Values:
    """Return one link for all lines of a row that found one source."""
    order = np.lexsort((source, row))
    row, source, factor = row[order], source[order], factor[order]
    new = np.flatnonzero((np.diff(row, prepend=-1) != 0) | (np.diff(source, prepend=-1) != 0))
    total = np.add.reduceat(factor, new) if len(new) else factor[:0]
    return Values(Links(receivers[row[new]], source[new], total, total), row[new], rays)
