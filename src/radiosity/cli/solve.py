"""``radiosity solve``"""

from dataclasses import asdict, replace
from functools import partial

from ..errors import MethodError
from . import checkpoints, interrupts, live, outputs
from .live import UNSEEN, LiveOptions
from .solve_options import (
    BaselineOptions,
    BudgetOptions,
    Cut,
    CutOptions,
    MethodName,
    MethodOptions,
    OutputOptions,
    Running,
    RunOptions,
    SceneOptions,
    Unset,
)
from .streams import say, tell

DEFAULT_RAYS = 10_000_000
NOT_REACHED = 3  # exit status: results are there, above the error asked for


def solve(
    scene: str,
    /,
    *,
    files: OutputOptions = Unset.output,
    seen: LiveOptions = UNSEEN,
    budget: BudgetOptions = Unset.budget,
    run: RunOptions = Unset.run,
    method: MethodName = "auto",
    choices: MethodOptions = Unset.method,
    baseline: BaselineOptions = Unset.baseline,
    cut: CutOptions = Unset.cut,
    reading: SceneOptions = Unset.reading,
) -> int:
    """Solve a scene, print a report and write the outputs.

    Exit status: 0 when all went well, 1 failed, 2 wrong input, 3 the error asked for was not reached (results are written), 128
    and the signal's number after an interruption.

    Parameters
    ----------
    scene
        A scene file (.xml .glb .gltf .obj .ply .stl .mgf .rad .hbjson .ifc .vs3 .toml) or a built-in scene: cornell-box,
        room, rooms, studio, labyrinth.
    method
        Name of a method; `radiosity methods` lists them. auto chooses one for the scene, by a short pilot run; it takes
        --basis. The other options below change a part of the method. Without a method they change random-walk.
    """
    given = budget.given
    seen.check(refines=cut.refine_check)
    if cut.refine_check and (run.resume is not None or run.checkpoint is not None):
        raise MethodError("--refine-check solves anew on two meshes; it cannot --resume a run, and keeps no --checkpoint")
    output = files.output
    tables = [path.with_suffix(".refine.csv") for path in output if path.suffix.lower() == ".csv"] if cut.refine_check else []
    outputs.check([*output, *tables])

    import radiosity as rd

    from .progress import bar

    chosen = rd.method.resolve(method, **(asdict(choices) | asdict(baseline)))
    if not given and not isinstance(chosen, rd.Baseline):
        budget = replace(budget, rays=DEFAULT_RAYS)
    loaded = outputs.scene_of(scene, reading, [*outputs.files_of(output), *tables])
    before = None if run.resume is None else rd.load_solution(run.resume)
    keeper = None if cut.refine_check else checkpoints.chosen(run.checkpoint, run.no_checkpoint, output, chosen, run.resume)
    with bar() as progress:
        patches = _patches(loaded, cut, chosen, before, run, progress)

    with live.page(seen, patches) as shown:
        checked = None
        try:
            with bar() as progress:
                options = asdict(budget) | {name: getattr(run, name) for name in ("seed", "device", "replicates", "memory")}
                options |= {"cluster": run.cluster}
                if cut.refine_check:
                    checked = rd.refine_check(patches, chosen, **options, progress=progress)
                    solution = checked.coarse
                else:
                    told = live.listeners(shown, progress)
                    solution = rd.solve(patches, chosen, **options, **told, resume=before, checkpoint=keeper)
            also: list = [("the report", lambda: tell(solution.report()))]
            if checked is not None:
                also += [("the refine check's report", lambda: tell(f"\n{checked.report()}"))]
                also += [(path, partial(checked.export, path)) for path in tables]
            kept = None if keeper is None else keeper.path
            outputs.write(solution, output, exposure=files.exposure, checkpoint=kept, also=also)
        except KeyboardInterrupt:
            if keeper is None or not keeper.written:
                raise
            return checkpoints.left_behind(keeper)
        left = checkpoints.finish(keeper, solution, output, named=run.checkpoint is not None, resume=run.resume)
        if left is not None:
            say(solution.status, f"stopped before the end; --resume {left} goes on from there")
        live.finish(shown, solution)
    if solution.status == "interrupted":
        return interrupts.status()
    ends = [solution.status] if checked is None else [checked.coarse.status, checked.fine.status]
    return NOT_REACHED if "not reached" in ends else 0


def _patches(scene, cut: Cut, method, before, run: Running, progress):
    """Return the scene cut as asked, or else as in the run to continue, or else as it is."""
    import radiosity as rd

    from ..run.baseline_budget import cut_for
    from ..run.refusals import refuse_hierarchical

    if cut.given and cut.follows:
        refuse_hierarchical(method)
        options = {name: getattr(run, name) for name in ("seed", "device", "memory")}
        count = cut.patches or len(rd.subdivide(scene, **cut_for(method)))
        return rd.adapt(scene, count, progress=progress, basis=getattr(method, "basis", "constant"), **options)
    if cut.given:
        if cut.contacts:
            refuse_hierarchical(method)
        size = {"size": cut.patch_size, "cells": cut.cells} if cut.patch_size or cut.cells else cut_for(method)
        return rd.subdivide(
            scene, **(size | {"powers_of_two": cut.powers_of_two or method.needs_powers_of_two, "contacts": cut.contacts})
        )
    if before is not None and (before.patches.scene.hash == scene.hash or before.patches.scene.is_cut_of(scene)):
        return before.patches
    return scene
