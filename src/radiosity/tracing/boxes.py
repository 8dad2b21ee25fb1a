"""The order of lines in packets: rounds of a patch's lines are fired box by box (`sampling.numbers.strata`)."""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from ..device.backend import upload
from ..sampling.numbers import strata

SHIFT = 3  # 8 lines a lane, of neighbouring boxes: what the lines of a patch have in common is found once for them


@dataclass(frozen=True)
class Boxes:
    """Boxes of like directions, and the patches whose lines are taken in their order.

    Attributes:
        count: UInt32, how many boxes there are; no literal, so that one kernel serves all sizes.
        walk: UInt32, the order in which lines take them: remainders of their indices modulo ``count``.
        entries: UInt32, four words a patch, all that a lane reads: the index of the first line, the lines of a box, what leads
            from that index to the next one that ``count`` divides, and 0.
    """

    count: Any
    walk: Any
    entries: Any

    @staticmethod
    def of(types, size: tuple[int, int], fired, counts) -> "Boxes":
        """Return the boxes of a size, one of `strata.SIZES`, for patches that fire ``counts`` lines after ``fired`` others.

        Counts are whole rounds.
        """
        count, first = strata.boxes(*size), fired + 1
        entries = dr.ravel(types.Array4u(first, counts // count, count - first % count, types.UInt32(0)))
        dr.eval(entries)
        return Boxes(dr.opaque(types.UInt32, count), upload(types.UInt32, strata.walk(*size)), entries)

    def turns(self, types, index, rank):
        """Return a function from the turn of a lane to the index of its line then, when lines go box by box; called in a kernel.

        A lane takes a line of 2^`SHIFT` boxes in a row, and the lanes of a packet those of the same boxes.

        Args:
            index: of the lane's first line, as they are counted. rank: of its patch.
        """
        first, lines, ahead, _ = dr.gather(types.Array4u, self.entries, rank)
        lane = (index - first) >> SHIFT
        row = _quotient(types, lane, lines)
        box, start = row << SHIFT, first + (lane - row * lines) * self.count

        def turned(turn):
            offset = dr.gather(types.UInt32, self.walk, box + turn) + ahead
            return start + dr.select(offset >= self.count, offset - self.count, offset)

        return turned


def _quotient(types, dividend, divisor):
    """Return a quotient of 32-bit numbers; it must be below 2^20. A single precision guess, at most one off, is mended."""
    guess = types.UInt32(types.Float(dividend) / types.Float(divisor))
    rest = types.Int(dividend - guess * divisor)
    guess = dr.select(rest < 0, guess - 1, guess)
    return dr.select(rest >= types.Int(divisor), guess + 1, guess)
