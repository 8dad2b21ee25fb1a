"""Blocks of a sequence: every 2^32 indices it takes a new randomisation (contract 4).

Kernels have indices of 32 bits. The k-th line of a row is line k modulo 2^32 of block k / 2^32, rounded down. Block 0 has the
stream of the purpose itself, and each later block a child of it whose key is the block's number.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..device.backend import upload
from .numbers import WORDS, AbstractNumbers
from .streams import Purpose, Seed, stream

BITS = 32
BLOCK = 1 << BITS  # indices; the first block has one less, since index 0 is never used


@dataclass(frozen=True, eq=False)
class Blocks:
    """The randomisations of the replicates of a run, in each block.

    Attributes:
        numbers: what is made random.
        types: of arrays on the device.
        seed, replicates: as in a run.
        purpose, child: of the stream.
    """

    numbers: AbstractNumbers
    types: Any
    seed: Seed | int
    replicates: int
    purpose: Purpose
    child: tuple[int, ...] = ()

    @cached_property
    def _made(self) -> list:
        return [0, None]  # how many blocks there are in a table, and the table

    def drawn(self, block: int = 0) -> np.ndarray:
        """Return the words of a block, (replicates, 8) uint32."""
        key = (*self.child, block) if block else self.child
        drawn = [self.numbers.randomisation(stream(self.seed, r, self.purpose, *key)) for r in range(self.replicates)]
        return np.array(drawn, np.uint32).reshape(self.replicates, WORDS)

    def words(self, block: int = 0):
        """Return the words of a block on the device, UInt32: eight a replicate."""
        return upload(self.types.UInt32, self.drawn(block))

    def prepare(self, last: int) -> None:
        """Draw all blocks up to ``last``, for kernels whose rows take their lines from different blocks."""
        if last >= self._made[0]:
            count = 1 << (last + 1).bit_length()
            words = np.concatenate([self.drawn(block) for block in range(count)])
            self._made[:] = count, upload(self.types.UInt32, words)

    @property
    def known(self):
        """The words that `prepare` has drawn, UInt32, one block after the other."""
        return self._made[1]


def parts(done: np.ndarray, counts: np.ndarray) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Yield lines, block by block, whose indices follow the first ``done`` ones of each row.

    Args:
        done, counts: whole numbers of 64 bits: the lines of each row so far, and now.

    Yields:
        The block, the index before the first one of each row within the block, and the number of lines there. An index before the
        first of a later block is 2^32 - 1, since 32-bit arithmetic wraps around.
    """
    done, counts = np.asarray(done, np.int64), np.asarray(counts, np.int64)
    fires = counts > 0
    if not fires.any():
        return
    first, last = int(((done[fires] + 1) >> BITS).min()), int(((done + counts)[fires] >> BITS).max())
    for block in range(first, last + 1):
        begin = np.maximum(done, (block << BITS) - 1)
        more = np.maximum(np.minimum(done + counts, ((block + 1) << BITS) - 1) - begin, 0)
        if more.any():
            yield block, begin & (BLOCK - 1), more
