"""Random walks that shoot: particles leave the lights, hit patches, and go on or end there.

Continuous: S. N. Pattanaik and S. P. Mudur, "Computation of global illumination by Monte Carlo simulation of the particle model
of light", 3rd Eurographics Workshop on Rendering, 1992. Discrete: M. Sbert 1997. The estimator decides what a hit scores.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import frozen
from ...device.launches import shared
from ...errors import MethodError
from ...sampling.numbers import DIMENSIONS
from ...tally.far_sides import FarSides
from ...tally.hit_counts import HitCounts
from ...tally.hit_tally import DENSE, AbstractHitTally, hit_tally
from ...tracing.lanes import Launch, sums
from ...tracing.line_tracer import LineTracer
from ...tracing.refill import follow, lanes_for
from ...tracing.spots import Spot
from ...tracing.spots import spot as spot_on
from ..base import AbstractTally
from ..state import Arrays, Sizes
from .density import DensityTally
from .fractions import Fractions
from .launches import AbstractWalks
from .of_blocks import OfBlocks
from .particles import ParticleBank, PathSegments, Step
from .scores import Scores
from .sorting import FEW, Array, arrays, cuts, order, ranges
from .source_sampling import Begun, SourceSampling
from .state import WalkState
from .tally import WalkTally

# After their first segment, up to so many particles of a launch are followed until they end in one kernel: the sums are the same.
# On a CPU that is all of a launch, unless its cores are very many. The number for GPUs was not measured.
TAILS = {"cpu": 1 << 22, "cuda": 1 << 20}


@dataclass(frozen=True)
class Adding:
    """How the walks of a launch add to counters: their hits, and the mode in which they add scores."""

    hits: AbstractHitTally
    mode: dr.ReduceMode

    @staticmethod
    def of(hits: HitCounts, lines: int) -> "Adding":
        """Return what suits a launch of ``lines`` first lines."""
        mode = dr.ReduceMode.Expand if lines > DENSE * hits.tracer.total else dr.ReduceMode.Direct
        return Adding(hit_tally(hits, lines, flags=False), mode)


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
        panes = FarSides.of(self.tracer, self.problem.source)
        self.segments = PathSegments(self.tracer, self.method, panes)
        self.source_sampling = SourceSampling.of_power(self.problem, self.seed, self.replicates)
        self.fractions = Fractions.of(self.tracer, self.problem) if self.method.absorption == "fractional" else None
        self.scores = Scores(self.tracer, self.problem, self.method)
        self._of_blocks = OfBlocks(self.tracer, self.segments)

    def _enter(self, block: int) -> None:
        self.tracer, self.segments = self._of_blocks.at(block)
        if self.fractions is not None:
            self.fractions.tracer = self.tracer

    def _look(self) -> None:
        self.hits.look()
        self.scores.look()

    @property
    def stage_independent(self) -> bool:
        return self.fractions is None and self.method.order != "sorted"

    def _sources(self, before: int, quanta: int) -> Iterator[Begun]:
        if self.fractions is not None:
            return self.fractions.batches(before, quanta)
        return self.source_sampling.batches(self.tracer, before, quanta)

    def _chunks(self, begun: Begun, limit: int) -> int:
        if self.method.order != "sorted":
            return super()._chunks(begun, limit)
        return len(ranges(self.tracer, begun.batch, limit))

    def _launches(self, begun: Begun, before: int, done: int, end: int | None, limit: int) -> Iterator[tuple[Any, int | None]]:
        if self.method.order == "sorted":
            walks = self.source_sampling.count(before).sum(axis=1, dtype=np.int64)
            every = arrays(self.tracer, begun.batch, walks, done, limit)
            yield from every if end is None else islice(every, max(end - done, 0))
        else:
            yield from super()._launches(begun, before, done, end, limit)

    def _follow(self, launch: Launch | Array, largest: int) -> int:
        array = launch if isinstance(launch, Array) else None
        launch = launch.launch if isinstance(launch, Array) else launch
        types, segment, lines, bits = self.types, 1, launch.lanes, self.tracer.numbers.bits_for(largest)
        number, index, record = launch.read(types)
        if self.fractions is not None:
            number, record = self.fractions.birthplace(number, index, bits)
        weights = self.scores.born(number)
        self.scores.count_fired(weights, launch.lanes, launch.real(types))
        step = self.segments.first(number, index, record, bits)
        adding = Adding.of(self.hits, launch.width)
        particles, real = ParticleBank(number, index, (), weights), launch.real(types)
        if array is not None:
            particles, step = self._in_order(particles, step, real, 1, array)
        particles, alive = self._settle(particles, step, real, 1, adding)
        few = TAILS[self.geometry.device.name] if self.method.order == "breadth-first" else launch.width
        few = few if array is None else FEW
        while True:
            rows = dr.compress(alive)
            if dr.width(rows) == 0:
                break
            particles = particles.at(rows)
            if self.fractions is None and particles.size <= few:
                lines += self._to_the_end(particles, segment, adding)
                break
            lines += particles.size
            self.scores.count_fired(particles.weights, particles.size)
            number = dr.opaque(types.UInt32, segment, particles.size)
            step = self.segments.later(particles, number) if array is None else self.segments.in_order(particles, number, array)
            segment += 1
            if array is not None:
                particles, step = self._in_order(particles, step, True, segment, array)
            particles, alive = self._settle(particles, step, True, segment, adding)
        adding.hits.settle()
        return lines

    def _in_order(self, particles: ParticleBank, step: Step, real, segment: int, array: Array) -> tuple[ParticleBank, Step]:
        """Return particles in the order of their places, where the number of each tells which go on (`sorting.cuts`)."""
        tracer, types = self.tracer, self.types
        dr.eval(step.landed, step.place, particles.columns())
        size = dr.width(step.landed)
        rows = order(self.geometry, step.place, real & (step.landed < tracer.total), size)
        landed, *place = (dr.gather(type(column), column, rows) for column in (step.landed, *step.place))
        on = landed < tracer.total
        patch = landed - array.replicate * tracer.n_opaque
        chances = dr.select(on, dr.gather(types.Float, self.scores.survival, patch, on), 0)
        number = cuts(types, chances, self.segments.part(dr.opaque(types.UInt32, segment), array))
        dr.eval(landed, place, number)
        return particles.at(rows), Step(landed, [number] * DIMENSIONS, tuple(place))

    def _settle(self, particles: ParticleBank, step, real, segment: int, adding: Adding) -> tuple[ParticleBank, Any]:
        """Score hits and decide which particles go on, in a kernel of its own."""
        after, alive = self._landed(particles, step, real, segment, adding)
        with shared(dr.width(alive)):
            dr.eval(*adding.hits.arrays(), *self.scores.arrays(), alive, after.columns())
        return after, alive

    def _landed(self, particles: ParticleBank, step, real, segment, adding: Adding) -> tuple[ParticleBank, Any]:
        tracer, types = self.tracer, self.types
        on = real & (step.landed < tracer.total)
        patch = step.landed - tracer.replicate(particles.walk) * tracer.n_opaque
        probability = dr.gather(types.Float, self.scores.survival, patch, on)
        if self.fractions is None:
            alive = on & (step.numbers[4] < probability)
        else:
            alive = on & (probability > 0) & self.fractions.go_on(particles.index, segment)
        adding.hits.add(step.landed, [], real)
        spot = None if self.scores.moments is None else self._spot(step)
        self.scores.deposit(particles.weights, step.landed, patch, probability, alive, real, adding.mode, spot)
        factor = None if self.fractions is None else self.fractions.factor(segment)
        across = self.scores.across(step.numbers[4], patch, on)
        weights = self.scores.reflected(particles.weights, patch, on, factor, across)
        return ParticleBank(particles.walk, particles.index, self.segments.from_side(step.place, across), weights), alive

    def _spot(self, step: Step) -> Spot:
        """Return where lines hit patches, of walks that go on from there."""
        _, s, t = step.place
        _, place = self.tracer.record(dr.select(step.landed < self.tracer.total, step.landed, 0))
        return spot_on(self.geometry, place, s, t)

    def _to_the_end(self, particles: ParticleBank, segment: int, adding: Adding) -> int:
        """Follow particles in one launch, and return the number of their lines."""
        types, size = self.types, particles.size

        def step(columns, so_far, going):
            *columns, segment = columns
            lines, *powers = so_far
            here = particles.having(columns)
            fixed = self.scores.fixed(here.weights)
            powers = [power + dr.select(going, more, 0) for power, more in zip(powers, fixed, strict=True)]
            after, alive = self._landed(here, self.segments.later(here, segment, going), going, segment + 1, adding)
            lines += dr.select(going, types.UInt32(1), types.UInt32(0))
            return [*after.columns(), segment + 1], (lines, *powers), alive

        lanes = lanes_for(types, size)
        none = (dr.zeros(types.UInt32, lanes), *(dr.zeros(types.UInt64, lanes) for _ in particles.weights))
        starts = [*particles.columns(), dr.opaque(types.UInt32, segment, size)]
        lines, *powers = follow(types, starts, size, none, step, lambda: [*adding.hits.arrays(), *self.scores.arrays()])
        (took,) = sums(types, lines)
        if self.scores.carries:
            self.scores.add_fired([int(frozen(power).sum()) for power in powers])
        else:
            self.scores.count_fired((), took)
        return took

    def _state(self, **progress: Any) -> WalkState:
        arrivals, missed = self.hits.read()
        counts = {"arrivals": arrivals, "missed": missed, "moments": self.scores.read_moments()}
        return WalkState(**counts, **self.scores.read(), **progress)

    def read(self, arrays: Arrays, sizes: Sizes) -> WalkState:
        wanted = {"received", "received_missed"} if self.scores.weighted else set()
        wanted |= {"moments"} if self.scores.moments is not None else set()
        if WalkState.lacking(arrays, sizes, wanted):
            raise MethodError("the solution to go on from lacks the counts of its run; start anew")
        return WalkState.read(arrays, sizes, wanted)

    def _put_back(self, state: WalkState) -> None:
        self.hits.write(state.arrivals, state.missed)
        self.scores.write(state)
        self.scores.write_moments(state.moments)

    @property
    def tally(self) -> AbstractTally[WalkState]:
        counted = WalkTally(self.method.estimator == "collision", self.fractions is not None, self.scores.basis)
        return DensityTally(counted) if self.method.reconstruction == "local-linear" else counted
