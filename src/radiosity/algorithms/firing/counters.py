"""The firing engine's integers: hit and fired counts of every source row and replicate.

Rows, their numbers and slots are those of `LineTracer`. `due` tells which lines are due, and `fire` fires them; an order
(`orders`) decides which row fires when.

Counters have 32 bits until one of them comes near their end. From then on the engine is wide: counters have upper words
(`tally.wraps`), target counts have 64 bits, and the lines that a row fires in a wavefront lie in one block of its numbers
(`sampling.blocks`). The integers are the same as they would be with wide counters from the start.
"""

import drjit as dr
import numpy as np

from ...errors import MethodError
from ...method.model import Method
from ...problem.model import Problem
from ...problem.quanta import phases
from ...sampling.blocks import BLOCK
from ...sampling.streams import Seed
from ...tally.bands import BandTally
from ...tally.hit_counts import HitCounts
from ...tally.wraps import Wraps
from ...tracing.coherent_costs import fewest_lines
from ...tracing.geometry import Geometry
from ...tracing.lanes import sums
from ...tracing.line_tracer import LineTracer
from ...tracing.rounds import Rounds
from .elsewhere import Firer
from .targets import TargetCounts


class FiringCounters:
    """The hit and fired counts of all rows, and what is known of the lines that are due.

    Attributes:
        tracer: lines of the rows.
        problem: its ``rows`` and the scalar problem ``source``.
        targets: how many lines rows must have fired.
        hits: the hit counts.
        fired: UInt32 (total,), the fired count of each row, modulo 2^32; ``fired_upper`` has the upper words.
        quanta: N of the stage that began last.
        everywhere: True where any row may have lines due.
        landed: the slots that lines of the last wavefront hit, on the host, where these were few; else None.
        has_due: True where some row may still have to fire a line.
        firer: fires wavefronts elsewhere; None: here.
        parted: True where the last wavefront has a part of the lines that were due, or of those of a wavefront with bands.
        wide: True where 32 bits may be too few for the next wavefront.
        swept: lines of the wavefronts so far.
        rounds: which lines are traced in packets; None: none.
        unseen: at least the number of lines since counters were looked at.
    """

    def __init__(self, geometry: Geometry, problem: Problem, method: Method, seed: Seed | int, replicates: int):
        self.problem, self.source = problem, problem.source
        self.tracer = LineTracer.of(geometry, method.points, method.randomisation, seed, replicates, problem.lights)
        fewest = fewest_lines(method, geometry.device.name)
        self.rounds = None if fewest is None else Rounds.of(self.tracer, fewest)
        self.types, self.total = self.tracer.types, self.tracer.total
        self.targets = TargetCounts(self.tracer, self.source, phases(seed, replicates, self.tracer.n))
        self.fired, self.fired_upper = dr.opaque(self.types.UInt32, 0, self.total), Wraps(self.types)
        self.bands = BandTally(self.tracer, problem.rows, self.source) if problem.rows.weighed else None
        self.hits = HitCounts(self.tracer, self.bands)
        self.hits.forget_touched()
        self.landed: np.ndarray | None = None
        self.quanta = self.swept = self.unseen = 0
        self.everywhere, self.has_due, self.wide, self.parted = True, False, False, False
        self.firer: Firer | None = None

    def set_quanta(self, quanta: int) -> None:
        """Begin a stage: N for each replicate; it may only grow."""
        if quanta < self.quanta:
            raise MethodError(f"quanta may only grow within a run ({self.quanta} to {quanta})")
        self.targets.begin(quanta)
        self.quanta, self.everywhere, self.has_due = quanta, True, True
        self._widen()

    def look(self) -> None:
        """Note which counters wrapped around, and whether 32 bits suffice for the next wavefront."""
        self.hits.look()
        self.fired_upper.look(self.fired)
        if self.bands is not None:
            self.bands.look()
        self.unseen = 0
        self._widen()

    def _widen(self) -> None:
        grown = self.fired_upper.halves is not None or self.hits.upper.halves is not None
        self.wide = self.targets.much or grown
        if self.wide:
            self.tracer.blocks.prepare(self.fired_upper.largest + 1)

    def look_everywhere(self) -> None:
        """Look through all rows when lines that are due are asked for next."""
        self.everywhere, self.landed = True, None

    def counters(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return hit and fired counts, (replicates, n), and escaped and lost lines, (2, replicates): uint32, or uint64."""
        arrivals, missed = self.hits.read()
        return arrivals, self.fired_upper.values(self.fired).reshape(arrivals.shape), missed

    @property
    def lines(self) -> int:
        """The number of lines fired so far."""
        lines = sums(self.types, self.fired)[0]
        if self.fired_upper.halves is None:
            return lines
        return lines + (sums(self.types, self.fired_upper.upper(self.fired))[0] << 32)

    def rows(self):
        """Return the numbers of all rows."""
        return dr.arange(self.types.UInt32, self.total)

    def blocks(self, numbers):
        """Return the blocks of the lines that row numbers fire next; in a kernel."""
        u32, fired = self.types.UInt32, self.targets.read(self.fired, numbers)
        return self.fired_upper.upper(fired, numbers) + dr.select(fired == u32(BLOCK - 1), u32(1), u32(0))

    def target_counts_before(self, numbers):
        """Return the target counts of row numbers when the wavefront was fixed, from the hit counts that bands keep.

        It is for wavefronts that keep no counts.
        """
        assert self.bands is not None
        before = self.bands.arrivals_before
        return self.targets.after(numbers, dr.gather(self.types.UInt32, before, numbers), before)
