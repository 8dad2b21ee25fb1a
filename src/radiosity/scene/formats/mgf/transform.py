"""MGF transformations: ``-t -rx -ry -rz -s -mx -my -mz -i -a``, as in section 2.2.2 of its specification."""

from collections.abc import Iterator
from itertools import product
from math import prod

import numpy as np

MOST_INSTANCES = 1_000_000
AXES = "xyz"


def instances(words: list[bytes]) -> Iterator[np.ndarray]:
    """The matrices of all instances that a transformation makes, one after the other.

    A matrix is (4, 4) and acts on row vectors, ``(x, y, z, 1) @ matrix``, so that arguments apply from left to right.
    The last array varies fastest; instance 0 is where the arguments outside the arrays put it.

    Raises:
        ValueError: an argument is not understood; the message names it.
    """
    segments: list[tuple[bool, int, np.ndarray]] = [(False, 1, np.eye(4))]  # is it an array, how often, the matrix
    queue = list(reversed(words))
    while queue:
        flag = queue.pop().decode("latin-1")
        if flag in ("-i", "-a"):
            count = int(_number(queue, flag))
            if count < (1 if flag == "-a" else 0):
                raise ValueError(f"'{flag} {count}'")
            segments.append((flag == "-a", count, np.eye(4)))
        else:
            array, count, matrix = segments[-1]
            segments[-1] = (array, count, matrix @ _single(flag, queue))
    counts = [count if array else 1 for array, count, _ in segments]
    if prod(counts) > MOST_INSTANCES:
        raise ValueError(f"{prod(counts)} instances; at most {MOST_INSTANCES}")
    return _matrices(segments, counts)


def _matrices(segments, counts) -> Iterator[np.ndarray]:
    for indices in product(*map(range, counts)):
        total = np.eye(4)
        for (array, count, matrix), index in zip(segments, indices, strict=True):
            total = total @ np.linalg.matrix_power(matrix, index if array else min(count, MOST_INSTANCES))
        yield total


def _single(flag: str, queue: list[bytes]) -> np.ndarray:
    matrix = np.eye(4)
    if flag == "-t":
        matrix[3, :3] = [_number(queue, flag) for _ in range(3)]
    elif flag == "-s":
        factor = _number(queue, flag)
        if factor == 0:
            raise ValueError("'-s 0'")
        matrix[:3, :3] *= factor
    elif flag[:2] == "-m" and len(flag) == 3 and flag[2] in AXES:
        axis = AXES.index(flag[2])
        matrix[axis, axis] = -1
    elif flag[:2] == "-r" and len(flag) == 3 and flag[2] in AXES:
        one, two = ((1, 2), (2, 0), (0, 1))[AXES.index(flag[2])]
        angle = np.radians(_number(queue, flag))
        matrix[one, one] = matrix[two, two] = np.cos(angle)
        matrix[one, two] = np.sin(angle)
        matrix[two, one] = -np.sin(angle)
    else:
        raise ValueError(f"'{flag[:40]}'")
    return matrix


def _number(queue: list[bytes], flag: str) -> float:
    try:
        value = float(queue.pop())
    except (IndexError, ValueError):
        raise ValueError(f"'{flag}' without its numbers") from None
    if not np.isfinite(value):
        raise ValueError(f"'{flag} {value}'")
    return value
