"""Pieces of long arrays: work on one piece at a time stays in the cache, and takes little memory."""

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from typing import TypeVar

PIECE = 1 << 16
THREADS = min(os.cpu_count() or 1, 8)

Part = TypeVar("Part")
Result = TypeVar("Result")


def pieces(count: int, size: int | None = None) -> Iterator[slice]:
    """Yield slices that cover ``count`` entries, a piece at a time: `PIECE` entries, or ``size``."""
    step = size or PIECE
    for start in range(0, count, step):
        yield slice(start, min(start + step, count))


def of_pieces(work: Callable[[slice], Result], count: int, size: int | None = None) -> list[Result]:
    """Return what ``work`` returns for each piece of ``count`` entries, in order; pieces are shared among threads.

    It pays where ``work`` calls NumPy on long arrays, which lets other threads go on.
    """
    return in_threads(work, list(pieces(count, size)))


def in_threads(work: Callable[[Part], Result], parts: Sequence[Part]) -> list[Result]:
    """Return what ``work`` returns for each part, in order; the parts are shared among threads."""
    if len(parts) < 2 or THREADS < 2:
        return [work(part) for part in parts]
    tasks = [(copy_context(), part) for part in parts]  # how NumPy takes odd numbers is the caller's choice in all threads
    with ThreadPoolExecutor(THREADS) as pool:
        return list(pool.map(lambda task: task[0].run(work, task[1]), tasks))
