"""`view_factors`, which makes view factors from a scene or from lines that were traced before."""

from typing import Any

import numpy as np

from ..device.backend import choose
from ..device.memory import limited
from ..device.turn import turn
from ..diagnostics.contact_findings import tell
from ..errors import MethodError
from ..patches import Patches, subdivide
from ..run.budget import Budget
from ..run.line_set.model import LineSet
from ..run.line_set.trace import trace_lines
from ..run.progress import Listener
from ..run.whole_number import whole
from ..sampling.streams import Seed
from ..scene.model import Scene
from ..tracing.geometry import Geometry
from .choice import MANY, PILOT, Choice, Rays
from .factor_target import FactorTarget, until
from .from_lines import from_lines
from .from_polygons import FacingPairs, from_polygons
from .groups import Groups, groups_of
from .narrow import warn_of_narrow
from .view_factors import ViewFactors

METHODS = ("auto", "lines", "polygons")
USUAL = 1_000_000  # lines
LEAST = 16  # lines of a patch and replicate in the pilot; runs that are not twice as long count lines without one


def view_factors(
    scene: Scene | Patches | LineSet,
    *,
    rays: float | None = None,
    error: float | None = None,
    error_of: str | None = None,
    group: str | dict | np.ndarray | list = "surface",
    method: str = "auto",
    replicates: int = 8,
    seed: int = 0,
    sources=None,
    numbers: str = "halton",
    device: str = "auto",
    progress: Listener | None = None,
    memory: str | float | None = None,
    cluster: Any = None,
) -> ViewFactors:
    """Return view factors between surfaces, groups of surfaces or patches.

    Emission and reflectance do not matter. Surfaces are diffuse, and what is between them does nothing.

    Args:
        scene: a `Scene`, its `Patches`, or lines that `trace_lines` has counted. A scene is not cut for factors between surfaces;
            between patches it is cut into about 20 000.
        rays: lines in all, replicates together; the default is a million. It is also the work of polygons, see ``method``.
        error: take more lines until this relative error is reached, such as 0.01: the RMS error of all factors over their RMS; in
            95 % of runs the true error is below it. ``rays`` beside it is a limit. Where it is not reached, the status says so,
            and a warning tells.
        error_of: ``row:NAME`` is the error of the factors of one group; ``NAME`` may be a pattern.
        group: "surface" (a surface of two radiating sides is two groups, such as ``shield (front)`` and ``shield (back)``),
            "patch", a dictionary of names to names of surfaces or patterns, such as ``{"walls": ["north", "south"]}`` (surfaces
            that it does not name are groups of their own), or a whole number for each patch.
        method: "lines" are counted. "polygons" have exact factors without obstacles, and rays find the visible share of each
            pair, one or more. "auto" takes what has the smaller predicted error after the work of as many lines.
        replicates: independent randomised runs; from 2 on there are standard errors. Of lines that were counted: theirs.
        seed: with the same inputs, the same bits.
        sources: names of small surfaces that get more lines, as of `trace_lines`.
        numbers: the sequence of points of lines, as of `Method`.
        device, progress, memory: as of `solve`.
        cluster: as of `solve`, for lines; pairs of polygons are traced here.

    Returns:
        The factors. Those of lines are as counted, see `ViewFactors.restored`; those of polygons are restored.

    Raises:
        MethodError: a choice or budget that makes no sense, a group that does not exist, or polygons that cannot be taken.

    Example:
        >>> factors = rd.view_factors(rd.load_scene("room"), rays=100_000, method="lines").restored()
        >>> floor, ceiling = factors.names.index("floor"), factors.names.index("ceiling")
        >>> bool(0.1 < factors.matrix[floor, ceiling] < 0.5), bool(factors.standard_error[floor, ceiling] < 0.01)
        (True, True)
    """
    if method not in METHODS:
        raise MethodError(f"method '{method}' does not exist; known are {', '.join(METHODS)}")
    if error_of is not None and error is None:
        raise MethodError("error_of says whose error is to be reached; give the error, too (error=0.01, --error 1%)")
    if isinstance(scene, LineSet):
        return _of_lines(scene, rays if error is None else error, group, method)
    if error is not None:
        target, patches = FactorTarget.of(error, error_of), _cut(scene, group)
        target.check(groups_of(patches, group).names)
        options: dict = {"group": group, "method": method, "replicates": replicates, "seed": seed, "sources": sources}
        options |= {"numbers": numbers, "device": device, "progress": progress, "memory": memory, "cluster": cluster}
        return until(target, lambda work: view_factors(patches, rays=work, **options), len(patches), replicates, rays)
    Budget(rays=USUAL if rays is None else rays)  # refuses what is no number of lines
    work = int(USUAL if rays is None else rays)
    replicates, number = whole(replicates, "replicates", 1), Seed(whole(seed, "seed", 0))
    with limited(memory), turn():
        patches = _cut(scene, group)
        groups = groups_of(patches, group)
        facts = {"scene": patches.scene.source, "geometry": patches.hash, "seed": number.value, "work": work}
        arguments = {"replicates": replicates, "seed": number.value, "sources": sources, "numbers": numbers, "device": device}
        geometry, pilot = Geometry(patches, choose(device)), None
        if method == "polygons":
            tell(patches.scene, any_light=True)
            pairs = FacingPairs.of(geometry, len(groups.names))
            spent = Rays.of(work, len(patches), len(pairs.one), replicates)
            return _polygons(pairs, groups, spent, replicates, number, facts)
        if method == "auto" and (choice := Choice.of(geometry, groups, work, replicates, number)):
            few = LEAST * replicates * len(patches)
            few = max(min(work // PILOT, 4 * few), few)
            predicted = {}
            if len(groups.names) > MANY:
                predicted = choice.by_counts(groups, work, number)
            elif few <= work // 2:
                pilot = trace_lines(patches, rays=few, progress=progress, **arguments)
                some = from_lines(pilot.pairs, groups, pilot.rays, {"line_set": pilot.provenance}, pilot.status)
                if pilot.status == "interrupted":
                    return some
                predicted = choice.by_pilot(some.restored(), groups, work, number)
            if predicted:
                facts |= {"predicted": predicted}
                if predicted["polygons"] < predicted["lines"]:
                    pairs = FacingPairs.of(geometry, len(groups.names), choice.sample.facing)
                    return _polygons(pairs, groups, choice.spent, replicates, number, facts)
        warn_of_narrow(geometry, groups)
        lines = trace_lines(patches, rays=work, progress=progress, resume=pilot, cluster=cluster, **arguments)
        return from_lines(lines.pairs, groups, lines.rays, facts | {"line_set": lines.provenance}, lines.status)


def _cut(scene: Scene | Patches, group) -> Patches:
    """Return patches; a scene is cut where its patches themselves are asked for."""
    if isinstance(scene, Scene):
        return subdivide(scene) if isinstance(group, str) and group == "patch" else subdivide(scene, cells=1)
    if not isinstance(scene, Patches):
        raise MethodError(
            f"view_factors takes a Scene, Patches or a LineSet, not {type(scene).__name__}; load a file with load_scene"
        )
    return scene


def _of_lines(lines: LineSet, rays, group, method: str) -> ViewFactors:
    if method == "polygons" or rays is not None:
        word = "polygons need the patches themselves" if method == "polygons" else "rays were traced already"
        raise MethodError(
            f"view_factors of a line set: {word}; give its patches (lines.patches), or leave method, rays and error out"
        )
    groups = groups_of(lines.patches, group)
    if lines.method.lines == "local":
        warn_of_narrow(Geometry(lines.patches, choose("auto")), groups)
    return from_lines(lines.pairs, groups, lines.rays, {"line_set": lines.provenance}, lines.status)


def _polygons(pairs: FacingPairs, groups: Groups, spent: Rays, replicates: int, seed: Seed, facts: dict) -> ViewFactors:
    rays = max(spent.pair, 1.0)
    facts = facts | {"rays_of_a_pair": rays, "lines_of_a_patch": spent.missed}
    return from_polygons(pairs, groups, int(rays * len(pairs.one)), spent.missed, replicates, seed, facts)
