"""One stochastic Jacobi step: patches send powers along local lines, and patches receive them.

Lights without area are rows after the patches, as in `LineTracer`: they send what they emit, and receive nothing.

The number of lines of a patch is its expectation c_i, rounded systematically: with offset r, uniform in [0, 1), patch i fires
floor(C_i + r) - floor(C_(i-1) + r) lines, where C_i is the sum of expectations up to it. Each count is one of the two whole
numbers next to c_i, and its mean is c_i.
"""

import math
from collections.abc import Callable
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import frozen, small, upload
from ...errors import MethodError
from ...method import Method
from ...patches.bases import BASES
from ...problem.model import Problem
from ...problem.quanta import Source
from ...sampling.streams import Purpose, Seed, stream
from ...tally.scores import Ends, Receivers
from ...tally.shooter import Shooter
from ...tracing.geometry import Geometry
from ..state import Sizes
from .elements import Elements
from .refinement import Refinement

BITS = 30
LINE = 2**BITS  # fixed point units of one expected line
MOST = 1 << 29  # lines of a replicate in one iteration, or of its probing lines: what they carry fits in 64 bits
LEAST_UNITS = 2**12  # of a line, however important: so its power is rounded by less than 0.02 %
TURNS = 2  # sequences that steps take in turn where both ends of a line score (docs/iterations.md)


def units_of_a_quantum(importance: np.ndarray | None) -> int:
    """Return the fixed point units of a quantum: LINE, or more where lines carry less, so that each has `LEAST_UNITS` or more."""
    if importance is None:
        return LINE
    return LINE << max(math.ceil(math.log2(float(importance.max()) * LEAST_UNITS / LINE)), 0)


class Exchange:
    """Sends powers along lines, and receives them.

    Arrays over patches and columns are flat, column c of patch number m at m * n_columns + c. A group of bands has a column for
    each function of the basis: the power of a patch times the coefficient of its polynomial, the first of which is the power.

    Attributes:
        shooter: fires the lines.
        basis: of the light on patches.
        n, replicates, groups, columns, total: sizes; n counts patches and lights without area; total is n * replicates.
        area: (total,) Float64, share of each patch in the area of all.
        rho: (total * columns,) Float64, reflectance, rounded as in the firing engine.
        tau: the same of diffuse transmittance; None where nothing diffuses light.
        beyond: (total * columns,) UInt32, the entry of the other side of each; None where nothing diffuses light.
        emitted: (total * columns,) Float64, E_i A_i over Phi.
        column: (total * columns,) UInt32, replicate * n_columns + column of each entry.
        unit: fixed point units of a quantum.
        importance: (total,) Float64, LINE times the lines of a unit that leaves each patch; None: a quantum is a line everywhere.
        step: the number of steps so far: each has rounding offsets of its own.
        turns: the number of sequences of points that steps take in turn; a warm-up has as many others.
        first: the first of the sequences that are used now.
        refinement: of the lines' pairs of elements; None: lines land on patches.
        blurred: (slots * columns,) Int64, what patches received in the last step less what lines brought where they hit; None
            where lines are not refined.
    """

    def __init__(self, geometry: Geometry, problem: Problem, method: Method, seed: Seed | int, replicates: int):
        groups = problem.groups
        self.seed, self.replicates, self.groups = seed, replicates, groups.n_groups
        self.basis = BASES[method.basis]
        self.columns = self.groups * self.basis.size
        self.two_ended = method.estimator == "bidirectional"
        self.turns, self.first = TURNS if self.two_ended else 1, 0
        sequences = self.turns * (2 if self.two_ended and method.warm_up else 1)
        self.shooter = Shooter(geometry, method, seed, replicates, self.groups, sequences, self.basis, problem.lights)
        rows = problem.rows
        self.types, self.n, self.total = self.shooter.types, len(rows.area), self.shooter.total
        self.areas = rows.area / rows.area.sum()
        self.area = self._tiled(self.areas[:, None])
        self.rho = self._tiled(self._by_function(Source.fixed(rows.reflectance) * 2.0**-32))
        self.tau: Any = None
        self.beyond: Any = None
        if rows.through is not None and rows.other is not None:
            self.tau = self._tiled(self._by_function(Source.fixed(rows.through) * 2.0**-32))
            numbers = np.arange(replicates)[:, None] * self.n + rows.other
            entries = numbers.reshape(-1, 1) * self.columns + np.arange(self.columns)
            self.beyond = upload(self.types.UInt32, entries.astype(np.uint32))
        emitted = rows.emission * rows.area[:, None] / problem.source.power
        if self.basis.size > 1:  # emission is constant on a patch
            emitted = self._by_function(emitted) * (np.arange(self.columns) % self.basis.size == 0)
        self.emitted = self._tiled(emitted)
        self.importance: Any = None
        self.share_out_by(problem.shares)
        self.replicate = self.shooter.tracer.replicate(dr.arange(self.types.UInt32, self.total))
        every = np.arange(replicates)
        slots = np.concatenate([np.repeat(every, self.n), every, every])
        self.slot_replicate = upload(self.types.UInt32, np.repeat(slots, self.columns).astype(np.uint32))
        row = dr.arange(self.types.UInt32, self.total * self.columns)
        self.column = self.by_patch(self.replicate) * self.columns + row % self.columns
        dr.eval(self.replicate, self.column)
        self.refinement: Refinement | None = None
        self.blurred: Any = None
        if method.refine_lines:
            self.refinement = Refinement(Elements(self.shooter.tracer), method.refine_lines)
        self.step = 0

    def share_out_by(self, importance: np.ndarray | None) -> None:
        """Share lines out by the importance of rows, (n_rows,) float64."""
        self.unit = units_of_a_quantum(importance)
        if importance is not None:
            self.importance = self._tiled(importance[:, None] * (LINE / self.unit))

    def lines_of(self, power):
        """Return the expected lines of powers in units of a quantum / `unit`, (total,) UInt64 times LINE.

        Where lines are shared out by importance, a patch with power expects at least 1 / LINE, so that no power is left out.
        """
        largest = self.largest(power)
        if self.importance is None:
            return self.types.UInt64(largest)
        return dr.select(largest > 0, self.types.UInt64(dr.maximum(largest * self.importance, 1.0)), 0)

    def scattered(self, values):
        """Return what patches send on of received values, (total * columns,) Float64."""
        sent = self.rho * values
        if self.tau is None:
            return sent
        dr.eval(values)
        return sent + self.tau * dr.gather(self.types.Float64, values, self.beyond)

    @property
    def sizes(self) -> Sizes:
        """The sizes of states."""
        return Sizes(self.replicates, self.n, self.columns)

    def _tiled(self, values: np.ndarray):
        return upload(self.types.Float64, np.tile(values.ravel(), self.replicates))

    @staticmethod
    def needed(blurred: np.ndarray | None) -> np.ndarray:
        """Return what a state of refined lines must hold.

        Raises:
            MethodError: it does not.
        """
        if blurred is None:
            raise MethodError("the solution to go on from lacks what its elements blurred; start anew")
        return blurred

    def by_patch(self, values):
        """Spread a (total,) array over the columns."""
        return values if self.columns == 1 else dr.repeat(values, self.columns)

    def _by_function(self, values: np.ndarray) -> np.ndarray:
        """Spread (n, groups) over the columns."""
        return values if self.basis.size == 1 else np.repeat(values, self.basis.size, axis=1)

    def by_replicate(self, values: np.ndarray):
        """Spread (replicates,) float64 over patches, to (total,) Float64."""
        return dr.gather(self.types.Float64, small(self.types.Float64, values), self.replicate)

    def by_slot(self, values: np.ndarray):
        """Spread (replicates,) float64 over slots and columns."""
        return dr.gather(self.types.Float64, small(self.types.Float64, values), self.slot_replicate)

    def by_column(self, values: np.ndarray):
        """Spread (replicates, columns) float64 over patches, to (total * columns,) Float64."""
        return dr.gather(self.types.Float64, small(self.types.Float64, values), self.column)

    def largest(self, values):
        """Return the largest magnitude of the groups, from (total * columns,) to (total,).

        That of a polynomial is the root of its mean square over the patch, from all its coefficients.
        """
        if self.basis.size == 1:
            sizes = dr.abs(values)
        else:
            dr.eval(values)
            sizes = dr.sqrt(dr.block_reduce(dr.ReduceOp.Add, values * values, self.basis.size))
        return sizes if self.groups == 1 else dr.block_reduce(dr.ReduceOp.Max, sizes, self.groups)

    def sums(self, values) -> np.ndarray:
        """Return the sum of (total,) whole numbers in each replicate, (replicates,)."""
        sums = dr.block_reduce(dr.ReduceOp.Add, values, self.n)
        dr.eval(sums)
        return np.array(sums)

    def counts(self, expected):
        """Return the lines that patches fire in this step, (total,) UInt32, from their expectation in units of 1 / LINE."""
        types = self.types
        dr.eval(expected)
        before = dr.prefix_sum(expected)
        dr.eval(before)
        drawn = [np.random.Generator(np.random.Philox(self._stream(r))).integers(0, LINE) for r in range(self.replicates)]
        offset = dr.gather(types.UInt64, small(types.UInt64, drawn), self.replicate)
        low = before - dr.gather(types.UInt64, before, self.replicate * self.shooter.tracer.n_opaque) + offset
        counts = types.UInt32(((low + expected) >> BITS) - (low >> BITS))
        dr.eval(counts)
        return counts

    @property
    def turn(self) -> int:
        """The number of the sequence, among those in use now, that the next step takes."""
        return self.step % self.turns

    def begin_warm_up(self) -> None:
        """Use sequences that no later step uses, where steps take several in turn."""
        self.first = self.turns if self.turns > 1 else 0

    def end_warm_up(self) -> None:
        self.first = 0

    def shoot(self, counts, weights=None, ends: Ends | None = None, receivers: Receivers | None = None) -> int:
        """Fire the lines of a step, see `Shooter.shoot`."""
        self.shooter.sequences.take(self.first + self.turn)
        lines = self.shooter.shoot(counts, weights, ends, receivers=receivers)
        self.step += 1  # last: where the shot is stopped between two parts, the state is that before the step
        return lines

    def _stream(self, replicate: int) -> np.random.SeedSequence:
        return stream(self.seed, replicate, Purpose.ROUNDING, self.step)

    def _refined(self, power, whole, counts, weights=None, ends: Ends | None = None) -> int:
        """Fire the lines of a step to elements, where lines are refined; see `send`."""
        if self.refinement is None:
            return self.shoot(counts, weights, ends)
        self.refinement.begin(self.largest(power) / self.by_replicate(np.broadcast_to(whole, self.replicates)))
        elements = self.refinement.elements
        lines = self.shoot(counts, weights, ends, Receivers(elements.size, self.refinement.receiver))
        received, types = self.shooter.scores.received, self.types
        self.shooter.scores.received = elements.pushed(received, self.columns)
        on_patches = dr.gather(types.Int64, received, dr.arange(types.UInt32, self.shooter.slots * self.columns))
        self.blurred = self.shooter.scores.received - on_patches - self.shooter.scores.moved
        dr.eval(self.blurred)
        return lines

    def send(self, power, expected, whole: float | np.ndarray) -> tuple[int, Callable[[], np.ndarray] | None]:
        """Send powers; `Shooter.received` then holds what arrived.

        Args:
            power: (total * columns,) Float64, signed, in the units of received power; below 2^30 of them for each expected line.
            expected: (total,) UInt64, mean number of lines that patches fire, times LINE; positive where there is power.
            whole: Phi in the units of ``power``, or (replicates,) of them.

        Returns:
            Lines fired, and a function that reads the power that left each replicate in them, (replicates, groups) int64; None
            where both ends score, or lines carry polynomials.
        """
        types = self.types
        counts = self.counts(expected)
        mean = types.Float64(expected) * (1.0 / LINE)
        if self.two_ended:
            return self._refined(power, whole, counts, ends=self._ends(power, mean)), None
        # a patch that surely fires divides its power among its lines; one that may not fire sends it over its probability
        lines = dr.select(expected >= LINE, types.Float64(counts), mean)
        share = power / self.by_patch(dr.select(lines > 0, lines, 1.0))
        if self.basis.size > 1:
            return self.shoot(counts, types.Float(share)), None
        kind = types.Int if self.importance is None else types.Int64  # a line of little importance carries many quanta
        weights = kind(dr.round(share))
        dr.eval(weights)
        return self._refined(power, whole, counts, weights), lambda: self._left(weights, counts)

    def _left(self, weights, counts) -> np.ndarray:
        """Return the power that left along lines, (replicates, groups) int64."""
        types = self.types
        total = dr.opaque(types.Int64, 0, self.replicates * self.columns + 1)
        left = types.Int64(weights) * types.Int64(self.by_patch(counts))
        dr.scatter_add(total, left, self.column, mode=dr.ReduceMode.Expand)
        return frozen(total)[:-1].reshape(self.replicates, self.columns)

    def _ends(self, power, mean) -> Ends:
        types = self.types
        none = dr.zeros(types.Float, 2 * self.replicates)
        density = dr.concat([types.Float(mean / self.area), none])
        carried = dr.concat([types.Float(power / self.by_patch(self.area)), dr.repeat(none, self.columns)])
        dr.eval(density, carried)
        return Ends(density, carried)

    def patches(self, received):
        """Return the part of the patches of an array over slots and columns, (total * columns,)."""
        return dr.gather(type(received), received, dr.arange(self.types.UInt32, self.total * self.columns))
