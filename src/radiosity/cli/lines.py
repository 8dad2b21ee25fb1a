"""``radiosity lines``"""

from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Group, Parameter

from ..errors import MethodError, OutputError, printable
from . import checkpoints, interrupts, outputs
from .options import Count, Flag, Seconds
from .solve import DEFAULT_RAYS
from .solve_options import PATCHES, RUN, Machine, Mesh, SceneOptions, Unset
from .streams import say, tell

BUDGET, LINES = Group("How long to trace: one of these", sort_key=1), Group("The lines", sort_key=2)


@dataclass(frozen=True)
class LineBudget:
    """The budget: when to stop.

    Attributes:
        rays: Number of lines in all, such as 10M (the default), 500k or 1e7.
        seconds: Time to trace, such as 60, 5min or 1h.
        quanta: Reproduce lines: their number N of each replicate.
    """

    rays: Count = None
    seconds: Seconds = None
    quanta: Count = None


@dataclass(frozen=True)
class LineChoices:
    """Which lines are traced.

    Attributes:
        sources: Surfaces that share a quarter of all lines, such as lamps and heaters: by area alone small ones have few. Several
            at once; NAME may be a pattern such as lamp*, and NAME:front or NAME:back is one side alone.
        lines: local (from the patches), or global ones: global, global-disc, spans, bundles.
        numbers: Sequence of points that lines are made from; `radiosity methods numbers` lists the choices.
        one_way: Count lines where they begin alone. By default each counts at both its ends, and rows are balanced.
    """

    sources: Annotated[tuple[str, ...], Parameter(consume_multiple=(1, None), negative=(), show_default=False)] = ()
    lines: str = "local"
    numbers: str = "halton"
    one_way: Flag = False


@dataclass(frozen=True)
class LineRunning(Machine):
    """What concerns the run.

    Attributes:
        replicates: Number of independent randomised sets of lines, from which errors are found.
        first_replicate: Trace the replicates of the seed from this one on: `relight` adds files of other replicates.
        resume: Continue from this .npz file of lines of the same geometry, sources, seed and replicates; its lines count. It
            reuses its patches unless you set others.
        checkpoint: An .npz file that keeps the lines so far, written about every 30 seconds, for --resume after a crash. It is
            removed at the end. Default: for runs of half a minute and more, beside the output.
        no_checkpoint: Write no checkpoint.
        cluster: Trace on the workers of Dask, as of `radiosity solve`: tcp://HOST:PORT, or local:N.
    """

    replicates: Count = 8
    first_replicate: Annotated[int, Parameter(show_default=False)] = 0
    resume: Path | None = None
    checkpoint: Path | None = None
    no_checkpoint: Flag = False
    cluster: str | None = None


class Plain:
    """Each group of options where none of them is given."""

    budget, choices, size, run = LineBudget(), LineChoices(), Mesh(), LineRunning()


def lines(
    scene: str,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    budget: Annotated[LineBudget, Parameter(name="*", group=BUDGET)] = Plain.budget,
    choices: Annotated[LineChoices, Parameter(name="*", group=LINES)] = Plain.choices,
    size: Annotated[Mesh, Parameter(name="*", group=PATCHES)] = Plain.size,
    run: Annotated[LineRunning, Parameter(name="*", group=RUN)] = Plain.run,
    reading: SceneOptions = Unset.reading,
) -> int:
    """Count lines between the patches of a scene, once for any light; `radiosity relight` solves with them.

    Emission and reflectance do not matter, and nothing needs to emit. Ctrl-C ends the run early and writes the lines so far.

    Parameters
    ----------
    scene
        A scene file or the name of a built-in scene, as of `radiosity solve`.
    output
        The .npz file to write.
    """
    if output.suffix.lower() != ".npz":
        raise OutputError(f"{output}: lines are written to an .npz file; give it that suffix")
    import radiosity as rd

    from ..run.line_set.saving import save_lines
    from ..solution.whole import check_place
    from .progress import bar

    check_place(output)
    if budget == Plain.budget:
        budget = replace(budget, rays=DEFAULT_RAYS)
    method = rd.Method(order="matrix", lines=choices.lines, numbers=choices.numbers)
    loaded = outputs.scene_of(scene, reading, [output])
    before = None if run.resume is None else rd.load_lines(run.resume)
    keeper = checkpoints.chosen(run.checkpoint, run.no_checkpoint, [output], method, run.resume, save_lines)
    try:
        with bar() as progress:
            given: dict[str, Any] = asdict(budget) | {
                name: getattr(run, name) for name in ("seed", "device", "replicates", "first_replicate", "memory", "cluster")
            }
            found = rd.trace_lines(
                _patches(loaded, size, before, run, progress),
                **given,
                sources=_sources(choices.sources),
                lines=choices.lines,
                numbers=choices.numbers,
                both_ways=not choices.one_way,
                progress=progress,
                resume=before,
                checkpoint=keeper,
            )
        found.save(output)
    except KeyboardInterrupt:
        if keeper is None or not keeper.written:
            raise
        return checkpoints.left_behind(keeper)
    tell(str(found))
    tell(f"wrote {printable(output)}")
    checkpoints.finish(keeper, found, [output], named=run.checkpoint is not None, resume=run.resume)
    if found.status == "interrupted":
        say(found.status, f"stopped before the end; --resume {output} goes on from there")
        return interrupts.status()
    return 0


def _sources(given: tuple[str, ...]) -> dict[str, str] | None:
    """Return names and sides; a name that ends in :front or :back is one side of a surface."""
    found = {}
    for text in given:
        name, between, side = text.rpartition(":")
        one = between and side in ("front", "back")
        if not (name if one else text):
            raise MethodError(f"--sources {text!r}: it names no surface; write NAME or NAME:front")
        found |= {name: side} if one else {text: "both"}
    return found or None


def _patches(scene, size: Mesh, before, run: LineRunning, progress):
    """Return the scene cut as asked, or else as in the lines to continue, or else as it is."""
    import radiosity as rd

    if size.sized:
        return rd.subdivide(scene, size=size.patch_size, cells=size.cells, contacts=size.contacts)
    if size.follows:
        return rd.adapt(scene, size.patches, seed=run.seed, device=run.device, memory=run.memory, progress=progress)
    if before is not None and before.patches.scene.is_cut_of(scene):
        return before.patches
    if before is not None and before.patches.scene.geometry_hash == scene.geometry_hash:
        return rd.Patches(scene, before.patches.columns, before.patches.rows)
    return scene
