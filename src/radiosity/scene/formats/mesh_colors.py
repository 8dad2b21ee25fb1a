"""Colours that meshes bring along, where files count them from 0 to 255 and not to 1."""

from collections.abc import Iterable

import numpy as np

from ...errors import shown
from ..assemble import warn

FULL = 255


def are_bytes(colors: np.ndarray) -> bool:
    """Return whether colours, (n, 3), NaN where there is none, are whole numbers up to 255 that exceed 1."""
    known = colors[np.isfinite(colors)]
    return bool(len(known) and known.min() >= 0 and 1 < known.max() <= FULL and (known == np.floor(known)).all())


def warn_of_bytes(source, whose: Iterable[str]) -> None:
    """Tell once whose colours were divided by 255."""
    if names := list(dict.fromkeys(whose)):
        text = f"colours that are whole numbers above 1, where 0 to 1 is expected, are taken as 0 to {FULL}"
        warn(f"{source}: {text}: {shown(names)}")
