"""``radiosity solve``"""

from functools import partial
from pathlib import Path

from ..errors import MethodError
from . import checkpoints, interrupts, outputs
from .options import Chosen, Count, DeviceName, Flag, Length, Outputs, Seconds, Seed, Share, Stops
from .streams import say, tell

DEFAULT_RAYS = 10_000_000
NOT_REACHED = 3  # exit status: results are there, above the error asked for


def solve(
    scene: str,
    /,
    *,
    output: Outputs = (),
    rays: Count = None,
    seconds: Seconds = None,
    error: Share = None,
    error_of: str | None = None,
    quanta: Count = None,
    method: str = "random-walk",
    equation: str | None = None,
    lines: str | None = None,
    order: str | None = None,
    numbers: str | None = None,
    randomisation: str | None = None,
    estimator: str | None = None,
    absorption: str | None = None,
    first_shot: Share = None,
    control_variate: bool | None = None,
    warm_up: bool | None = None,
    reconstruction: str | None = None,
    factors: str | None = None,
    solver: str | None = None,
    reciprocal: Chosen = None,
    resolution: Count = None,
    rotated: bool | None = None,
    samples: Count = None,
    ambient: Chosen = None,
    overshooting: Chosen = None,
    epsilon: Share = None,
    refinement: str | None = None,
    patch_size: Length = None,
    cells: Count = None,
    powers_of_two: Flag = False,
    replicates: Count = None,
    seed: Seed = 0,
    device: DeviceName = "auto",
    resume: Path | None = None,
    checkpoint: Path | None = None,
    no_checkpoint: Flag = False,
    memory: str | None = None,
    coherent: Flag = False,
    max_reflectance: float = 0.95,
    strict: Flag = False,
    refine_check: Flag = False,
    allow_outside: Flag = False,
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
        x.surfaces.csv, one of surfaces with their net power.
    rays
        Lines to trace in all, such as 10M (the default), 500k or 1e7. Baselines go on until they are done, or progressive and
        hierarchical ones until so many lines are traced.
    seconds
        Or: for how long to trace, such as 60, 5min or 1h.
    error
        Or: until the relative error is below this, such as 1% or 0.01; in 95 % of runs the true error is. Lines or seconds given
        beside it are a limit. A run that ends above the error, or on too few lines to tell it, has the status "not reached" and
        the exit status 3. Without a limit it ends at 4 billion lines for each replicate, where its counters are full.
    error_of
        Whose error: surface:NAME (RMS over its patches) or mean:NAME (of its mean irradiance, the ± of the report); NAME may be
        a pattern. Default: the whole scene's.
    quanta
        Or: exactly so many quanta of power in each replicate; the report of a run names its number.
    method
        A named method; `radiosity methods` lists them.
    equation
        Another choice for the method's part of this name: where a particle leaves the patch that it hit.
    lines
        Likewise: what carries it.
    order
        Likewise: which line is fired next.
    numbers
        Likewise: which points of the unit cube the lines are made from.
    randomisation
        Of numbers: by-patch (each patch shifts the sequence by its own amount) or shared (one shift for all patches).
    estimator
        Likewise: what is scored of a walk or line: collision, absorption, survival, gathering, bidirectional.
    absorption
        Likewise: how a walk ends: rounded, drawn, fractional.
    first_shot
        Of global lines: the share of all lines that sends the lights' own power by local lines first, such as 25%.
    control_variate
        Of iterations: take a constant radiosity out of what lines carry.
    warm_up
        Of regular iterations: begin with incremental ones.
    reconstruction
        Of particles: patches (landings are counted) or local-linear (planes are fitted to them).
    factors
        Of baselines: where form factors come from: polygons, hemicube, lines.
    solver
        Of full-matrix: jacobi, gauss-seidel, southwell, conjugate-gradients.
    reciprocal
        Of full-matrix: make A_i F_ij symmetric, and rows sum to what does not escape.
    resolution
        Of hemicubes: pixels along an edge of the top.
    rotated
        Of hemicubes: turned by random angles (the default), or aligned with their faces.
    samples
        Of baselines: lines of a pair of patches or of a link (16), or of a patch with factors lines (4096).
    ambient
        Of progressive refinement: add an estimate of the light that was not shot yet.
    overshooting
        Of progressive refinement: shoot a part of the light that is still to come, too.
    epsilon
        Of hierarchical radiosity: up to what a link is left as it is, relative to what the scene emits, such as 1e-5.
    refinement
        Of hierarchical radiosity: brightness-factor, error-radiance, error-power.
    patch_size
        Longest edge of a patch, in metres. Default: what gives about 20 000 patches, of baselines 2 000.
    cells
        Or: cut every face into CELLS x CELLS patches.
    powers_of_two
        Cut faces into 1, 2, 4, 8 ... cells along each edge, as hierarchical radiosity does by itself: then other methods have the
        same patches to compare with.
    replicates
        Independent randomised runs, from which the errors come. Default: 8, of baselines 1.
    seed
        Of all randomisation; equal seeds give equal results.
    device
        auto, cpu or cuda.
    resume
        Go on from this .npz of the same scene, method, seed and replicates, also an interrupted one. Its lines count.
        Default of the patches: as it has them. Not for full-matrix and hierarchical.
    checkpoint
        An .npz file to keep the run's state in, every 30 seconds or so, for --resume after a crash, a kill or a power cut; it is
        removed when all outputs are written. Default: once a run takes a minute, beside the first output: out/box.glb ->
        out/box.checkpoint.npz.
    no_checkpoint
        Keep none.
    memory
        That the run may take, such as 8G or none; more is refused before it begins. Default: 70 % of what is free.
    coherent
        Trace packets of like lines: faster where a patch fires 50 000 and more in a sweep, but not equal bit for bit where a
        line meets two faces in one point.
    max_reflectance
        Bring larger reflectances in files down to this; what your own .toml sets below 1 stays as it is.
    strict
        Faults in the scene that could be skipped with a warning are errors.
    refine_check
        Solve on patches cut into four, too, and report sampling and discretisation errors apart; with a .csv output also as
        NAME.refine.csv.
    allow_outside
        The scene may name files (includes, meshes, textures) outside its folder.
    exposure
        Of pictures and meshes: stops brighter than the automatic scale; +1 is twice.
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

    from ..engine.baseline_budget import cut_for
    from .progress import bar

    choices = {
        "equation": equation, "lines": lines, "order": order, "numbers": numbers, "randomisation": randomisation,
        "estimator": estimator, "absorption": absorption, "first_shot": first_shot, "control_variate": control_variate,
        "warm_up": warm_up, "reconstruction": reconstruction, "coherent": coherent or None, "factors": factors, "solver": solver,
        "reciprocal": reciprocal, "resolution": resolution, "rotated": rotated, "samples": samples, "ambient": ambient,
        "overshooting": overshooting, "epsilon": epsilon, "refinement": refinement,
    }  # fmt: skip
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
