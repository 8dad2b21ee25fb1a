"""What a pane of clear glass lets through at each angle, by Fresnel's formulas with absorption between its two sides."""

import numpy as np

STEPS = 1000  # cosines: means are right to 1e-6


def share_at(cosine: np.ndarray, transmissivity: np.ndarray | float, index: float) -> np.ndarray:
    """Return the share of unpolarised light that goes through straight on, all reflections between the sides counted.

    Args:
        cosine: of the angle to the normal, in (0, 1].
        transmissivity: share of light that is not absorbed on the way across the pane, at right angles to it.
        index: of refraction, above 1.
    """
    inside = np.sqrt(1 - (1 - cosine**2) / index**2)
    kept = np.asarray(transmissivity, np.float64) ** (1 / inside)
    through = np.zeros(np.broadcast_shapes(kept.shape, np.shape(cosine)))
    for side in ((cosine - index * inside) / (cosine + index * inside), (index * cosine - inside) / (index * cosine + inside)):
        reflected = side**2
        through += (1 - reflected) ** 2 * kept / (1 - reflected**2 * kept**2) / 2
    return through


def mean_share(transmissivity: np.ndarray | float, index: float) -> np.ndarray:
    """Return the share of diffuse light that goes through, (...), for transmissivities, (...)."""
    cosine = (np.arange(STEPS) + 0.5) / STEPS
    return (share_at(cosine, np.asarray(transmissivity, np.float64)[..., None], index) * 2 * cosine).mean(axis=-1)


def of_mean(share: float, index: float) -> float:
    """Return the transmissivity of a pane that lets this share of diffuse light through: `mean_share` solved for it."""
    low, high = 0.0, 1.0
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if mean_share(middle, index) < share else (low, middle)
    return high


def of_normal(share: float, index: float) -> float:
    """Return the transmissivity of a pane that lets this share of light through at right angles.

    With R the reflectance of one side, t = (1 - R)² m / (1 - R² m²) is solved for m.
    """
    reflected = ((index - 1) / (index + 1)) ** 2
    if share <= 0:
        return 0.0
    half = (1 - reflected) ** 2 / (2 * share * reflected**2)
    return float(1 / (reflected**2 * (half + np.sqrt(half**2 + 1 / reflected**2))))
