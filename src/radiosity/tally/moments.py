"""Moments of a basis: what a line adds where it hits, as polynomials of the places where it begins and ends; called in kernels.

A line that leaves place x of patch i carries the polynomial of i at x, a weight that may be negative. At place y of patch j it
adds that weight times phi_k(y) to moment k of j. Lines of one patch begin at uniform places, so the mean of what they bring is
what the polynomial sends. Moments are summed as whole numbers, so no sum depends on an order or on threads.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr

from ..patches.bases import Basis
from ..tracing.spots import Spot

Add = Callable[[Any, Any, Any], None]


@dataclass(frozen=True)
class Moments:
    """Adds of lines to moments. Columns of a slot are group by group, the K functions of a basis in each.

    Attributes:
        basis: with more than one function.
        groups: how many groups of bands there are.
        total: slots below this are patches; behind them only the first moment counts.
        types: of the device.
    """

    basis: Basis
    groups: int
    total: int
    types: Any

    def forth(self, weights, number, landed, begin: Spot, end: Spot, add: Add) -> None:
        """Add what lines bring to where they end.

        Args:
            weights: Float, the polynomial that a line of each patch number carries, K coefficients a group.
            add: takes whole numbers, their columns, and where they count.
        """
        here, there = self._functions(begin), self._functions(end)
        for group in range(self.groups):
            self._add(self._value(weights, number, group, here), landed, group, there, add)

    def both(self, ends, number, landed, begin: Spot, end: Spot, add: Add) -> None:
        """Add what lines bring to both their ends; see `tally.scores.Ends`, whose ``carried`` has K coefficients a group."""
        Float = self.types.Float
        here, there = self._functions(begin), self._functions(end)
        both = dr.gather(Float, ends.density, number) + dr.gather(Float, ends.density, landed)
        beyond = [there[0], *(dr.select(landed < self.total, value, 0) for value in there[1:])]  # of slots that are no patches
        for group in range(self.groups):
            forth = self._value(ends.carried, number, group, here) / both
            back = self._value(ends.carried, landed, group, beyond) / both
            self._add(forth, landed, group, there, add)
            self._add(back, number, group, here, add)

    def _functions(self, spot: Spot) -> list:
        return self.basis.functions(spot.a, spot.b, spot.select)

    def _value(self, coefficients, number, group: int, functions: list):
        first = (number * self.groups + group) * len(functions)
        return sum(dr.gather(self.types.Float, coefficients, first + k) * value for k, value in enumerate(functions))

    def _add(self, value, slot, group: int, functions: list, add: Add) -> None:
        first = (slot * self.groups + group) * len(functions)
        for k, function in enumerate(functions):
            add(self.types.Int64(dr.round(value * function)), first + k, True if k == 0 else slot < self.total)
