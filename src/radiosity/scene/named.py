"""Surfaces that a user names."""

import difflib
from collections.abc import Sequence
from fnmatch import fnmatchcase

from ..errors import MethodError

SHOWN = 8


def surfaces_called(names: Sequence[str], wanted: str) -> list[int]:
    """Return the indices of surfaces of a name, or else of those whose names match a pattern such as ``desk*``.

    Raises:
        MethodError: no surface is called so.
    """
    found = [i for i, known in enumerate(names) if known == wanted] or [i for i, k in enumerate(names) if fnmatchcase(k, wanted)]
    if not found:
        close = difflib.get_close_matches(wanted, names, SHOWN, 0.5) or names[:SHOWN]
        raise MethodError(f"no surface is called '{wanted}'; there are {len(names)}, such as {', '.join(close)}")
    return found
