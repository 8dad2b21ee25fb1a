"""Lines of a year of daylight on workers: ranges of the lines of replicates, and suns, between two barriers."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..patches import Patches
from ..problem.model import Problem
from ..sensors.annual.coefficients import OF_PATCHES, Replicate, Setup, counts_of
from ..sensors.annual.elsewhere import AbstractYearLines, Shares, SkyUnit, SunUnit
from ..sensors.annual.gathering import lines_of
from ..sensors.annual.memory import YearSizes
from ..sensors.receivers import planes_of
from .barrier import Barrier
from .crew import DaskCrew
from .job import AbstractJob
from .room import refuse
from .scenes import scene_on
from .worker import Brought, bring, job_of, keep, taken

FEWEST = 1 << 17  # lines of a unit
AT_A_TIME = 2  # units of each worker between two barriers, where they need not be fewer: an idle one then takes the next


@dataclass(frozen=True, eq=False)
class YearJob(AbstractJob):
    """What workers need of a year, besides the scene.

    Attributes:
        scene: the key of the `SceneJob`.
        setup: sensors, sky and seed.
    """

    scene: str
    setup: Setup

    def traced(self, unit: SkyUnit | SunUnit) -> Any:
        """Return what a unit brings; replicates stay for later units.

        Raises:
            MethodError: the worker has too little memory for another replicate.
        """
        scene, place = job_of(self.scene), (self.key, unit.replicate, 0)
        run = taken(place)
        if run is None:
            self._check(scene.problem.patches, unit)
            run = self.setup.replicate(scene.geometry, scene.problem, unit.replicate)
        found = unit.traced(run)
        keep(place, "", run)
        return found

    def _check(self, patches: Patches, unit: SkyUnit | SunUnit) -> None:
        sensors, cosine = self.setup.sensors, None if isinstance(unit, SunUnit) else unit.ranges[0][1]
        each = None if cosine is None else cosine / OF_PATCHES if unit.patches else cosine
        planes, faces = planes_of(sensors), patches.scene.n_faces
        sizes = YearSizes(len(sensors), planes, len(patches), faces, len(self.setup.sky), 1, each)
        refuse(
            sizes.on_worker(unit.lines),
            f"the daylight of a year at {len(sensors):,} sensors and on {len(patches):,} patches, in one replicate,",
            "take fewer sensors, larger patches, 145 sky patches",
        )


def trace_unit(key: str, unit: tuple[int, SkyUnit | SunUnit]) -> Brought:
    """Trace a unit, which has a number; see `bring`."""
    return bring(key, lambda job: [(unit[0], job.traced(unit[1]))])


@contextmanager
def years(client: Any, setup: Setup, problem: Problem, device: str) -> Iterator[AbstractYearLines]:
    """Give what traces lines on the workers of a client."""
    scene = scene_on(client, problem.scalar, device)
    crew = DaskCrew(client, YearJob(scene.key, setup), before=(scene,))
    crew.bring(crew.job)
    try:
        yield DaskYearLines(crew)
    finally:
        crew.release()


class DaskYearLines(AbstractYearLines):
    """Traces the lines of all replicates between two barriers."""

    def __init__(self, crew: DaskCrew):
        self.barrier = Barrier(crew, trace_unit, lambda unit: [(unit[0], unit[1].traced(self._runs[unit[1].replicate]))])
        self._runs: list[Replicate] = []

    def advance(self, runs: list[Replicate], each: int) -> Iterator[int]:
        whole = []
        for number, run in enumerate(runs):
            for kind, count in counts_of(each):
                gathering = run.of(patches=kind)
                ranges = gathering.due(count, count)
                whole.append(SkyUnit(number, kind, ranges, lines_of(ranges) * gathering.lines.packets.receivers))
        found = self._traced(runs, whole)
        for unit, parts in zip(whole, found, strict=True):
            yield runs[unit.replicate].of(patches=unit.patches).add(unit.ranges, parts)

    def suns(self, runs: list[Replicate], towards: np.ndarray, first: int) -> Iterator[Shares]:
        whole = []
        for number, run in enumerate(runs):
            for kind in (False, True):
                rays = run.sunlight(patches=kind)
                lines = len(towards) * len(rays.places) * rays.samples
                whole.append(SunUnit(number, kind, towards, first, 0, len(towards), lines, rays.places if kind else None))
        found = [np.concatenate(parts) for parts in self._traced(runs, whole)]
        return (run.of_suns(*found[2 * number : 2 * number + 2]) for number, run in enumerate(runs))

    def fewest(self, unit: SkyUnit | SunUnit) -> int:
        """Return the fewest lines of a part of a unit: as many as there are numbers in the tables that it brings."""
        if isinstance(unit, SunUnit):
            return FEWEST
        gathering = self._runs[unit.replicate].of(patches=unit.patches)
        return max(FEWEST, gathering.lines.packets.lanes * len(gathering.bins[0].patches))

    def _traced(self, runs: list[Replicate], whole: list) -> list[list]:
        """Return what the parts of each unit bring, in their order."""
        self._runs, units, of = runs, [], []
        most = max(AT_A_TIME * len(self.barrier.workers()) // len(whole), 1)
        for number, unit in enumerate(whole):
            parts = min(most, max(unit.lines // self.fewest(unit), 1))
            units += unit.cut(parts)
            of += [number] * parts
        brought = dict(self.barrier.done(list(enumerate(units)), lambda unit: unit[1].lines))
        found: list[list] = [[] for _ in whole]
        for number, at in enumerate(of):
            found[at].append(brought[number])
        return found
