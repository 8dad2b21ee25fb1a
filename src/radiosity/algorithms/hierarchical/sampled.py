"""Lines between ends of links: sides are drawn from clusters, elements are themselves."""

from dataclasses import dataclass

import numpy as np

from ...patches import elements
from ...patches.clusters import Clusters
from ...tracing.drawn_lines import Table, kernels
from ...tracing.geometry import Geometry
from ...tracing.visibility import Polygons, mixed
from .ends import Ends

GOLDEN = (5**0.5 - 1) / 2
BY_POWER = 0.75  # of lines; where light is now, most light will be, but not all


@dataclass(frozen=True, eq=False)
class Lines:
    """Lines between m pairs of ends.

    Attributes:
        whole, seen: (m, rays) float64, 1/m²: cos cos' / r² of the ends of lines, and the same where they see each other, else 0.
        receiver, source: (m, rays) int64, the sides that lines were drawn between; -1 where an end is an element.
        table: the polygons on the device.
        receivers: (m, rays) int64, the polygons of the receivers in the table.
        keys: (m,) uint64, the numbers of the pairs.
    """

    whole: np.ndarray
    seen: np.ndarray
    receiver: np.ndarray
    source: np.ndarray
    table: Table
    receivers: np.ndarray
    keys: np.ndarray

    def middles(self, clusters: Clusters, one: Ends, other: Ends) -> tuple[np.ndarray, np.ndarray]:
        """Return the middles of the polygons that were drawn, (m, rays, 3) of each end."""
        pairs = (self.receiver, one), (self.source, other)
        first, second = (np.where((side >= 0)[:, :, None], clusters.middle[side], end.centre[:, None]) for side, end in pairs)
        return first, second


def drawn(
    clusters: Clusters,
    geometry: Geometry,
    lines: tuple[int, int],
    one: Ends,
    other: Ends,
    stream: int = 0,
    reach: np.ndarray | None = None,
) -> Lines:
    """Return lines between pairs of ends.

    Args:
        lines: rays of a pair, and the seed.
        stream: other lines of the same pairs.
        reach: what sides of ``other`` are drawn in proportion to, as in `Clusters.drawn`, but for a share of 1 - `BY_POWER`.
    """
    rays, seed = lines
    key = mixed(one.number.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15) + other.number.astype(np.uint64))
    if stream:
        key = mixed(key + np.uint64(stream))
    lane = np.arange(rays)
    starts = [(mixed(key + np.uint64(i)) >> np.uint64(11)).astype(float) / 2**53 for i in (1, 2)]
    numbers = (lane + starts[0][:, None]) / rays, (lane * GOLDEN + starts[1][:, None]) % 1
    receiver, source = _drawn(clusters, one, numbers[0], None), _drawn(clusters, other, numbers[1], reach)
    table, flat = _sides(clusters, geometry), [_flat(clusters, end) for end in (one, other)]
    rows = []
    for side, polygons in zip((receiver, source), flat, strict=True):
        rows.append(np.where(side >= 0, side, table.count + np.cumsum(side[:, 0] < 0)[:, None] - 1))
        table = table.joined(Table.of(geometry, polygons)) if len(polygons) else table
    whole, seen = kernels(geometry, table, rows[1], rows[0], mixed(key), seed)
    transmittance = geometry.scene.transmittance
    if transmittance is not None:  # receivers are solid parts alone, and sides of clusters are drawn by them already
        faces = [_faces(clusters, side, polygons) for side, polygons in zip((receiver, source), flat, strict=True)]
        seen = seen * np.where(source >= 0, 1, 1 - transmittance[faces[1]]) / (1 - transmittance[faces[0]])
    return Lines(whole, seen, receiver, source, table, rows[0], mixed(key))


def _drawn(clusters: Clusters, end: Ends, number: np.ndarray, reach: np.ndarray | None) -> np.ndarray:
    """Return the sides that are drawn from clusters, and -1 for elements, (m, rays) int64."""
    side, whole = np.full(number.shape, -1), end.cluster >= 0
    number, cluster = number[whole], np.broadcast_to(end.cluster[whole, None], number[whole].shape)
    if reach is None:
        side[whole] = clusters.drawn(cluster, number)
        return side
    share = by_power(clusters, end.cluster[whole], reach)[:, None]
    within = number < share
    of_power = clusters.drawn(cluster, np.where(within, number / np.maximum(share, 1e-300), 0), reach)
    of_area = clusters.drawn(cluster, np.where(within, 0, (number - share) / (1 - share)))
    side[whole] = np.where(within, of_power, of_area)
    return side


def by_power(clusters: Clusters, cluster: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Return the share of lines whose sides are drawn by ``reach``, (m,): the others are drawn by area."""
    return np.where(reach[clusters.end[cluster]] > reach[clusters.begin[cluster]], BY_POWER, 0.0)


def _flat(clusters: Clusters, end: Ends) -> Polygons:
    """Return the polygons of the ends that are elements, one after the other."""
    flat, tree = end.number[end.cluster < 0], clusters.hierarchy
    return Polygons(elements.corners(tree, flat), tree.face(flat))


def _faces(clusters: Clusters, drawn: np.ndarray, flat: Polygons) -> np.ndarray:
    """Return the faces of what was drawn, (m, rays)."""
    face = clusters.hierarchy.side_face[drawn]
    face[drawn[:, 0] < 0] = flat.face[:, None]
    return face


def _sides(clusters: Clusters, geometry: Geometry) -> Table:
    """Return the table of all sides, which is made once."""
    if "sides" not in geometry.made:
        geometry.made["sides"] = Table.of(geometry, Polygons(clusters.corners, clusters.hierarchy.side_face))
    return geometry.made["sides"]
