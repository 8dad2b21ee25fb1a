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
        """Make on the device what `leave` reads: in a loop that is recorded nothing can be made.

        Args:
            geometry: a `tracing.geometry.Geometry`. Kernels see points p of the scene at ``geometry.bvh.place(p)``.
        """

    @abstractmethod
    def leave(self, light: Any, numbers: Any) -> tuple[Any, Any]:
        """In a kernel: where lines begin, and their directions of unit length, three floats each, in the caster's coordinates.

        The power that leaves in a solid angle is its share of the lines times the light's power.

        Args:
            light: UInt32, 0 to n_lights - 1; where a lane fires a patch's line it may be any of them.
            numbers: four floats in [0, 1) at least: two for the direction, two for the place.
        """
