"""Lights without area: they fire lines and receive none."""

from abc import ABC, abstractmethod
from typing import Any

import numpy as np


class AbstractLights(ABC):
    """Lights of one kind, each a row of `SourceRows` after those of the patches.

    Attributes:
        power: (n_lights, n_bands) float64, W or lm that each light sends.
    """

    power: np.ndarray

    @abstractmethod
    def prepare(self, geometry: Any) -> None:
        """Make on the device what `leave` reads: nothing can be made while a loop is recorded.

        Args:
            geometry: a `tracing.geometry.Geometry`. Kernels see points p of the scene at ``geometry.bvh.place(p)``.
        """

    @abstractmethod
    def leave(self, light: Any, numbers: Any) -> tuple[Any, Any]:
        """Return where lines begin, and their directions, of unit length; called in a kernel.

        Both have three floats, in the BVH's coordinates. The power that leaves in a solid angle is the share of the lines there
        times the light's power.

        Args:
            light: UInt32, 0 to n_lights - 1; any of these where a lane fires a patch's line.
            numbers: four floats or more in [0, 1): two for the direction, two for the place.
        """
