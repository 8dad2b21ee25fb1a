"""How many quanta a small number of lines makes, estimated by a discarded pilot run."""

import math
import warnings

from ..algorithms.base import AbstractAlgorithm, Swept
from ..errors import RadiosityWarning
from .budget import LEAST_QUANTA

ENOUGH = 20.0  # times sqrt(patches): quanta from which on a number of lines is met closely
MOST = 1 << 15  # quanta of the trial, or an eighth of a replicate's budget


def few_quanta(rays: float, replicates: int, algorithm: AbstractAlgorithm, tried: Swept) -> int:
    """N of each replicate for ``rays`` lines of all replicates.

    Args:
        process: of one replicate; it is used up.
        tried: called as the trial goes on.
    """
    each, patches = rays / replicates, len(algorithm.problem.patches)
    trial = max(min(math.ceil(each), LEAST_QUANTA), min(int(each) // 8, MOST))
    algorithm.advance(trial, tried)
    lines = algorithm.tally.about_lines(algorithm.problem, algorithm.capture())
    found = max(1, round(trial * each / max(lines, 1)))
    enough = ENOUGH * math.sqrt(patches)
    if found < enough:
        warnings.warn(
            f"{rays:g} lines give each of {replicates} replicates {found} quanta for {patches} patches; with fewer than "
            f"{enough:.0f} their number is met only roughly, and errors are large",
            RadiosityWarning,
            stacklevel=6,
        )
    return found
