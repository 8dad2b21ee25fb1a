"""The position index of a source of glare: how much less it disturbs than one on the line of sight."""

import numpy as np

NEAR = 0.6  # below the line of sight: of the distance along it


def position_index(way: np.ndarray, gaze: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Return the position index p of sources, (n,) float64; infinite behind the observer.

    Above the line of sight it is Guth's (CIE 117, 1995); below it that of T. Iwata et al., "Position index for a glare source
    below the line of vision", Lighting Research and Technology 29 (1997).

    Args:
        way: (n, 3), from the observer to sources.
        gaze: (3,) of unit length, the line of sight.
        up: (3,), not along the line of sight.
    """
    above = up - (up @ gaze) * gaze
    above = above / np.linalg.norm(above)
    ahead, height, aside = way @ gaze, way @ above, way @ np.cross(gaze, above)
    away = np.hypot(height, aside)
    tau = np.degrees(np.arctan2(np.abs(aside), np.maximum(height, 0)))
    sigma = np.degrees(np.arctan2(away, ahead))
    guth = np.exp(
        (35.2 - 0.31889 * tau - 1.22 * np.exp(-2 * tau / 9)) * 1e-3 * sigma
        + (21 + 0.26667 * tau - 0.002963 * tau**2) * 1e-5 * sigma**2
    )
    ratio = np.divide(away, ahead, out=np.full(len(way), np.inf), where=ahead > 0)
    below = 1 + np.where(ratio < NEAR, 0.8, 1.2) * ratio
    return np.where(ahead > 0, np.where(height >= 0, guth, below), np.inf)
