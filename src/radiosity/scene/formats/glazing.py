"""What a pane of clear glass lets through, by the formulas of Fresnel with absorption between its two sides."""

import numpy as np

INDEX = 1.52  # index of refraction of glass, where a file does not say
STEPS = 1000  # cosines: means are right to 1e-6


def clear_share(transmissivity: np.ndarray, index: float = INDEX) -> np.ndarray:
    """Return the share of diffuse light that goes through a pane, reflections between its sides counted.

    It is the mean over directions of diffuse light: 0.81 for glass of which 0.88 goes straight on at right angles to it.

    Args:
        transmissivity: (n_bands,) share of light that is not absorbed on the way across the pane, at right angles to it.
        index: of refraction, above 1.
    """
    cosine = (np.arange(STEPS) + 0.5) / STEPS
    inside = np.sqrt(1 - (1 - cosine**2) / index**2)
    kept = np.asarray(transmissivity, np.float64)[:, None] ** (1 / inside)
    through = np.zeros_like(kept)
    for side in ((cosine - index * inside) / (cosine + index * inside), (index * cosine - inside) / (index * cosine + inside)):
        reflected = side**2
        through += (1 - reflected) ** 2 * kept / (1 - reflected**2 * kept**2) / 2
    return (through * 2 * cosine).mean(axis=1)


def transmissivity_of(transmittance: float) -> float:
    """Return the transmissivity of glass of index 1.52 of which this share of light goes through straight on.

    With R the reflectance of one side, t = (1 - R)² m / (1 - R² m²) is solved for m.
    """
    reflected = ((INDEX - 1) / (INDEX + 1)) ** 2
    if transmittance <= 0:
        return 0.0
    half = (1 - reflected) ** 2 / (2 * transmittance * reflected**2)
    return float(1 / (reflected**2 * (half + np.sqrt(half**2 + 1 / reflected**2))))
