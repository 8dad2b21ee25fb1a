"""Pieces of long arrays: work on one piece at a time stays in the cache, and takes little memory."""

from collections.abc import Iterator

PIECE = 1 << 16


def pieces(count: int) -> Iterator[slice]:
    """Yield slices that cover ``count`` entries, a piece at a time."""
    for start in range(0, count, PIECE):
        yield slice(start, min(start + PIECE, count))
