"""The tally of iterations whose lines bring light to elements: it states what the elements blur."""

from dataclasses import dataclass, field

import numpy as np

from ...patches import Hierarchy
from ...problem.model import Problem
from ...solution.errors import mean_and_error
from ..base import AbstractBiasedTally
from .state import IterationState
from .tally import IterationTally

WINDOW = 2  # levels above the patches: of 16 patches, or 4 of a side that is cut in one direction


@dataclass(frozen=True)
class RefinedTally(AbstractBiasedTally[IterationState]):
    """Reads iterations as another tally, and states what elements of many patches blur.

    Attributes:
        plain: the tally that reads power received.
    """

    plain: IterationTally
    _windows: dict = field(default_factory=dict, compare=False)

    def lines(self, problem: Problem, state: IterationState) -> int:
        return self.plain.lines(problem, state)

    def arrivals(self, problem: Problem, state: IterationState) -> np.ndarray:
        return self.plain.arrivals(problem, state)

    def irradiance(self, problem: Problem, state: IterationState, group: int) -> tuple[np.ndarray, float]:
        return self.plain.irradiance(problem, state, group)

    def line(self, problem: Problem, state: IterationState, group: int) -> np.ndarray | float:
        return self.plain.line(problem, state, group)

    def books(self, problem: Problem, state: IterationState, group: int) -> dict:
        return self.plain.books(problem, state, group)

    def bias(self, problem: Problem, state: IterationState, group: int) -> np.ndarray:
        """Return the root mean square bias about each patch, (n_patches,); NaN for a single replicate.

        What lines bring where they hit has no bias of elements. So the mean over replicates of what patches received beside it is
        the bias and noise, and its square less its variance estimates the squared bias without bias. That of a patch is noisy, so
        it is averaged over the patches of a window.
        """
        scheme, (replicates, n) = state.scheme, state.fired.shape
        assert scheme.blurred is not None
        blurred = scheme.blurred.reshape(replicates * (n + 2), -1)[: replicates * n, group] * scheme.scale
        mean, error = mean_and_error(blurred.reshape(replicates, n))
        window = self._window(problem)
        square = np.bincount(window, mean**2 - error**2) / np.bincount(window)
        return np.sqrt(np.maximum(square, 0))[window]

    def bias_of_sums(self, problem: Problem, state: IterationState, group: int) -> np.ndarray:
        """Return no bias: elements keep their power, so whole surfaces have none."""
        return np.zeros(len(problem.patches))

    def _window(self, problem: Problem) -> np.ndarray:
        """Return the number of the window of each patch, (n_patches,) int64."""
        if "of" not in self._windows:
            tree = Hierarchy(problem.patches)
            element = tree.leaf(np.arange(len(problem.patches)))
            for _ in range(WINDOW):
                above = tree.parent(element)
                element = np.where(above < 0, element, above)
            self._windows["of"] = np.unique(element, return_inverse=True)[1]
        return self._windows["of"]
