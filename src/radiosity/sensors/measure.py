"""`measure`, which finds the light that falls on sensors."""

from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from ..device.backend import choose
from ..device.memory import limited
from ..device.turn import turn
from ..errors import MethodError, shown
from ..patches import Patches
from ..problem.model import Problem
from ..run.budget import Budget
from ..run.progress import Listener, Stop, Teller
from ..run.solve import solve
from ..run.whole_number import whole
from ..sampling.streams import Seed
from ..scene.habits import warn
from ..scene.model import Scene
from ..solution.model import Solution
from ..tracing.geometry import Geometry
from .model import Sensors
from .reflected import reflected
from .result import Measurement
from .target import OF, achieved, worst
from .tracing import Tracing

FIRST = 32  # lines of a sensor in the first stage, in each replicate
MOST = 1 << 20  # lines of a sensor in each replicate
SHARE = 0.5  # of the lines or of the error goes to the solution, where there is none yet
AT_ONCE = 1 << 24  # lines of a launch: between launches a run can be interrupted
BEHIND = 0.5  # share of lines that meet backs: a sensor is likely inside of something


def measure(
    scene: Scene | Patches | Solution,
    sensors: Sensors | None = None,
    *,
    rays: float | None = None,
    error: float | None = None,
    error_of: str = "mean",
    replicates: int | None = None,
    seed: int = 0,
    device: str = "auto",
    progress: Listener | None = None,
    memory: str | float | None = None,
) -> Measurement:
    """Measure the irradiance or illuminance at sensors, by a final gather at each.

    Shadow rays go to lamps, luminaires, suns and openings, and cosine lines read the solution's reflected radiosity where they
    hit. So shadows are sharp and sensors may lie anywhere. What lines read is constant on each patch: cut the scene finely where
    sensors are near to its surfaces.

    Args:
        scene: a `Solution`, or a scene or patches to solve first, which takes half of the lines or of the error.
        sensors: where to measure; by default what the scene's file asks for (`Sensors.of_scene`).
        rays, error: one at most: lines in all, replicates together; or the relative error that the true one is below in 95 % of
            runs. The default is an error of 1 %.
        error_of: "mean": of the mean of each set of sensors; "worst": of each sensor.
        replicates: independent randomised runs, those of the solution by default; from 2 on there are standard errors.
        seed: with the same inputs, the same bits.
        device, progress, memory: as of `solve`.

    Returns:
        What was measured. Ctrl-C ends the run early and returns the last complete stage.

    Raises:
        MethodError: a choice or budget that makes no sense, or a scene whose backs let lines pass. SceneError: nothing emits.

    Example:
        >>> room = rd.load_scene("room")
        >>> plane = rd.Sensors.grid(room, "floor", height=2.0, spacing=1.0)
        >>> found = rd.measure(rd.subdivide(room, cells=4), plane, rays=500_000)
        >>> found.illuminance.shape == (len(plane), 1), bool(found.table()[0]["U0"] <= 1)
        (True, True)
    """
    if error_of not in OF:
        raise MethodError(f"error_of is '{error_of}'; sensors take {', '.join(OF)}")
    if sensors is None:
        sensors = Sensors.of_scene(scene_of(scene))
    if not isinstance(sensors, Sensors):
        raise MethodError(f"measure takes Sensors, not {type(sensors).__name__}; make them with Sensors.of or Sensors.grid")
    if rays is None and error is None:
        error = 0.01
    if rays is not None and error is not None:
        raise MethodError("give rays or an error, not both")
    budget = Budget(rays=rays, error=error)
    number = whole(seed, "seed", 0)
    with limited(memory), turn():
        begun = perf_counter()
        status = "complete"
        if isinstance(scene, Solution):
            solution = scene
        else:
            part = Budget(rays=None if rays is None else rays * SHARE, error=None if error is None else error * SHARE)
            solution = solve(
                scene, rays=part.rays, error=part.error, replicates=replicates, seed=number, device=device, progress=progress
            )
            budget = replace(budget, rays=None if rays is None else max(rays - solution.rays, 1.0))
            status = solution.status if solution.status == "interrupted" else status
        run = Run(solution, sensors, budget, error_of, replicates, number, device, progress)
        measured = replace(run.measured(), seconds=perf_counter() - begun)
        return measured if status == "complete" else replace(measured, status=status)


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
        inside = _inside(tracing, self.sensors)
        found = Measurement.of(solution, self.sensors, problem, values, inside, tracing.traced, perf_counter() - begun, status)
        if reached or status != "complete":
            return found
        of, now = achieved(found, self.error_of)
        warn(
            f"the relative error of {of} is {now:.2g}, and {self.budget.error:.2g} was asked for; what is left is the error of "
            "the solution: solve longer"
        )
        return replace(found, status="not reached")


def scene_of(given: Scene | Patches | Solution, caller: str = "measure") -> Scene:
    """Return the scene of what `measure` takes.

    Raises:
        MethodError: it is something else.
    """
    if isinstance(given, Scene):
        return given
    if isinstance(given, Patches):
        return given.scene
    if isinstance(given, Solution):
        return given.patches.scene
    raise MethodError(f"{caller} takes a Scene, Patches or a Solution, not {type(given).__name__}; load a file with load_scene")


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


def _inside(tracing: Tracing, sensors: Sensors) -> np.ndarray:
    """Return which sensors see mostly backs, (n_sensors,) bool, and tell of them."""
    inside = tracing.behind() > BEHIND
    if inside.any():
        where = np.flatnonzero(inside)
        names = shown([f"{sensors.names[sensors.set[i]]} at {np.round(sensors.points[i], 3).tolist()}" for i in where], 5)
        warn(
            f"{len(where)} of {len(sensors)} sensors see mostly backs of surfaces: {names}; they seem to lie inside of "
            "something, or behind a wall, and are left out of minimum, mean and uniformity. Move them, or turn the faces"
        )
    return inside
