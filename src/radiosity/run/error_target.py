"""The error target of a run: the patches or surfaces whose error it must reach."""

from dataclasses import dataclass, field

import numpy as np

from ..errors import MethodError
from ..patches import Patches
from ..scene.named import surfaces_called
from ..solution.errors import SURE
from ..solution.intervals import student
from .aim import Aim
from .snapshot import Snapshot

SURFACE, MEAN = KINDS = ("surface:", "mean:")
PAIRS = 1e8  # pairs of light and vertex: with more, they are not checked
FLAT = 1e-9  # of the scene's size: vertices no further in front of a light's plane lie in it


@dataclass(frozen=True, eq=False)
class Target:
    """The error that a run must reach: of all patches, of those of some surfaces, or of the mean irradiance over these surfaces.

    Attributes:
        rows: the patches whose error it is.
        surfaces: (k,) int, the surfaces whose mean it is; None: the error is the RMS over the patches.
        aim: what lines are shared out for, where the error is that of its value.
    """

    rows: np.ndarray | slice = field(default_factory=lambda: slice(None))
    surfaces: np.ndarray | None = None
    aim: Aim | None = None

    @staticmethod
    def of(patches: Patches, name: str | None, aim: Aim | None = None) -> "Target":
        """Make the target from a text: ``surface:NAME`` is the RMS over the patches of a surface, ``mean:NAME`` its mean; None is
        what lines are shared out for (``aim``), or else all patches.

        Raises:
            MethodError: the text has another form, or there is no such surface.
        """
        if name is None:
            return Target() if aim is None else Target(np.flatnonzero(aim.share), aim=aim)
        rows = rows_of(patches, name)
        return Target(rows, np.unique(patches.surface[rows]) if str(name).startswith(MEAN) else None)

    def error(self, snapshot: Snapshot) -> float:
        """Return the relative error, the largest of the bands; NaN where unknown."""
        if self.aim is not None:
            return snapshot.error_of_sum(self.aim.share, radiosity=self.aim.radiosity)
        return snapshot.error(self.rows) if self.surfaces is None else snapshot.error_of_mean(self.rows, self.surfaces)

    def judged(self, snapshot: Snapshot) -> bool:
        """Return whether the error comes from enough lines."""
        if self.aim is not None:
            return snapshot.judged_sum(self.aim.share)
        return snapshot.judged(self.rows) if self.surfaces is None else snapshot.judged_mean(self.rows)

    def margin(self, snapshot: Snapshot) -> float:
        """Return how many times the stated error the true one may be; for a mean by Student's distribution."""
        return snapshot.margin(self.rows) if self.surfaces is None and self.aim is None else student(SURE, snapshot.replicates)


def rows_of(patches: Patches, name: str) -> np.ndarray:
    """Return indices of the patches that ``surface:NAME`` or ``mean:NAME`` means; ``NAME`` may be a pattern such as ``desk*``.

    Raises:
        MethodError: the text has another form, or there is no such surface.
    """
    kind, wanted = next(((k, str(name).removeprefix(k)) for k in KINDS if str(name).startswith(k)), ("", ""))
    names = list(patches.scene.names)
    if not kind or not wanted:
        raise MethodError(
            f"error_of is '{name}'; write {SURFACE}NAME (RMS over its patches) or {MEAN}NAME (of its mean irradiance), such as "
            f"{SURFACE}{names[0]}"
        )
    found = surfaces_called(names, wanted)
    rows = np.flatnonzero(np.isin(patches.surface, found))
    if not len(rows):
        raise MethodError(f"error_of is '{name}', and no patch is on that surface; choose another")
    return rows


def nothing_before_lights(patches: Patches) -> bool:
    """Return True where it is certain, by the vertices, that nothing lies in front of any light, so that no line can hit."""
    scene = patches.scene
    if scene.lights:
        return False
    lit = patches.emission.any(axis=1)
    normal, point = patches.normal[lit], patches.centroid[lit]
    vertices = scene.vertices[np.unique(scene.faces[scene.faces >= 0])]
    planes = np.unique(np.column_stack([normal, (normal * point).sum(axis=1)]), axis=0)
    if len(planes) * len(vertices) > PAIRS:
        return False
    tolerance = FLAT * np.ptp(vertices, axis=0).max()
    return all((vertices @ plane[:3] - plane[3]).max() <= tolerance for plane in planes)
