"""Groups whose faces are too narrow for lines."""

import numpy as np

from ..diagnostics import narrow
from ..tracing.geometry import Geometry
from .groups import Groups

HEAT = (
    "their view factors, and heat, may be as far off, which errors do not show; take view factors with method='polygons', or a "
    "smaller scene"
)


def left_out(geometry: Geometry, groups: Groups) -> np.ndarray:
    """Return the share of each group's area from which no line begins, (n,)."""
    return narrow.left_out(geometry, groups.labels, len(groups.names))


def warn_of_narrow(geometry: Geometry, groups: Groups) -> None:
    """Warn of groups of which lines leave out more than a hundredth."""
    narrow.warn_of_narrow(geometry, left_out(geometry, groups), groups.names, HEAT, 3)
