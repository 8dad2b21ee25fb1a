"""The inverse of `merging`: the state of some replicates of a run, taken from the state of all."""

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np

from .merge_rules import added, alike, fired_low, fired_upper, of_first
from .state import AbstractState, Layout

S = TypeVar("S", bound=AbstractState)

# The rule by which a field is merged, and what each part gets of it: value, number of the part -> value.
RULES: dict[Callable, Callable[[Any, int], Any]] = {
    alike: lambda value, at: value,
    **dict.fromkeys((added, fired_low, fired_upper), lambda value, at: value if at == 0 else value * 0),
    of_first: lambda value, at: value if at == 0 else value[:0],
}


def divisible(kind: type[AbstractState]) -> bool:
    """Return whether states of this class can be split."""
    return not kind.alone and _known(kind)


def _known(kind: type) -> bool:
    """Return whether there is a rule for each field. Numbers that are merged by a rule of their own are equal in all parts."""
    for one in fields(kind)[1:]:
        facts = one.metadata
        if "record" in facts:
            if not _known(facts["record"]):
                return False
        elif facts.get("merged") not in (None, *RULES) and "layout" in facts:
            return False
    return True


def split(state: S, counts: list[int]) -> list[S]:
    """Return the states of parts of ``counts`` replicates each, in order; merged, they are the state again.

    The class of the state is `divisible`. Arrays are views of the state's.
    """
    assert sum(counts) == state.sizes.replicates
    found, first = [], 0
    for at, count in enumerate(counts):
        found.append(_part(state, at, first, count))
        first += count
    return found


def _part(record: Any, at: int, first: int, count: int) -> Any:
    values: dict[str, Any] = {"sizes": replace(record.sizes, replicates=count)}
    for one in fields(record)[1:]:
        value, facts = getattr(record, one.name), one.metadata
        if value is None:
            continue
        if "record" in facts:
            values[one.name] = _part(value, at, first, count)
        elif facts["merged"] in RULES:
            values[one.name] = RULES[facts["merged"]](value, at)
        elif "kind" in facts:
            values[one.name] = value
        else:
            values[one.name] = _sliced(facts["layout"], value, record, slice(first, first + count))
    return type(record)(**values)


def _sliced(layout: Layout, value: np.ndarray, record: Any, part: slice) -> np.ndarray:
    """Return the replicates ``part`` of an array, see `merging.side_by_side`."""
    if not layout.flat:
        return value[_at(layout, "replicates", part)]
    sizes = record.sizes
    if "slots" not in layout.axes:
        return value.reshape(sizes.shape(layout.axes))[_at(layout, "replicates", part)].ravel()
    groups, rows = value.reshape(sizes.shape(layout.axes)), sizes.replicates * sizes.rows
    own = groups[part.start * sizes.rows : part.stop * sizes.rows]
    missed = groups[rows:].reshape(2, sizes.replicates, -1)[:, part]
    return np.concatenate([own.ravel(), missed.ravel()])


def _at(layout: Layout, axis: str, part: slice) -> tuple[slice, ...]:
    return tuple(part if name == axis else slice(None) for name in layout.axes)
