"""The energy balance of a run in whole numbers: emitted + rounding = absorbed + escaped + lost, exactly (contract 8)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..pieces import pieces


@dataclass(frozen=True)
class Books:
    """The energy balance: sums over replicates, in units of 2^-32 of the unit of powers (a quantum, or 2^-31 of it).

    Attributes:
        emitted, absorbed, escaped, lost: whole numbers.
        fired: power that left patches along lines, summed from the lines' side.
        reflected: power that patches must send for the hits that they received.
        watts: W or lm of one unit, for the mean over replicates.
        most_rounding: what rounding cannot exceed, where that is known.
    """

    emitted: int
    fired: int
    reflected: int
    absorbed: int
    escaped: int
    lost: int
    watts: float
    most_rounding: int | None = None

    COLUMNS: ClassVar = ("emitted", "rounding", "absorbed", "escaped", "lost")

    @property
    def rounding(self) -> int:
        """The energy that rounding to whole lines added: fired less emitted less reflected."""
        return self.fired - self.emitted - self.reflected

    @property
    def closes(self) -> bool:
        """True where both sides are equal, and rounding to whole lines can have added what it has: else lines were not fired."""
        possible = self.most_rounding is None or abs(self.rounding) <= self.most_rounding
        return possible and self.emitted + self.rounding == self.absorbed + self.escaped + self.lost

    def powers(self) -> dict:
        """The columns in W or lm, and ``closes``."""
        return {name: getattr(self, name) * self.watts for name in self.COLUMNS} | {"closes": self.closes}


def by_difference(emitted: float, absorbed: float, escaped: float, lost: float) -> dict:
    """The energy balance of a method that does not carry power line by line.

    The residual is the error of the method (of form factors, or statistical). It is shown as rounding, and ``closes`` is None.
    """
    rounding = absorbed + escaped + lost - emitted
    return {"emitted": emitted, "rounding": rounding, "absorbed": absorbed, "escaped": escaped, "lost": lost, "closes": None}


def exact_totals(rows: np.ndarray, weight: np.ndarray) -> tuple[int, int]:
    """Return the sum of (k, n) unsigned integers, and the sum of their products with (n,) uint32, without overflow."""
    total = weighted = 0
    for part in pieces(rows.shape[1]):
        low, high = exact_columns(rows[:, part])
        total += exact_sum(low) + (exact_sum(high) << 32)
        weighted += exact_dot(low, weight[part]) + (exact_dot(high, weight[part]) << 32)
    return total, weighted


def signed_totals(rows: np.ndarray, weight: np.ndarray) -> tuple[int, int]:
    """Return the totals of `exact_totals` for signed integers of 64 bits."""
    total = weighted = 0
    for part in pieces(rows.shape[1]):
        columns = np.zeros((2, part.stop - part.start), np.int64)  # sums of low and of high halves
        for row in rows[:, part]:
            columns += row & 0xFFFFFFFF, row >> 32
        for shift, column in zip((0, 32), columns, strict=True):
            for sign in (1, -1):
                one = np.maximum(sign * column, 0)
                total += sign * exact_sum(one) << shift
                weighted += sign * exact_dot(one, weight[part]) << shift
    return total, weighted


def exact_dot(long: np.ndarray, short: np.ndarray) -> int:
    """Return the sum of uint64 times uint32 without rounding or overflow, by 16-bit limbs."""
    long, short = np.asarray(long, np.uint64).ravel(), np.asarray(short, np.uint64).ravel()
    limb, total = np.uint64(0xFFFF), 0
    for i in range(4):
        a = (long >> np.uint64(16 * i)) & limb
        if a.any():
            for j in range(2):
                total += int(np.dot(a, (short >> np.uint64(16 * j)) & limb)) << (16 * (i + j))
    return total


def exact_sum(values: np.ndarray) -> int:
    """Return the sum of unsigned integers of up to 64 bits without overflow."""
    values = np.asarray(values)
    if values.dtype.itemsize <= 4:
        return int(values.sum(dtype=np.uint64))
    values = values.astype(np.uint64, copy=False).ravel()
    return int((values & np.uint64(0xFFFFFFFF)).sum()) + (int((values >> np.uint64(32)).sum()) << 32)


def exact_columns(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the sums of columns of unsigned integers without overflow, of their low and of their high 32 bits, uint64 each."""
    low, high = np.zeros((2, rows.shape[1]), np.uint64)
    for row in rows:
        low += row & np.uint32(0xFFFFFFFF)
        if row.dtype.itemsize > 4:
            high += row >> np.uint64(32)
    return low, high
