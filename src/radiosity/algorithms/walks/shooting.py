"""Random walks that shoot: particles leave the lights, hit patches, and go on or end there.

Continuous: S. N. Pattanaik and S. P. Mudur, "Computation of global illumination by Monte Carlo simulation of the particle model
of light", 3rd Eurographics Workshop on Rendering, 1992. Discrete: M. Sbert 1997. The estimator decides what a hit scores.
"""

from dataclasses import replace
from typing import Any

import drjit as dr

from ...device.recorded import loop
from ...errors import MethodError
from ...tally.hit_counts import HitCounts
from ...tally.hit_tally import DENSE
from ...tracing.lanes import Batch, Launch
from ...tracing.line_tracer import LineTracer
from ..base import AbstractTally
from ..state import Arrays, Sizes
from .density import DensityTally
from .fractions import Fractions
from .launches import AbstractWalks
from .particles import ParticleBank, PathSegments
from .scores import Scores
from .source_sampling import SourceSampling
from .state import WalkState
from .tally import WalkTally

FEW = 1 << 12  # so few particles are followed until they end in one kernel: the sums are the same


class Walks(AbstractWalks[WalkState]):
    """Runs walks of local lines that score where they hit."""

    def _prepare(self) -> None:
        method = self.method
        # with fractional absorption walk n takes point n, also for its first patch: patches have no points of their own
        if method.absorption == "fractional":
            method = replace(method, randomisation="shared")
        self.tracer = LineTracer.of(self.geometry, method.points, method.randomisation, self.seed, self.replicates)
        self.hits = HitCounts(self.tracer)
        self.types = self.tracer.types
        self.segments = PathSegments(self.tracer, continuous=self.method.equation == "continuous")
        self.source_sampling = SourceSampling.of_power(self.problem, self.seed, self.replicates)
        self.fractions = Fractions.of(self.tracer, self.problem) if self.method.absorption == "fractional" else None
        self.scores = Scores(self.tracer, self.problem, self.method)

    @property
    def stage_independent(self) -> bool:
        return self.fractions is None

    def _sources(self, before: int, quanta: int) -> tuple[Batch | None, int]:
        if self.fractions is not None:
            return self.fractions.batch(before, quanta)
        return self.source_sampling.batch(self.tracer, before, quanta)

    def _follow(self, launch: Launch, largest: int) -> int:
        types, segment, lines, bits = self.types, 1, launch.lanes, self.tracer.numbers.bits_for(largest)
        number, index, record = launch.read(types)
        if self.fractions is not None:
            number, record = self.fractions.birthplace(number, index, bits)
        weights = self.scores.born(number)
        self.scores.count_fired(weights, launch.lanes, launch.real(types))
        step = self.segments.first(number, index, record, bits)
        particles, alive = self._settle(ParticleBank(number, index, (), weights), step, launch.real(types), 1, launch.width)
        while True:
            rows = dr.compress(alive)
            if dr.width(rows) == 0:
                return lines
            particles = particles.at(rows)
            if self.fractions is None and (particles.size <= FEW or self.method.order == "depth-first"):
                return lines + self._to_the_end(particles, segment)
            lines += particles.size
            self.scores.count_fired(particles.weights, particles.size)
            number = dr.opaque(types.UInt32, segment, particles.size)
            step = self.segments.later(particles, number)
            segment += 1
            particles, alive = self._settle(particles, step, True, segment, particles.size)

    def _settle(self, particles: ParticleBank, step, real, segment: int, width: int) -> tuple[ParticleBank, Any]:
        """Score hits and decide which particles go on, in a kernel of its own."""
        mode = dr.ReduceMode.Expand if width > DENSE * self.tracer.total else dr.ReduceMode.Direct
        after, alive = self._landed(particles, step, real, segment, mode)
        dr.eval(self.hits.arrivals, *self.scores.arrays(), alive, after.columns())
        return after, alive

    def _landed(self, particles: ParticleBank, step, real, segment, mode) -> tuple[ParticleBank, Any]:
        tracer, types = self.tracer, self.types
        on = real & (step.landed < tracer.total)
        patch = step.landed - tracer.replicate(particles.walk) * tracer.n_opaque
        probability = dr.gather(types.Float, self.scores.survival, patch, on)
        if self.fractions is None:
            alive = on & (step.numbers[4] < probability)
        else:
            alive = on & (probability > 0) & self.fractions.go_on(particles.index, segment)
        self.hits.add(step.landed, real, mode)
        self.scores.deposit(particles.weights, step.landed, patch, probability, alive, real, mode)
        factor = None if self.fractions is None else self.fractions.factor(segment)
        weights = self.scores.reflected(particles.weights, patch, on, factor)
        return ParticleBank(particles.walk, particles.index, step.place, weights), alive

    def _to_the_end(self, particles: ParticleBank, segment: int) -> int:
        """Follow particles in one symbolic loop, and return the number of their lines."""
        types, size = self.types, particles.size
        going = dr.arange(types.UInt32, max(size, 2)) < dr.opaque(types.UInt32, size)
        particles = particles if size > 1 else particles.at(dr.zeros(types.UInt32, 2) + dr.opaque(types.UInt32, 0))
        lines = dr.zeros(types.UInt32, dr.width(going))
        sums = tuple(dr.zeros(types.UInt64, dr.width(going)) for _ in particles.weights)

        def body(columns, segment, lines, sums, going):
            here = particles.having(columns)
            sums = tuple(s + dr.select(going, fixed, 0) for s, fixed in zip(sums, self.scores.fixed(here.weights), strict=True))
            step = self.segments.later(here, segment)
            after, alive = self._landed(here, step, going, segment + 1, dr.ReduceMode.Direct)
            # particles that ended keep their places: slots after the patches have no record
            kept = [dr.select(alive, new, old) for new, old in zip(after.columns(), columns, strict=True)]
            return tuple(kept), segment + 1, lines + dr.select(going, types.UInt32(1), types.UInt32(0)), sums, alive

        state = (particles.columns(), dr.opaque(types.UInt32, segment, dr.width(going)), lines, sums, going)
        _, _, lines, sums, _ = loop(state, lambda columns, segment, lines, sums, going: going, body)
        total = dr.sum(types.UInt64(lines))
        parts = [dr.sum(s) for s in sums]
        dr.eval(self.hits.arrivals, *self.scores.arrays(), total, parts)
        took = int(total[0])
        if self.scores.carries:
            self.scores.add_fired([int(part[0]) for part in parts])
        else:
            self.scores.count_fired((), took)
        return took

    def _state(self, **progress: Any) -> WalkState:
        (arrivals, missed), (fired, received, its_missed) = self.hits.read(), self.scores.read()
        scores = {"fired_power": fired, "received": received, "received_missed": its_missed}
        return WalkState(arrivals=arrivals, missed=missed, **scores, **progress)

    def read(self, arrays: Arrays, sizes: Sizes) -> WalkState:
        wanted = ("received", "received_missed") if self.scores.weighted else ()
        if WalkState.lacking(arrays, sizes, wanted):
            raise MethodError("the solution to go on from lacks the counts of its run; start anew")
        return WalkState.read(arrays, sizes, wanted)

    def _put_back(self, state: WalkState) -> None:
        self.hits.write(state.arrivals, state.missed)
        self.scores.write(state.fired_power, state.received, state.received_missed)

    @property
    def tally(self) -> AbstractTally[WalkState]:
        counted = WalkTally(self.method.estimator == "collision", self.fractions is not None)
        return DensityTally(counted) if self.method.reconstruction == "local-linear" else counted
