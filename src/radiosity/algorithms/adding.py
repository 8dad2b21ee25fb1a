"""The sum of states whose fields are sums of whole numbers: of walks, or lines, that were followed in several places."""

from dataclasses import fields, replace
from typing import TypeVar

import numpy as np

from .state import UPPER, Record

R = TypeVar("R", bound=Record)


def added(one: R, other: R) -> R:
    """Return the first record with the arrays of the other added; words modulo 2^64 are carried to their upper words."""
    found, names = {}, {field.name for field in fields(one)}
    for field in fields(one)[1:]:
        name, value = field.name, getattr(one, field.name)
        if "layout" not in field.metadata or name.endswith(UPPER) or value is None:
            continue
        more = getattr(other, name)
        if name + UPPER not in names:
            found[name] = _counted(value, more)
            continue
        found[name] = low = value + more
        above = [getattr(record, name + UPPER) for record in (one, other)]
        upper = (low < value).astype(np.uint64) + sum(np.uint64(0) if up is None else up.astype(np.uint64) for up in above)
        kind = next((up.dtype for up in above if up is not None), np.dtype(np.uint32))
        found[name + UPPER] = upper.astype(kind) if upper.any() else None
    return replace(one, **found)


def _counted(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the sum of counts, uint32 where that suffices, else uint64; that of signed words as it is."""
    if one.dtype.kind != "u":
        return one + other
    total = one.astype(np.uint64) + other
    return total if int(total.max(initial=0)) >> 32 else total.astype(np.uint32)
