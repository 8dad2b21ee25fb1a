"""The pilot run: a few lines, which are discarded, estimate how many quanta a small number of lines makes."""

import math
import warnings

from ..algorithms.base import AbstractAlgorithm, Swept
from ..errors import RadiosityWarning
from .budget import LEAST_QUANTA

ENOUGH = 20.0  # times sqrt(patches): from so many quanta on, the number of lines is near what was asked for
MOST = 1 << 15  # quanta of the pilot run, or an eighth of a replicate's budget


def few_quanta(rays: float, replicates: int, algorithm: AbstractAlgorithm, told: Swept) -> int:
    """Return N of each replicate for ``rays`` lines of all replicates.

    Args:
        algorithm: of one replicate; it cannot be used afterwards.
        told: called while the pilot run goes on.
    """
    each, patches = rays / replicates, len(algorithm.problem.patches)
    pilot = max(min(math.ceil(each), LEAST_QUANTA), min(int(each) // 8, MOST))
    algorithm.advance(pilot, told)
    lines = algorithm.tally.about_lines(algorithm.problem, algorithm.capture())
    found = max(1, round(pilot * each / max(lines, 1)))
    enough = ENOUGH * math.sqrt(patches)
    if found < enough:
        warnings.warn(
            f"{rays:g} lines give each of {replicates} replicates {found} quanta for {patches} patches; with fewer than "
            f"{enough:.0f} their number is met only roughly, and errors are large",
            RadiosityWarning,
            stacklevel=7,
        )
    return found
