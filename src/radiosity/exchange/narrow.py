"""Faces that are too narrow for lines: lines begin a little inside the edges, which leaves much of a narrow face out."""

import warnings

import numpy as np

from ..errors import RadiosityWarning, shown
from ..tracing.geometry import Geometry
from .groups import Groups

TOLD = 0.01  # of a group's area: factors may be as far off, relative


def left_out(geometry: Geometry, groups: Groups) -> np.ndarray:
    """Return the share of each group's area from which no line begins, (n,)."""
    patches = geometry.patches
    missing = geometry.left_out[patches.face] * patches.area
    return np.bincount(groups.labels, missing, len(groups.names)) / groups.area(patches)


def warn_of_narrow(geometry: Geometry, groups: Groups) -> None:
    """Warn of groups of which lines leave out more than `TOLD`."""
    share = left_out(geometry, groups)
    rows = np.flatnonzero(share > TOLD)
    if len(rows):
        told = shown([f"{groups.names[i]}: {share[i]:.0%}" for i in rows[np.argsort(-share[rows])]])
        warnings.warn(
            f"{geometry.scene.source}: faces are so narrow, for the size of the scene, that lines leave out a part of their area "
            f"along the edges ({told}); their view factors, and heat, may be as far off, which errors do not "
            "show; take view factors with method='polygons', or a smaller scene",
            RadiosityWarning,
            stacklevel=3,
        )
