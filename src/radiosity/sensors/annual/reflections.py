"""How light that falls on patches comes to sensors: by all reflections, along counted lines."""

from typing import Any

import numpy as np

from ...patches.scatter import Scatter

TOLERANCE = 1e-4  # of the light that has come: reflections end where those left are less
MOST = 2000  # reflections
AT_ONCE = 256  # sensors


def weights(seen: Any, factors: Any, scatter: Scatter) -> np.ndarray:
    """Return the irradiance of each sensor by a unit of irradiance on each patch, all reflections together.

    A sensor gets g B from B = S (H + F B), so that its weights are y S, where y = g + (y S) F: the equation is solved backwards,
    for each sensor in place of each light. S, what patches send on, is symmetric.

    Args:
        seen: g, the share of each sensor's lines that hit each patch, a sparse array (n_sensors, n_patches).
        factors: F, that of each patch's lines, a sparse array (n_patches, n_patches).
        scatter: S, (n_patches,) numbers.

    Returns:
        (n_sensors, n_patches) float32.
    """
    backwards, least = factors.T.tocsr(), TOLERANCE * (1 - scatter.albedo.max())
    sent = scatter.in_column
    found = np.empty(seen.shape, np.float32)
    for at in range(0, seen.shape[0], AT_ONCE):
        new = sent.of_rows(seen[at : at + AT_ONCE].toarray(), 0).T
        total = new.copy()
        for _ in range(MOST):
            new = sent.of_rows((backwards @ new).T, 0).T
            total += new
            if new.sum() <= least * total.sum():
                break
        found[at : at + AT_ONCE] = total.T
    return found
