"""The discretisation error apart from the sampling error: the same scene is solved on two meshes.

A solution is constant on each patch, and discrete methods send light evenly from all of it. The error of this is seen where
every patch is cut into four: how much the mean over a patch changes, and how much its four children differ from each other. Both
fall as patches shrink. The noise of both is known from the replicates, and is taken out.
"""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..device.memory import limited
from ..device.turn import turn
from ..errors import MethodError, keeping
from ..hooks import HOOKS
from ..method import Auto, Baseline, Method, resolve
from ..patches import Patches, subdivide
from ..patches.nesting import halved, parents
from ..scene.model import Scene
from ..solution.errors import mean_and_error
from ..solution.model import Solution
from ..solution.refinement import RefineCheck
from .baseline_budget import cut_for

if TYPE_CHECKING:
    from .run import Run

RUN = ("rays", "seconds", "error", "error_of", "quanta", "replicates", "seed", "device", "progress")
APART = 1 << 20  # difference of the seeds of the two runs, so that their errors are independent


def refine_check(
    scene: Scene | Patches,
    method: str | Method | Baseline | Auto = "auto",
    *,
    memory: str | float | None = None,
    cluster: Any = None,
    **choices,
) -> RefineCheck:
    """Solve on the patches, and on four times as many with as many lines a patch.

    Args:
        scene, method, memory, cluster, choices: as of `solve`; ``rays``, ``quanta`` and ``seconds`` are those of the first run,
            and the second takes four times as many of the first two, as much time, or the same ``error``.

    Raises:
        MethodError: as of `solve`, or fewer than 2 replicates: then nothing tells noise from change. SceneError: patches too
            small. KeyboardInterrupt: before both runs had a complete stage.

    Example:
        >>> check = rd.refine_check(rd.subdivide(rd.load_scene("room"), cells=1), rays=5_000)
        >>> len(check.coarse.patches), len(check.fine.patches)
        (18, 72)
    """
    from .solve import prepared

    chosen = resolve(method, **{k: v for k, v in choices.items() if k not in RUN})
    if isinstance(chosen, Baseline):
        raise MethodError("a refine check needs errors from replicates, which baselines have none of; cut the scene finer")
    options = {k: v for k, v in choices.items() if k in RUN}
    if options.get("replicates") == 1:
        raise MethodError("replicates is 1; a refine check needs 2 or more, to tell noise from change")
    coarse = subdivide(scene, **cut_for(chosen)) if isinstance(scene, Scene) else scene
    fine = halved(coarse)
    parent = parents(fine, coarse)
    more = {k: 4 * v for k, v in options.items() if k in ("rays", "quanta") and v is not None}
    seed = options.get("seed", 0)
    with limited(memory), turn(), keeping():
        first = prepared(coarse, chosen, **options)
        one = _finished(first, cluster)
        second = prepared(fine, first.method, **(options | more | {"seed": seed + APART}))
        second.also = lambda stage: stage.sums(parent, len(coarse))
        other = _finished(second, cluster)
    assert second.snapshot is not None
    received = second.snapshot.asked[1] / coarse.area[:, None]  # (replicates, n_coarse, n_bands)
    _, error = mean_and_error(received)
    return RefineCheck(replace(one, state={}), replace(other, state={}), parent, error)


def _finished(run: "Run[Solution]", cluster: Any) -> Solution:
    solution = run.solve() if cluster is None else HOOKS["cluster"](cluster, lambda: run)
    if solution.status == "interrupted":
        raise KeyboardInterrupt
    return solution
