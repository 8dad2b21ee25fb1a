"""Gather: every patch fires shadow rays to the lamps, and cosine lines that read the radiosity where they hit.

The first cosine lines of each patch are stored, and the equation among patches is solved along them (`rows`). Later lines read
that solution. From time to time it is corrected: what all lines so far say, less what they read, is the residual of a system that
is solved along the stored lines again (iterative refinement). So the result tends to the solution by all lines, and the state
after N is a function of the seed and N alone.
"""

from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import frozen, upload
from ...errors import MethodError
from ...patches.bases import BASES
from ...sampling.blocks import BLOCK
from ...sampling.streams import Purpose
from ...tally.wraps import Wraps
from ...tracing.coherent_costs import fewest_lines
from ..base import AbstractAlgorithm, Interrupted, Swept
from ..state import Arrays, Sizes
from .chances import Chances
from .correction import Correction
from .elsewhere import AbstractLinesElsewhere, GatherLines
from .lane_scatter import LaneScatter
from .lines import Lines
from .near import Near
from .packets import Packets
from .pilot import LINES, Pilot
from .reading import Reading
from .shares import Shares
from .smooth import SmoothTally
from .state import GatherState
from .stored_lines import StoredLines
from .sums import Sums
from .tally import GatherTally

SLICE = 1 << 22  # lines of a slice: between slices a run can be interrupted
APART = 1 << 24  # lines of a patch between two looks at sums, where they are very many


class Gather(AbstractAlgorithm[GatherState]):
    """Runs shadow rays and cosine lines. ``quanta`` is the number of lines of a replicate."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        if self.geometry.some_backs_pass:
            raise MethodError(
                f"{self.problem.patches.scene.source}: some backs let lines pass, so what a patch sees is not what sees the "
                "patch; method gather needs both to be equal: take --method random-walk"
            )
        coherent = fewest_lines(self.method, self.geometry.device.name) is not None
        self.packets = Packets(self.geometry, self.replicates, coherent)
        self.chances = Chances.of(self.geometry, self.problem)
        self.types: Any = self.packets.types
        self.basis = BASES[self.method.basis]
        self._quanta, self._done = 0, 0
        self._shares: Shares | None = None
        self._lines: Lines | None = None
        self.elsewhere: AbstractLinesElsewhere | None = None  # traces cosine lines and shadow rays elsewhere; None: here

    @property
    def sizes(self) -> Sizes:
        return Sizes(self.replicates, self.packets.n, self.columns)  # lights without area are no patches, and gather nothing

    @property
    def quanta(self) -> int:
        return self._quanta

    @property
    def stage_independent(self) -> bool:
        return True

    @property
    def tally(self) -> GatherTally | SmoothTally:
        plain = GatherTally(Near.of(self.chances), self.basis)
        return SmoothTally(plain) if self.method.reconstruction == "smooth" else plain

    @property
    def groups(self) -> int:
        return self.problem.groups.n_groups

    @property
    def columns(self) -> int:
        """The number of sums of a patch: K coefficients of each group of bands (`moments`)."""
        return self.groups * self.basis.size

    def quanta_for(self, lines: float) -> int:
        return max(round((lines - LINES * self.packets.n) / self.replicates), 1)

    def _begin(self) -> None:
        """Run the pilot, and make the sums."""
        types = self.types
        self._shares = Pilot.of(self.geometry, self.problem, self.chances, self.method, self.seed).shares
        self._lines = self.lines()
        self._scatter = LaneScatter.of_lanes(self.packets, self.problem.groups.scatter, self.basis.size)
        kinds = self._lines.shadow_kind, types.Int64
        self._brought, self._met = (Sums(self.packets, kind, self.columns) for kind in kinds)
        self._reading = Reading.nothing(types.Float, self.packets.lanes, self.columns, self.replicates)
        self._missed = [dr.zeros(types.UInt32, self.packets.lanes) for _ in range(2)]
        self._missed_upper, self._unseen = [Wraps(types) for _ in range(2)], 0
        self._stored = StoredLines(self.packets, self.basis)

    def lines(self) -> Lines:
        """Return what traces its lines."""
        purposes = (Purpose.NUMBERS, Purpose.SHADOW_RAYS)
        return Lines.of(self.packets, self.chances, self.problem, self.method, self.seed, purposes, self.basis)

    def advance(self, quanta: int, swept: Swept) -> None:
        told = 0
        if self._shares is None:
            self._begin()
            told = LINES * self.packets.n
        shares = self._shares
        assert shares is not None
        self._quanta = quanta
        corrections = shares.corrections(quanta)
        more = 1 if self.elsewhere is None else self.elsewhere.slices
        while self._done < quanta:
            step = max(more * SLICE * max(dr.thread_count() // 2, 1) // self.replicates, 1)
            end = min([quanta, self._done + step, *(at for at in corrections if at > self._done)])
            told += self._trace(shares, end)
            self._done = end
            if end in corrections:
                self._met, self._reading = self._corrected(shares)
            swept(told)
            told = 0
            if self.elsewhere is not None and self.elsewhere.over:
                raise Interrupted("interrupted")

    def _trace(self, shares: Shares, quanta: int) -> int:
        """Trace the lines up to N, and return their number."""
        lines = self._lines
        assert lines is not None
        before = shares.counts(self._done) if self._done else np.zeros_like(shares.counts(0))
        more = shares.counts(quanta) - before
        if more[1].any():
            self._shadow(lines, before[1], more[1])
        if more[0].any():
            storing = self._done < shares.stored_quanta
            if storing:
                self._stored.make_room(int((before + more)[0].max()))
                self._add_cosine(*lines.cosine(before[0], more[0], None, self._stored))
            else:
                self._cosine(lines, before[0], more[0])
        dr.eval(self._brought.low, self._met.low, self._missed)
        self._unseen += int(more.max())
        if self._unseen > APART:
            self._look(int((before + more).max()))
        return int((more * self.packets.sizes).sum()) * self.replicates

    def _shadow(self, lines: Lines, before: np.ndarray, more: np.ndarray) -> None:
        """Trace shadow rays, from these counts of each packet on."""
        sent = GatherLines("shadow", before, more)
        if not self._pays(sent):
            self._brought.add(lines.shadow(before, more))
            return
        assert self.elsewhere is not None
        for sums in self.elsewhere.trace(sent):
            self._brought.add([upload(lines.shadow_kind, column) for column in sums[0]])

    def _cosine(self, lines: Lines, before: np.ndarray, more: np.ndarray) -> None:
        """Trace cosine lines that are not stored, from these counts of each packet on."""
        if not self._pays(GatherLines("cosine", before, more)):
            self._add_cosine(*lines.cosine(before, more, self._reading.reflected))
            return
        assert self.elsewhere is not None
        read = [frozen(column) for column in self._reading.reflected]
        for met, missed in self.elsewhere.trace(GatherLines("cosine", before, more, read)):
            whole = ((self.types.Int64, met), (self.types.UInt32, missed))
            self._add_cosine(*([upload(kind, column) for column in columns] for kind, columns in whole))

    def _add_cosine(self, met: list, missed: list) -> None:
        self._met.add(met)
        self._missed = [total + more for total, more in zip(self._missed, missed, strict=True)]

    def _pays(self, lines: "GatherLines") -> bool:
        """Return whether lines are to be traced elsewhere."""
        return self.elsewhere is not None and lines.total(self.packets.sizes) * self.replicates >= self.elsewhere.least

    def _look(self, most: int) -> None:
        """Set apart what sums cannot hold much longer, where a patch has ``most`` lines."""
        self._unseen = 0
        for upper, missed in zip(self._missed_upper, self._missed, strict=True):
            upper.look(missed)
        if most >= BLOCK:
            self._brought.set_apart()
            self._met.set_apart()

    def _corrected(self, shares: Shares) -> tuple[Sums, Reading]:
        """Return sums of cosine lines, and what they read, corrected."""
        assert self._lines is not None
        correction = Correction(self.packets, shares, self._stored, self._scatter, self.basis, self.groups, self._lines.unit)
        return correction.of(self._done, self._brought, self._met, self._reading)

    # ---- states ----------------------------------------------------------------------------------------------------

    def capture(self) -> GatherState:
        packets, shares = self.packets, self._shares
        if shares is None or not self._done:
            return GatherState.empty(self.sizes, self._quanta)
        met, reading = self._met, self._reading
        if self._done < shares.stored_quanta and self._done == self._quanta:
            met, reading = self._corrected(shares)
        counts = [upper.values(count) for upper, count in zip(self._missed_upper, self._missed, strict=True)]
        missed = np.stack([packets.patch_values(count) for count in counts])
        of_packets = (*shares.counts(self._done), shares.stored(self._done))
        kind = np.uint64 if max(int(count.max()) for count in of_packets) >= BLOCK else np.uint32
        cosine, rays, stored = (np.repeat(count, packets.sizes)[packets.place].astype(kind) for count in of_packets)
        (brought, brought_upper), (met_words, met_upper) = self._brought.read(), met.read()
        by_patch = self._by_patch
        halves = np.stack([by_patch(reading.halves[at : at + self.columns]) for at in (0, self.columns)])
        return GatherState(
            sizes=self.sizes,
            quanta=self._quanta,
            done=self._done,
            cosine=cosine,
            rays=rays,
            stored=stored,
            brought=brought,
            met=met_words,
            brought_upper=brought_upper,
            met_upper=met_upper,
            reflected=by_patch(reading.reflected),
            halves=halves,
            first_bias=by_patch(reading.first),
            bias_left=by_patch(reading.left),
            missed=missed,
            unsolved=reading.missing,
        )

    def _by_patch(self, columns: list) -> np.ndarray:
        """Return values of lanes, of each column, as (replicates, n_patches, columns)."""
        return np.stack([self.packets.patch_values(frozen(one)) for one in columns], axis=-1)

    def _by_lane(self, kind, values: np.ndarray) -> list:
        """Return the inverse of `_by_patch`."""
        return [upload(kind, self.packets.lane_values(values[..., column])) for column in range(self.columns)]

    def read(self, arrays: Arrays, sizes: Sizes) -> GatherState:
        if GatherState.lacking(arrays, sizes):
            raise MethodError("the solution to go on from lacks the sums of its gather; start anew")
        return GatherState.read(arrays, sizes)

    def restore(self, state: GatherState) -> None:
        self._begin()
        shares, lines, types = self._shares, self._lines, self.types
        assert shares is not None
        assert lines is not None
        self._quanta, self._done = state.quanta, state.done
        if not state.done:
            return
        stored = shares.stored(state.done)
        self._stored.make_room(int(stored.max()))
        again, missed = lines.cosine(np.zeros_like(stored), stored, keep=self._stored)
        self._brought.write(state.brought, state.brought_upper)
        if state.done < shares.stored_quanta:  # lines read nothing yet; what `capture` added is found again
            self._met.low, self._missed = [types.Int64(value) for value in again], missed
            return
        self._met.write(state.met, state.met_upper)
        halves = [value for half in state.halves for value in self._by_lane(types.Float, half)]
        reflected, first, left = (self._by_lane(types.Float, x) for x in (state.reflected, state.first_bias, state.bias_left))
        lanes = [self.packets.lane_values(count) for count in state.missed]
        self._missed = [upload(types.UInt32, upper.of(x)) for upper, x in zip(self._missed_upper, lanes, strict=True)]
        self._reading = Reading(reflected, halves, first, left, state.unsolved)
