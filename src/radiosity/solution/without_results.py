"""Solutions of runs without a complete stage: they hold a state from which the run continues, and no results yet."""

import numpy as np

from ..patches.model import Patches
from .model import Solution


def without_results(patches: Patches, replicates: int, seconds: float, status: str, provenance: dict, state: dict) -> Solution:
    """Return a solution of 0 quanta, whose results are unknown (NaN)."""
    unknown = np.full((len(patches), len(patches.scene.bands)), np.nan)
    book = dict.fromkeys(("emitted", "rounding", "absorbed", "escaped", "lost"), np.nan) | {"closes": None}
    books = tuple(dict(book) for _ in patches.scene.bands)
    arrivals = np.zeros(len(patches), np.int64)
    return Solution(patches, unknown, unknown, arrivals, 0, seconds, 0, replicates, books, status, provenance, state)
