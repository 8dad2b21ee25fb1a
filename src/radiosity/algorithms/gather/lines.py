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
from ...tracing.ray_generation import MASK, Frame, before, place_number
from .chances import Chances
from .glow import Glow
from .lamps import NONE
from .packets import ESCAPED, LOST, Packets

KERNEL = 1 / 3  # of the density of shadow rays: above this kernel, cosine lines count
UNITS = 2.0**30  # fixed point units of one line
TOUCHES = 1 - 1e-5  # of a light's distance: what a ray hits so near to it is no obstacle, such as the ceiling that it hangs on


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
        sky: what lines see that leave the scene, where there is a sky.
    """

    packets: Packets
    chances: Chances
    numbers: AbstractNumbers
    by_patch: bool
    keys: tuple[Any, Any]
    emission: list
    most: float
    sky: Glow | None = None

    @staticmethod
    def of(packets: Packets, chances: Chances, problem: Problem, method: Method, seed: Seed | int, purposes) -> "Lines":
        """Make the lines of a run.

        Args:
            method: its numbers and their randomisation.
            purposes: of the streams of cosine lines and of shadow rays.
        """
        types, emission, lights = packets.types, problem.groups.emission, problem.lights
        numbers = ready(method.points, types)
        keys = []
        for purpose in purposes:
            drawn = [numbers.randomisation(stream(seed, r, purpose)) for r in range(packets.replicates)]
            keys.append(upload(types.UInt32, np.array(drawn, np.uint32)))
        shares = emission / np.maximum(problem.unit, 1e-300)
        columns = [upload(types.Float, np.append(column, [0, 0]).astype(np.float32)) for column in shares.T]
        chances.prepare()
        by_patch, both = method.randomisation == "by-patch", (keys[0], keys[1])
        sky = None if lights is None or lights.sky is None else Glow.of(lights.sky, packets.geometry, problem)
        return Lines(packets, chances, numbers, by_patch, both, columns, most_read(problem), sky)

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
        record = packets.record(patch)
        points = self._points(self.keys[0], replicate, record, patch, start, int((done + counts).max()))
        frame, position_of = packets.frame(record)
        normal, row = frame.normal * frame.side, self.chances.row(place)
        base, lanes, scale = replicate * packets.read_width, dr.opaque(UInt32, packets.lanes), dr.opaque(Float, self.unit)
        one, none, lamps = UInt32(1), UInt32(0), self.chances.lamps
        dr.eval(start, count, row, base)

        def body(number, escaped, lost, *sums):
            u = points(number)
            origin, direction = frame.leave(*position_of(u), u)
            hit = first_hit(geometry, origin, direction, coherent=packets.coherent)
            met = patch_of(geometry, hit, packets.n + 1, packets.n)
            if lamps.n_faces:
                lamp = dr.gather(UInt32, lamps.lamp_of_patch, met)
                lit = lamp != NONE
                facing = dr.gather(types.Array3f, lamps.normals, lamp, lit)
                kernel = dr.dot(normal, direction) * -dr.dot(facing, direction) * (1 / np.pi)
                density = self.chances.density_of(row, lamp, lit)
                counted = lit & (kernel > KERNEL * density * hit.distance * hit.distance)
                values = [dr.gather(Float, column, met, counted) for column in self.emission]
            else:
                values = [dr.zeros(Float, packets.lanes) for _ in self.emission]
            if self.sky is not None:
                values = self._with_sky(values, met == packets.n, origin, direction, normal, row)
            where = dr.gather(UInt32, packets.place_on_device, met)
            if keep is not None:
                dr.scatter(keep, where, (start + number) * lanes + lane)
            if read is not None:
                there = where < packets.read_width
                values = [value + dr.gather(Float, b, base + where, there) for value, b in zip(values, read, strict=True)]
            gone = [total + dr.select(where == code, one, none) for total, code in ((escaped, ESCAPED), (lost, LOST))]
            if squares:
                return (number + 1, *gone, *_squared(sums, values))
            fixed = [self._fixed(types.Int64, value * scale + 0.5) for value in values]
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
        record = packets.record(patch)
        points = self._points(self.keys[1], replicate, record, patch, start, int((done + counts).max()))
        frame, position_of = packets.frame(record)
        normal, row = frame.normal * frame.side, self.chances.row(place)
        beams, openings, n_faces = self.chances.beams, self.chances.lamps.openings, self.chances.lamps.n_faces
        kind = Float if squares else types.UInt64
        zeros = [dr.zeros(kind, packets.lanes) for _ in range(self.groups * (1 + squares))]
        if not self.chances.targets:
            return zeros
        others = dr.opaque(types.UInt32, len(self.chances.lamps))
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
            arrival = None
            if beams is not None:
                aimed = lamp >= others
                light = dr.select(aimed, lamp - others, 0)
                towards, distance, share = beams.lights.arrive(light, origin, (u[0], u[1]))
                direction = dr.select(aimed, towards, direction)
                above = dr.dot(towards, normal)
                faces = dr.select(aimed, (above > 0) & (share > 0), faces)
                arrival = aimed, light, distance, above * share / density, beams.powers
            own = () if beams is None else (u[0], u[1])  # rays of a sensor to a point lamp are all the same
            hit = first_hit(geometry, origin, direction, coherent=packets.coherent, active=faces, own=own)
            met = patch_of(geometry, hit, packets.n + 1, packets.n)
            seen = faces & (met - first < cells)
            part = dr.select(seen, kernel / bound, 0)
            brought = [part * dr.gather(Float, column, met, seen) for column in self.emission]
            if openings is not None and self.sky is not None:
                through = faces & (lamp >= n_faces) & (lamp < others) & ~hit.valid
                number_of, _, front = openings.nearest(origin, direction, through)
                through &= number_of + dr.select(front, types.UInt32(0), openings.count) == lamp - n_faces
                seen_sky = self.sky.shares(direction)
                brought = [dr.select(through, kernel / bound * one, old) for one, old in zip(seen_sky, brought, strict=True)]
            if arrival is not None:
                aimed, light, distance, part, powers = arrival
                arrives = faces & aimed & (~hit.valid | (hit.distance >= distance * TOUCHES))
                brought = [
                    dr.select(arrives, part * dr.gather(Float, column, light, aimed), old)
                    for column, old in zip(powers, brought, strict=True)
                ]
            if squares:
                return (number + 1, *_squared(sums, brought))
            fixed = [self._fixed(types.UInt64, value * UNITS + 0.5) for value in brought]
            return (number + 1, *(total + value for total, value in zip(sums, fixed, strict=True)))

        return self._summed(count, body, zeros)

    def _fixed(self, kind, value):
        """Return whole numbers of 64 bits; the light of lamps fits into 32."""
        return kind(self.types.Int(value)) if self.sky is None and self.chances.beams is None else kind(value)

    def _with_sky(self, values: list, escaped, origin, direction, normal, row) -> list:
        """Return what cosine lines meet, with the sky where they escape, unless it counts for shadow rays through an opening;
        called in a kernel."""
        assert self.sky is not None
        counted, openings, lamps = escaped, self.chances.lamps.openings, self.chances.lamps
        if openings is not None:
            found, distance, front = openings.nearest(origin, direction, escaped)
            crosses = escaped & (found != NONE)
            lamp = dr.select(crosses, found + dr.select(front, self.types.UInt32(0), openings.count) + lamps.n_faces, 0)
            facing = dr.gather(self.types.Array3f, lamps.normals, lamp, crosses)
            kernel = dr.dot(normal, direction) * -dr.dot(facing, direction) * (1 / np.pi)
            density = self.chances.density_of(row, lamp, crosses)
            counted = escaped & (~crosses | (kernel > KERNEL * density * distance * distance))
        return [dr.select(counted, one, old) for one, old in zip(self.sky.shares(direction), values, strict=True)]

    def _point_of(self, lamp, u):
        """Return a point of a lamp, the lamp's normal, its first patch and their number; called in a kernel."""
        types, lamps = self.types, self.chances.lamps
        if not lamps.n_faces:
            nothing = types.UInt32(0)
            end, facing = self._point_of_opening(lamp, u) if lamps.openings is not None else (types.Array3f(0), types.Array3f(0))
            return end, facing, nothing, nothing
        if self.chances.targets == lamps.n_faces:
            return self._point_of_face(lamp, u)
        end, facing, first, cells = self._point_of_face(dr.minimum(lamp, lamps.n_faces - 1), u)
        is_face = lamp < lamps.n_faces
        if lamps.openings is not None:
            there, towards = self._point_of_opening(dr.maximum(lamp, lamps.n_faces), u)
            end, facing = dr.select(is_face, end, there), dr.select(is_face, facing, towards)
        return end, facing, first, dr.select(is_face, cells, 0)

    def _point_of_opening(self, lamp, u):
        """Return a point of an opening and the normal of its side; called in a kernel."""
        lamps = self.chances.lamps
        assert lamps.openings is not None
        side = lamp - lamps.n_faces
        back = side >= lamps.openings.count
        number = dr.minimum(dr.select(back, side - lamps.openings.count, side), lamps.openings.count - 1)
        end, normal = lamps.openings.point(number, u[0], u[1], True)
        return end, dr.select(back, -normal, normal)

    def _point_of_face(self, lamp, u):
        """Return a point of a lamp that is a face, its normal, its first patch and their number; called in a kernel."""
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
