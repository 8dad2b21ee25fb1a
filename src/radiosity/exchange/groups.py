"""Groups of patches, between which view factors are asked for."""

from dataclasses import dataclass

import numpy as np

from ..errors import MethodError, shown
from ..patches.model import Patches
from ..scene.model import Back
from ..scene.named import surfaces_called

KINDS = ("surface", "patch")


@dataclass(frozen=True, eq=False)
class Groups:
    """Names of groups, and which patches they have.

    Attributes:
        names: n names.
        labels: (n_patches,) int64, the group of each patch.
    """

    names: tuple[str, ...]
    labels: np.ndarray

    def area(self, patches: Patches) -> np.ndarray:
        """Return the area of each group, (n,) m²: radiating sides."""
        return np.bincount(self.labels, patches.area, len(self.names))


def groups_of(patches: Patches, group) -> Groups:
    """Return the groups that an argument means.

    Args:
        group: "surface" (a surface of two radiating sides is two groups, ``NAME (front)`` and ``NAME (back)``), "patch", a
            dictionary of names to lists of names of surfaces, sides or patterns (what it does not name stays apart, as by
            "surface"), or a whole number for each patch.

    Raises:
        MethodError: there is no such group or surface, or a surface is in two groups.
    """
    if isinstance(group, str):
        if group == "patch":
            return Groups(tuple(_patch_names(patches)), np.arange(len(patches)))
        if group == "surface":
            return _by_side(patches)
        raise MethodError(
            f"group '{group}' does not exist; known are {', '.join(KINDS)}, or give a dictionary such as {_such(patches)}"
        )
    if isinstance(group, dict):
        return _by_name(patches, group)
    return _by_label(patches, group)


def _such(patches: Patches) -> str:
    return f"{{'shell': ['{patches.scene.names[0]}']}}"


def _patch_names(patches: Patches) -> list[str]:
    """Return a name for each patch: its surface and its number in the order of all patches."""
    return [f"{patches.scene.names[s]} {i}" for i, s in enumerate(patches.surface)]


def _by_side(patches: Patches) -> Groups:
    scene = patches.scene
    two = np.bincount(scene.surface[scene.back == Back.RADIATES], minlength=len(scene.names)) > 0
    return _present(patches, 2 * patches.surface.astype(np.int64) + (patches.is_back & two[patches.surface]), two)


def _present(patches: Patches, code: np.ndarray, two: np.ndarray) -> Groups:
    """Return groups by 2 surface + side; surfaces without patches have none."""
    found, labels = np.unique(code, return_inverse=True)
    names = [f"{patches.scene.names[c // 2]}{(' (back)' if c % 2 else ' (front)') if two[c // 2] else ''}" for c in found]
    return Groups(_unique(names), labels.astype(np.int64))


def _by_name(patches: Patches, group: dict) -> Groups:
    sides, names, scene_names = _by_side(patches), tuple(str(name) for name in group), patches.scene.names
    first = np.full(len(sides.names), -1)  # a patch of each side
    first[sides.labels] = np.arange(len(patches))
    surface = patches.surface[first]
    owner = np.full(len(sides.names), -1)
    for number, members in enumerate(group.values()):
        for member in [members] if isinstance(members, str) else list(members):
            for index in surfaces_called([*sides.names, *scene_names], str(member)):
                of = np.flatnonzero(surface == index - len(owner)) if index >= len(owner) else np.array([index])
                taken = of[(owner[of] >= 0) & (owner[of] != number)]
                if len(taken):
                    other = names[owner[taken[0]]]
                    raise MethodError(
                        f"'{sides.names[taken[0]]}' is in the groups '{other}' and '{names[number]}'; leave it in one of them"
                    )
                owner[of] = number
    empty = [name for i, name in enumerate(names) if i not in owner]
    if empty:
        raise MethodError(f"the groups {shown(empty)} have no radiating side; leave them out, or name other surfaces")
    rest = np.flatnonzero(owner < 0)
    owner[rest] = len(names) + np.arange(len(rest))
    return Groups(_unique([*names, *(sides.names[i] for i in rest)]), owner[sides.labels])


def _by_label(patches: Patches, labels) -> Groups:
    try:
        labels = np.asarray(labels)
        good = labels.shape == (len(patches),) and labels.dtype.kind in "iu" and labels.min() >= 0
    except (TypeError, ValueError):
        good = False
    if not good:
        raise MethodError(
            f"group must be 'surface', 'patch', a dictionary such as {_such(patches)}, or a whole number of 0 or more for "
            f"each of the {len(patches)} patches"
        )
    found, compact = np.unique(labels, return_inverse=True)
    return Groups(tuple(f"group {number}" for number in found.tolist()), compact.astype(np.int64))


def _unique(names: list[str]) -> tuple[str, ...]:
    """Return the names.

    Raises:
        MethodError: two groups have one name.
    """
    twice = sorted({name for name in names if names.count(name) > 1}) if len(set(names)) < len(names) else []
    if twice:
        raise MethodError(f"two groups would be called {shown(twice)}; give the groups other names")
    return tuple(names)
