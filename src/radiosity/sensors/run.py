"""The run of the lines of sensors, which read a solution."""

from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from ..device.backend import choose
from ..errors import MethodError
from ..problem.model import Problem
from ..run.budget import Budget
from ..run.progress import Listener, Stop, Teller
from ..sampling.streams import Seed
from ..scene.habits import warn
from ..solution.model import Solution
from ..tracing.geometry import Geometry
from .model import Sensors
from .reflected import reflected
from .result import Measurement
from .target import achieved, worst
from .tracing import Tracing

FIRST = 32  # lines of a sensor in the first stage, in each replicate
MOST = 1 << 20  # lines of a sensor in each replicate
AT_ONCE = 1 << 24  # lines of a launch: between launches a run can be interrupted
BEHIND = 0.5  # share of lines that meet backs: a sensor is likely inside of something


@dataclass(frozen=True, eq=False)
class Run:
    """A run of the lines of sensors, which read a solution.

    Attributes:
        solution: that lines read.
        sensors: where.
        budget: lines, or an error of what ``error_of`` says.
        replicates: None: those of the solution.
        seed, device, progress: see `measure`.
        direct: the light of lamps, suns and the sky counts; False: only what surfaces reflect.
    """

    solution: Solution
    sensors: Sensors
    budget: Budget
    error_of: str
    replicates: int | None
    seed: int
    device: str
    progress: Listener | None
    direct: bool = True

    def measured(self) -> Measurement:
        """Trace the lines. What is left of the error asked for is told."""
        solution, begun = self.solution, perf_counter()
        count = self.replicates or (solution.replicates if solution.replicates > 1 else 8)
        if solution.replicates > 1 and count != solution.replicates:
            raise MethodError(
                f"the solution has {solution.replicates} replicates, and sensors are to have {count}: leave replicates out"
            )
        geometry = Geometry(solution.patches.solid, choose(self.device))
        if geometry.some_backs_pass:
            raise MethodError(
                f"{solution.patches.scene.source}: some backs let lines pass, so what a sensor sees is not what sees the sensor; "
                "sensors need both to be equal: make these surfaces radiate or absorb on both sides"
            )
        problem, stop = Problem.of(solution.patches), Stop()
        teller = Teller(self.budget, self.progress)
        with stop.listening():
            light = reflected(solution, geometry, problem)
            tracing = Tracing.of(geometry, problem, self.sensors, light, count, Seed(self.seed), direct=self.direct)
            values, status, reached = _staged(tracing, self.budget, problem, self.sensors, teller, stop, self.error_of)
        inside = tracing.behind() > BEHIND
        found = Measurement.of(solution, self.sensors, problem, values, inside, tracing.traced, perf_counter() - begun, status)
        if reached or status != "complete":
            return found
        of, now = achieved(found, self.error_of)
        warn(
            f"the relative error of {of} is {now:.2g}, and {self.budget.error:.2g} was asked for; what is left is the error of "
            "the solution: solve longer"
        )
        return replace(found, status="not reached")


def _staged(tracing: Tracing, budget: Budget, problem: Problem, sensors: Sensors, teller: Teller, stop: Stop, error_of: str):
    """Trace stage by stage. Return values of the last complete one, a status, and whether the target was reached."""
    planes, values, each = tracing.receivers.receivers, None, float(FIRST)
    replicates, before = tracing.receivers.replicates, np.inf
    teller.begin(0)
    if budget.rays is not None:
        each = max(budget.rays / (planes * replicates), 2.0)
    done = 0.0
    while True:
        step = max(AT_ONCE / (planes * replicates), 1.0)
        while done < each:
            done = min(done + step, each)
            tracing.advance(done)
            teller.lines = tracing.traced
            teller.tell("measuring")
            if stop.asked and values is not None:
                return values, "interrupted", True
        values = tracing.values()
        if stop.asked:
            return values, "interrupted", True
        if budget.error is None:
            return values, "complete", True
        now = worst(values * problem.unit, sensors, error_of, tracing.behind() > BEHIND)
        teller.complete(tracing.traced, max(int(each), 1), now)
        if now <= budget.error:
            return values, "complete", True
        if each >= MOST or (now > 0.9 * before and each > 1 << 12):
            return values, "complete", False
        before, each = now, 2 * each
