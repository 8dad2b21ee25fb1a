"""Scores: the power that lines of a shot bring, summed in 64-bit fixed point, so no sum depends on an order or on threads.

A line scores where it hits, or at both of its ends, and other slots than these may receive that power.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr

from ..patches.bases import Basis
from .moments import Moments


@dataclass(frozen=True)
class Ends:
    """The score at both ends of a line from i to j: ``carried_i`` / (``density_i`` + ``density_j``) at j.

    The score at i is ``carried_j`` over the same sum.

    Attributes:
        density: (slots,) Float, expected lines of each patch by its area, any unit; positive where it fires; 0 behind patches.
        carried: (slots * n_columns,) Float, the power by area, in fixed point units times the unit of density; 0 behind patches.
        groups: how many groups of bands it has; None: those of the shooter.
    """

    density: Any
    carried: Any
    groups: int | None = None


@dataclass(frozen=True)
class Receivers:
    """Slots that receive what lines bring, where these are not those that lines hit.

    Attributes:
        size: the number of slots, those of the tracer first.
        of: called in kernels with the patch number that sends and the slot that a line hit: the slot that receives.
    """

    size: int
    of: Callable[[Any, Any], Any]


@dataclass(frozen=True)
class Load:
    """What the lines of a shot carry, and where they bring it.

    Attributes:
        weights: (total * n_groups,) Int32 or Int64, what each line of a patch number adds to the slot that it hits; with a basis
            of more functions (total * n_columns,) Float, the coefficients of a polynomial.
        ends: what lines add at both ends, in place of ``weights``.
        receivers: what receives, where it is not what lines hit; without polynomials.
    """

    weights: Any = None
    ends: Ends | None = None
    receivers: Receivers | None = None


class Scores:
    """What slots received of one shot.

    Attributes:
        groups: of bands; 0: no power is counted.
        basis: of the light on patches.
        received: (slots * n_columns,) Int64; of all receivers where the shot has them. A slot has a column for each group of
            bands, or with a basis of K functions K columns for each: the power times each function, summed.
        moved: (slots * n_columns,) Int64, where the shot has receivers what other slots received than those that lines hit, by
            the slots that they hit.
    """

    def __init__(self, types: Any, total: int, slots: int, groups: int, basis: Basis):
        self.types, self.total, self.slots, self.groups, self.basis = types, total, slots, groups, basis
        self.received: Any = dr.opaque(types.Int64, 0, slots * groups * basis.size) if groups else None
        self.moved: Any = None

    def _groups(self, load: Load) -> int:
        return self.groups if load.ends is None or load.ends.groups is None else load.ends.groups

    def sizes(self, load: Load) -> tuple[int, int]:
        """Return the numbers of entries of ``received`` and ``moved`` for such a shot."""
        slots = self.slots if load.receivers is None else load.receivers.size
        moved = self.slots * self._groups(load) if load.receivers else 0
        return slots * self._groups(load) * self.basis.size, moved

    def begin(self, load: Load) -> None:
        """Set all scores to zero, for a new shot."""
        if self.groups:
            size, moved = self.sizes(load)
            self.received = dr.opaque(self.types.Int64, 0, size)
            self.moved = dr.opaque(self.types.Int64, 0, moved) if load.receivers else None

    def add(self, load: Load, number, landed, real, mode: dr.ReduceMode) -> None:
        """Add what lines of patch numbers bring to the slots where they landed; called in a kernel, with a constant basis.

        Args:
            real: which lines count.
        """
        types, ends, receivers = self.types, load.ends, load.receivers
        to, back_to = landed, number
        if receivers is not None:
            to = receivers.of(number, landed)
            if ends is not None:  # behind patches nothing sends back
                back_to = receivers.of(dr.select(landed < self.total, landed, number), number)
        for g in range(self.groups):
            here, there = number * self.groups + g, landed * self.groups + g
            gets, gets_back = to * self.groups + g, back_to * self.groups + g
            if ends is None:
                weight = dr.gather(type(load.weights), load.weights, here)
                self._add(types.Int64(weight), gets, there, real, mode)
                continue
            both = dr.gather(types.Float, ends.density, number) + dr.gather(types.Float, ends.density, landed)
            forth, back = (dr.gather(types.Float, ends.carried, at) / both for at in (here, there))
            self._add(types.Int64(dr.round(forth)), gets, there, real, mode)
            self._add(types.Int64(dr.round(back)), gets_back, here, real, mode)

    def add_moments(self, load: Load, number, lines, real, mode: dr.ReduceMode) -> None:
        """Add what lines (see `traced`) bring to moments; called in a kernel, with a basis of more functions."""
        landed, begin, end = lines
        moments = Moments(self.basis, self._groups(load), self.total, self.types)

        def add(value, column, counts):
            self._add(value, column, column, real & counts, mode)

        if load.ends is None:
            moments.forth(load.weights, number, landed, begin, end, add)
        else:
            moments.both(load.ends, number, landed, begin, end, add)

    def _add(self, value, index, hit, real, mode) -> None:
        """Add a power to what a column receives, and note it where a line hit another one."""
        dr.scatter_add(self.received, value, index, active=real, mode=mode)
        if self.moved is not None:
            dr.scatter_add(self.moved, value, hit, active=real & (index != hit), mode=mode)
