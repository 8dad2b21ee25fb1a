"""The merge of states of runs that have different replicates of one seed, to the state of one run with all of them."""

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np

from ..errors import MethodError
from .state import AbstractState, Layout, Record

S = TypeVar("S", bound=AbstractState)


def merge(states: Sequence[S]) -> S:
    """Return the state of one run with the replicates of all states, in the order given.

    The caller makes sure that the replicates are different.

    Raises:
        MethodError: states of other algorithms, quanta or sizes, within a stage, or of an algorithm whose replicates cannot be
            solved apart.
    """
    if not states:
        raise MethodError("merge: there is no state; give one or more")
    first = states[0]
    for at, state in enumerate(states, 1):
        if type(state) is not type(first):
            raise MethodError(
                f"merge: state 1 is a {type(first).__name__}, state {at} a {type(state).__name__}; take runs of one method"
            )
        if state.alone and len(states) > 1:
            raise MethodError(f"merge: {state.alone}; solve all replicates in one run")
        if state.quanta != first.quanta:
            raise MethodError(
                f"merge: state 1 has {first.quanta} quanta, state {at} has {state.quanta}; solve them with equal quanta"
            )
        if state.unfinished:
            raise MethodError(
                f"merge: state {at} is within its stage of {state.quanta} quanta; go on with it to the end (resume)"
            )
        if (state.sizes.rows, state.sizes.groups) != (first.sizes.rows, first.sizes.groups):
            raise MethodError(
                f"merge: state 1 has {first.sizes.rows} rows in {first.sizes.groups} groups of bands, state {at} has "
                f"{state.sizes.rows} in {state.sizes.groups}; take runs of one scene, cut alike"
            )
    return _merged(list(states))


def _merged(records: list[Any]) -> Any:
    sizes = [record.sizes for record in records]
    values: dict[str, Any] = {"sizes": replace(sizes[0], replicates=sum(size.replicates for size in sizes))}
    for one in fields(records[0])[1:]:
        found, facts = [getattr(record, one.name) for record in records], one.metadata
        there = [value is not None for value in found]
        upper, rule = facts.get("zeros", False), facts.get("merged")
        if not any(there) and not (upper and rule is not None):
            continue
        if upper and rule is None:
            found = [zeros_like(facts["layout"], value, record, found) for value, record in zip(found, records, strict=True)]
        elif not upper and not all(there):
            raise MethodError(f"merge: state {there.index(False) + 1} lacks '{one.name}', and others have it; solve them alike")
        if "record" in facts:
            values[one.name] = _merged(found)
        elif facts["merged"] is not None:
            values[one.name] = facts["merged"](facts.get("layout"), found, records)
        elif "kind" in facts:
            values[one.name] = _equal(one.name, found)
        else:
            values[one.name] = side_by_side(facts["layout"], found, records)
    return type(records[0])(**values)


def zeros_like(layout: Layout, value: np.ndarray | None, record: Record, others: list) -> np.ndarray:
    """Return the array, or zeros of the type that other states have."""
    if value is not None:
        return value
    kind = next(other.dtype for other in others if other is not None)
    found = np.zeros(record.sizes.shape(layout.axes), kind)
    return found.ravel() if layout.flat else found


def _equal(name: str, values: list) -> Any:
    other = next((at for at, value in enumerate(values) if value != values[0]), None)
    if other is not None:
        raise MethodError(f"merge: '{name}' is {values[0]} in state 1 and {values[other]} in state {other + 1}; solve them alike")
    return values[0]


def side_by_side(layout: Layout, values: list, records: list[Record]) -> np.ndarray:
    """Join arrays along the axis of replicates; where they have slots, join rows, and escaped and lost power, apart."""
    if not layout.flat:
        return np.concatenate(values, axis=layout.axes.index("replicates"))
    shaped = [value.reshape(record.sizes.shape(layout.axes)) for value, record in zip(values, records, strict=True)]
    if "slots" not in layout.axes:
        return np.concatenate(shaped, axis=layout.axes.index("replicates")).ravel()
    splits = [record.sizes.replicates * record.sizes.rows for record in records]
    rows = [value[:split] for value, split in zip(shaped, splits, strict=True)]
    missed = [value[split:].reshape(2, -1, value.shape[1]) for value, split in zip(shaped, splits, strict=True)]
    return np.concatenate([*(value.ravel() for value in rows), np.concatenate(missed, axis=1).ravel()])
