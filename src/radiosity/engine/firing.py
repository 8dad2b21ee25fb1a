"""The quantum firing engine: integer counters of every patch and replicate on a device, and the kernels that move them.

Patch i of replicate r has number r * n_patches + i in every array: replicates go through the same kernels as extra
patches. After the patches, ``arrivals`` has two slots a replicate: lines escaped, and lines lost on absorbing backs.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ..errors import MethodError
from ..method.model import Method
from ..method.numbers import make, strata
from . import quanta as contract
from .bands import BandGroups, BandTally
from .device import upload
from .geometry import Geometry
from .lines import land, local_line, patch_of

CHUNK = 1 << 22  # lanes of one launch


@dataclass(frozen=True)
class Lanes:
    """Lines to fire: patch number in all replicates and its how-manieth line (from 0), as kernels read them."""

    rank: Any
    patches: Any
    begins: Any
    fired: Any
    deficits: Any
    start: int
    count: int


class Engine:
    """Counters and kernels. What fires when is the business of an order."""

    def __init__(self, geometry: Geometry, source: contract.Source, method: Method, seed: int, replicates: int,
                 groups: BandGroups | None = None):  # fmt: skip
        self.geometry, self.source, self.method = geometry, source, method
        self.n, self.replicates = len(geometry.patches), replicates
        self.total = self.n * replicates
        if self.total + 2 * replicates > 2**31:
            raise MethodError(f"{self.n} patches times {replicates} replicates are too many to count; take fewer of either")
        self.types = geometry.device.types
        self.numbers = make(method.numbers)
        u32 = self.types.UInt32
        self.rho = upload(u32, self.source.rho)
        self.phase = upload(u32, contract.phases(seed, replicates, self.n))
        drawn = [self.numbers.randomisation(contract.stream(seed, r, 1)) for r in range(replicates)]
        self.randomisation = upload(u32, np.array(drawn, np.uint32))
        self.arrivals = dr.zeros(u32, self.total + 2 * replicates)
        self.fired = dr.zeros(u32, self.total)
        self.n_opaque, self.magic = dr.opaque(u32, self.n), dr.opaque(u32, (2**32 - 1) // self.n)
        self.quanta = 0
        self.bands = BandTally(self, groups) if groups is not None and groups.n_groups > 1 else None

    # ---- host side -------------------------------------------------------------------------------------------------

    def set_quanta(self, quanta: int) -> None:
        """Begin a stage: N for each replicate; it may only grow."""
        if quanta < self.quanta:
            raise MethodError(f"quanta may only grow within a run ({self.quanta} to {quanta})")
        whole, fraction = self.source.emitted(quanta)
        self.whole, self.fraction = (upload(self.types.UInt32, a) for a in (whole, fraction))
        self.quanta = quanta

    def counters(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Arrivals and fired lines, (replicates, n_patches) uint32, and escaped and lost lines, (2, replicates)."""
        dr.eval(self.arrivals, self.fired)
        flat = np.array(self.arrivals)
        arrivals = flat[: self.total].reshape(self.replicates, self.n)
        return arrivals, np.array(self.fired).reshape(self.replicates, self.n), flat[self.total :].reshape(2, self.replicates)

    # ---- kernels ---------------------------------------------------------------------------------------------------

    def replicate(self, patch):
        """Of a patch number: its quotient by n_patches, from a product by the reciprocal that is one short at most."""
        quotient = dr.mul_hi(patch, self.magic)
        return quotient + dr.select(patch - quotient * self.n_opaque >= self.n_opaque, self.types.UInt32(1), self.types.UInt32(0))

    def owed(self):
        """UInt32 for each patch and replicate: lines owed in all."""
        types = self.types
        number = dr.arange(types.UInt32, self.total)
        patch = number - self.replicate(number) * self.n_opaque
        wide = types.UInt64
        rho, fraction = dr.gather(types.UInt32, self.rho, patch), dr.gather(types.UInt32, self.fraction, patch)
        low = wide(rho) * wide(dr.gather(types.UInt32, self.arrivals, number)) + wide(fraction) + wide(self.phase)
        return dr.gather(types.UInt32, self.whole, patch) + types.UInt32(low >> 32)

    def trace(self, number, index, bits: int, *, coherent: bool = False):
        """Fire the ``index``-th line (from 1) of each patch number: the slot of ``arrivals`` where it lands."""
        types = self.types
        replicate = self.replicate(number)
        patch = number - replicate * self.n_opaque
        randomisation = dr.gather(types.Array4u, self.randomisation, replicate)
        numbers = self.numbers.points(index, patch, randomisation, bits)
        origin, direction = local_line(self.geometry, patch, numbers)
        hit = land(self.geometry, origin, direction, coherent=coherent)
        none = 0xFFFFFFFD
        landed = patch_of(self.geometry, hit, none - 1, none)
        missed = dr.select(landed == none, types.UInt32(self.total), types.UInt32(self.total + self.replicates)) + replicate
        return dr.select(landed >= none - 1, missed, landed + replicate * self.n_opaque)

    def fire(self, lanes: Lanes, bits: int, boxes: tuple[int, int] | None = None) -> None:
        """Trace lanes and count where they land; with ``boxes``, in packets of like directions."""
        number, index = self.read(lanes, boxes)
        landed = self.trace(number, index, bits, coherent=boxes is not None)
        dr.scatter_add(self.arrivals, self.types.UInt32(1), landed)
        if self.bands is not None:
            self.bands.deposit(number, landed)
        dr.eval(self.arrivals)

    def lanes(self, deficit):
        """Chunks of lanes, one a line, for a deficit (UInt32 for each patch number), and how many lines in all."""
        types = self.types
        numbers = dr.compress(deficit > 0)
        if dr.width(numbers) == 0:
            return
        count = dr.gather(types.UInt32, deficit, numbers)
        begin = dr.prefix_sum(types.UInt64(count))
        fired = dr.gather(types.UInt32, self.fired, numbers)
        dr.eval(count, begin, fired)
        total = int(begin[dr.width(numbers) - 1]) + int(count[dr.width(numbers) - 1])
        for start in range(0, total, CHUNK):
            width = min(CHUNK, total - start)
            # each entry writes its rank where its lines begin; the running maximum carries it to all of them
            rank = dr.zeros(types.UInt32, width)
            first, end = dr.opaque(types.UInt64, start), dr.opaque(types.UInt64, start + width)  # no literals: one kernel for all
            here = (begin < end) & (begin + types.UInt64(count) > first)
            at = types.UInt32(dr.maximum(begin, first) - first)
            dr.scatter(rank, dr.arange(types.UInt32, dr.width(numbers)), at, active=here)
            rank = dr.block_prefix_reduce(dr.ReduceOp.Max, rank, width, exclusive=False)
            yield Lanes(rank, numbers, begin, fired, count, start, width)

    def read(self, lanes: Lanes, boxes: tuple[int, int] | None = None):
        """In a kernel of width ``lanes.count``: patch number and index (from 1) of each line."""
        types = self.types
        lane = types.UInt64(dr.arange(types.UInt32, lanes.count)) + dr.opaque(types.UInt64, lanes.start)
        number = dr.gather(types.UInt32, lanes.patches, lanes.rank)
        within = types.UInt32(lane - dr.gather(types.UInt64, lanes.begins, lanes.rank))
        base = dr.gather(types.UInt32, lanes.fired, lanes.rank) + 1
        if boxes is None:
            return number, base + within
        return number, base + self._by_boxes(base, within, dr.gather(types.UInt32, lanes.deficits, lanes.rank), boxes)

    def _by_boxes(self, base, within, count, boxes: tuple[int, int]):
        """Which of a patch's ``count`` lines from ``base`` on is fired as the ``within``-th, when they go box by box.

        As many whole cycles of the boxes as fit are permuted; the rest, less than a cycle, keeps its order.
        """
        types = self.types
        n = strata.boxes(*boxes)
        walk = upload(types.UInt32, strata.walk(*boxes))
        cycles = count // n
        box = types.UInt32(types.Float64(within) / types.Float64(cycles))  # exact for 32-bit numbers
        whole = within < cycles * n
        offset = dr.gather(types.UInt32, walk, box, whole) + n - base % n
        offset = dr.select(offset >= n, offset - n, offset)
        return dr.select(whole, offset + (within - box * cycles) * n, within)

    def boxes_for(self, deficit) -> tuple[int, int] | None:
        """For coherent firing: boxes that fit the lines of a typical line's patch; None where it would not pay."""
        squares = dr.sum(self.types.Float64(deficit) * self.types.Float64(deficit))
        total = dr.sum(self.types.Float64(deficit))
        dr.eval(squares, total)
        return strata.largest(1.0 * float(squares[0]) / float(total[0]))
