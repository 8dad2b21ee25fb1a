"""What is to be solved: patches, their bands, and the scalar problem that lines are shared out by."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..patches.model import Patches
from .bands import BandGroups
from .quanta import Source


@dataclass(frozen=True, eq=False)
class Problem:
    """A scene's equation.

    Attributes:
        patches: the unknowns.
        groups: bands that are one problem (see `BandGroups`).
        source: the scalar problem of the largest band of each patch (contract 3).
    """

    patches: Patches
    groups: BandGroups
    source: Source

    @cached_property
    def scalar(self) -> "Problem":
        """The largest band of each patch alone: it fires as many lines."""
        groups = self.groups
        emission, reflectance = (x.max(axis=1, keepdims=True) for x in (groups.emission, groups.reflectance))
        return replace(self, groups=BandGroups(np.zeros(1, np.int64), np.ones(1), emission, reflectance))

    @staticmethod
    def of(patches: Patches) -> "Problem":
        """Compare the bands and sum the emission.

        Raises:
            SceneError: nothing emits.
        """
        groups = BandGroups.of(patches)
        return Problem(patches, groups, Source.of(patches, groups.emission.max(axis=1), groups.reflectance.max(axis=1)))
