"""Bright sides: surfaces that reflect so much light from so small a place that lines should look for them, as for lamps.

The reflector around a lamp is one. Cosine lines meet it rarely, and then it is very bright: that is most of the noise of a final
gather. Shadow rays go to such sides, and find what they reflect with their emission; cosine lines then do not read it.
"""

from dataclasses import replace

import numpy as np

from ..problem.model import Problem
from ..solution.model import Solution
from ..tally.unmet import sides
from .reflected import mean_reflected

BRIGHT = 8.0  # times the area mean of what surfaces reflect
MOST = 0.05  # of the area of all sides may be bright: more are no small places


def with_bright(solution: Solution, problem: Problem, light: np.ndarray) -> tuple[Problem, np.ndarray]:
    """Return a problem in which bright sides are lamps, and what cosine lines read of the others.

    Args:
        problem: of the solution.
        light: (n_patches, n_columns) what patches reflect, in shares of the unit of light, see `mean_reflected`.
    """
    patches, size = solution.patches, solution.basis.size
    level = light[:, ::size].max(axis=1)
    bright = _bright(sides(patches), patches.area, level)
    bright &= ~patches.scene.panes[patches.face]  # of panes only a part is solid
    if not bright.any():
        return problem, light
    emission = np.where(bright[:, None], np.nan_to_num(solution.radiosity), patches.emission)
    changed = Problem.of(replace(patches, own_emission=emission))
    read = np.nan_to_num(mean_reflected(solution, changed))
    read[bright, ::size] = 0.0  # how their light varies about its mean is still read
    return changed, read


def _bright(side: np.ndarray, area: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Return which patches lie on bright sides, (n_patches,) bool; of too many the brightest are taken."""
    power, areas = np.bincount(side, area * level), np.bincount(side, area)
    mean = np.divide(power, areas, out=np.zeros_like(power), where=areas > 0)
    order = np.argsort(-mean, kind="stable")
    taken = np.zeros(len(mean), bool)
    taken[order] = np.cumsum(areas[order]) <= MOST * areas.sum()
    return (taken & (mean > BRIGHT * power.sum() / areas.sum()))[side]
