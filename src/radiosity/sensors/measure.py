"""`measure`, which finds the light that falls on sensors."""

from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np

from ..device.memory import limited
from ..device.turn import turn
from ..errors import MethodError, shown
from ..patches import Patches
from ..run.budget import Budget
from ..run.on_cluster import on_cluster
from ..run.progress import Listener
from ..run.whole_number import whole
from ..scene.habits import warn
from ..scene.model import Scene
from ..solution.model import Solution
from .groups import parts_of
from .model import Sensors
from .result import Measurement
from .run import traced
from .target import OF

HURRIED = 1e5  # lines of each group after one that was interrupted


def measure(
    scene: Scene | Patches | Solution,
    sensors: Sensors | None = None,
    *,
    rays: float | None = None,
    error: float | None = None,
    error_of: str = "mean",
    groups: bool | dict[str, list[str]] = False,
    importance: bool = False,
    replicates: int | None = None,
    seed: int = 0,
    device: str = "auto",
    progress: Listener | None = None,
    memory: str | float | None = None,
    cluster: Any = None,
) -> Measurement:
    """Measure the irradiance or illuminance at sensors, by a final gather at each.

    Shadow rays go to lamps, luminaires, suns and openings, and cosine lines read the solution's reflected radiosity where they
    hit. So shadows are sharp and sensors may lie anywhere. What lines read is constant on each patch: cut the scene finely where
    sensors are near to its surfaces.

    Args:
        scene: a `Solution`, or a scene or patches to solve first, which takes half of the lines, or as many as the error needs.
        sensors: where to measure; by default what the scene's file asks for (`Sensors.of_scene`).
        rays, error: one at most: lines in all, replicates together; or the relative error that the true one is below in 95 % of
            runs. The default is an error of 1 %.
        error_of: "mean": of the mean of each set of sensors; "worst": of each sensor.
        groups: True measures the light of each group by itself, so that it can be dimmed afterwards (`Measurement.dimmed`):
            luminaires by their group (or name), suns, the sky, and surfaces that emit by name. A dictionary makes groups of names
            or patterns; what it leaves out is the group "others".
        importance: the lines of the solution are shared out by what they add at the sensors: for sensors far from all lamps
            (docs/importance.md).
        replicates: independent randomised runs, those of the solution by default; from 2 on there are standard errors.
        seed: with the same inputs, the same bits.
        device, progress, memory, cluster: as of `solve`.

    Returns:
        What was measured. Ctrl-C ends the run early and returns the last complete stage.

    Raises:
        MethodError: a choice or budget that makes no sense. SceneError: nothing emits.

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
    number = whole(seed, "seed", 0)
    with limited(memory), turn(), on_cluster(cluster) as client:
        begun = perf_counter()

        def one(part: Scene | Patches | Solution, budget: Budget) -> Measurement:
            options = {"cluster": client, "importance": importance}
            return traced(part, sensors, budget, error_of, replicates, number, device, progress, **options)[1]

        if groups is False:
            found = one(scene, Budget(rays=rays, error=error))
        elif isinstance(scene, Solution):
            name = _only_group(scene, {} if groups is True else groups)
            found = _together({name: one(scene, Budget(rays=rays, error=error))})
        else:
            of_group, done = parts_of(scene, {} if groups is True else groups), {}
            budget = Budget(rays=rays, error=error)
            if budget.rays is not None:
                budget = Budget(rays=max(budget.rays // len(of_group), 1))
            for name, part in of_group.items():
                done[name] = one(part, budget)
                if done[name].status == "interrupted":
                    budget = Budget(rays=HURRIED)  # the rest is rough, and says so by its errors, but no light is missing
            found = _together(done)
        found = replace(found, seconds=perf_counter() - begun)
    _tell_of_inside(found)
    return found


def _only_group(solution: Solution, groups: dict[str, list[str]]) -> str:
    """Return the one group of lights that a solution has.

    Raises:
        MethodError: it has several, or none.
    """
    names = list(parts_of(solution.patches, groups))
    if len(names) != 1:
        held = shown(names) or "there are none"
        raise MethodError(
            f"the solution holds the light of all groups together ({held}), and their sum tells of none alone: give the "
            "scene or its patches, from which each group is solved by itself"
        )
    return names[0]


def _together(parts: dict[str, Measurement]) -> Measurement:
    """Return the sum of the light of groups, which keeps each."""
    found = list(parts.values())
    statuses = {one.status for one in found}
    return replace(
        found[0],
        values=sum((one.values for one in found[1:]), found[0].values),
        inside=np.any([one.inside for one in found], axis=0),
        rays=sum(one.rays for one in found),
        status=next((status for status in ("interrupted", "not reached") if status in statuses), "complete"),
        parts={name: one.values for name, one in parts.items()},
        outside=found[0].outside if len(found) == 1 else None,
        outsides={name: one.outside for name, one in parts.items() if one.outside is not None},
    )


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


def _tell_of_inside(found: Measurement) -> None:
    """Name the sensors that see mostly backs."""
    sensors, where = found.sensors, np.flatnonzero(found.inside)
    if len(where):
        names = shown([f"{sensors.names[sensors.set[i]]} at {np.round(sensors.points[i], 3).tolist()}" for i in where], 5)
        warn(
            f"{len(where)} of {len(sensors)} sensors see mostly backs of surfaces: {names}; they seem to lie inside of "
            "something, or behind a wall, and are left out of minimum, mean and uniformity. Move them, or turn the faces"
        )
