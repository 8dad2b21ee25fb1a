"""What a pane of clear glass lets through, where a file gives transmissivities or transmittances of glass."""

import numpy as np

from ..clear_glass import mean_share, of_normal

INDEX = 1.52  # index of refraction of glass, where a file does not say


def clear_share(transmissivity: np.ndarray, index: float = INDEX) -> np.ndarray:
    """Return the share of diffuse light that goes through a pane, reflections between its sides counted.

    It is the mean over directions of diffuse light: 0.81 for glass of which 0.88 goes straight on at right angles to it.

    Args:
        transmissivity: (n_bands,) share of light that is not absorbed on the way across the pane, at right angles to it.
        index: of refraction, above 1.
    """
    return mean_share(np.asarray(transmissivity, np.float64), index)


def transmissivity_of(transmittance: float) -> float:
    """Return the transmissivity of glass of index 1.52 of which this share of light goes through straight on."""
    return of_normal(transmittance, INDEX)
