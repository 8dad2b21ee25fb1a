"""Whose error a run is to reach, and whether there is any."""

import difflib
from fnmatch import fnmatchcase

import numpy as np

from ..errors import MethodError
from ..patches import Patches

KIND = "surface:"
SHOWN = 8
PAIRS = 1e8  # of lights and vertices: more are not looked at
FLAT = 1e-9  # of the scene's size: vertices no further in front of a light's plane lie in it


def rows_of(patches: Patches, name: str) -> np.ndarray:
    """Indices of the patches that ``surface:NAME`` means; ``NAME`` may be a pattern such as ``desk*``.

    Raises:
        MethodError: another form, or no such surface.
    """
    wanted, names = str(name).removeprefix(KIND), list(patches.scene.names)
    if not str(name).startswith(KIND) or not wanted:
        raise MethodError(f"error_of is '{name}'; write {KIND}NAME, such as {KIND}{names[0]}")
    found = [i for i, known in enumerate(names) if known == wanted] or [i for i, k in enumerate(names) if fnmatchcase(k, wanted)]
    rows = np.flatnonzero(np.isin(patches.surface, found))
    if not len(rows):
        close = difflib.get_close_matches(wanted, names, SHOWN, 0.5) or names[:SHOWN]
        raise MethodError(f"no surface is called '{wanted}'; there are {len(names)}, such as {', '.join(close)}")
    return rows


def nothing_before_lights(patches: Patches) -> bool:
    """Nothing lies in front of any light, so that no line can land: known for certain where it is said, by the vertices."""
    scene = patches.scene
    lit = patches.emission.any(axis=1)
    normal, point = patches.normal[lit], patches.centroid[lit]
    vertices = scene.vertices[np.unique(scene.faces[scene.faces >= 0])]
    planes = np.unique(np.column_stack([normal, (normal * point).sum(axis=1)]), axis=0)
    if len(planes) * len(vertices) > PAIRS:
        return False
    tolerance = FLAT * np.ptp(vertices, axis=0).max()
    return all((vertices @ plane[:3] - plane[3]).max() <= tolerance for plane in planes)
