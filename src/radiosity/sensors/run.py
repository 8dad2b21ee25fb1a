"""The run of the lines of sensors, which read a solution."""

from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from ..device.backend import choose
from ..errors import MethodError
from ..hooks import HOOKS
from ..method import Method
from ..patches import Patches
from ..problem.model import Problem
from ..run.budget import Budget
from ..run.progress import Listener, Stop, Teller
from ..run.solve import solve
from ..sampling.streams import Seed
from ..scene.habits import warn
from ..scene.model import Scene
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
SHARE = 0.5  # of the lines goes to the solution, where there is none yet; and of the error, at the end
ROUGH, ROUGHEST = 10.0, 0.2  # times the error of sensors, at most: the error of a solution of all patches, at first
IMPORTANT = 0.7  # of the error of sensors: that of a solution for them
FINER = 0.25  # of its error is that of the next one
PATIENT = 3  # stages, where the solution is made for the sensors
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
        cluster: a client of workers that trace the lines; None: here.
        patience: stages in which the error must fall, or else the error of the solution is what is left. One stage alone may
            find more by chance, and a solution that is good enough would be made anew.
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
    patience: int = 1
    cluster: Any = None

    def measured(self) -> Measurement:
        """Trace the lines; the status says whether the error was reached.

        Raises:
            MethodError: other replicates than the solution's, or an error without replicates.
        """
        solution, begun = self.solution, perf_counter()
        count = self.replicates or (solution.replicates if solution.replicates > 1 else 8)
        if solution.replicates > 1 and count != solution.replicates:
            raise MethodError(
                f"the solution has {solution.replicates} replicates, and sensors are to have {count}: leave replicates out"
            )
        if count < 2 and self.budget.error is not None:
            raise MethodError("an error is found from replicates: give 2 or more, or rays in place of the error")
        geometry = Geometry(solution.patches.solid, choose(self.device))
        problem, stop = Problem.of(solution.patches), Stop()
        teller = Teller(self.budget, self.progress)
        with stop.listening():
            light = reflected(solution, geometry, problem)
            tracing = Tracing.of(geometry, problem, self.sensors, light, count, Seed(self.seed), direct=self.direct)
            with sensing_on(self.cluster, tracing, problem, geometry.device.name):
                values, status, reached = _staged(
                    tracing, self.budget, problem, self.sensors, teller, stop, self.error_of, self.patience
                )
        inside = tracing.behind() > BEHIND
        found = Measurement.of(solution, self.sensors, problem, values, inside, tracing.traced, perf_counter() - begun, status)
        return found if reached or status != "complete" else replace(found, status="not reached")


def sensing_on(client: Any, tracing: Tracing, problem: Problem, device: str) -> AbstractContextManager:
    """Return a context in which the workers of a client trace the lines of sensors; here where it is None."""
    return nullcontext() if client is None else HOOKS["sensing"](client, tracing, problem, device)


def traced(
    given: Scene | Patches | Solution,
    sensors: Sensors,
    budget: Budget,
    error_of: str,
    replicates: int | None,
    seed: int,
    device: str,
    progress: Listener | None,
    *,
    direct: bool = True,
    cluster: Any = None,
    importance: bool = False,
) -> tuple[Solution, Measurement]:
    """Solve where there is no solution yet, and trace the lines of sensors.

    Each sensor sees many patches, so that a rough solution is mostly enough. Where it is not, it goes on. An error that is not
    reached is told.

    Args:
        importance: lines of the solution are shared out for the sensors, and its error is that of what they see.

    Raises:
        MethodError: importance for a solution that is there already.
    """
    options: dict[str, Any] = {"seed": seed, "device": device, "progress": progress, "cluster": cluster}
    if importance:
        if isinstance(given, Solution):
            raise MethodError(
                "importance shares out the lines of a solution, and this one is there already: give the scene, or solve it with "
                "importance=sensors"
            )
        options["importance"] = sensors
    patience = PATIENT if importance else 1

    def measured(solution: Solution) -> Measurement:
        left = (
            budget if budget.rays is None or isinstance(given, Solution) else Budget(rays=max(budget.rays - solution.rays, 1.0))
        )
        options = {"patience": patience, "cluster": cluster}
        return Run(solution, sensors, left, error_of, replicates, seed, device, progress, direct, **options).measured()

    if isinstance(given, Solution):
        solution, found = given, measured(given)
        if given.replicates < 2 and len(found.values) > 1:
            warn(f"{given.patches.scene.source}: the solution has one replicate, whose error is not in the errors of sensors")
    elif budget.error is None:
        rays = budget.rays and max(int(budget.rays * SHARE), 1)
        solution = solve(given, rays=rays, replicates=replicates, **options)
        found = measured(solution)
    else:
        error = IMPORTANT * budget.error if importance else min(ROUGH * budget.error, ROUGHEST)
        solution = solve(given, error=error, replicates=replicates, **options)
        found = measured(solution)
        while found.status == "not reached" and solution.status == "complete" and error > SHARE * budget.error:
            error = max(error * FINER, SHARE * budget.error)
            method = Method(**solution.provenance["choices"])
            before = None if importance else solution  # its last stage was no rung, so that no run goes on from it
            solution = solve(solution.patches, method, error=error, replicates=replicates, resume=before, **options)
            found = measured(solution)
    if solution.status == "interrupted":
        found = replace(found, status="interrupted")
    if found.status == "not reached" and budget.error is not None:
        of, now = achieved(found, error_of)
        if np.isinf(now):
            warn(f"no line found light at the sensors, so that the relative error of {of} is unknown")
        else:
            warn(
                f"the relative error of {of} is {now:.2g}, and {budget.error:.2g} was asked for; what is left is the error of "
                "the solution: solve longer"
            )
    return solution, found


def _staged(
    tracing: Tracing, budget: Budget, problem: Problem, sensors: Sensors, teller: Teller, stop: Stop, error_of: str, patience: int
):
    """Trace stage by stage. Return values of the last complete one, a status, and whether the target was reached."""
    planes, values, each = tracing.receivers.receivers, None, float(FIRST)
    replicates, before = tracing.receivers.replicates, [np.inf] * patience
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
        if each >= MOST or (now > 0.9 * before[0] and each > 1 << 12):
            return values, "complete", False
        before, each = [*before[1:], now], 2 * each
