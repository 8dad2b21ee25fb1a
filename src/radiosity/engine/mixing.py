"""In which order a replicate's global lines are taken: blocks of lines one after the other, each in an order of its own.

Multipath reads a path out of lines that follow each other on a patch. Neighbours in a low discrepancy sequence are made to
differ, so such paths would turn in regular ways: on the labyrinth with a first shot that gave errors of three standard errors.
Within a block the order is drawn anew (Philox); the set of lines stays what it is.
"""

from dataclasses import dataclass

import numpy as np

from .quanta import stream
from .spans import Pairs, Spans

VISITS = 64  # of a mean patch within a block, where that is not too long
LEAST, MOST = 1 << 10, 1 << 18  # lines of a block
ORDER = 2  # purpose of the stream (`quanta.stream`), which has the block as a child


@dataclass(frozen=True, eq=False)
class Mixed:
    """Spans of a replicate's lines in the mixed order."""

    spans: Spans

    @property
    def block(self) -> int:
        """Lines of a block, a power of two."""
        wanted = VISITS / float(self.spans.ends_per_line.mean())
        return int(np.clip(2.0 ** np.ceil(np.log2(wanted)), LEAST, MOST))

    def draw(self, replicate: int, first: int, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Both ends of the spans of the lines that come ``first`` to ``first + count`` in the mixed order."""
        ones, others, at = [], [], first
        while at < first + count:
            number, begin = divmod(at, self.block)
            length = min(self.block - begin, first + count - at)
            seed = stream(self.spans.seed, replicate, ORDER)
            child = np.random.SeedSequence(seed.entropy, spawn_key=(number,))
            order = np.random.Generator(np.random.Philox(child)).permutation(self.block)[begin : begin + length]
            one, other = rearranged(self.spans.draw(replicate, number * self.block, self.block), order, self.block)
            ones.append(one)
            others.append(other)
            at += length
        return np.concatenate(ones), np.concatenate(others)


def rearranged(pairs: Pairs, order: np.ndarray, lines: int) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the spans of some of a number of lines, line by line in the order given."""
    counts = np.bincount(pairs.line, minlength=lines)
    begins = np.cumsum(counts) - counts
    taken = counts[order]
    rows = np.repeat(begins[order] - (np.cumsum(taken) - taken), taken) + np.arange(taken.sum())
    return pairs.one[rows], pairs.other[rows]
