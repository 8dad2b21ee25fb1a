"""The two kinds of lines of a gather: cosine lines and shadow rays. What they find is in `targets`."""

import functools
import operator
from dataclasses import dataclass

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...device.recorded import loop
from ...method import Method
from ...patches.bases import CONSTANT, Basis, of_size
from ...problem.model import Problem
from ...sampling.streams import Seed
from ...tracing.against import light_along, sends
from ...tracing.hits import Hit, first_hit, patch_of
from ...tracing.ray_generation import before
from ...tracing.spots import Spot, spot, spot_of
from .chances import Chances
from .glow import Glow
from .line_numbers import LineNumbers, largest
from .moments import light_at, products
from .packets import ESCAPED, LOST, Packets
from .stored_lines import StoredLines
from .targets import Targets

UNKNOWN = 0xFFFFFFFF  # in place of a place: nothing was met yet
UNITS = 2.0**30  # fixed point units of one line


@dataclass(frozen=True, eq=False)
class Lines:
    """Traces lines of all lanes. Values are in shares of the largest emission of their group of bands.

    Attributes:
        packets: the lanes.
        targets: what they find.
        numbers: those that lines take.
        most: the largest value that a cosine line may read, for fixed point.
        finer: units of cosine lines are so many times finer than usual, where they find little light.
        basis: sums are moments of its functions where lines leave; columns are group by group (`moments`).
    """

    packets: Packets
    targets: Targets
    numbers: LineNumbers
    most: float
    finer: int = 1
    basis: Basis = CONSTANT

    @staticmethod
    def of(
        packets: Packets,
        chances: Chances,
        problem: Problem,
        method: Method,
        seed: Seed | int,
        purposes,
        basis: Basis = CONSTANT,
    ) -> "Lines":
        """Make the lines of a run.

        Args:
            method: its numbers and their randomisation.
            purposes: of the streams of cosine lines and of shadow rays.
            basis: of the sums.
        """
        types, emission, lights = packets.types, problem.groups.emission, problem.lights
        numbers = LineNumbers.of(method, types, seed, packets.replicates, purposes)
        shares = emission / np.maximum(problem.unit, 1e-300)
        columns = [upload(types.Float, np.append(column, [0, 0]).astype(np.float32)) for column in shares.T]
        chances.prepare()
        sky = None if lights is None or lights.sky is None else Glow.of(lights.sky, packets.geometry, problem)
        targets = Targets(packets, chances, columns, sky)
        return Lines(packets, targets, numbers, most_read(problem), basis=basis)

    @property
    def groups(self) -> int:
        return len(self.targets.emission)

    @property
    def unit(self) -> float:
        """Fixed point units of the value 1 of a cosine line."""
        return UNITS / self.most * self.finer

    @property
    def types(self):
        return self.packets.types

    # ---- cosine lines ----------------------------------------------------------------------------------------------

    def cosine(
        self, done, counts, read=None, keep: StoredLines | None = None, squares: bool = False, bins=None
    ) -> tuple[list, list]:
        """Trace cosine lines. Return sums of what they meet, of each column: Int64, or Float with squares; and how many lines
        escaped and were lost, UInt32 each.

        That is the emission of lamps for which cosine lines count, and what is read.

        Args:
            done, counts: of each packet, (count,) int: the lines of each patch so far, and now.
            read: of each group, the reflected radiosity of each lane, Float; or its K coefficients in a basis, group by group.
            keep: takes where the lines hit.
            bins: ``bins(lane, direction, value)`` is called with what each line brings of the first group, in fixed point.
        """
        found = [self._cosine(*part, read, keep, bins, squares=squares) for part in self.numbers.parts(0, done, counts)]
        return _added([sums for sums, _ in found]), _added([missed for _, missed in found])

    def _cosine(self, keys, done, counts, read, keep: StoredLines | None, bins, *, squares: bool) -> tuple[list, list]:
        """Trace the lines of one block, whose randomisation is ``keys``."""
        packets, chances, types = self.packets, self.targets.chances, self.types
        geometry, UInt32, Float = packets.geometry, types.UInt32, types.Float
        lane, replicate, place, patch = packets.read()
        start, count = packets.of_packets(done, place), packets.of_packets(counts, place)
        record = packets.record(patch)
        points = self.numbers.points_of(keys, replicate, record, patch, start, largest(done, counts))
        frame, position_of = packets.frame(record)
        normal, row = frame.normal * frame.side, chances.row(place)
        base, lanes, scale = replicate * packets.read_width, dr.opaque(UInt32, packets.lanes), dr.opaque(Float, self.unit)
        one, none = UInt32(1), UInt32(0)
        size = 1 if read is None else len(read) // self.groups
        spots, ends = self.basis.size > 1 and not squares, keep is not None and self.basis.size > 1
        dr.eval(start, count, row, base)

        def values_of(hit: Hit, met, origin, direction):
            """Return the place of the patch that a line meets, or a code, where on it, and what the line finds there."""
            values = self.targets.met(met, hit, origin, direction, normal, row)
            where = dr.gather(UInt32, packets.place_on_device, met)
            there = where < packets.read_width
            end = spot_of(geometry, met, there, hit) if size > 1 or ends else None
            if read is not None:
                here = [dr.gather(Float, b, base + where, there) for b in read]
                if size > 1:
                    assert end is not None
                    found = light_at(of_size(size), end, here)
                    here = [dr.clip(value, -self.most, self.most) for value in found]  # so that sums hold them
                values = [value + one for value, one in zip(values, here, strict=True)]
            return where, end, values

        def nearest(origin, direction):
            hit = first_hit(geometry, origin, direction, coherent=packets.coherent)
            return values_of(hit, patch_of(geometry, hit, packets.n + 1, packets.n), origin, direction)

        def through_fronts(origin, direction):
            def visit(hit, stops, met, where, *sums):
                side = patch_of(geometry, hit, packets.n + 1, packets.n)
                side = dr.select(hit.valid & ~sends(hit), packets.n + 1, side)
                place, _, values = values_of(hit, side, origin, direction)
                counts = met & (where == UNKNOWN) & (stops | sends(hit))
                more = (total + dr.select(met, value, 0) for total, value in zip(sums, values, strict=True))
                return dr.select(counts, place, where), *more

            zeros = (dr.zeros(Float, packets.lanes) for _ in range(self.groups))
            state = (dr.full(UInt32, UNKNOWN, packets.lanes), *zeros)
            where, *values = light_along(geometry, origin, direction, visit, state, coherent=packets.coherent)
            return where, None, values

        found = through_fronts if geometry.some_backs_pass else nearest

        def body(number, escaped, lost, *sums):
            u = points(number)
            s, t = position_of(u)
            origin, direction = frame.leave(s, t, u)
            where, end, values = found(origin, direction)
            begin = spot(geometry, record[1], s, t) if spots or ends else None
            if keep is not None:
                keep.keep((start + number) * lanes + lane, where, begin, end)
            gone = [total + dr.select(where == code, one, none) for total, code in ((escaped, ESCAPED), (lost, LOST))]
            if squares:
                return (number + 1, *gone, *_squared(sums, values))
            fixed = self._columns(types.Int64, values, scale, begin)
            if bins is not None:
                bins(lane, direction, fixed[0])
            return (number + 1, *gone, *(total + value for total, value in zip(sums, fixed, strict=True)))

        zeros = [dr.zeros(UInt32, packets.lanes) for _ in range(2)]
        zeros += self._zeros(types.Int64, squares=squares)
        escaped, lost, *sums = self._summed(count, body, zeros, keep)
        return sums, [escaped, lost]

    # ---- shadow rays -----------------------------------------------------------------------------------------------

    def shadow(self, done, counts, squares: bool = False, bins=None):
        """Trace shadow rays, and return the sums of what they bring, of each column: `shadow_kind`, or Float with their squares.

        Args: see `cosine`.
        """
        return _added([self._shadow(*part, bins, squares=squares) for part in self.numbers.parts(1, done, counts)])

    def _shadow(self, keys, done, counts, bins, *, squares: bool) -> list:
        packets, chances = self.packets, self.targets.chances
        lane, replicate, place, patch = packets.read()
        start, count = packets.of_packets(done, place), packets.of_packets(counts, place)
        record = packets.record(patch)
        points = self.numbers.points_of(keys, replicate, record, patch, start, largest(done, counts))
        frame, position_of = packets.frame(record)
        normal, row = frame.normal * frame.side, chances.row(place)
        zeros = self._zeros(self.shadow_kind, squares=squares)
        if not chances.targets:
            return zeros
        dr.eval(start, count, row)
        spots = self.basis.size > 1 and not squares

        def body(number, *sums):
            u = points(number)
            s, t = position_of(u)
            begin = spot(packets.geometry, record[1], s, t) if spots else None
            origin = before(frame.origin + frame.first * s + frame.second * t, normal, frame.offset)
            brought, direction = self.targets.brought(origin, normal, row, u)
            stopped = packets.stopped(record, dr.dot(direction, normal))
            brought = brought if stopped is None else [value * stopped for value in brought]
            if squares:
                return (number + 1, *_squared(sums, brought))
            fixed = self._columns(self.types.UInt64, brought, UNITS, begin)
            if bins is not None:
                bins(lane, direction, fixed[0])
            return (number + 1, *(total + value for total, value in zip(sums, fixed, strict=True)))

        return self._summed(count, body, zeros)

    # ---- both ------------------------------------------------------------------------------------------------------

    @property
    def shadow_kind(self):
        """The type of sums of shadow rays: moments may be negative."""
        return self.types.UInt64 if self.basis.size == 1 else self.types.Int64

    def _zeros(self, kind, *, squares: bool) -> list:
        """Return sums of nothing: of each column, or of each group and of its squares."""
        kind, count = (self.types.Float, 2 * self.groups) if squares else (kind, self.groups * self.basis.size)
        return [dr.zeros(kind, self.packets.lanes) for _ in range(count)]

    def _columns(self, kind, values: list, scale, begin: Spot | None) -> list:
        """Return what lines add to each column, in whole numbers of 64 bits; called in a kernel."""
        if begin is None:
            return [self._fixed(kind, value * scale + 0.5) for value in values]
        return [self.types.Int64(value) for value in products(self.basis, begin, values, scale)]

    def _fixed(self, kind, value):
        """Return whole numbers of 64 bits."""
        return kind(self.types.Int(value)) if self.targets.small and self.finer == 1 else kind(value)

    def _summed(self, count, body, zeros: list, keep: StoredLines | None = None) -> list:
        """Return the sums of a loop over ``count`` lines of each lane."""
        state = (dr.zeros(self.types.UInt32, self.packets.lanes), *zeros)
        _, *sums = loop(state, lambda number, *_: number < count, body)
        dr.eval(sums, *([] if keep is None else keep.arrays()))
        return sums


def _added(found: list[list]) -> list:
    """Return the sums of columns."""
    return [functools.reduce(operator.add, columns) for columns in zip(*found, strict=True)]


def most_read(problem: Problem) -> float:
    """Return a bound of what a cosine line reads, in shares of the largest emission: four times that of the solution."""
    return 4.0 / max(1.0 - float(problem.groups.scatter.albedo.max()), 1e-3)


def _squared(sums, values):
    """Add values to the first half of some sums, and their squares to the second."""
    half = len(values)
    return [
        *(total + value for total, value in zip(sums[:half], values, strict=True)),
        *(total + value * value for total, value in zip(sums[half:], values, strict=True)),
    ]
