"""`radiative_exchange`: net heat of surfaces and floating temperatures, with error bars."""

import time
import warnings
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ..device.backend import choose
from ..errors import MethodError, RadiosityWarning
from ..patches import Patches, subdivide
from ..run.budget import Budget
from ..run.line_set.model import LineSet
from ..run.on_cluster import on_cluster
from ..run.progress import Listener
from ..run.whole_number import whole
from ..scene.model import Scene
from ..tracing.geometry import Geometry
from .conditions import Conditions
from .estimate import Estimate, Estimator
from .groups import groups_of
from .narrow import warn_of_narrow
from .result import RadiativeExchange
from .target import Target
from .tracing import trace

RAYS = 2_000_000  # where nothing else is asked for
PATCHES = 2_000  # of a scene that is not cut yet
FIRST = 64  # lines of a patch in the first stage of a run to an error
MOST, ENDLESS = 2**34, 2**60  # lines in all, where there is no limit: while the error is unknown, and when it is known
LEAP = 4  # most doublings between two looks at the error
SLOPE = 0.6  # of the error against lines, by which the next look is chosen


def radiative_exchange(
    scene: Scene | Patches | LineSet,
    temperature: Mapping[str, float] | None = None,
    *,
    emissivity=None,
    flux: Mapping[str, float] | None = None,
    adiabatic: Iterable[str] = (),
    isothermal: Iterable[str] = (),
    surroundings: float | None = None,
    wavelengths: Iterable[float] | None = None,
    rays: float | None = None,
    error: float | None = None,
    error_of: str | None = None,
    replicates: int = 8,
    seed: int = 0,
    device: str = "auto",
    progress: Listener | None = None,
    memory: str | float | None = None,
    cluster: Any = None,
) -> RadiativeExchange:
    """Solve for the heat that surfaces exchange by radiation.

    Each surface has a temperature, a flux, or is adiabatic: from the arguments, or from the scene's .toml file. Arguments go
    first. Names of surfaces may be patterns such as ``"wall*"``; an exact name goes before a pattern, and that before ``"*"``.

    Args:
        scene: a `Scene` (cut into about 2 000 patches), the `Patches` of one, or a `LineSet` whose lines are taken.
        temperature: K, of surfaces by name.
        emissivity: by name, or one number for all surfaces; above 0, at most 1; with ``wavelengths`` also a list, one number a
            band. Sides may differ: ``{"shield": {"front": 0.05, "back": 0.8}}``. Absorptance is the same. Default: 1 -
            reflectance, if the scene's file gives it, which is told.
        flux: W that a whole surface gets from elsewhere and gives off; negative: that it is cooled by.
        adiabatic: names of surfaces that get nothing from elsewhere. Each cell of such a surface, and of one of given flux, takes
            a temperature of its own, the same on both sides where both radiate: so a sheet is a radiation shield.
        isothermal: names of those of them that conduct well, so that the whole surface has one temperature.
        surroundings: K, of the black surroundings of what leaves the scene. A scene that lines leave needs it; 0 is allowed.
        wavelengths: edges between bands in micrometres, ascending, such as [3, 8]; the first band is below the first edge.
        rays: lines in all; default two million.
        error: trace until the relative error is below this, such as 0.01; in 95 % of runs the true error then is. ``rays`` beside
            it is a limit. Where it is not reached, the status says so, and a warning tells.
        error_of: "net:NAME" or "temperature:NAME"; default: of the net heat of all surfaces of given temperature, relative to the
            largest.
        replicates: independent randomised runs; from 2 on there are errors.
        seed: with the same inputs, the same bits.
        device, progress, memory, cluster: as in `solve`.

    Raises:
        SceneError: a condition is missing, given twice, unknown or out of range; lines escape and there are no surroundings;
            nothing determines a temperature. MethodError: no such surface, or a budget that makes no sense.

    Example:
        >>> maze = rd.subdivide(rd.load_scene("labyrinth"), cells=1)
        >>> heat = rd.radiative_exchange(maze, {"floor": 310, "*": 290}, emissivity=0.9, rays=100_000)
        >>> bool(heat["floor"]["net"] > 0), bool(abs(heat.net.sum()) < 1e-6)
        (True, True)
    """
    begun = time.perf_counter()
    replicates, seed = whole(replicates, "replicates", 1), whole(seed, "seed", 0)
    if not isinstance(scene, (Scene, Patches, LineSet)):
        raise MethodError(f"radiative_exchange takes a Scene, Patches or a LineSet, not {type(scene).__name__}")
    lines = scene if isinstance(scene, LineSet) else None
    if lines is not None and (rays is not None or error is not None or cluster is not None):
        raise MethodError("lines are there already: leave rays, error and cluster out, or give the patches")
    cut = subdivide(scene, about=PATCHES) if isinstance(scene, Scene) else scene
    patches = cut.patches if isinstance(cut, LineSet) else cut
    conditions = Conditions.of(
        patches,
        temperature=temperature,
        emissivity=emissivity,
        flux=flux,
        adiabatic=adiabatic,
        isothermal=isothermal,
        surroundings=surroundings,
        wavelengths=wavelengths,
    )
    if error_of is not None and error is None:
        raise MethodError("error_of says whose error is to be reached; give the error, too (error=0.01, --error 1%)")
    estimator = Estimator(patches, conditions)
    if lines is None or lines.method.lines == "local":
        warn_of_narrow(Geometry(patches, choose(device)), groups_of(patches, "surface"))
    options: dict[str, Any] = {"replicates": replicates, "seed": seed, "device": device, "progress": progress, "memory": memory}
    status = "complete"
    with on_cluster(cluster) as client:  # one for all stages
        options["cluster"] = client
        if error is None:
            if lines is None:
                lines = trace(patches, conditions, RAYS if rays is None else rays, None, **options)
                status = lines.status
            found = estimator.estimate(lines.pairs)
        else:
            target = Target.of(patches.scene.names, estimator.floats, error, error_of)
            if replicates < 2:
                raise MethodError("an error can be reached with 2 replicates or more; one alone tells none")
            lines, found, status = _until(target, estimator, rays, options)
    return _result(patches, conditions, found, lines, status, time.perf_counter() - begun)


def _until(target: Target, estimator: Estimator, rays: float | None, options: dict):
    """Trace in stages that double until the error is reached; return lines, estimate and status.

    Ctrl-C returns those of the last stage that was solved.
    """
    patches, most = estimator.patches, int(Budget(rays=ENDLESS if rays is None else rays).rays or 0)
    goal = min(max(FIRST * len(patches), 2000 * options["replicates"]), most)
    last = None
    while True:
        try:
            lines = trace(patches, estimator.conditions, goal, last and last[0], **options)
            found = estimator.estimate(lines.pairs, tell=last is None)
        except KeyboardInterrupt:
            if last is None:
                raise
            return *last, "interrupted"
        bound, last = target.reached(found, options["replicates"]), (lines, found)
        if bound <= target.error:
            return lines, found, "complete"
        if lines.status == "interrupted":
            return lines, found, "interrupted"
        known = np.isfinite(bound) and bound > 0
        if goal >= most or (rays is None and not known and goal >= MOST) or lines.status != "complete":
            break
        doublings = np.log2(bound / target.error) / SLOPE if known else 1.0
        goal = min(goal * 2 ** int(np.clip(np.floor(doublings), 1, LEAP)), most)
    text = f"is {bound:.2%}" if np.isfinite(bound) else "cannot be judged from so few lines"
    warnings.warn(
        f"the error asked for, {target.error:.2%}, was not reached with {lines.rays:,} lines: it {text}; take more rays",
        RadiosityWarning,
        stacklevel=3,
    )
    return lines, found, "not reached"


def _result(patches: Patches, conditions: Conditions, found: Estimate, lines, status: str, seconds: float) -> RadiativeExchange:
    k = len(patches.scene.names)
    area = np.bincount(patches.surface, patches.area, k)
    mean = [_means(patches, band) for band in conditions.emissivity]
    kind = np.where(~np.isnan(conditions.temperature), "temperature", np.where(conditions.flux == 0, "adiabatic", "flux"))
    kind = np.where(area > 0, kind, "none")
    return RadiativeExchange(
        names=patches.scene.names,
        conditions=tuple(kind.tolist()),
        area=area,
        emissivity=np.stack(mean, axis=1),
        net=found.net[:k],
        net_standard_error=found.net_error[:k],
        temperature=found.temperature,
        temperature_standard_error=found.temperature_error,
        surroundings=conditions.surroundings,
        surroundings_net=float(found.net[k]),
        surroundings_net_standard_error=float(found.net_error[k]),
        exchange=found.exchange,
        exchange_standard_error=found.exchange_error,
        wavelengths=conditions.wavelengths,
        patch_net=found.patch_heat / patches.area,
        patch_net_standard_error=found.patch_heat_error / patches.area,
        patch_temperature=found.patch_temperature,
        patches=patches,
        rays=int(lines.rays),
        replicates=int(lines.replicates),
        seed=int(lines.seed),
        quanta=int(lines.quanta),
        seconds=seconds,
        status=status,
        provenance=dict(lines.provenance),
    )


def _means(patches: Patches, values: np.ndarray) -> np.ndarray:
    """Area means over surfaces, (k,), to the last bit where all values of a surface are equal."""
    k, result = len(patches.scene.names), []
    for i in range(k):
        here = patches.surface == i
        equal = not here.any() or np.ptp(values[here]) == 0
        result.append(
            values[here].max(initial=np.nan if not here.any() else 0.0)
            if equal
            else np.average(values[here], weights=patches.area[here])
        )
    return np.array(result)
