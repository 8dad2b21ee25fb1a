"""The problem to solve: patches, their bands, and the scalar problem that says how many lines each row fires."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..patches.model import Patches
from .bands import BandGroups
from .lights import AbstractLights
from .lights.together import AllLights, lights_of
from .quanta import Source
from .source_rows import SourceRows


@dataclass(frozen=True, eq=False)
class Problem:
    """A scene's equation.

    Attributes:
        patches: the unknowns are their radiosities; of panes it is the solid part (`Patches.solid`).
        groups: bands that are one problem (see `BandGroups`).
        source: the scalar problem of the largest band of each row (contract 3).
        rows: what fires lines: the patches, and lights without area.
        lights: lights without area, or None.
        importance: (n_rows,) float64, positive: what light from each row is worth, by which lines are shared out; None: all
            light is worth the same.
        prefers_sources: what emits gets a part of all lines, also by methods that would give it none.
    """

    patches: Patches
    groups: BandGroups
    source: Source
    rows: SourceRows
    lights: AllLights | None = None
    importance: np.ndarray | None = None
    prefers_sources: bool = False

    @cached_property
    def unit(self) -> np.ndarray:
        """What a gather counts light in, (n_groups,) W/m² or lm/m²: the largest emission, or more where lights need it."""
        largest = self.groups.emission.max(axis=0)
        if self.lights is None:
            return largest
        return np.maximum(largest, self.rows.emission[self.rows.n_patches :].sum(axis=0) / self.patches.area.sum())

    @property
    def shares(self) -> np.ndarray | None:
        """Lines of a unit of power of each row in iterations, (n_rows,): the importance, or else `SourceRows.lines`; None: 1."""
        return self.rows.lines if self.importance is None else self.importance

    @cached_property
    def scalar(self) -> "Problem":
        """Return the problem of the largest band of each row alone, which fires as many lines."""
        rows, n = self.rows, self.rows.n_patches
        emission, reflectance = (x.max(axis=1, keepdims=True) for x in (rows.emission, rows.reflectance))
        through = None if rows.through is None else rows.through.max(axis=1, keepdims=True)
        one, other = np.zeros(1, np.int64), self.groups.other
        groups = BandGroups(one, np.ones(1), emission[:n], reflectance[:n], one, None if through is None else through[:n], other)
        return replace(self, groups=groups, rows=SourceRows(n, emission, reflectance, rows.area, rows.lines, through, rows.other))

    @staticmethod
    def of(patches: Patches, lights: AbstractLights | None = None, through: bool = False) -> "Problem":
        """Make the problem of patches: compare their bands and sum the emission.

        Args:
            lights: lights without area; by default those of the scene.
            through: lines of the sky and of suns through the scene's openings are rows of their own, which fire more lines.

        Raises:
            SceneError: nothing emits.
        """
        if lights is None:
            lights = lights_of(patches.scene, patches.emission.shape[1], through)
        elif not isinstance(lights, AllLights):
            lights = AllLights((lights,))
        patches = patches.solid
        power = np.zeros((0, patches.emission.shape[1])) if lights is None else lights.power
        groups = BandGroups.of(patches, power)
        rows = SourceRows.of(patches, groups, power[:, groups.leaders], None if lights is None else lights.is_through)
        return Problem(patches, groups, rows.scalar(patches), rows, lights)
