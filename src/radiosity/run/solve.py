"""`solve`, which makes a solution from a scene."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from ..device.memory import limited
from ..device.turn import turn
from ..diagnostics.contact_findings import tell
from ..diagnostics.lamps_at_faces import warn_of_spots
from ..diagnostics.narrow import warn_of_light
from ..diagnostics.near_lamps import warn_of_near_lamps
from ..errors import MethodError, keeping
from ..hooks import HOOKS
from ..method import Auto, Baseline, Method, resolve
from ..patches import Patches, subdivide
from ..sampling.streams import Seed
from ..scene.model import Scene
from ..solution.binomial import LEAST_REPLICATES
from ..solution.model import Solution
from .baseline_budget import chosen_budget, cut_for
from .budget import Budget
from .checkpoint import Checkpoint
from .part import Part
from .progress import Listener
from .refusals import refines, refuse_cut, refuse_hierarchical, refuse_open, refuse_panes
from .whole_number import whole

if TYPE_CHECKING:
    from .run import Run


def solve(
    scene: Scene | Patches,
    method: str | Method | Baseline | Auto = "auto",
    *,
    rays: float | None = None,
    seconds: float | None = None,
    error: float | None = None,
    quanta: int | None = None,
    replicates: int | None = None,
    seed: int = 0,
    first_replicate: int = 0,
    all_replicates: int | None = None,
    device: str = "auto",
    progress: Listener | None = None,
    watch: Callable[[Solution], None] | None = None,
    resume: Solution | None = None,
    error_of: str | None = None,
    importance: Any = None,
    adaptive: bool | int = False,
    checkpoint: str | Path | Checkpoint | None = None,
    checkpoint_every: float = 30.0,
    memory: str | float | None = None,
    cluster: Any = None,
    **choices,
) -> Solution:
    """Solve B = E + rho F B.

    Args:
        scene: a `Scene` (cut into about 20 000 patches) or the `Patches` of one.
        method: a preset's name, a `Method` or a `Baseline`; or "auto", which takes gather, random-walk or an iteration with a
            control variate, as a pilot of the scene says (`Solution.provenance` holds which, and why). A run that goes on keeps
            the method of its solution.
        choices: replace the method's own by name, such as ``numbers="sobol"``; see `Method` and `Baseline`. "auto" takes a
            ``basis``, and then gather, particle-tracing or the iteration. With other choices it is random-walk with them. Without
            ``warm_up`` another order or other lines than the method's drop its warm-up.
        rays, seconds, error, quanta: exactly one (with a baseline none is needed, which then goes on until it is done): lines
            traced in all (replicates together); wall time (the first stage is completed whatever it takes); relative error of the
            scene (`Solution.error`), which the true one is below in 95 % of runs; or N of each replicate, which replays a run of
            the same method bit for bit ("auto" may choose another: name the one that it chose). An error alone may have a limit
            beside it, rays, seconds or both. Where it is not reached within that, or where there are too few hits to know it (a
            run without a limit then ends after some 2^32 lines for each replicate), the status is "not reached" and a warning
            says what is known.
        error_of: "surface:NAME": reach the error on the patches of this surface (or all whose names match a pattern) instead; or
            "mean:NAME": that of the mean irradiance over it, as `Solution.surface_interval` tells it.
        replicates: independent randomised runs; from 2 on there are standard errors. Default: 8, of baselines 1.
        seed: with the same inputs, the same bits.
        first_replicate: the run has the replicates from this one on of all those of its seed: a part, to be put together with
            others by `merge`. Give ``quanta``, so that all parts have as many.
        all_replicates: how many replicates all parts have together. Results that depend on their stages (see ``resume``) need it,
            since the first stage depends on the number of replicates.
        device: "auto", "cpu" or "cuda".
        progress: called with a `Progress` after each wavefront.
        watch: called after each complete stage with the solution so far, whose status is "running"; in short runs also before the
            first stage is complete, so that some five solutions are shown. The result stays the same to the last bit.
        resume: a solution of the same scene, method, seed and replicates to go on from, also an interrupted one; the
            budget counts its lines. The result is that of one run with as many quanta in the end. Runs whose results depend on
            their stages (several bands by counts, fractional absorption, iterations, a first shot) go on from an interruption, or
            from a stage that is a power of two.
        importance: share lines out for one result, without a bias: "surface:NAME" (or a pattern; the mean irradiance over it),
            "camera" or "camera:1" (the second) of the scene, "sensors" of the scene's file, a `Camera` or `Sensors` (the mean
            radiosity that they see). ``error`` then is that of this result, unless error_of says another. Other patches have
            larger errors. Lights are surfaces, luminaires, suns and a sky. For incremental iterations, which "auto" takes
            (docs/importance.md).
        adaptive: True, or a number of patches: the scene is cut first where light varies, by `adapt` with the same seed, and
            then solved. The pilots that find the mesh come on top of the budget. To go on from its solution (``resume``), leave
            it out: the mesh is kept.
        checkpoint: an .npz file that is written every now and then, whole or not at all, for ``resume=load_solution(checkpoint)``
            after the process has been killed. Until a first stage is complete it has no results (NaN, 0 quanta). An interruption
            writes it too; at the end it stays, brought up to date.
        checkpoint_every: seconds; longer where writing takes more than a thirtieth of that.
        memory: the limit, such as "8G", a number of bytes, or "none" for no limit. Default: 70 % of what is free.
        cluster: workers of Dask that trace the lines, to the same bits as here: the address of a scheduler
            ("tcp://host:8786"), "local:N" for N processes on this machine, or a `distributed.Client` (docs/cluster.md).

    Returns:
        The solution of the last complete stage. Ctrl-C ends the run early and returns what is there; the integers of an
        unfinished stage are kept for ``resume``. Of several threads one solves at a time; the others wait for it to end.

    Raises:
        SceneError: nothing emits. MethodError: a choice or budget that makes no sense, a solution that cannot be resumed, or
            more memory than the run may take. OutputError: no checkpoint can be written there. DeviceError: nothing to run on,
            or hits were lost, since another thread ran kernels of Dr.Jit or Mitsuba.
            KeyboardInterrupt: Ctrl-C before the first stage was complete; a checkpoint has been written.

    Example:
        >>> patches = rd.subdivide(rd.load_scene("room"), cells=2)
        >>> solution = rd.solve(patches, rays=10_000, seed=1)
        >>> solution.radiosity.shape, solution.status
        ((72, 1), 'complete')
    """
    chosen = resolve(method, **choices)
    with limited(memory), turn(), keeping():
        if adaptive is not False:
            scene = _adapted(scene, chosen, adaptive, seed, device, progress, resume)

        def made() -> "Run[Solution]":
            run = prepared(
                scene,
                chosen,
                rays=rays,
                seconds=seconds,
                error=error,
                quanta=quanta,
                replicates=replicates,
                seed=seed,
                first_replicate=first_replicate,
                all_replicates=all_replicates,
                device=device,
                progress=progress,
                resume=resume,
                error_of=error_of,
                importance=importance,
                checkpoint=checkpoint,
                checkpoint_every=checkpoint_every,
            )
            run.watch = watch
            return run

        return made().solve() if cluster is None else HOOKS["cluster"](cluster, made)


def prepared(
    scene: Scene | Patches,
    chosen: Method | Baseline | Auto,
    *,
    rays=None,
    seconds=None,
    error=None,
    quanta=None,
    replicates=None,
    seed=0,
    first_replicate=0,
    all_replicates=None,
    device="auto",
    progress=None,
    resume=None,
    error_of=None,
    importance=None,
    checkpoint=None,
    checkpoint_every=30.0,
) -> "Run[Solution]":
    """Return a checked run that has not begun; arguments and errors are those of `solve`."""
    usual = 1 if isinstance(chosen, Baseline) else 8
    replicates = usual if replicates is None else whole(replicates, "replicates", 1)
    if isinstance(chosen, Method) and chosen.reconstruction == "smooth" and replicates < LEAST_REPLICATES:
        raise MethodError(
            f"reconstruction 'smooth' tells noise from light by comparing replicates; it needs {LEAST_REPLICATES} or more, not "
            f"{replicates}: give more, or leave reconstruction out"
        )
    in_all = None if all_replicates is None else whole(all_replicates, "all_replicates", 1)
    first = whole(first_replicate, "first_replicate", 0)
    part = Part(Seed(whole(seed, "seed", 0), first), replicates, in_all)
    if isinstance(chosen, Baseline):
        budget = chosen_budget(chosen, rays=rays, seconds=seconds, error=error, quanta=quanta)
    else:
        budget = Budget(rays, seconds, error, quanta)
        budget.check(replicates)
    if resume is not None and not isinstance(resume, Solution):
        raise MethodError(f"resume takes a Solution, not {type(resume).__name__}; load a file with load_solution")
    if resume is not None and isinstance(scene, Scene) and resume.patches.scene.is_cut_of(scene):
        scene = resume.patches
    scene = patches_of(scene, chosen, "solve")
    refuse_cut(scene, chosen)
    if resume is not None and len(resume.patches) != len(scene):
        raise MethodError(f"cannot go on from a solution of {len(resume.patches)} patches with {len(scene)}; cut the scene alike")
    if error_of is not None and error is None:
        raise MethodError("error_of says whose error is to be reached; give the error, too (error=0.01, --error 1%)")
    choice = None
    if importance is not None:
        from .aim import method_of

        chosen = method_of(chosen)
    if isinstance(chosen, Auto):
        from .choice import choice_for

        begun = perf_counter()
        choice = choice_for(chosen, scene, budget, part, device, resume)
        choice = replace(choice, seconds=perf_counter() - begun)
        chosen = choice.method
    refuse_open(scene.scene, chosen)
    refuse_panes(scene.scene, chosen)
    keeper = checkpoint if checkpoint is None else Checkpoint.of(checkpoint, checkpoint_every, chosen)
    from .record import Record
    from .run import Run

    run = Run(scene, chosen, budget, part, device, progress, resume, keeper, error_of, choice, importance, record=Record)
    tell(scene.scene)  # what searches the faces comes after the memory estimate
    local = chosen.lines == "local" or chosen.first_shot if isinstance(chosen, Method) else chosen.factors == "lines"
    if local:
        warn_of_light(run.geometry, scene, stacklevel=3)
    if isinstance(chosen, Method) and chosen.machine == "gather":
        warn_of_spots(scene)
    if not refines(chosen):
        warn_of_near_lamps(scene, device)
    return run


def patches_of(scene: Scene | Patches, method: Method | Baseline | Auto, caller: str) -> Patches:
    """Return the patches to solve for; a scene is cut as the method needs it.

    Raises:
        MethodError: it is neither a scene nor patches.
    """
    if isinstance(scene, Scene):
        scene = subdivide(scene, **cut_for(method))
    if not isinstance(scene, Patches):
        raise MethodError(f"{caller} takes a Scene or Patches, not {type(scene).__name__}; load a file with load_scene")
    return scene


def _adapted(scene, chosen, adaptive, seed, device, progress, resume) -> Patches:
    """Return the patches of ``adaptive``; see `solve`."""
    if resume is not None:
        raise MethodError("adaptive makes a new mesh, and resume keeps that of its solution: leave one of them out")
    refuse_hierarchical(chosen)
    count = len(subdivide(scene, **cut_for(chosen))) if adaptive is True else whole(adaptive, "adaptive", 1)
    basis = "constant" if isinstance(chosen, Baseline) else chosen.basis
    return HOOKS["adapt"](scene, count, seed=seed, device=device, progress=progress, basis=basis)
