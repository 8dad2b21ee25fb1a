"""The two kinds of lines of a gather, and the rule that says which of them counts for the light of a lamp.

Cosine lines leave a patch and read the radiosity where they hit. Shadow rays go to points of lamps. Both can find the light of a
lamp's point; each pair of points counts for one of them (the maximum heuristic: E. Veach and L. Guibas, "Optimally combining
sampling techniques for Monte Carlo rendering", SIGGRAPH 1995). A cosine line counts where its density over the lamp, the kernel
cos cos' / (pi r^2), is above `KERNEL` times that of the shadow ray. So what a shadow ray brings is bounded.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...device.recorded import loop
from ...method import Method
from ...problem.model import Problem
from ...sampling.hemisphere import triangle
from ...sampling.numbers import AbstractNumbers, ready
from ...sampling.streams import Seed, stream
from ...tracing.faces import COLUMN_BITS, QUAD
from ...tracing.hits import first_hit, patch_of
from ...tracing.ray_generation import MASK, Frame, before, place_number, position
from .chances import Chances
from .lamps import NONE
from .packets import ESCAPED, LOST, Packets

KERNEL = 1 / 3  # of the density of shadow rays: above this kernel, cosine lines count
UNITS = 2.0**30  # fixed point units of one line


@dataclass(frozen=True, eq=False)
class Lines:
    """Traces lines of all lanes. Values are in shares of the largest emission of their group of bands.

    Attributes:
        packets: the lanes.
        chances: of lamps that shadow rays go to.
        numbers: the points of the unit cube.
        by_patch: each patch moves them by a shift of its own.
        keys: randomisation of the replicates, for cosine lines and for shadow rays.
        emission: of each group of bands, (n_patches + 2,) Float.
        most: the largest value that a cosine line may read, for fixed point.
    """

    packets: Packets
    chances: Chances
    numbers: AbstractNumbers
    by_patch: bool
    keys: tuple[Any, Any]
    emission: list
    most: float

    @staticmethod
    def of(packets: Packets, chances: Chances, problem: Problem, method: Method, seed: Seed | int, purposes) -> "Lines":
        """Make the lines of a run.

        Args:
            method: its numbers and their randomisation.
            purposes: of the streams of cosine lines and of shadow rays.
        """
        types, emission = packets.types, problem.groups.emission
        numbers = ready(method.points, types)
        keys = []
        for purpose in purposes:
            drawn = [numbers.randomisation(stream(seed, r, purpose)) for r in range(packets.replicates)]
            keys.append(upload(types.UInt32, np.array(drawn, np.uint32)))
        shares = emission / np.maximum(emission.max(axis=0), 1e-300)
        columns = [upload(types.Float, np.append(column, [0, 0]).astype(np.float32)) for column in shares.T]
        chances.prepare()
        return Lines(
            packets, chances, numbers, method.randomisation == "by-patch", (keys[0], keys[1]), columns, most_read(problem)
        )

    @property
    def groups(self) -> int:
        return len(self.emission)

    @property
    def unit(self) -> float:
        """Fixed point units of the value 1 of a cosine line."""
        return UNITS / self.most

    @property
    def types(self):
        return self.packets.types

    # ---- cosine lines ----------------------------------------------------------------------------------------------

    def cosine(self, done, counts, read=None, keep=None, squares: bool = False) -> tuple[list, list]:
        """Trace cosine lines. Return sums of what they meet, of each group: Int64, or Float with squares; and how many lines
        escaped and were lost, UInt32 each.

        That is the emission of lamps for which cosine lines count, and what is read.

        Args:
            done, counts: of each packet, (count,) int: the lines of each patch so far, and now.
            read: of each group, the reflected radiosity of each lane, Float.
            keep: UInt32, line number times lanes plus lane: takes the lane's place where the line hits, or
                `packets.ESCAPED` or `LOST`.
        """
        packets, types = self.packets, self.types
        geometry, UInt32, Float = packets.geometry, types.UInt32, types.Float
        lane, replicate, place, patch = packets.read()
        start, count = packets.of_packets(done, place), packets.of_packets(counts, place)
        record = self._record(patch)
        points = self._points(self.keys[0], replicate, record, patch, start, int((done + counts).max()))
        frame, position_of = self._frame(record)
        normal, row = frame.normal * frame.side, self.chances.row(place)
        base, lanes, scale = replicate * packets.width_on_device, dr.opaque(UInt32, packets.lanes), dr.opaque(Float, self.unit)
        one, none = UInt32(1), UInt32(0)
        dr.eval(start, count, row, base)

        def body(number, escaped, lost, *sums):
            u = points(number)
            origin, direction = frame.leave(*position_of(u), u)
            hit = first_hit(geometry, origin, direction, coherent=packets.coherent)
            met = patch_of(geometry, hit, packets.n + 1, packets.n)
            lamp = dr.gather(UInt32, self.chances.lamps.lamp_of_patch, met)
            lit = lamp != NONE
            facing = dr.gather(types.Array3f, self.chances.lamps.normals, lamp, lit)
            kernel = dr.dot(normal, direction) * -dr.dot(facing, direction) * (1 / np.pi)
            density = self.chances.density_of(row, lamp, lit)
            counted = lit & (kernel > KERNEL * density * hit.distance * hit.distance)
            values = [dr.gather(Float, column, met, counted) for column in self.emission]
            where = dr.gather(UInt32, packets.place_on_device, met)
            if keep is not None:
                dr.scatter(keep, where, (start + number) * lanes + lane)
            if read is not None:
                there = where < packets.width_on_device
                values = [value + dr.gather(Float, b, base + where, there) for value, b in zip(values, read, strict=True)]
            gone = [total + dr.select(where == code, one, none) for total, code in ((escaped, ESCAPED), (lost, LOST))]
            if squares:
                return (number + 1, *gone, *_squared(sums, values))
            fixed = [types.Int64(types.Int(value * scale + 0.5)) for value in values]
            return (number + 1, *gone, *(total + value for total, value in zip(sums, fixed, strict=True)))

        zeros = [dr.zeros(UInt32, packets.lanes) for _ in range(2)]
        zeros += [dr.zeros(Float if squares else types.Int64, packets.lanes) for _ in range(self.groups * (1 + squares))]
        escaped, lost, *sums = self._summed(count, body, zeros, keep)
        return sums, [escaped, lost]

    # ---- shadow rays -----------------------------------------------------------------------------------------------

    def shadow(self, done, counts, squares: bool = False):
        """Trace shadow rays, and return the sums of what they bring, of each group: UInt64, or Float with their squares.

        Args: see `cosine`.
        """
        packets, types = self.packets, self.types
        geometry, Float = packets.geometry, types.Float
        _, replicate, place, patch = packets.read()
        start, count = packets.of_packets(done, place), packets.of_packets(counts, place)
        record = self._record(patch)
        points = self._points(self.keys[1], replicate, record, patch, start, int((done + counts).max()))
        frame, position_of = self._frame(record)
        normal, row = frame.normal * frame.side, self.chances.row(place)
        dr.eval(start, count, row)

        def body(number, *sums):
            u = points(number)
            s, t = position_of(u)
            origin = before(frame.origin + frame.first * s + frame.second * t, normal, frame.offset)
            lamp, density = self.chances.choose(row, u[4])
            end, facing, first, cells = self._point_of(lamp, u)
            way = end - origin
            square = dr.squared_norm(way)
            direction = way * dr.rsqrt(square)
            kernel = dr.dot(direction, normal) * -dr.dot(direction, facing) * (1 / np.pi)
            bound = density * square
            faces = (dr.dot(direction, normal) > 0) & (dr.dot(direction, facing) < 0) & (kernel <= KERNEL * bound)
            hit = first_hit(geometry, origin, direction, coherent=packets.coherent, active=faces)
            met = patch_of(geometry, hit, packets.n + 1, packets.n)
            seen = faces & (met - first < cells)
            share = dr.select(seen, kernel / bound, 0)
            brought = [share * dr.gather(Float, column, met, seen) for column in self.emission]
            if squares:
                return (number + 1, *_squared(sums, brought))
            fixed = [types.UInt64(types.Int(value * UNITS + 0.5)) for value in brought]
            return (number + 1, *(total + value for total, value in zip(sums, fixed, strict=True)))

        kind = Float if squares else types.UInt64
        return self._summed(count, body, [dr.zeros(kind, packets.lanes) for _ in range(self.groups * (1 + squares))])

    def _point_of(self, lamp, u):
        """Return a point of a lamp, the lamp's normal, its first patch and their number; called in a kernel."""
        types = self.types
        face, counts, first, cells = dr.gather(types.Array4u, self.chances.lamps.records, lamp)
        frame = Frame.of(self.packets.geometry, face)
        a, b = triangle(u[0], u[1])
        quad = (counts & QUAD) != 0
        s, t = dr.select(quad, u[0], a), dr.select(quad, u[1], b)
        s, t = s * types.Float(counts & MASK), t * types.Float((counts >> COLUMN_BITS) & MASK)
        return frame.origin + frame.first * s + frame.second * t, frame.normal * frame.side, first, cells

    # ---- both ------------------------------------------------------------------------------------------------------

    def _summed(self, count, body, zeros: list, keep=None) -> list:
        """Return the sums of a loop over ``count`` lines of each lane."""
        state = (dr.zeros(self.types.UInt32, self.packets.lanes), *zeros)
        _, *sums = loop(state, lambda number, *_: number < count, body)
        dr.eval(sums, *([] if keep is None else [keep]))
        return sums

    def _points(self, keys, replicate, record, patch, start, largest: int):
        """Return a function from the number of a line to its numbers."""
        numbers = self.numbers
        halves = [dr.gather(self.types.Array4u, keys, replicate * 2 + half) for half in (0, 1)]
        words = [word for half in halves for word in half]
        if self.by_patch:
            words = numbers.of_patch(words, place_number(record))
        bits = numbers.bits_for(largest)
        return lambda number: numbers.points(start + number + 1, patch, words, bits)

    def _record(self, patch):
        """Return the two words of patches, see `Geometry.patch_records`."""
        return dr.gather(self.types.Array2u, self.packets.geometry.patch_records, patch)

    def _frame(self, record):
        """Return the frame of patches' faces, and a function from numbers to a place on them."""
        geometry, (face, place) = self.packets.geometry, record
        return Frame.of(geometry, face), lambda u: position(geometry, place, u[2], u[3])


def most_read(problem: Problem) -> float:
    """Return a bound of what a cosine line reads, in shares of the largest emission: four times that of the solution."""
    return 4.0 / max(1.0 - float(problem.groups.reflectance.max()), 1e-3)


def _squared(sums, values):
    """Add values to the first half of some sums, and their squares to the second."""
    half = len(values)
    return [
        *(total + value for total, value in zip(sums[:half], values, strict=True)),
        *(total + value * value for total, value in zip(sums[half:], values, strict=True)),
    ]
