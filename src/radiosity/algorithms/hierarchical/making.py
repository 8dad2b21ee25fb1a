"""Links made from pairs of elements: form factor, visible share, and by how much they may be wrong."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...patches import Hierarchy
from ...patches.clusters import Clusters
from ...pieces import pieces
from ...tracing.geometry import Geometry
from ...tracing.visibility import Polygons, visible_share
from .kernel import Shapes, facing, samples, unoccluded
from .links import Links
from .parameters import Hierarchical
from .values import Values, valued
from .volumes import volumetric

BATCH = 1 << 13  # pairs: their points fit into the processor's cache

Told = Callable[[int], None]


@dataclass(eq=False)
class Maker:
    """Makes links, and counts rays and pairs.

    Attributes:
        geometry: the scene on a device, or None where no rays are asked for.
        hierarchy: the elements.
        parameters: the parameters, such as the number of rays.
        told: called after each batch with the rays traced for it; it may raise.
        clusters: clusters above the elements, or None.
        rays: rays traced so far.
        pairs: pairs looked at so far.
    """

    geometry: Geometry | None
    hierarchy: Hierarchy
    parameters: Hierarchical
    told: Told
    clusters: Clusters | None = None
    rays: int = 0
    pairs: int = 0

    def make(self, receiver: np.ndarray, source: np.ndarray, radiosity: np.ndarray | None = None) -> Links:
        """Return links for the pairs that face each other, batch after batch.

        Args:
            radiosity: (n_elements, n_bands): lines that judge a link draw most sides of its source by their power; None: by area.
        """
        reach = None
        if self.clusters is not None and radiosity is not None:
            power = radiosity[self.hierarchy.first[:-1]].sum(axis=1) * self.clusters.side_area
            reach = self.clusters.summed(power)
        parts = [self._batch(receiver[rows], source[rows], reach) for rows in pieces(len(receiver), BATCH)] or [Links.none()]
        return Links.appended(parts)

    def valued(self, links: Links, rays: int, shine: np.ndarray) -> Values:
        """Return what lines find of links of which an end is a cluster; see `values.valued`."""
        assert self.clusters is not None
        assert self.geometry is not None
        parts = []
        for rows in pieces(len(links), max(16 * BATCH // rays, 1)):
            found = valued(self.clusters, self.geometry, (rays, self.parameters.seed), links.take(rows), shine)
            parts.append(Values(found.links, found.row + rows.start, found.rays))
            self._count(found.rays, rows.stop - rows.start)
        return Values.joined(parts)

    def plain(self, receiver: np.ndarray, source: np.ndarray, rays: int) -> Links:
        """Return links of elements that are not judged: their spread is their factor."""
        parts = [Links.none()]
        for rows in pieces(len(receiver), 4 * BATCH):
            one, other = Shapes.of(self.hierarchy, receiver[rows]), Shapes.of(self.hierarchy, source[rows])
            some, _ = facing(self.hierarchy, one, other)
            one, other = one.take(some), other.take(some)
            share, traced = self._visible(one, other, rays)
            factor = unoccluded(self.hierarchy, one, other) * share
            parts.append(Links(one.element, other.element, factor, factor))
            self._count(traced, rows.stop - rows.start)
        return Links.appended(parts)

    def _count(self, rays: int, pairs: int) -> None:
        self.rays += rays
        self.pairs += pairs
        self.told(rays)

    def _batch(self, receiver: np.ndarray, source: np.ndarray, reach: np.ndarray | None) -> Links:
        if self.clusters is None:
            return self._flat(receiver, source)
        flat = np.maximum(receiver, source) < len(self.hierarchy)
        links, rays = volumetric(self.clusters, self.geometry, self.parameters, receiver[~flat], source[~flat], reach)
        self._count(rays, int((~flat).sum()))
        return Links.appended([self._flat(receiver[flat], source[flat]), links])

    def _flat(self, receiver: np.ndarray, source: np.ndarray) -> Links:
        """Return links of elements."""
        one, other = Shapes.of(self.hierarchy, receiver), Shapes.of(self.hierarchy, source)
        some, whole = facing(self.hierarchy, one, other)
        one, other, whole = one.take(some), other.take(some), whole[some]
        factor = unoccluded(self.hierarchy, one, other)
        share, rays = self._visible(one, other, self.parameters.rays)
        if self.parameters.refinement == "brightness-factor":
            spread = _seen(np.where(whole, factor, np.maximum(factor, _disc(one, other))), share, self.parameters.rays)
        else:
            spread = self._spread(one, other, factor, share, whole)
        self._count(rays, len(receiver))
        return Links(one.element, other.element, factor * share, spread)

    def _visible(self, receiver: Shapes, source: Shapes, rays: int) -> tuple[np.ndarray, int]:
        """Return visible shares, with rays from the source as light goes, and the number of rays."""
        count = len(receiver.element)
        if self.geometry is None or count == 0:
            return np.ones(count), 0
        one, other = (Polygons(shape.corners, self.hierarchy.face(shape.element)) for shape in (source, receiver))
        share = visible_share(self.geometry, one, other, rays, self.parameters.seed)
        if (through := self.geometry.scene.transmittance) is not None:  # irradiance is that of the receiver's solid part
            share /= 1 - through[other.face]
        return share, count * rays

    def _spread(self, one: Shapes, other: Shapes, factor: np.ndarray, share: np.ndarray, whole: np.ndarray) -> np.ndarray:
        """Return the largest difference of a point's factor from the link's.

        Where obstacles hide a part, points may see all or nothing.
        """
        values = samples(self.hierarchy, one, other)
        high, low = values.max(axis=1), values.min(axis=1)
        high = np.where(whole, high, np.maximum(high, _disc(one, other)))
        clear = np.maximum(high - factor, factor - low)
        partly = np.maximum(high - factor * share, factor * share)
        return np.where(share >= 1, clear, _seen(np.where(share > 0, partly, high), share, self.parameters.rays))


def _seen(value: np.ndarray, share: np.ndarray, rays: int) -> np.ndarray:
    """Return a bound where no ray came through: some share may still be visible, by Laplace's rule one in rays + 2."""
    return np.where(share > 0, value, value / (rays + 2))


def _disc(receiver: Shapes, source: Shapes) -> np.ndarray:
    """Return a rough bound of the factor from a point of the receiver to the source, for any directions of the two.

    It judges pairs that are partly behind each other's planes, since points of quadrature may miss the visible part.
    """
    square = ((receiver.centroid - source.centroid) ** 2).sum(axis=1)
    return source.area / (np.pi * square + source.area)
