"""Random walks that gather: from patches, in proportion to area, to the light (M. Sbert 1997; collision estimator).

The transitions are those of shooting. A line that leaves patch q estimates the radiosity that it meets: emission of the patch
it hits, plus, where the walk goes on there, reflectance over survival probability times what the next line meets. So every part
of a walk is a sample of the irradiance of the patch where it begins, and all are used. The number of parts and what they met are
correlated, so the mean has a bias of the order of one over the walks of a replicate: 2 % at two walks a patch and mean
reflectance 0.5, 0.2 % at 27.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import frozen, upload
from ...errors import MethodError
from ...problem.model import Problem
from ...solution.books import by_difference, exact_sum
from ...tally.far_sides import FarSides
from ...tally.hit_counts import HitCounts
from ...tally.unmet import bias, means, sides
from ...tally.wraps import Wraps
from ...tracing.lanes import Launch
from ...tracing.line_tracer import LineTracer
from ..base import AbstractMeanTally
from ..state import Arrays, Sizes
from .launches import AbstractWalks
from .of_blocks import OfBlocks
from .particles import ParticleBank, PathSegments
from .source_sampling import Begun, SourceSampling
from .state import GatheringState

UNIT = 2.0**24  # fixed point units of the largest emission of a group


@dataclass(frozen=True)
class Visit:
    """One segment of a launch's walks: lanes, patch numbers that they left, slots that they hit, and which of them go on.

    ``leaves`` are the patch numbers that they go on from, which differ from the slots where they go on ``across`` a pane.
    """

    lane: Any
    left: Any
    landed: Any
    alive: Any
    leaves: Any
    across: Any = None


class Gathering(AbstractWalks[GatheringState]):
    """Runs walks that gather: it keeps sums of the radiosity met, and numbers of lines that left each patch."""

    def _prepare(self) -> None:
        method = self.method
        self.tracer = LineTracer.of(self.geometry, method.points, method.randomisation, self.seed, self.replicates)
        self.types = types = self.tracer.types
        self.hits, self.fired = HitCounts(self.tracer), dr.opaque(types.UInt32, 0, self.tracer.total)
        panes = FarSides.of(self.tracer, self.problem.source)
        self.segments = PathSegments(self.tracer, self.method, panes)
        self.source_sampling = SourceSampling.of_area(self.problem, self.seed, self.replicates)
        groups = self.problem.groups
        self.n, top = groups.n_groups, groups.reflectance.max(axis=1)
        through = None if groups.through is None else groups.through.max(axis=1)
        self.survival = upload(types.Float, (top if through is None else top + through).astype(np.float32))
        self.stays = None if through is None else upload(types.Float, top.astype(np.float32))
        emission = groups.emission / groups.emission.max(axis=0)
        ratio = groups.reflectance / np.where(top > 0, top, 1)[:, None]
        far = ratio if through is None else groups.through / np.where(through > 0, through, 1)[:, None]
        self.emission, self.ratio, self.ratio_across = (
            [upload(types.Float, c.astype(np.float32)) for c in x.T] for x in (emission, ratio, far)
        )
        self.met = dr.opaque(types.UInt64, 0, self.tracer.total * self.n)
        self.fired_upper, self.met_upper = Wraps(types), Wraps(types, 64)
        self._of_blocks = OfBlocks(self.tracer, self.segments)

    def _enter(self, block: int) -> None:
        self.tracer, self.segments = self._of_blocks.at(block)

    def _look(self) -> None:
        self.hits.look()
        self.fired_upper.look(self.fired)
        self.met_upper.look(self.met)

    @property
    def stage_independent(self) -> bool:
        return True

    def _sources(self, before: int, quanta: int) -> Iterator[Begun]:
        return self.source_sampling.batches(self.tracer, before, quanta)

    def _follow(self, launch: Launch, largest: int) -> int:
        types, visits = self.types, []
        number, index, record = launch.read(types)
        step = self.segments.first(number, index, record, self.tracer.numbers.bits_for(largest))
        lane, particles = dr.arange(types.UInt32, launch.width), ParticleBank(number, index, (), ())
        particles, visit = self._land(particles, lane, number, step, launch.real(types))
        while True:
            visits.append(visit)
            rows: Any = dr.compress(visit.alive)
            if dr.width(rows) == 0:
                break
            lane, left = (dr.gather(types.UInt32, column, rows) for column in (visit.lane, visit.leaves))
            particles = particles.at(rows)
            segment = dr.opaque(types.UInt32, len(visits), particles.size)
            particles, visit = self._land(particles, lane, left, self.segments.later(particles, segment), True)
        self._score(visits, launch)
        return launch.lanes + sum(dr.width(visit.lane) for visit in visits[1:])

    def _land(self, particles: ParticleBank, lane, left, step, real) -> tuple[ParticleBank, Visit]:
        tracer, types = self.tracer, self.types
        on = real & (step.landed < tracer.total)
        patch = step.landed - tracer.replicate(particles.walk) * tracer.n_opaque
        alive = on & (step.numbers[4] < dr.gather(types.Float, self.survival, patch, on))
        self.hits.add(step.landed, real)
        dr.scatter_add(self.fired, types.UInt32(1), left, active=real)
        leaves, across, place = step.landed, None, step.place
        if self.stays is not None and self.segments.panes is not None:
            across = alive & (step.numbers[4] >= dr.gather(types.Float, self.stays, patch, on))
            leaves = dr.select(across, self.segments.panes.beyond(leaves, across), leaves)
            place = self.segments.from_side(place, across)
            dr.eval(across, leaves)
        after = ParticleBank(particles.walk, particles.index, place, ())
        dr.eval(self.hits.arrivals, self.fired, alive, step.landed, left, lane, after.columns())
        return after, Visit(lane, left, step.landed, alive, leaves, across)

    def _score(self, visits: list[Visit], launch: Launch) -> None:
        """Score what each line met, from the last segments back to the first."""
        tracer, types = self.tracer, self.types
        met = [dr.opaque(types.Float, 0.0, launch.width) for _ in range(self.n)]
        for at, visit in reversed(list(enumerate(visits))):
            real = launch.real(types) if at == 0 else True
            on = real & (visit.landed < tracer.total)
            patch = visit.landed - tracer.replicate(visit.left) * tracer.n_opaque
            for g in range(self.n):
                behind = dr.gather(types.Float, met[g], visit.lane, visit.alive)
                value = dr.gather(types.Float, self.emission[g], patch, on)
                ratio = dr.gather(types.Float, self.ratio[g], patch, visit.alive)
                if visit.across is not None:
                    far = dr.gather(types.Float, self.ratio_across[g], patch, visit.across)
                    ratio = dr.select(visit.across, far, ratio)
                value += ratio * behind
                dr.eval(value)  # before its entry is overwritten
                dr.scatter(met[g], value, visit.lane, active=real)
                fixed = types.UInt64(value * UNIT + 0.5)
                dr.scatter_add(self.met, fixed, visit.left * self.n + g, active=on)
            dr.eval(self.met, met)

    def _state(self, **progress: Any) -> GatheringState:
        arrivals, missed = self.hits.read()
        fired, upper = self.fired_upper.values(self.fired).reshape(arrivals.shape), self.met_upper.read(self.met)
        shape = (self.replicates, self.tracer.n, self.n)
        met, upper = frozen(self.met).reshape(shape), None if upper is None else upper.reshape(shape)
        return GatheringState(arrivals=arrivals, fired=fired, missed=missed, met=met, met_upper=upper, **progress)

    def read(self, arrays: Arrays, sizes: Sizes) -> GatheringState:
        if GatheringState.lacking(arrays, sizes):
            raise MethodError("the solution to go on from lacks the sums of its run; start anew")
        return GatheringState.read(arrays, sizes)

    def _put_back(self, state: GatheringState) -> None:
        self.hits.write(state.arrivals, state.missed)
        self.fired = upload(self.types.UInt32, self.fired_upper.of(state.fired))
        self.met = upload(self.types.UInt64, self.met_upper.of(state.met, state.met_upper))

    @property
    def tally(self) -> "GatheringTally":
        return GatheringTally()


class GatheringTally(AbstractMeanTally[GatheringState]):
    """Reads means of the radiosity met."""

    def lines(self, problem: Problem, state: GatheringState) -> int:
        return exact_sum(state.fired)

    def arrivals(self, problem: Problem, state: GatheringState) -> np.ndarray:
        return state.fired.sum(axis=0, dtype=np.int64)  # a patch is measured by the lines that leave it

    def irradiance(self, problem: Problem, state: GatheringState, group: int) -> tuple[np.ndarray, float]:
        mean = means(state.about("met", (..., group)), self.measured(problem, state), sides(problem.patches))
        return mean * problem.patches.area, float(problem.groups.emission[:, group].max()) / UNIT

    def line(self, problem: Problem, state: GatheringState, group: int) -> np.ndarray | float:
        """Return the power that one of a patch's lines brings where it hits the brightest light."""
        brightest, each = problem.groups.emission[:, group].max(), state.fired.sum(axis=0) / len(state.fired)
        return brightest * problem.patches.area / np.maximum(each, 1)

    def bias(self, problem: Problem, state: GatheringState, group: int) -> np.ndarray:
        return bias(self.irradiance(problem, state, group)[0], self.measured(problem, state))

    def measured(self, problem: Problem, state: GatheringState) -> np.ndarray:
        return state.fired

    def books(self, problem: Problem, state: GatheringState, group: int) -> dict:
        values, unit = self.irradiance(problem, state, group)
        received = values.mean(axis=0) * unit
        albedo, area = problem.groups.scatter.albedo[:, group], problem.patches.area
        emitted = float(problem.groups.emission[:, group] @ area)
        left = emitted + float(received @ albedo)
        # walks do not leave patches in proportion to light, so missed power is taken to be the power that does not hit
        missed = max(left - float(received.sum()), 0.0)
        counts = [exact_sum(kind) for kind in state.missed]
        escaped, lost = (missed * count / max(sum(counts), 1) for count in counts)
        return by_difference(emitted, float(received @ (1 - albedo)), escaped, lost)
