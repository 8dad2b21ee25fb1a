"""Each line refines the pair of elements that it carries power between, and brings its power to the receiving one.

P. Bekaert, L. Neumann, A. Neumann, M. Sbert, Y. Willems, "Hierarchical Monte Carlo radiosity", Eurographics Rendering Workshop
1998. A line from patch i to patch j begins with the sides that hold them. While the pair is too coarse the larger of the two is
divided, and the line goes to the part that holds its end. It brings the power of patch i to the element that is left of the
receiver, whose patches share it by area. No link is stored.

A pair (r, s) is too coarse while it may err by more than epsilon of the emitted power Phi,

    P_s A_r / (pi D²) * (2 c_r c_s + c_r + c_s) * h_r / D  >  epsilon Phi,

which is the power that s sends to r times what that differs by over r, to first order: cos cos / (pi d²) changes by 2/d where r
moves away, and by 1/d over each cosine where it turns. P_s is what the patches of s send; h are half diagonals; D² is the squared
distance of the centroids, plus both h²; c_r is the largest cosine at r that s may have, cos + h_s / D, at most 1, and likewise
c_s. No element receives as a whole whose half diagonal is above the clearance of one of its patches: what stands that near to
it hides a part of it.

What is decided of a pair depends on the pair alone, not on the line. So all lines between two elements go the same way, and the
mean of what they bring to r is what s sends to r past all obstacles. What is wrong is that the patches of r share alike.

The published method sends the mean radiosity of s. Here a line carries the power of its own patch: lines leave patches in
proportion to their power, so it is the same for all, and nothing of it is lost.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...device.recorded import loop
from .clearance import largest_clear
from .elements import Elements, Place

INVERSE_PI = 0.318309886
ALIKE = 0.99  # of two areas that differ by less the receiver's is divided


class Refinement:
    """Pairs of elements that lines of a step are refined to.

    Attributes:
        elements: of the patches.
        epsilon: the share of Phi that a pair may err by, Float.
        largest: UInt32, the level of the largest element about each patch that may receive as a whole.
        sent: what the patches of each element send in this step, (elements.size,) Float, shares of Phi.
    """

    def __init__(self, elements: Elements, epsilon: float):
        self.elements = elements
        self.epsilon = dr.opaque(elements.types.Float, epsilon)
        clear = largest_clear(elements.tree, elements.tracer.geometry)
        self.largest = upload(elements.types.UInt32, clear.astype(np.uint32))
        self.sent: Any = None

    def begin(self, sent) -> None:
        """Begin a step in which patches send power of this size, (total,) Float64, shares of Phi."""
        self.sent = self.elements.pulled(sent)

    def receiver(self, source, slot):
        """Return the slot that receives what a line brings from a patch number to a slot; called in a kernel."""
        elements, UInt32 = self.elements, self.elements.types.UInt32
        is_patch = slot < elements.total
        patch = dr.select(is_patch, slot, source)
        of_s, of_r = elements.place(source), elements.place(patch)
        frames = elements.frame(of_s), elements.frame(of_r)

        def body(at_s, at_r, going):
            s, r = End.of(of_s, frames[0], at_s), End.of(of_r, frames[1], at_r)
            sent = dr.gather(elements.types.Float, self.sent, elements.slot(source, of_s, at_s))
            going &= sent * unevenness(s, r) > self.epsilon
            divides_r = (at_s == of_s.deepest) | (r.area >= ALIKE * s.area)
            at_s = dr.select(going & ~divides_r, at_s + 1, at_s)
            at_r = dr.select(going & divides_r, at_r + 1, at_r)
            return at_s, at_r, going & (at_r < of_r.deepest)

        top = dr.gather(UInt32, self.largest, elements.row(patch))
        begin = dr.zeros(UInt32, dr.width(source)), top, is_patch & (top < of_r.deepest)
        _, level, _ = loop(begin, lambda at_s, at_r, going: going, body)
        return dr.select(is_patch, elements.slot(patch, of_r, level), slot)


@dataclass(frozen=True)
class End:
    """An end of a pair in the BVH's units: its centroid, unit normal, area, and squared half diagonal."""

    centroid: Any
    normal: Any
    area: Any
    half: Any

    @staticmethod
    def of(place: Place, frame, level) -> "End":
        """Return the end that is the element of a level at a place, whose face has this frame."""
        Float = type(frame.side)
        wide, high = place.shifts(level)
        column, row, inverted = place.cell(level)
        middle = dr.select(place.quad, Float(0.5), dr.select(inverted == 1, Float(2 / 3), Float(1 / 3)))
        first, second = frame.first * Float(1 << wide), frame.second * Float(1 << high)
        centroid = frame.origin + first * (Float(column) + middle) + second * (Float(row) + middle)
        area = dr.norm(dr.cross(first, second)) * dr.select(place.quad, Float(1), Float(0.5))
        return End(centroid, frame.normal * frame.side, area, (dr.squared_norm(first) + dr.squared_norm(second)) / 4)


def unevenness(s: End, r: End):
    """Return what the light of s may differ by over r, as a share of the power that s sends."""
    between = r.centroid - s.centroid
    inverse = dr.rcp(dr.squared_norm(between) + s.half + r.half)  # 1 / D²
    one = dr.sqrt(inverse)
    of_s = _cosine(dr.dot(s.normal, between) * one, r, one)
    of_r = _cosine(-dr.dot(r.normal, between) * one, s, one)
    return r.area * (INVERSE_PI * inverse) * (2 * of_r * of_s + of_r + of_s) * dr.sqrt(r.half) * one


def _cosine(cosine, other: End, inverse):
    """Return the largest cosine towards the other end."""
    return dr.minimum(dr.maximum(cosine, 0) + dr.sqrt(other.half) * inverse, 1)
