"""Stored lines as rows of form factors: where each line hits is known, so the equation among patches can be solved.

The first lines of every patch are kept. With F' the share of them that hits each patch, x = r + rho F' x is solved by Jacobi
iterations: a sparse system of each replicate, which nothing is traced for. With a basis x are coefficients, and F' has
moments of the functions at both ends of the lines.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import small, upload
from ...device.recorded import loop
from .fit import Fit
from .lane_scatter import LaneScatter
from .moments import light_at
from .packets import Packets
from .stored_lines import StoredLines

WHOLE = 2.0**48  # fixed point units of sums of power: values are below 2^14
LONGEST = 400  # iterations
CHECKED = 4  # iterations between two looks at the change
SLOWEST = 0.98  # largest factor that is believed


@dataclass(frozen=True, eq=False)
class Rows:
    """Stored lines of all lanes.

    Attributes:
        packets: the lanes.
        lines: where they hit.
        stored: UInt32 (lanes,), the stored lines of each lane.
        scatter: what lanes send on of the light that they receive.
    """

    packets: Packets
    lines: StoredLines
    stored: Any
    scatter: LaneScatter
    _fits: dict = field(default_factory=dict)

    def means(self, values: list, half: int | None = None) -> list:
        """Return the mean over the stored lines of values where they hit, of each column; or over the first or second half.

        With a basis of K functions columns are coefficients, K of each group: polynomials are read where lines hit, and their
        moments are means where lines leave; those after the first are covariances (`Fit.centred`).
        """
        packets, types, basis = self.packets, self.packets.types, self.lines.basis
        UInt32, Float = types.UInt32, types.Float
        lane, replicate, _, _ = packets.read()
        base, lanes = replicate * packets.width_on_device, dr.opaque(UInt32, packets.lanes)
        begin_at, end_at = self._range(half)
        share = dr.rcp(Float(dr.maximum(end_at - begin_at, 1)))
        dr.eval(begin_at, end_at, share)

        def body(number, *sums):
            where = dr.gather(UInt32, self.lines.hits, number * lanes + lane)
            there = where < packets.width_on_device
            met = [dr.gather(Float, value, base + where, there) for value in values]
            if basis.size > 1:
                begin, end = self.lines.spots(number * lanes + lane)
                functions = basis.functions(begin.a, begin.b, begin.select)
                met = [value * function for value in light_at(basis, end, met) for function in functions]
            return (number + 1, *(total + value for total, value in zip(sums, met, strict=True)))

        state = (UInt32(begin_at), *(dr.zeros(Float, packets.lanes) for _ in values))
        _, *sums = loop(state, lambda number, *sums: number < end_at, body)
        moments = [total * share for total in sums]
        if basis.size == 1:
            return moments
        fit, size = self._fit(half), basis.size
        return [one for at in range(0, len(moments), size) for one in fit.centred(moments[at : at + size])]

    def _range(self, half: int | None) -> tuple[Any, Any]:
        """Return the first of the stored lines that count, and the first that does not."""
        none, middle = self.stored * 0, self.stored >> 1
        return {None: (none, self.stored), 0: (none, middle), 1: (middle, self.stored)}[half]

    def _fit(self, half: int | None) -> Fit:
        if half not in self._fits:
            begin, end = self._range(half)
            dr.eval(begin, end)
            self._fits[half] = Fit.of(self.lines, begin, end)
        return self._fits[half]

    def _fitted(self, means: list, half: int | None) -> list:
        """Return the columns of polynomials from `means`."""
        size = self.lines.basis.size
        if size == 1:
            return means
        fit = self._fit(half)
        return [one for at in range(0, len(means), size) for one in fit.polynomial(means[at : at + size])]

    def solve(self, right: list, tolerance: "float | np.ndarray", start: list | None = None, half: int | None = None):
        """Return x = r + rho F' x of each column, along all stored lines or half of them; and what is missing in each replicate.

        A Jacobi iteration takes longest for the even part of the light. So after some, a multiple of the reflectance is added,
        which makes the power of all areas balance. Where changes fall by a factor q from one iteration to the next, what is
        missing is about q / (1 - q) times the last change.

        Args:
            right: of each column, (lanes,) Float.
            tolerance: of all replicates or of each, (replicates,) float: iterations end once about no more than this is missing
                anywhere in a replicate. Each ends for itself, so that replicates do not depend on each other.
            start: the first iterate; ``right`` by default.
        """
        found, before = list(right if start is None else start), np.full(self.packets.replicates, np.inf)
        open_, missing = np.ones(self.packets.replicates, bool), np.zeros(self.packets.replicates)
        for iteration in range(1, LONGEST + 1):
            met = self._fitted(self.means(found, half), half)
            new = [one + sent for one, sent in zip(right, self.scatter.of(met), strict=True)]
            if iteration % CHECKED == CHECKED - 3:
                new = [one for group, even in enumerate(self.even) for one in self._balanced(new, found, group, *even)]
            if not open_.all():
                goes_on = self._of_replicates(open_) != 0
                new = [dr.select(goes_on, value, old) for value, old in zip(new, found, strict=True)]
            dr.eval(new)
            if iteration % CHECKED in (CHECKED - 1, 0):
                change = np.max([self._largest(dr.abs(a - b)) for a, b in zip(new, found, strict=True)], axis=0)
                if iteration % CHECKED == CHECKED - 1:
                    before = change
                else:
                    factor = np.minimum(change / np.maximum(before, 1e-300), SLOWEST)
                    missing = np.where(open_, change * factor / (1 - factor), missing)
                    open_ &= missing > tolerance
                    if not open_.any():
                        return new, missing
            found = new
        return found, missing

    def _largest(self, values) -> np.ndarray:
        """Return the largest value of each replicate, (replicates,) float64."""
        return np.array(dr.block_reduce(dr.ReduceOp.Max, values, self.packets.width), np.float64)

    def _of_replicates(self, flags: np.ndarray):
        """Return the flag of each replicate, 0 or 1, for each of its lanes."""
        _, replicate, _, _ = self.packets.read()
        return dr.gather(self.packets.types.UInt32, small(self.packets.types.UInt32, flags.astype(np.uint32)), replicate)

    @cached_property
    def even(self) -> list:
        """Return, of each group, what an iteration makes of light like the reflectance, and by how much less power it is."""
        found, flat = [], [dr.zeros(self.packets.types.Float, self.packets.lanes) for _ in range(self.lines.basis.size - 1)]
        for group, albedo in enumerate(self.scatter.albedo):
            again = self.scatter.of(self._fitted(self.means([albedo, *flat]), None), group)
            less = self._power(albedo - again[0])
            dr.eval(again, less)
            found.append((again, less))
        return found

    def _balanced(self, new: list, old: list, group: int, again: list, less) -> list:
        """Return the columns of a group of an iterate, with as much even light more as makes its power balance."""
        _, replicate, _, _ = self.packets.read()
        first, size = group * self.lines.basis.size, self.lines.basis.size
        wanted = self._power(new[first] - old[first])
        factor = dr.select(less > 0, wanted / dr.maximum(less, 1e-30), 0)
        more = dr.gather(self.packets.types.Float, factor, replicate)
        return [value + one * more for value, one in zip(new[first : first + size], again, strict=True)]

    def _power(self, values):
        """Return the sum over each replicate of values times shares of the area, from whole numbers, so that no order matters."""
        types = self.packets.types
        whole = types.Int64(dr.round(types.Float64(values * self.share) * WHOLE))
        return types.Float(types.Float64(dr.block_sum(whole, self.packets.width)) / WHOLE)

    @cached_property
    def share(self):
        """Return the share of each lane's area in that of its replicate, (lanes,) Float."""
        _, _, place, patch = self.packets.read()
        types, area = self.packets.types, self.packets.patches.area
        shares = upload(types.Float, (area / area.sum()).astype(np.float32))
        found = dr.gather(types.Float, shares, patch, place < dr.opaque(types.UInt32, self.packets.n))
        dr.eval(found)
        return found
