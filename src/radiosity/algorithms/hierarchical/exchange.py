"""The equation with given links: gather over links, push down, reflect, pull up, until nothing changes."""

import math
from collections.abc import Callable

import numpy as np

from .levels import Levels
from .links import Links


class Exchange:
    """Finds the irradiance of patches from the radiosity of patches, over links.

    Args:
        levels: the values of all elements.
        links: the links; sums over those of one receiver are in their order.
    """

    def __init__(self, levels: Levels, links: Links):
        from scipy.sparse import csr_array

        self.levels, rank = levels, levels.ranks.rank
        receiver = rank[links.receiver]
        rows = np.argsort(receiver, kind="stable")  # sums over links keep their order
        starts = np.searchsorted(receiver[rows], np.arange(len(rank) + 1))
        self.factors = csr_array((links.factor[rows], rank[links.source[rows]], starts), shape=(len(rank),) * 2)

    def gather(self, radiosity: np.ndarray) -> np.ndarray:
        """Return the irradiance from the radiosity, (n_patches, n_bands) each."""
        return self.levels.push_ranks(self.factors @ self.levels.pull_ranks(radiosity))

    def solve(
        self, emission: np.ndarray, reflectance: np.ndarray, begin: np.ndarray, tolerance: float, told: Callable[[int], None]
    ) -> np.ndarray:
        """Return the irradiance H, where B = E + rho H and H comes from B, (n_patches, n_bands).

        It takes Jacobi iterations. Each leaves at most rho_max of an error where factors sum to at most one.

        Args:
            begin: an irradiance to begin with.
            tolerance: tolerance of radiosity, relative to the largest one of its band.
        """
        received, bound = begin, float(reflectance.max(initial=0.0))
        steps = 2 + (math.ceil(math.log(tolerance * (1 - bound) / 10) / math.log(bound)) if bound > 0 else 0)
        for _ in range(steps):
            new = self.gather(emission + reflectance * received)
            change = np.abs(reflectance * (new - received)).max(axis=0)
            received = new
            told(0)
            if (change <= tolerance * (1 - bound) * (emission + reflectance * received).max(axis=0)).all():
                break
        return received
