"""About how much memory a run takes beyond scene and patches, by its process; it does not grow with the number of lines.

Baselines have estimates of their own (`algorithms.estimate`).
"""

import os
from dataclasses import dataclass

import numpy as np

from ..algorithms.matrix.algorithm import LIMIT
from ..device import memory
from ..method import Baseline, Method
from ..patches import Patches
from ..solution.local_linear import Regions
from .budget import first_stage

FACE = 800  # bytes, of the tree and the records of hits
REACHED = 100  # of a cell within a kernel, while planes are fitted; 76 to 100 were measured, and 12 are kept
TURNS = 12  # of a patch in a replicate, and 8 more in each group of bands: what steps in turns keep apart
PAIR = 24  # of a pair of patches that is counted, while counts are merged


@dataclass(frozen=True)
class MemoryEstimate:
    """Bytes: whatever is solved; a patch, and each band of it; a patch in a replicate, and each group of bands of it."""

    fixed: float
    patch: float
    band: float
    replicate: float
    group: float


# peaks of fresh processes, 16 000 and 220 000 patches, 1 and 8 replicates, grey and RGB (benchmarks/memory_estimate.py)
MEMORY_ESTIMATES = {
    "firing": MemoryEstimate(50e6, 60, 80, 15, 27),  # of the fixed part, 20e6 while kernels of long runs are compiled
    "walks": MemoryEstimate(90e6, 60, 80, 36, 17),
    "gathering": MemoryEstimate(120e6, 60, 80, 88, 10),
    "iteration": MemoryEstimate(10e6, 60, 80, 82, 135),
    "multipath": MemoryEstimate(115e6, 60, 80, 18, 46),
    "pooling": MemoryEstimate(100e6, 60, 80, 211, 213),
    "matrix": MemoryEstimate(120e6, 60, 80, 20, 20),
}


def demand(method: Method, patches: Patches, groups: int, replicates: int, rays: float | None) -> float:
    """Bytes.

    Args:
        method: what solves.
        patches: for what.
        groups: of bands that are one problem each.
        replicates: of it.
        rays: lines in all, where they are known: pairs of patches that counts are kept of are no more.
    """
    one, n = MEMORY_ESTIMATES[method.machine], len(patches)
    fixed = one.fixed * max(1.0, (os.cpu_count() or 1) / 4)  # launches grow with the cores
    total = fixed + FACE * patches.scene.n_faces + n * (one.patch + one.band * len(patches.scene.bands))
    total += n * replicates * (one.replicate + one.group * groups)
    if method.estimator == "bidirectional":
        total += n * replicates * (TURNS + 8 * groups)
    if method.reconstruction == "local-linear":
        first = replicates * first_stage(replicates, n)
        total += REACHED * _cells_reached(patches, min(first, rays or first))
    if method.machine == "matrix":
        total += PAIR * min(replicates * n * (n + 2.0), rays or LIMIT, LIMIT)
    return total


def _cells_reached(patches: Patches, hit_tally: float) -> float:
    """By the kernels of all patches together, where landings are spread evenly; kernels are widest where there are few."""
    regions = Regions.find(patches)
    width = regions.bandwidth(hit_tally * patches.area / patches.area.sum())
    share = np.minimum(np.pi * width**2 / regions.area, 1.0)
    return float((share * np.bincount(regions.of, minlength=regions.count) ** 2.0).sum())


def check(method: Method | Baseline, patches: Patches, groups: int, replicates: int, rays: float | None) -> None:
    """Refuse a run that will not fit.

    Raises:
        MethodError: with the number and the way out.
    """
    if isinstance(method, Baseline):
        return
    wanted, room = (demand(method, patches, groups, replicates, rays), memory.room())
    if wanted <= room:
        return
    fitting = next((few for few in range(replicates - 1, 0, -1) if demand(method, patches, groups, few, rays) <= room), 0)
    way_out = f"take {fitting} replicates or fewer, or larger patches" if fitting else "take larger patches"
    memory.refuse(wanted, f"{method} on {len(patches):,} patches in {replicates} replicates", way_out)
