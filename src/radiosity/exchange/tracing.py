"""The lines of a radiative exchange."""

import numpy as np

from ..patches.model import Patches
from ..run.line_set.model import LineSet
from ..run.line_set.trace import trace_lines
from .conditions import Conditions

SMALL = 0.1  # share of the scene's area below which surfaces that are hot or cold by themselves get more lines


def sources(patches: Patches, conditions: Conditions) -> list[str]:
    """Return the names of small surfaces of given temperature or flux: by area alone they would have few lines."""
    area = np.bincount(patches.surface, patches.area, len(patches.scene.names))
    driven = ~(conditions.flux == 0) & (area > 0)
    return [patches.scene.names[i] for i in np.flatnonzero(driven & (area < SMALL * area.sum()))]


def trace(patches: Patches, conditions: Conditions, rays: float, before: LineSet | None, **options) -> LineSet:
    """Trace lines, or go on from those ``before``; options are those of `trace_lines`."""
    return trace_lines(patches, rays=rays, sources=sources(patches, conditions) or None, resume=before, **options)
