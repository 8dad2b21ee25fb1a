"""How light that falls on patches comes to sensors: by all reflections, along counted lines."""

from typing import Any

import numpy as np

TOLERANCE = 1e-4  # of the light that has come: reflections end where those left are less
MOST = 2000  # reflections
AT_ONCE = 256  # sensors


def weights(seen: Any, factors: Any, reflectance: np.ndarray) -> np.ndarray:
    """Return the irradiance of each sensor by a unit of irradiance on each patch, all reflections together.

    A sensor gets g B from B = rho (H + F B), so that its weights are y rho, where y = g + (y rho) F: the equation is solved
    backwards, for each sensor in place of each light.

    Args:
        seen: g, the share of each sensor's lines that hit each patch, a sparse array (n_sensors, n_patches).
        factors: F, that of each patch's lines, a sparse array (n_patches, n_patches).
        reflectance: (n_patches,) rho.

    Returns:
        (n_sensors, n_patches) float32.
    """
    backwards, rho = factors.T.tocsr(), reflectance[:, None]
    found = np.empty(seen.shape, np.float32)
    for at in range(0, seen.shape[0], AT_ONCE):
        new = seen[at : at + AT_ONCE].T.toarray() * rho
        total = new.copy()
        for _ in range(MOST):
            new = (backwards @ new) * rho
            total += new
            if new.sum() <= TOLERANCE * total.sum() * (1 - reflectance.max()):
                break
        found[at : at + AT_ONCE] = total.T
    return found
