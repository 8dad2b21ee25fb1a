"""Stored lines as rows of form factors: where each line hits is known, so the equation among patches can be solved.

The first lines of every patch are kept. With F' the share of them that hits each patch, x = r + rho F' x is solved by Jacobi
iterations: a sparse system of each replicate, which nothing is traced for.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...device.recorded import loop
from .packets import Packets

LONGEST = 400  # iterations
CHECKED = 4  # iterations between two looks at the change


@dataclass(frozen=True, eq=False)
class Rows:
    """Stored lines of all lanes.

    Attributes:
        packets: the lanes.
        hits: UInt32, the place that line k of a lane hits, at k * lanes + lane; see `Lines.cosine`.
        stored: lines of each patch.
        reflectance: of each group of bands, (lanes,) Float.
    """

    packets: Packets
    hits: Any
    stored: int
    reflectance: list

    @staticmethod
    def reflectances(packets: Packets, reflectance: np.ndarray) -> list:
        """Return the reflectance of each group at each lane from (n_patches, n_groups)."""
        _, _, place, patch = packets.read()
        real = place < dr.opaque(packets.types.UInt32, packets.n)
        columns = [upload(packets.types.Float, column.astype(np.float32)) for column in reflectance.T]
        found = [dr.gather(packets.types.Float, column, patch, real) for column in columns]
        dr.eval(found)
        return found

    def means(self, values: list, halves: list | None = None) -> list:
        """Return the mean over the stored lines of values where they hit, of each group.

        With ``halves``, two more sets of values, return also the mean of the first of them over the first half of the lines, and
        of the second over the second half.
        """
        packets, types = self.packets, self.packets.types
        UInt32, Float = types.UInt32, types.Float
        lane, replicate, _, _ = packets.read()
        base, lanes = replicate * packets.width_on_device, dr.opaque(UInt32, packets.lanes)
        stored, half = dr.opaque(UInt32, self.stored), dr.opaque(UInt32, self.stored // 2)
        groups = len(values)

        def body(number, *sums):
            where = dr.gather(UInt32, self.hits, number * lanes + lane)
            there = where < packets.width_on_device
            met = [dr.gather(Float, value, base + where, there) for value in values]
            if halves is not None:
                first = number < half
                met += [dr.gather(Float, value, base + where, there & first) for value in halves[:groups]]
                met += [dr.gather(Float, value, base + where, there & ~first) for value in halves[groups:]]
            return (number + 1, *(total + value for total, value in zip(sums, met, strict=True)))

        count = groups * (1 if halves is None else 3)
        state = (dr.zeros(UInt32, packets.lanes), *(dr.zeros(Float, packets.lanes) for _ in range(count)))
        _, *sums = loop(state, lambda number, *sums: number < stored, body)
        shares = [
            dr.opaque(Float, 1 / max(lines, 1)) for lines in (self.stored, self.stored // 2, self.stored - self.stored // 2)
        ]
        return [total * shares[at // groups] for at, total in enumerate(sums)]

    def solve(self, right: list, tolerance: float, halves: list | None = None) -> tuple[list, list]:
        """Return x = r + rho F' x of each group, and the solutions of two more sets of right sides along halves of the lines.

        Args:
            right: of each group, (lanes,) Float.
            tolerance: iterations end once none of them changes a value by more than this.
            halves: right sides for the first half of the lines, then for the second.
        """
        groups, several = len(right), halves is not None
        right = right + (halves or [])
        rho = self.reflectance * (3 if several else 1)
        found = list(right)
        for iteration in range(1, LONGEST + 1):
            met = self.means(found[:groups], found[groups:] if several else None)
            new = [start + share * value for start, share, value in zip(right, rho, met, strict=True)]
            dr.eval(new)
            looked = iteration % CHECKED == 0
            change = max(float(dr.max(dr.abs(a - b))[0]) for a, b in zip(new, found, strict=True)) if looked else np.inf
            found = new
            if change < tolerance:
                break
        return found[:groups], found[groups:]

    def missed(self, code: int):
        """Return how many stored lines of each lane ended with a code of `packets`, (lanes,) UInt32."""
        packets, UInt32 = self.packets, self.packets.types.UInt32
        lane, lanes = dr.arange(UInt32, packets.lanes), dr.opaque(UInt32, packets.lanes)
        stored, wanted = dr.opaque(UInt32, self.stored), dr.opaque(UInt32, code)

        def body(number, total):
            where = dr.gather(UInt32, self.hits, number * lanes + lane)
            return number + 1, total + dr.select(where == wanted, UInt32(1), UInt32(0))

        state = (dr.zeros(UInt32, packets.lanes), dr.zeros(UInt32, packets.lanes))
        _, total = loop(state, lambda number, total: number < stored, body)
        dr.eval(total)
        return total
