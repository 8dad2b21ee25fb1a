"""What a run is for: a surface, or what a camera or sensors see. Lines are shared out by what they add to it."""

from dataclasses import dataclass, replace
from hashlib import sha256
from typing import Any

import numpy as np

from ..algorithms.importance.adjoint import Importance
from ..algorithms.importance.sight import shares_seen
from ..errors import MethodError
from ..hooks import HOOKS
from ..method import Auto, Baseline, Method, resolve
from ..patches import Patches
from ..problem.model import Problem
from ..sampling.streams import Seed
from ..scene.named import surfaces_called
from ..tracing.geometry import Geometry

SURFACE = "surface:"
METHOD = "stochastic-jacobi-incremental"  # the preset whose lines are shared out


@dataclass(frozen=True, eq=False)
class Aim:
    """A result to know well: a weighted sum over patches.

    Attributes:
        name: what it is, in words.
        share: (n_patches,) float64, the weight of each patch; the sum is 1, or less where a part of what is seen is no patch.
        radiosity: True where it is the sum of radiosity that is seen; False: of irradiance that falls on a surface.
    """

    name: str
    share: np.ndarray
    radiosity: bool

    @staticmethod
    def of(given: Any, geometry: Geometry, patches: Patches) -> "Aim":
        """Make it from what `solve` takes as ``importance``.

        Raises:
            MethodError: it has another form, or sees no patch that reflects. SceneError: the scene has no such camera or sensors.
        """
        if isinstance(given, str) and given.startswith(SURFACE):
            rows = np.isin(patches.surface, surfaces_called(list(patches.scene.names), given.removeprefix(SURFACE)))
            if not rows.any():
                raise MethodError(f"importance is '{given}', and no patch is on that surface; choose another")
            area = np.where(rows, patches.area, 0.0)
            return Aim(given, area / area.sum(), radiosity=False)
        called, origins, directions = HOOKS["sight"](patches.scene, given)
        share = shares_seen(geometry, patches, origins, directions)
        aim = Aim(f"{called} ({sha256(share.tobytes()).hexdigest()[:12]})", share, radiosity=True)
        if not (share * patches.scatter.albedo.max(axis=1)).any():
            raise MethodError(
                f"{patches.scene.source}: no patch that reflects light is seen by {called}, so that there is nothing to share "
                "lines out by: turn the view, or leave importance out"
            )
        return aim

    def shared(self, problem: Problem, geometry: Geometry, method: Method, seed: Seed | int) -> Importance:
        """Find the importance of patches for it, by a pilot."""
        area, albedo = problem.patches.area, problem.groups.scatter.albedo.max(axis=1)
        return Importance.of(geometry, problem, self.share / area * (albedo if self.radiosity else 1.0), method, seed)


def shared_before(problem: Problem, resume: Any) -> tuple[Problem, int]:
    """Return a problem with the importance of the result that a run goes on from, and the lines of the pilot then."""
    values = resume.state.get("importance")
    lines = int(resume.provenance.get("importance_lines", 0))
    return replace(problem, importance=None if values is None else np.asarray(values)), lines


def method_of(chosen: Method | Baseline | Auto) -> Method:
    """Return the method whose lines are shared out: the one that was chosen, or that of `METHOD` for auto.

    Raises:
        MethodError: it cannot share them out.
    """
    method = resolve(METHOD, basis=chosen.basis) if isinstance(chosen, Auto) else chosen
    if not isinstance(method, Method) or method.order != "incremental":
        raise MethodError(f"importance is for --order incremental, not {method}: take --method {METHOD}, or leave the method out")
    for name, usual in (("estimator", "collision"), ("control_variate", False), ("basis", "constant")):
        if getattr(method, name) != usual:
            raise MethodError(f"importance does not go with {name} {getattr(method, name)}: leave {name} out")
    return method
