"""The lines of a radiative exchange, traced in stages."""

from dataclasses import dataclass, replace

import numpy as np

from ..factors.counted import CountedPairs
from ..method import Method
from ..patches.model import Patches
from ..run.solve import solve


@dataclass(frozen=True, eq=False)
class Lines:
    """Counted lines, and what made them."""

    pairs: CountedPairs
    rays: int
    replicates: int
    seed: int
    seconds: float
    status: str
    patches: Patches
    solution: object
    provenance: dict


def trace(patches: Patches, rays: float, *, replicates, seed, device, progress, memory, before=None):
    """Trace lines; go on from ``before``, if there is some."""
    scene = patches.scene
    lit = replace(scene, emission=np.ones_like(scene.emission), back_emission=np.ones_like(scene.emission), emission_paint=None)
    cut = before.solution.patches if before else Patches(lit, patches.columns, patches.rows)
    s = solve(
        cut,
        Method(order="matrix"),
        rays=rays,
        replicates=replicates,
        seed=seed,
        device=device,
        progress=progress,
        memory=memory,
        resume=before.solution if before else None,
    )
    pairs = CountedPairs(patches, s.state["keys"], s.state["counts"], replicates, True)
    return Lines(pairs, s.rays, replicates, seed, s.seconds, s.status, patches, s, s.provenance)
