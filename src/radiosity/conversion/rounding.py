"""32-bit coordinates: the surfaces whose areas they change are told."""

import numpy as np

from .told import Told

CHANGED = 1e-3  # of a surface's area: a larger change is told


def tell_of_rounding(told: Told, names, surface: np.ndarray, corners: np.ndarray) -> None:
    """Note surfaces whose triangles have other areas once their coordinates are rounded.

    Args:
        names: of all surfaces.
        surface: (n,) int, the surface of each triangle.
        corners: (n, 3, 3) float64 metres, as they are before they are rounded.
    """
    areas = _areas(corners)
    change = np.bincount(surface, np.abs(_areas(corners.astype(np.float32).astype(np.float64)) - areas), len(names))
    whole = np.bincount(surface, areas, len(names))
    told.add(
        f"coordinates of 32 bits change areas by more than {CHANGED:g} of them; move the scene to the origin",
        [names[i] for i in np.flatnonzero(change > CHANGED * whole)],
    )


def _areas(corners: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
