"""Random walks that shoot: particles leave the lights, land, and go on or end there.

Continuous: S. N. Pattanaik and S. P. Mudur, "Computation of global illumination by Monte Carlo simulation of the particle model
of light", 3rd Eurographics Workshop on Rendering, 1992. Discrete: M. Sbert 1997. What a landing scores is the estimator's choice.
"""

from dataclasses import replace
from typing import Any

import drjit as dr

from ...device.recorded import loop
from ...errors import MethodError
from ...tally.hits import HitCounts
from ...tally.landings import DENSE
from ...tracing.lanes import Batch, Chunk
from ...tracing.line_tracer import LineTracer
from ..process import AbstractTally, State
from .births import Births
from .density import DensityTally
from .flock import Flock, Legs
from .fractions import Fractions
from .launches import AbstractLaunches
from .scores import Scores
from .tally import WalkTally

FEW = 1 << 12  # particles that are followed to their ends at once: the sums are the same


class Walks(AbstractLaunches):
    """Walks of local lines that score where they land."""

    def _prepare(self) -> None:
        method = self.method
        if method.absorption == "fractional":  # walk n takes point n, its birth patch too: patches have no points of their own
            method = replace(method, randomisation="shared")
        self.tracer = LineTracer.of(self.geometry, method.numbers, method.randomisation, self.seed, self.replicates)
        self.hits = HitCounts(self.tracer)
        self.types = self.tracer.types
        self.legs = Legs(self.tracer, continuous=self.method.equation == "continuous")
        self.births = Births.of_power(self.problem, self.seed, self.replicates)
        self.fractions = Fractions.of(self.tracer, self.problem) if self.method.absorption == "fractional" else None
        self.scores = Scores(self.tracer, self.problem, self.method)

    @property
    def nested(self) -> bool:
        return self.fractions is None

    def _births(self, before: int, quanta: int) -> tuple[Batch | None, int]:
        if self.fractions is not None:
            return self.fractions.batch(before, quanta)
        return self.births.batch(self.tracer, before, quanta)

    def _follow(self, chunk: Chunk, largest: int) -> int:
        types, leg, lines, bits = self.types, 1, chunk.lanes, self.tracer.numbers.bits_for(largest)
        number, index, record = chunk.read(types)
        if self.fractions is not None:
            number, record = self.fractions.birthplace(number, index, bits)
        weights = self.scores.born(number)
        self.scores.count_fired(weights, chunk.lanes, chunk.real(types))
        step = self.legs.first(number, index, record, bits)
        flock, alive = self._settle(Flock(number, index, (), weights), step, chunk.real(types), 1, chunk.width)
        while True:
            rows = dr.compress(alive)
            if dr.width(rows) == 0:
                return lines
            flock = flock.at(rows)
            if self.fractions is None and (flock.size <= FEW or self.method.order == "depth-first"):
                return lines + self._to_the_end(flock, leg)
            lines += flock.size
            self.scores.count_fired(flock.weights, flock.size)
            number = dr.opaque(types.UInt32, leg, flock.size)
            step = self.legs.later(flock, number)
            leg += 1
            flock, alive = self._settle(flock, step, True, leg, flock.size)

    def _settle(self, flock: Flock, step, real, leg: int, width: int) -> tuple[Flock, Any]:
        """Score landings and decide who goes on, in a kernel of its own."""
        mode = dr.ReduceMode.Expand if width > DENSE * self.tracer.total else dr.ReduceMode.Direct
        after, alive = self._landed(flock, step, real, leg, mode)
        dr.eval(self.hits.arrivals, *self.scores.arrays(), alive, after.columns())
        return after, alive

    def _landed(self, flock: Flock, step, real, leg, mode) -> tuple[Flock, Any]:
        tracer, types = self.tracer, self.types
        on = real & (step.landed < tracer.total)
        patch = step.landed - tracer.replicate(flock.walk) * tracer.n_opaque
        probability = dr.gather(types.Float, self.scores.survival, patch, on)
        if self.fractions is None:
            alive = on & (step.numbers[4] < probability)
        else:
            alive = on & (probability > 0) & self.fractions.go_on(flock.index, leg)
        self.hits.add(step.landed, real, mode)
        self.scores.deposit(flock.weights, step.landed, patch, probability, alive, real, mode)
        factor = None if self.fractions is None else self.fractions.factor(leg)
        weights = self.scores.reflected(flock.weights, patch, on, factor)
        return Flock(flock.walk, flock.index, step.place, weights), alive

    def _to_the_end(self, flock: Flock, leg: int) -> int:
        """Follow particles in one symbolic loop: how many lines they took."""
        types, size = self.types, flock.size
        going = dr.arange(types.UInt32, max(size, 2)) < dr.opaque(types.UInt32, size)
        flock = flock if size > 1 else flock.at(dr.zeros(types.UInt32, 2) + dr.opaque(types.UInt32, 0))
        lines = dr.zeros(types.UInt32, dr.width(going))
        sums = tuple(dr.zeros(types.UInt64, dr.width(going)) for _ in flock.weights)

        def body(columns, leg, lines, sums, going):
            here = flock.having(columns)
            sums = tuple(s + dr.select(going, fixed, 0) for s, fixed in zip(sums, self.scores.fixed(here.weights), strict=True))
            step = self.legs.later(here, leg)
            after, alive = self._landed(here, step, going, leg + 1, dr.ReduceMode.Direct)
            # places of those that ended are kept as they were: what lies beyond the patches has no record
            kept = [dr.select(alive, new, old) for new, old in zip(after.columns(), columns, strict=True)]
            return tuple(kept), leg + 1, lines + dr.select(going, types.UInt32(1), types.UInt32(0)), sums, alive

        state = (flock.columns(), dr.opaque(types.UInt32, leg, dr.width(going)), lines, sums, going)
        _, _, lines, sums, _ = loop(state, lambda columns, leg, lines, sums, going: going, body)
        total = dr.sum(types.UInt64(lines))
        parts = [dr.sum(s) for s in sums]
        dr.eval(self.hits.arrivals, *self.scores.arrays(), total, parts)
        took = int(total[0])
        if self.scores.carries:
            self.scores.add_fired([int(part[0]) for part in parts])
        else:
            self.scores.count_fired((), took)
        return took

    def _counts(self) -> State:
        arrivals, missed = self.hits.read()
        return {"arrivals": arrivals, "missed": missed} | self.scores.capture()

    def _put_back(self, state: State) -> None:
        if not {"quanta", "arrivals", "missed"} <= set(state) or state["arrivals"].shape != (self.replicates, self.tracer.n):
            raise MethodError("the solution to go on from lacks the counts of its run; start anew")
        self.hits.write(state["arrivals"], state["missed"])
        self.scores.restore(state)

    @property
    def tally(self) -> AbstractTally:
        counted = WalkTally(self.method.estimator == "collision", self.fractions is not None)
        return DensityTally(counted) if self.method.reconstruction == "local-linear" else counted
