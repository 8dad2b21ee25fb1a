"""Places where lines begin and end on their patches, in coordinates of the patches (`patches.bases`); called in kernels."""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from .faces import COLUMN_BITS, INVERTED, QUAD
from .geometry import Geometry
from .hits import Hit, first_hit
from .line_tracer import LineTracer
from .ray_generation import MASK, position


@dataclass(frozen=True)
class Spot:
    """A point of a patch.

    Attributes:
        a, b: Float, coordinates within the patch; they have no meaning where there is no patch.
        quad: Bool, whether the patch is a parallelogram; True where all are.
    """

    a: Any
    b: Any
    quad: Any

    def select(self, quad: float, triangle: float):
        """Return the number for parallelograms where the patch is one, else that for triangles."""
        if self.quad is True:
            return quad
        return dr.select(self.quad, type(self.a)(quad), type(self.a)(triangle))


def traced(tracer: LineTracer, number, index, record, bits: int, block: Any = None) -> tuple[Any, Spot, Spot]:
    """Return the slot in which the ``index``-th line of each patch ends, where the line begins, and where it ends.

    The line is the same as that of `LineTracer.trace`.
    """
    geometry, replicate = tracer.geometry, tracer.replicate_or_none(number)
    numbers = tracer.points(number, index, replicate, record, bits, block)
    hit = first_hit(geometry, *tracer.leave(record)(numbers))
    slot = tracer.slot(hit, replicate)
    begin = spot(geometry, record[1], *position(geometry, record[1], numbers[2], numbers[3]))
    on_patch = slot < tracer.total
    _, place = tracer.record(dr.select(on_patch, slot, 0))
    return slot, begin, _at_hit(geometry, place, hit)


def spot_of(geometry: Geometry, patch, active, hit: Hit) -> Spot:
    """Return where lines hit patches, from the numbers of the patches; without meaning for lines that are not ``active``."""
    types = geometry.device.types
    _, place = dr.gather(types.Array2u, geometry.patch_records, dr.select(active, patch, 0))
    return _at_hit(geometry, place, hit)


def _at_hit(geometry: Geometry, place, hit: Hit) -> Spot:
    columns, rows = (geometry.device.types.Float(x & MASK) for x in (hit.packed, hit.packed >> COLUMN_BITS))
    return spot(geometry, place, hit.u * columns, hit.v * rows)


def spot(geometry: Geometry, place, s, t) -> Spot:
    """Return points of patches from face coordinates, in cells, and the second word of the patches' records."""
    Float = geometry.device.types.Float
    if not geometry.whole_faces:
        s, t = s - Float(place & MASK), t - Float((place >> COLUMN_BITS) & MASK)
    if geometry.all_quads:
        return Spot(dr.clip(s, 0, 1), dr.clip(t, 0, 1), True)
    inverted = (place & INVERTED) != 0
    a, b = dr.select(inverted, 1 - s, s), dr.select(inverted, 1 - t, t)
    return Spot(dr.clip(a, 0, 1), dr.clip(b, 0, 1), (place & QUAD) != 0)
