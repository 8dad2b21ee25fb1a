"""Lines between ends of links: sides are drawn from clusters, elements are themselves."""

import numpy as np

from ...patches import elements
from ...patches.clusters import Clusters
from ...tracing.drawn_lines import Table, kernels
from ...tracing.geometry import Geometry
from ...tracing.visibility import Polygons, mixed
from .ends import Ends

GOLDEN = (5**0.5 - 1) / 2


def sampled(
    clusters: Clusters,
    geometry: Geometry,
    lines: tuple[int, int],
    one: Ends,
    other: Ends,
    stream: int = 0,
    reach: np.ndarray | None = None,
) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Return means of cos cos' / r² over points of m pairs of ends, (2, m) 1/m²: of all points and of those that see each other.

    With them come the middles of the polygons that were drawn, (m, rays, 3) of each end.

    Args:
        lines: rays of a pair, and the seed.
        stream: other lines of the same pairs.
        reach: what sides of ``other`` are drawn in proportion to, as in `Clusters.drawn`.
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
    for drawn, polygons in zip((receiver, source), flat, strict=True):
        rows.append(np.where(drawn >= 0, drawn, table.count + np.cumsum(drawn[:, 0] < 0)[:, None] - 1))
        table = table.joined(Table.of(geometry, polygons)) if len(polygons) else table
    whole, seen = kernels(geometry, table, rows[1], rows[0], mixed(key), seed)
    transmittance = geometry.scene.transmittance
    if transmittance is not None:  # receivers are solid parts alone, and sides of clusters are drawn by them already
        faces = [_faces(clusters, drawn, polygons) for drawn, polygons in zip((receiver, source), flat, strict=True)]
        seen = seen * np.where(source >= 0, 1, 1 - transmittance[faces[1]]) / (1 - transmittance[faces[0]])
    middles = tuple(
        np.where((drawn >= 0)[:, :, None], clusters.middle[drawn], end.centre[:, None])
        for drawn, end in ((receiver, one), (source, other))
    )
    return np.stack([whole.mean(axis=1), seen.mean(axis=1)]), middles


def _drawn(clusters: Clusters, end: Ends, number: np.ndarray, reach: np.ndarray | None) -> np.ndarray:
    """Return the sides that are drawn from clusters, and -1 for elements, (m, rays) int64."""
    side, whole = np.full(number.shape, -1), end.cluster >= 0
    side[whole] = clusters.drawn(np.broadcast_to(end.cluster[whole, None], number[whole].shape), number[whole], reach)
    return side


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
