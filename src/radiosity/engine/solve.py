"""Scene in, solution out."""

from ..errors import MethodError
from ..method import Method, resolve
from ..patches import Patches, subdivide
from ..scene.model import Scene
from ..solution.model import Solution
from .budget import Budget
from .progress import Listener


def solve(
    scene: Scene | Patches,
    method: str | Method = "random-walk",
    *,
    rays: float | None = None,
    seconds: float | None = None,
    error: float | None = None,
    quanta: int | None = None,
    replicates: int = 8,
    seed: int = 0,
    device: str = "auto",
    equation: str | None = None,
    lines: str | None = None,
    order: str | None = None,
    numbers: str | None = None,
    estimator: str | None = None,
    absorption: str | None = None,
    first_shot: float | None = None,
    control_variate: bool | None = None,
    warm_up: bool | None = None,
    reconstruction: str | None = None,
    coherent: bool | None = None,
    progress: Listener | None = None,
    resume: Solution | None = None,
) -> Solution:
    """Solve B = E + rho F B.

    Args:
        scene: a `Scene` (cut into about 20 000 patches) or the `Patches` of one.
        method: a preset's name or a `Method`.
        equation, lines, order, numbers, estimator, absorption, first_shot, control_variate, warm_up, reconstruction, coherent:
            replace its choices; see `Method`. Without ``warm_up`` another order than the method's drops its warm-up.
        rays, seconds, error, quanta: exactly one: lines traced in all (replicates together); wall time (the first stage is
            completed whatever it takes); relative error of the scene (`Solution.error`); or N of each replicate, which
            replays a run bit for bit.
        replicates: independent randomised runs; from 2 on there are standard errors.
        seed: with the same inputs, the same bits.
        device: "auto", "cpu" or "cuda".
        progress: called with a `Progress` after each sweep.
        resume: a solution of the same scene, method, seed and replicates to go on from, also an interrupted one; the
            budget counts its lines. The result is that of one run with as many quanta in the end. Runs whose results depend on
            their stages (several bands by counts, fractional absorption, iterations, a first shot) go on from an interruption, or
            from a stage that is a power of two.

    Returns:
        The solution of the last complete stage. Ctrl-C ends the run early and returns what is there; the integers of an
        unfinished stage are kept for ``resume``.

    Raises:
        SceneError: nothing emits. MethodError: a choice or budget that makes no sense, or a solution that cannot be
            resumed. DeviceError: nothing to run on. KeyboardInterrupt: Ctrl-C before the first stage was complete.
    """
    budget = Budget(rays, seconds, error, quanta)
    chosen = resolve(
        method, equation=equation, lines=lines, order=order, numbers=numbers, estimator=estimator, absorption=absorption,
        first_shot=first_shot, control_variate=control_variate, warm_up=warm_up, reconstruction=reconstruction,
        coherent=coherent,
    )  # fmt: skip
    replicates, seed = _whole(replicates, "replicates", 1), _whole(seed, "seed", 0)
    budget.check(replicates)
    if isinstance(scene, Scene):
        scene = subdivide(scene)
    if not isinstance(scene, Patches):
        raise MethodError(f"solve takes a Scene or Patches, not {type(scene).__name__}; load a file with load_scene")
    if resume is not None and not isinstance(resume, Solution):
        raise MethodError(f"resume takes a Solution, not {type(resume).__name__}; load a file with load_solution")
    if resume is not None and len(resume.patches) != len(scene):
        raise MethodError(f"cannot go on from a solution of {len(resume.patches)} patches with {len(scene)}; cut the scene alike")
    from .run import Run

    return Run(scene, chosen, budget, replicates, seed, device, progress, resume).solve()


def _whole(value, name: str, least: int) -> int:
    try:
        good = not isinstance(value, bool) and int(value) == value and value >= least
    except (TypeError, ValueError, OverflowError):
        good = False
    if not good:
        raise MethodError(f"{name} is {value!r}; it must be a whole number of {least} or more")
    return int(value)
