"""`LineTracer` leads from a source row and an index to the slot of the line's hit, for lines of patches and of lights."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import upload
from ..errors import MethodError
from ..problem.lights import AbstractLights
from ..sampling.blocks import BLOCK, Blocks
from ..sampling.numbers import AbstractNumbers, ready
from ..sampling.streams import Purpose, Seed
from .geometry import Geometry
from .hits import first_hit, patch_of
from .ray_generation import BACK, local_lines, place_number

ESCAPED, LOST = 0xFFFFFFFD, 0xFFFFFFFC  # no patch has these numbers
LIGHTS = 1 << 30  # from here on the first word of a row's record is no face: a light's number follows


@dataclass(frozen=True, eq=False)
class LineTracer:
    """Lines of source rows: patches, then lights without area. It counts nothing.

    Row i of replicate r has number r * n + i in every array: replicates go through the same kernels as extra rows. Every line
    ends in a slot: slot r * n + i is patch i of replicate r. After ``total`` come two slots a replicate: one for lines that
    escaped, one for lines absorbed by backs. The k-th line of a row is a function of (seed, replicate, row, k) alone
    (contract 2).

    Attributes:
        geometry: the scene on a device.
        numbers: the points of the unit cube, their tables on the device.
        blocks: randomisations of the points, a new one every 2^32 lines of a row.
        randomisation: UInt32, eight words a replicate that move the points of the first block.
        by_patch: each row moves the points by a shift of its own, too.
        seed, replicates: as in a run.
        lights: rows after those of the patches, or None.
    """

    geometry: Geometry
    numbers: AbstractNumbers
    blocks: Blocks
    randomisation: Any
    by_patch: bool
    seed: Seed | int
    replicates: int
    lights: AbstractLights | None = None

    @staticmethod
    def of(
        geometry: Geometry,
        numbers: str,
        randomisation: str,
        seed: Seed | int,
        replicates: int,
        lights: AbstractLights | None = None,
    ) -> "LineTracer":
        """Make a tracer for a `Method`'s numbers and their randomisation.

        Raises:
            MethodError: there are more rows than 32 bits count.
        """
        points, types = ready(numbers, geometry.device.types), geometry.device.types
        blocks = Blocks(points, types, seed, replicates, Purpose.NUMBERS)
        tracer = LineTracer(geometry, points, blocks, blocks.words(), randomisation == "by-patch", seed, replicates, lights)
        tracer.prepare()
        return tracer

    def prepare(self) -> None:
        """Make what kernels read, before any loop is recorded."""
        if self.slots > 2**31:
            raise MethodError(f"{self.n} patches times {self.replicates} replicates are too many to count; take fewer of either")
        if self.lights is not None:
            self.lights.prepare(self.geometry)
        _ = self.n_opaque, self._magic, self._own_lines, self._records, self._replicates

    def of_stream(self, purpose: Purpose, *child: int) -> "LineTracer":
        """Return a tracer of the same rows with the randomisation of another stream."""
        blocks = replace(self.blocks, purpose=purpose, child=child)
        return replace(self, blocks=blocks, randomisation=blocks.words())

    def of_block(self, block: int) -> "LineTracer":
        """Return a tracer whose lines are all in one block: their index is taken modulo 2^32."""
        if block == 0:
            return self
        return replace(self, randomisation=self.blocks.words(block), by_patch=False)

    @property
    def types(self) -> Any:
        return self.geometry.device.types

    @property
    def n_patches(self) -> int:
        return len(self.geometry.patches)

    @property
    def n(self) -> int:
        """The number of rows of a replicate."""
        return self.n_patches + (0 if self.lights is None else len(self.lights.power))

    @property
    def total(self) -> int:
        """The number of rows of all replicates."""
        return self.n * self.replicates

    @property
    def slots(self) -> int:
        """The number of slots in which lines end."""
        return self.total + 2 * self.replicates

    @cached_property
    def n_opaque(self):
        """``n`` on the device, UInt32."""
        return dr.opaque(self.types.UInt32, self.n)

    @cached_property
    def _replicates(self):
        return dr.opaque(self.types.UInt32, self.replicates)

    @cached_property
    def _magic(self):
        return dr.opaque(self.types.UInt32, (2**32 - 1) // self.n)

    @property
    def own_lines(self) -> int:
        """How many lines of a row take a randomisation of its own, in the first block."""
        return own_lines(self.n) if self.by_patch else 0

    @cached_property
    def _own_lines(self):
        return dr.opaque(self.types.UInt32, self.own_lines)

    @cached_property
    def _records(self):
        """Records of rows, (n * 2,) UInt32: of patches see `Geometry.patch_records`; of lights their number, and 0."""
        if self.lights is None:
            return self.geometry.patch_records
        lights = np.zeros((len(self.lights.power), 2), np.uint32)
        lights[:, 0] = LIGHTS + np.arange(len(lights))
        records = dr.concat([self.geometry.patch_records, upload(self.types.UInt32, lights)])
        dr.eval(records)
        return records

    # ---- rows, in kernels ------------------------------------------------------------------------------------------

    def row(self, number):
        """Return the row, counted within its replicate, from its number."""
        return number - self.replicate(number) * self.n_opaque

    def record(self, number):
        """Return the two words of a row from its number: face and place, see `Geometry.patch_records`."""
        return dr.gather(self.types.Array2u, self._records, self.row(number))

    def replicate(self, number):
        """Return the replicate of a row's number: its quotient by n. A product by the reciprocal gives it, at most one short."""
        quotient = dr.mul_hi(number, self._magic)
        one = self.types.UInt32(1)
        return quotient + dr.select(number - quotient * self.n_opaque >= self.n_opaque, one, self.types.UInt32(0))

    def replicate_or_none(self, number):
        """Return the replicate of a row's number; 0, without a division, where there is one replicate."""
        return self.types.UInt32(0) if self.replicates == 1 else self.replicate(number)

    # ---- lines, in kernels -----------------------------------------------------------------------------------------

    def leave(self, record) -> Callable[[Any], tuple[Any, Any]]:
        """Return a function from numbers to the origin and direction of each row's line; made before a loop, called in it."""
        if self.lights is None:
            return local_lines(self.geometry, record)
        lights, UInt32 = self.lights, self.types.UInt32
        is_light = (record[0] & (BACK - 1)) >= LIGHTS
        of_patch = local_lines(self.geometry, self.types.Array2u(dr.select(is_light, UInt32(0), record[0]), record[1]))
        light = dr.select(is_light, record[0] - LIGHTS, UInt32(0))

        def line(numbers):
            return tuple(
                dr.select(is_light, there, here)
                for there, here in zip(lights.leave_where(light, numbers, is_light), of_patch(numbers), strict=True)
            )

        return line

    def points(self, number, index, replicate, record, bits: int, block: Any = None):
        """Return the numbers of the ``index``-th line (from 1) of each row, from the row's number and record.

        Args:
            block: UInt32 of each row, which then takes the ``index``-th line of that block; None: the first one.
        """
        row, randomisation = self._stream(number, replicate, record, block)
        return self.numbers.points(index, row, randomisation(index), bits)

    def points_in_turn(self, first, number, replicate, record, bits: int, turns: int, block: Any = None):
        """Return the numbers of ``turns`` lines of each row from the ``first``-th on, see `AbstractNumbers.in_turn`."""
        return self.numbers.in_turn(first, *self._stream(number, replicate, record, block), bits, turns)

    def points_at(self, index, number, replicate, record, bits: int, block: Any, turn):
        """Return the numbers of the line of each row whose index the function ``index`` gives for this turn."""
        return self.points(number, index(turn), replicate, record, bits, block)

    def trace(self, number, index, record, bits: int, block: Any = None):
        """Return the slot in which the ``index``-th line (from 1) of each row ends, in its block (see `points`)."""
        replicate = self.replicate_or_none(number)
        return self.land_in(self.leave(record)(self.points(number, index, replicate, record, bits, block)), replicate)

    def land_in(self, line, replicate, coherent: bool = False, active: Any = True):
        """Return the slot in which lines end, from their origins and directions."""
        return self.slot(first_hit(self.geometry, *line, coherent=coherent, active=active), replicate)

    def slot(self, hit, replicate):
        """Return the slot of lines of a replicate, from their hits."""
        patch, UInt32 = patch_of(self.geometry, hit, LOST, ESCAPED), self.types.UInt32
        missed = dr.select(patch == ESCAPED, UInt32(self.total), UInt32(self.total + self.replicates)) + replicate
        return dr.select(patch >= LOST, missed, patch + replicate * self.n_opaque)

    def _stream(self, number, replicate, record, block):
        """Return the row, and a function from the index to its randomisation: its own for its first lines, then that of all."""
        types = self.types
        row = number if self.replicates == 1 else number - replicate * self.n_opaque
        table, at, own = self.randomisation, replicate, True
        if block is not None:
            table, at, own = self.blocks.known, replicate + block * self._replicates, block == 0
        halves = [dr.gather(types.Array4u, table, at * 2 + half) for half in (0, 1)]
        words = [word for half in halves for word in half]
        if not self.by_patch:
            return row, lambda index: words
        place = place_number(record)
        return row, lambda index: self.numbers.of_patch(words, dr.select(own & (index <= self._own_lines), place, 0))


def own_lines(n: int) -> int:
    """Return how many lines of a row take its own randomisation: a power of two between 2 n and 4 n, for n rows.

    Beyond that, one randomisation for all rows is as good for means over surfaces, and better for patches.
    """
    return min(1 << (4 * n).bit_length() - 1, BLOCK - 1)
