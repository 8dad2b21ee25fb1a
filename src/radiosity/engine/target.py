"""Whose error a run is to reach."""

import difflib
from fnmatch import fnmatchcase

import numpy as np

from ..errors import MethodError
from ..patches import Patches

KIND = "surface:"
SHOWN = 8


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
