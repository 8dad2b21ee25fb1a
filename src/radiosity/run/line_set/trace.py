"""`trace_lines`, which makes a line set from a scene."""

import warnings
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from ...device.memory import limited
from ...device.turn import turn
from ...diagnostics.contact_findings import tell
from ...errors import MethodError, RadiosityWarning, result_kept
from ...hooks import HOOKS
from ...method import Method
from ...patches import Patches
from ...sampling.streams import Seed
from ...scene.model import Scene
from ..budget import Budget
from ..checkpoint import Checkpoint
from ..part import Part
from ..progress import Listener
from ..refusals import refuse_open, refuse_panes
from ..shortfall import warn_of_more
from ..solve import patches_of
from ..whole_number import whole
from .model import LineSet
from .problem import Sources, problem_of
from .saving import save_lines

ENDED = ("complete", "interrupted")  # what needs no warning


def trace_lines(
    scene: Scene | Patches,
    *,
    rays: float | None = None,
    seconds: float | None = None,
    quanta: int | None = None,
    replicates: int = 8,
    seed: int = 0,
    first_replicate: int = 0,
    sources: Iterable[str] | Mapping[str, str] | None = None,
    lines: str = "local",
    numbers: str = "halton",
    both_ways: bool = True,
    device: str = "auto",
    progress: Listener | None = None,
    resume: LineSet | None = None,
    checkpoint: str | Path | Checkpoint | None = None,
    checkpoint_every: float = 30.0,
    memory: str | float | None = None,
    cluster: Any = None,
) -> LineSet:
    """Count lines between patches, once for any light. Emission and reflectance of the scene do not matter.

    Args:
        scene: a `Scene` (cut into about 20 000 patches) or the `Patches` of one. Nothing in it needs to emit.
        rays, seconds, quanta: exactly one: lines in all (replicates together), wall time, or N of each replicate. Each patch has
            4 lines in each replicate at least.
        replicates: independent randomised sets of lines; from 2 on there are standard errors.
        seed: with the same geometry, the same bits.
        first_replicate: count the replicates of the seed from this one on: sets of different replicates are added.
        sources: names of surfaces (or patterns such as ``lamp*``) that share a quarter of all lines, in proportion to area; the
            other lines are shared by the area of all. Name small surfaces that matter, such as lamps and heaters: by area alone
            they have few lines, and large errors. For one side alone give a dictionary: ``{"lamp": "front"}``. For local lines.
        lines: "local" (from the patches), or global ones: "global", "global-disc", "spans", "bundles".
        numbers: the sequence of points, as of `Method`.
        both_ways: each local line counts at both its ends, and rows are balanced: reciprocal, and with the right sums. False:
            lines count where they begin alone. Lines of scenes with backs that let lines pass always do so.
        device, progress, checkpoint, checkpoint_every, memory, cluster: as of `solve`. On a cluster an interruption returns the
            lines of the last complete stage.
        resume: a line set of the same geometry, sources, seed and replicates to go on from, also an interrupted one; the budget
            counts its lines. The result is that of one run with as many quanta.

    Returns:
        The line set. Ctrl-C ends the run early and returns the lines so far, which are a whole set.

    Raises:
        MethodError: a choice or budget that makes no sense, a line set that cannot be continued, or more memory than the run may
            take. OutputError, DeviceError, KeyboardInterrupt: as of `solve`.

    Example:
        >>> patches = rd.subdivide(rd.load_scene("room"), cells=2)
        >>> lines = rd.trace_lines(patches, rays=100_000, sources={"light": "front"})
        >>> lines.replicates, lines.sources, abs(lines.rays - 100_000) < 1_000
        (8, ('light (front)',), True)
    """
    method = Method(order="matrix", lines=lines, numbers=numbers)
    part = Part(Seed(whole(seed, "seed", 0), whole(first_replicate, "first_replicate", 0)), whole(replicates, "replicates", 1))
    if sum(given is not None for given in (rays, seconds, quanta)) != 1:
        raise MethodError("give exactly one of rays, seconds and quanta to trace_lines")
    asked = Budget(rays, seconds, None, quanta)
    asked.check(part.replicates)
    if not isinstance(both_ways, bool):
        raise MethodError(f"both_ways is {both_ways!r}; it must be True or False")
    if resume is not None and not isinstance(resume, LineSet):
        raise MethodError(f"resume takes a LineSet, not {type(resume).__name__}; load a file with load_lines")
    if resume is not None and len(resume.parts) > 1:
        raise MethodError("cannot go on from a sum of line sets; go on with each of them, and add them again")
    with limited(memory), turn():
        if resume is not None and isinstance(scene, Scene) and resume.patches.scene.is_cut_of(scene):
            scene = resume.patches
        patches = patches_of(scene, method, "trace_lines")
        if resume is not None and len(resume.patches) != len(patches):
            raise MethodError(
                f"cannot go on from lines of {len(resume.patches)} patches with {len(patches)}; cut the scene alike"
            )
        refuse_open(patches.scene, method)
        refuse_panes(patches.scene, method)
        chosen = Sources.of(patches, sources)
        if chosen.names and lines != "local":
            raise MethodError(f"sources get more local lines, and lines '{lines}' begin at no surface; leave one of the two out")
        keeper = checkpoint if checkpoint is None else Checkpoint.of(checkpoint, checkpoint_every, method, save_lines)
        from ..run import Run
        from .record import LineRecord

        known = asked.rays is not None and lines == "local"  # then so is N, and no pilot is needed
        budget = Budget(quanta=max(1, round((asked.rays or 0) / part.replicates))) if known else asked
        record = partial(LineRecord, sources=chosen.names, both_ways=both_ways)
        problem = problem_of(patches, chosen)
        run = Run(patches, method, budget, part, device, progress, resume, keeper, record=record, problem=problem)
        tell(patches.scene, any_light=True)  # what searches the faces comes after the memory estimate
        found = run.solve() if cluster is None else HOOKS["cluster"](cluster, lambda: run)
    with result_kept():
        if resume is None and known:
            warn_of_more(found.rays, asked, part.replicates, patches)
        if found.status not in ENDED:
            warnings.warn(f"{found.rays:,} lines were traced, and no more: {found.status}", RadiosityWarning, stacklevel=2)
    return found
