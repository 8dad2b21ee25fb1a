"""Rules that join a field of several states, where they are not put side by side along the replicates (`state.array`)."""

import functools

import numpy as np

from ..errors import MethodError


def alike(layout, values: list, records: list) -> np.ndarray:
    """Return the array that all states have in common."""
    if not all(np.array_equal(value, values[0]) for value in values):
        raise MethodError("merge: states differ in what runs of one scene and method have in common; solve them alike")
    return values[0]


def added(layout, values: list, records: list):
    """Return the sum of values that are sums over replicates."""
    return functools.reduce(np.add, values) if layout is not None else sum(values)


def words(power: list[int]) -> tuple[np.ndarray, np.ndarray | None]:
    """Return the low and the upper words of whole numbers, uint64 each; None where all upper words are zero."""
    low, upper = (np.array([(one >> shift) % 2**64 for one in power], np.uint64) for shift in (0, 64))
    return low, upper if upper.any() else None


def fired_low(layout, values: list, records: list) -> np.ndarray:
    """Return the low words of the sum of the records' ``fired_in_all``, power that left along lines."""
    return _fired(records)[0]


def fired_upper(layout, values: list, records: list) -> np.ndarray | None:
    """Return the upper words of that sum, or None."""
    return _fired(records)[1]


def _fired(records: list) -> tuple[np.ndarray, np.ndarray | None]:
    return words([sum(powers) for powers in zip(*(record.fired_in_all for record in records), strict=True)])


def of_first(layout, values: list, records: list):
    """Return the value of the first state: a run has it for its first replicate alone."""
    return values[0]


def one_after_another(layout, values: list, records: list) -> np.ndarray:
    """Return the entries of all states, one state after the other."""
    return np.concatenate(values)
