"""Rules that join a field of several states, where it is not put side by side along the replicates (`state.array`)."""

import functools

import numpy as np

from ..errors import MethodError


def alike(layout, values: list, records: list) -> np.ndarray:
    """Arrays that all states have in common."""
    if not all(np.array_equal(value, values[0]) for value in values):
        raise MethodError("merge: states differ in what runs of one scene and method have in common; solve them alike")
    return values[0]


def added(layout, values: list, records: list):
    """Sums over the replicates."""
    return functools.reduce(np.add, values) if layout is not None else sum(values)


def of_first(layout, values: list, records: list):
    """What a run tells of its first replicate alone."""
    return values[0]


def one_after_another(layout, values: list, records: list) -> np.ndarray:
    """Entries of the replicates follow each other."""
    return np.concatenate(values)
