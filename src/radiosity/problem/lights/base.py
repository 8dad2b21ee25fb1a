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
            numbers: five floats in [0, 1): two for the direction, two for the place, one for a choice.
        """

    def leave_where(self, light: Any, numbers: Any, active: Any) -> tuple[Any, Any]:
        """Return what `leave` does, of the lanes that fire lines of these lights; the others may have any line.

        It may be overridden, where it saves time to know these lanes.
        """
        return self.leave(light, numbers)


class AbstractSky(AbstractLights):
    """Light of all directions, which lines see that leave the scene."""

    @abstractmethod
    def radiance(self, direction: Any) -> list:
        """Return what lines in these directions, of unit length, see: a Float for each band, W/(m² sr) or cd/m²; in a kernel."""


class AbstractPointLights(AbstractLights):
    """Lights that are seen from any point in one direction, so that shadow rays can go to them."""

    @abstractmethod
    def arrive(self, light: Any, point: Any, numbers: Any) -> tuple[Any, Any, Any]:
        """Return how the light of each light arrives at points; called in a kernel.

        That is the unit direction from the point to the light, the distance to it in the BVH's units (infinite for lights far
        away), and the share of its power, per square unit of the BVH, that passes the point on a plane perpendicular to the
        direction. The last is the mean over ``numbers``: lines in these directions bring what `leave` sends.

        Args:
            light: UInt32, 0 to n_lights - 1.
            point: three floats, in the BVH's coordinates.
            numbers: two floats in [0, 1).
        """
