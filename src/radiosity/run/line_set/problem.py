"""The problem of a run that only counts lines: black patches, which share the lines by area, and some surfaces more of them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from ...errors import MethodError
from ...patches import Patches
from ...problem.bands import BandGroups
from ...problem.model import Problem
from ...problem.source_rows import SourceRows
from ...scene.back import Back
from ...scene.named import surfaces_called

SIDES = ("both", "front", "back")


def some_backs_pass(patches: Patches) -> bool:
    """Return whether lines go on through some faces; then a line counts where it begins alone."""
    return bool(np.isin(patches.scene.back, (Back.PASSES, Back.OPEN)).any())


@dataclass(frozen=True, eq=False)
class Sources:
    """Patches that get more lines.

    Attributes:
        rows: (n_patches,) bool.
        names: names of their surfaces, with a side where it is one alone, such as "lamp (front)".
    """

    rows: np.ndarray
    names: tuple[str, ...]

    @staticmethod
    def of(patches: Patches, given) -> "Sources":
        """Return the sources of names of surfaces or patterns, or of a dictionary from names to "front", "back" or "both".

        Raises:
            MethodError: no names, no such surface, or a side that does not radiate.
        """
        rows, labels = np.zeros(len(patches), bool), {}
        for name, side in _listed(given).items():
            if side not in SIDES:
                raise MethodError(f"sources: '{name}' has the side {side!r}; known are {', '.join(SIDES)}")
            indices = surfaces_called(patches.scene.names, name)
            some = np.isin(patches.surface, indices) & ((side == "both") | (patches.is_back == (side == "back")))
            if not some.any():
                raise MethodError(f"sources: no patch is on '{name}' ({side}); name another surface or side, or leave it out")
            rows |= some
            labels |= {patches.scene.names[i]: side for i in sorted(indices)}
        return Sources(rows, tuple(name if side == "both" else f"{name} ({side})" for name, side in sorted(labels.items())))


def _listed(given) -> dict[str, str]:
    if given is None:
        return {}
    if isinstance(given, str):
        given = [given]
    if isinstance(given, Iterable):
        found = dict(given) if isinstance(given, Mapping) else dict.fromkeys(given, "both")
        if all(isinstance(name, str) for name in found):
            return found
    raise MethodError(f"sources is {given!r}; it must be a list of names of surfaces, or a dictionary from names to sides")


def problem_of(patches: Patches, sources: Sources) -> Problem:
    """Return the problem whose emission says which patches get more lines: those of the sources, or none."""
    patches = patches.solid
    emission = np.where(sources.rows if sources.rows.any() else True, np.ones(len(patches)), 0.0)[:, None]
    groups = BandGroups(np.zeros(1, np.int64), np.ones(1), emission, np.zeros_like(emission), np.zeros(1, np.int64))
    rows = SourceRows(len(patches), groups.emission, groups.reflectance, patches.area)
    return Problem(patches, groups, rows.scalar(patches), rows, prefers_sources=True)
