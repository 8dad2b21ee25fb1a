"""Long arrays, a piece at a time: what is made on the way stays in the cache, and takes no memory to speak of."""

from collections.abc import Iterator

PIECE = 1 << 16


def pieces(count: int) -> Iterator[slice]:
    """Of so many entries."""
    for start in range(0, count, PIECE):
        yield slice(start, min(start + PIECE, count))
