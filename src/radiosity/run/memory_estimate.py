"""The memory estimate of a run, beyond scene and patches, by its algorithm; it does not grow with the number of lines.

Baselines have estimates of their own (`algorithms.estimate`).
"""

import os
from dataclasses import dataclass

import numpy as np

from ..algorithms.gather.shares import OF_FUNCTION
from ..algorithms.matrix.algorithm import LIMIT
from ..device import memory
from ..factors.lines import FEW
from ..method import Baseline, Method
from ..patches import Patches
from ..patches.bases import BASES
from ..problem.lights.through import COLUMNS, ENTRIES, PLANES, ROWS
from ..solution.local_linear import Regions
from .budget import Budget, first_stage

FACE = 800  # bytes a face, for the BVH and the hit records
REACHED = 100  # bytes a cell within a kernel, while planes are fitted; 76 to 100 were measured, and 12 are kept
SMOOTHED, SMOOTHED_ONE = 650, 80  # bytes a patch, and a patch in a replicate, while values are smoothed; 8 of a group are kept
TURNS = 12  # bytes a patch in a replicate, and 8 more in each group of bands: what steps in turns keep apart
ELEMENTS, ELEMENT = 250, 16  # bytes a patch, and a patch in a replicate (27 more a group), where lines refine pairs of elements
SKY, THROUGH = 165, 90  # bytes an entry of a sky's table, and of tables of its lines through openings, at their peak
SORTED = 150e6  # bytes of particles that are sorted together, whose keys are copied
STORED = 12  # bytes a line of a gather that is stored with where it begins and ends, and FITTED bytes for pairs of functions
FITTED = 12
PAIR = 24  # bytes a pair of patches that is counted, while counts are merged


@dataclass(frozen=True)
class MemoryEstimate:
    """Bytes of a run: fixed; for a patch, and each band of it; for a patch in a replicate, and each group of bands of it."""

    fixed: float
    patch: float
    band: float
    replicate: float
    group: float


# peaks of fresh processes, 16 000 and 220 000 patches, 1 and 8 replicates, grey and RGB (benchmarks/memory_estimate.py)
MEMORY_ESTIMATES = {
    "firing": MemoryEstimate(50e6, 60, 80, 15, 27),  # the fixed part includes 20e6 while kernels of long runs are compiled
    "walks": MemoryEstimate(90e6, 60, 80, 36, 17),
    "gathering": MemoryEstimate(120e6, 60, 80, 88, 10),
    "gather": MemoryEstimate(60e6, 120, 80, 70, 160),  # 52 of the 70 bytes are for lines that long runs store
    "iteration": MemoryEstimate(10e6, 60, 80, 82, 135),
    "multipath": MemoryEstimate(115e6, 60, 80, 18, 46),
    "pooling": MemoryEstimate(100e6, 60, 80, 211, 213),
    "matrix": MemoryEstimate(120e6, 60, 80, 20, 20),
}


def memory_needed(method: Method, patches: Patches, groups: int, replicates: int, rays: float | None) -> float:
    """Return the bytes that a run will take.

    Args:
        method: the method of the run.
        patches: the patches that it solves.
        groups: the number of groups of bands.
        replicates: the number of replicates.
        rays: lines in all, where they are known: counts are kept of no more pairs of patches than that.
    """
    one, n = MEMORY_ESTIMATES[method.machine], len(patches)
    fixed = one.fixed * max(1.0, (os.cpu_count() or 1) / 4)  # launches grow with the cores
    size = BASES[method.basis].size  # a group of bands, and a band, has as many numbers as there are functions
    groups *= size
    total = fixed + FACE * patches.scene.n_faces + n * (one.patch + one.band * size * len(patches.scene.bands))
    total += n * replicates * (one.replicate + one.group * groups)
    if method.order == "sorted":
        total += SORTED
    if method.estimator == "bidirectional":
        total += n * replicates * (TURNS + 8 * groups)
    if method.refine_lines:
        total += n * (ELEMENTS + replicates * (ELEMENT + 27 * groups))
    if method.machine == "gather" and size > 1:
        total += n * replicates * (STORED * max(16, OF_FUNCTION * size) + FITTED * (size - 1) * (size + 2) // 2)
    if method.reconstruction == "local-linear":
        first = replicates * first_stage(replicates, n)
        total += REACHED * _cells_reached(patches, min(first, rays or first))
    if method.reconstruction == "smooth":
        total += n * (SMOOTHED + replicates * (SMOOTHED_ONE + 8 * groups))
    if method.machine == "matrix":
        lines = LIMIT if rays is None else max(rays, FEW * n * replicates)
        total += PAIR * min(replicates * n * (n + 2.0), lines, LIMIT)
    return total + _of_sky(patches, method)


def _of_sky(patches: Patches, method: Method) -> float:
    """Return the bytes of the tables of a sky, and of those of its lines through openings, which walks and iterations have."""
    lights = patches.scene.lights
    if lights.sky is None:
        return 0.0
    total, openings = SKY * lights.sky.radiance.size, lights.openings
    if openings is None or method.machine not in ("firing", "iteration"):
        return float(total)
    rows, columns, bands = lights.sky.radiance.shape
    table = 2 * max(ROWS, rows // 2) * max(COLUMNS, columns) * bands
    return float(total + THROUGH * min(table * (min(PLANES, len(openings)) + 1), ENTRIES + table))


def _cells_reached(patches: Patches, hit_tally: float) -> float:
    """Return the cells within the kernels of all patches together, for evenly spread hits; with few hits kernels are widest."""
    regions = Regions.find(patches)
    width = regions.bandwidth(hit_tally * patches.area / patches.area.sum())
    share = np.minimum(np.pi * width**2 / regions.area, 1.0)
    return float((share * np.bincount(regions.of, minlength=regions.count) ** 2.0).sum())


def lines_of(method: Method | Baseline, budget: Budget, replicates: int) -> float | None:
    """Return the lines of a budget, where they are known before the run; else None."""
    if budget.quanta is not None and method.machine == "matrix" and isinstance(method, Method) and method.lines == "local":
        return float(budget.quanta) * replicates
    return budget.rays


def check(method: Method | Baseline, patches: Patches, groups: int, replicates: int, rays: float | None) -> None:
    """Refuse a run that will not fit in memory.

    Raises:
        MethodError: the run will not fit; the message has the number of bytes and the way out.
    """
    if isinstance(method, Baseline):
        return
    wanted, room = (memory_needed(method, patches, groups, replicates, rays), memory.room())
    if wanted <= room:
        return
    fitting = next((few for few in range(replicates - 1, 0, -1) if memory_needed(method, patches, groups, few, rays) <= room), 0)
    way_out = f"take {fitting} replicates or fewer, or larger patches" if fitting else "take larger patches"
    memory.refuse(wanted, f"{method} on {len(patches):,} patches in {replicates} replicates", way_out)
