"""``radiosity solve``"""

from functools import partial
from pathlib import Path
from typing import Annotated

from ..errors import MethodError
from . import checkpoints, interrupts, outputs
from .options import (
    BASELINE,
    LENGTH,
    METHOD,
    PATCHES,
    RUN,
    SCENE,
    Chosen,
    Count,
    DeviceName,
    Flag,
    Length,
    Outputs,
    Seconds,
    Seed,
    Share,
    Stops,
)
from .streams import say, tell

DEFAULT_RAYS = 10_000_000
NOT_REACHED = 3  # exit status: results are there, above the error asked for


def solve(
    scene: str,
    /,
    *,
    output: Outputs = (),
    rays: Annotated[Count, LENGTH] = None,
    seconds: Annotated[Seconds, LENGTH] = None,
    error: Annotated[Share, LENGTH] = None,
    error_of: Annotated[str | None, LENGTH] = None,
    quanta: Annotated[Count, LENGTH] = None,
    method: Annotated[str, METHOD] = "random-walk",
    equation: Annotated[str | None, METHOD] = None,
    lines: Annotated[str | None, METHOD] = None,
    order: Annotated[str | None, METHOD] = None,
    numbers: Annotated[str | None, METHOD] = None,
    randomisation: Annotated[str | None, METHOD] = None,
    estimator: Annotated[str | None, METHOD] = None,
    absorption: Annotated[str | None, METHOD] = None,
    first_shot: Annotated[Share, METHOD] = None,
    control_variate: Annotated[bool | None, METHOD] = None,
    warm_up: Annotated[bool | None, METHOD] = None,
    reconstruction: Annotated[str | None, METHOD] = None,
    factors: Annotated[str | None, BASELINE] = None,
    solver: Annotated[str | None, BASELINE] = None,
    reciprocal: Annotated[Chosen, BASELINE] = None,
    resolution: Annotated[Count, BASELINE] = None,
    rotated: Annotated[bool | None, BASELINE] = None,
    samples: Annotated[Count, BASELINE] = None,
    ambient: Annotated[Chosen, BASELINE] = None,
    overshooting: Annotated[Chosen, BASELINE] = None,
    epsilon: Annotated[Share, BASELINE] = None,
    refinement: Annotated[str | None, BASELINE] = None,
    patch_size: Annotated[Length, PATCHES] = None,
    cells: Annotated[Count, PATCHES] = None,
    powers_of_two: Annotated[Flag, PATCHES] = False,
    replicates: Annotated[Count, RUN] = None,
    seed: Annotated[Seed, RUN] = 0,
    device: Annotated[DeviceName, RUN] = "auto",
    resume: Annotated[Path | None, RUN] = None,
    checkpoint: Annotated[Path | None, RUN] = None,
    no_checkpoint: Annotated[Flag, RUN] = False,
    memory: Annotated[str | None, RUN] = None,
    coherent: Annotated[Flag, RUN] = False,
    max_reflectance: Annotated[float, SCENE] = 0.95,
    strict: Annotated[Flag, SCENE] = False,
    refine_check: Annotated[Flag, PATCHES] = False,
    allow_outside: Annotated[Flag, SCENE] = False,
    exposure: Stops = None,
) -> int:
    """Solve a scene, print a report and write the outputs.

    Exit status: 0 when all went well, 1 failed, 2 wrong input, 3 the error asked for was not reached (results are written), 128
    and the signal's number after an interruption.

    Parameters
    ----------
    scene
        A scene file (.xml .glb .gltf .obj .ply .stl .mgf .toml) or a built-in scene: cornell-box, room, studio, labyrinth.
    output
        Files to write: .npz .glb .ply .vtp .csv .png .exr, several at once. Beside x.csv, a table of patches, goes
        x.surfaces.csv, a table of surfaces with their net power.
    rays
        Number of lines in all, such as 10M (the default), 500k or 1e7. Baselines run until they are done; progressive and
        hierarchical ones may end at this number.
    seconds
        Time to trace, such as 60, 5min or 1h.
    error
        Trace until the relative error is below this, such as 1% or 0.01. In 95 % of runs the true error then is. A number of
        lines or seconds beside it is a limit. A run that ends above the error, or with too few lines to tell, has the status
        "not reached" and the exit status 3. Without a limit it ends at 4 billion lines a replicate, when its counters are full.
    error_of
        What --error is the error of: surface:NAME (RMS over its patches), or mean:NAME (its mean irradiance, the ± of the
        report). NAME may be a pattern. Default: RMS over all patches.
    quanta
        Reproduce a run: energy packets (quanta) of each replicate, as its report says.
    method
        Name of a method; `radiosity methods` lists them. The options below change a part of it.
    equation
        Where a particle leaves the patch that it hit: discrete (a new point) or continuous (the same point).
    lines
        Line type: local, global, or another one that `radiosity methods lines` lists.
    order
        Which line is fired next; `radiosity methods order` lists the choices.
    numbers
        Sequence of points that lines are made from; `radiosity methods numbers` lists the choices.
    randomisation
        by-patch: each patch shifts the sequence by its own amount. shared: one shift for all patches.
    estimator
        What is counted of a walk or line: collision, absorption, survival, gathering, bidirectional.
    absorption
        How a walk ends: rounded, drawn, fractional.
    first_shot
        Global lines: share of all lines that sends the power of the lights by local lines first, such as 25%.
    control_variate
        Iterations: take a constant radiosity out of what lines carry.
    warm_up
        Regular iterations: begin with incremental ones.
    reconstruction
        Particles: patches (hits are counted) or local-linear (planes are fitted to them).
    factors
        Source of form factors: polygons, hemicube, lines.
    solver
        full-matrix: jacobi, gauss-seidel, southwell, conjugate-gradients.
    reciprocal
        full-matrix: make A_i F_ij symmetric, and rows sum to what does not escape.
    resolution
        Hemicubes: pixels along an edge of the top.
    rotated
        Hemicubes: turned by random angles (the default), or aligned with their faces.
    samples
        Lines for each pair of patches or link (16), or for each patch with --factors lines (4096).
    ambient
        Progressive refinement: add an estimate of the light that was not shot yet.
    overshooting
        Progressive refinement: shoot a part of the light that is still to come, too.
    epsilon
        Hierarchical radiosity: refine links whose error exceeds this share of what the scene emits, such as 1e-5.
    refinement
        Hierarchical radiosity: brightness-factor, error-radiance, error-power.
    patch_size
        Longest edge of a patch, in metres. Default: about 20 000 patches in all; 2 000 for baselines.
    cells
        Cut every face into CELLS x CELLS patches.
    powers_of_two
        Cut faces into 1, 2, 4, 8 ... cells along each edge. Hierarchical radiosity always does; with this option other methods
        have the same patches, to compare with it.
    replicates
        Number of independent randomised runs, from which errors are found. Default: 8; 1 for baselines.
    seed
        Seed of all random numbers. Equal seeds give equal results.
    device
        auto, cpu or cuda.
    resume
        Continue from this .npz file of the same scene, method, seed and replicates, finished or interrupted. Its lines count.
        It reuses its patches unless you set others. Not for full-matrix and hierarchical.
    checkpoint
        An .npz file that keeps the state of the run, written about every 30 seconds, for --resume after a crash, a kill or a
        power cut. It is removed when all outputs are written. Default: for runs of a minute and more, beside the first output:
        out/box.glb -> out/box.checkpoint.npz.
    no_checkpoint
        Write no checkpoint.
    memory
        Memory limit, such as 8G or none. A run that needs more is refused before it begins. Default: 70 % of what is free.
    coherent
        Trace similar lines together. Faster where a patch fires 50 000 lines or more in a sweep; bits may differ where a line
        meets two faces in one point.
    max_reflectance
        Bring larger reflectances in files down to this. What your own .toml sets below 1 stays as it is.
    strict
        Treat faults in the scene as errors, also those that could be skipped with a warning.
    refine_check
        Solve on patches cut into four, too, and report sampling and discretisation errors apart. With a .csv output also as
        NAME.refine.csv.
    allow_outside
        Let the scene name files (includes, meshes, textures) outside its folder.
    exposure
        Brightness of pictures and meshes, in stops above the automatic scale; +1 is twice.
    """
    asked = {"rays": rays, "seconds": seconds, "error": error, "quanta": quanta}
    given = [f"--{name}" for name, value in asked.items() if value is not None]
    if len(given) > 1 and (error is None or quanta is not None):
        raise MethodError(
            f"give one of --rays, --seconds, --error and --quanta, not {' and '.join(given)}; only --error goes with --rays or "
            "--seconds, as its limit"
        )
    if refine_check and (resume is not None or checkpoint is not None):
        raise MethodError("--refine-check solves anew on two meshes; it cannot --resume a run, and keeps no --checkpoint")
    tables = [path.with_suffix(".refine.csv") for path in output if path.suffix.lower() == ".csv"] if refine_check else []
    outputs.check([*output, *tables])

    import radiosity as rd

    from ..run.baseline_budget import cut_for
    from .progress import bar

    choices = {
        "equation": equation,
        "lines": lines,
        "order": order,
        "numbers": numbers,
        "randomisation": randomisation,
        "estimator": estimator,
        "absorption": absorption,
        "first_shot": first_shot,
        "control_variate": control_variate,
        "warm_up": warm_up,
        "reconstruction": reconstruction,
        "coherent": coherent or None,
        "factors": factors,
        "solver": solver,
        "reciprocal": reciprocal,
        "resolution": resolution,
        "rotated": rotated,
        "samples": samples,
        "ambient": ambient,
        "overshooting": overshooting,
        "epsilon": epsilon,
        "refinement": refinement,
    }
    chosen = rd.method.resolve(method, **choices)
    if not given and isinstance(chosen, rd.Method):
        asked["rays"] = DEFAULT_RAYS
    loaded = rd.load_scene(scene, max_reflectance=max_reflectance, strict=strict, allow_outside=allow_outside)
    before = None if resume is None else rd.load_solution(resume)
    keeper = None if refine_check else checkpoints.chosen(checkpoint, no_checkpoint, output, chosen, resume)
    patches = loaded
    if patch_size is not None or cells is not None or powers_of_two:
        size = {"size": patch_size, "cells": cells} if patch_size or cells else cut_for(chosen)
        patches = rd.subdivide(loaded, **(size | {"powers_of_two": powers_of_two or chosen.needs_powers_of_two}))
    elif before is not None and before.patches.scene.hash == loaded.hash:
        patches = before.patches

    checked = None
    try:
        with bar() as progress:
            options = {**asked, "error_of": error_of, "seed": seed, "device": device, "progress": progress}
            options |= {"replicates": replicates, "memory": memory}
            if refine_check:
                checked = rd.refine_check(patches, chosen, **options)
                solution = checked.coarse
            else:
                solution = rd.solve(patches, chosen, **options, resume=before, checkpoint=keeper)
        also: list = [("the report", lambda: tell(solution.report()))]
        if checked is not None:
            also += [("the refine check's report", lambda: tell(f"\n{checked.report()}"))]
            also += [(path, partial(checked.export, path)) for path in tables]
        outputs.write(solution, output, exposure=exposure, checkpoint=None if keeper is None else keeper.path, also=also)
    except KeyboardInterrupt:
        if keeper is None or not keeper.written:
            raise
        interrupts.answer()
        say("interrupted", f"stopped before the end; --resume {keeper.path} goes on from there")
        return interrupts.status()
    left = checkpoints.finish(keeper, solution, output, named=checkpoint is not None, resume=resume)
    if left is not None:
        say(solution.status, f"stopped before the end; --resume {left} goes on from there")
    if solution.status == "interrupted":
        return interrupts.status()
    ends = [solution.status] if checked is None else [checked.coarse.status, checked.fine.status]
    return NOT_REACHED if "not reached" in ends else 0
