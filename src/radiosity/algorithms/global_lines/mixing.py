"""The order in which multipath takes spans: blocks of lines one after the other, the spans of a block in a random order.

In multipath, spans that follow each other on a patch form a path. That is right if a span is independent of the spans before
it. Neighbours in a low discrepancy sequence are not independent: they are made to differ. Nor are spans of one line, or a span
that counts twice. The set of spans in a block does not change. One dependence is left: no span comes twice in a block. Its effect
is smaller in longer blocks.
"""

from dataclasses import dataclass

import numpy as np

from ...sampling.streams import Purpose, stream
from ...tracing.global_lines.spans import Pairs, Spans

VISITS = 256  # span ends of a mean patch within a block, where the block is not too long for it
LEAST, MOST = 1 << 10, 1 << 18  # least and most lines of a block


@dataclass(frozen=True, eq=False)
class Mixed:
    """The spans of the replicates' lines in the mixed order."""

    spans: Spans

    @property
    def block(self) -> int:
        """The number of lines of a block, a power of two."""
        wanted = VISITS / float(self.spans.ends_per_line.mean())
        return int(np.clip(2.0 ** np.ceil(np.log2(wanted)), LEAST, MOST))

    def draw(self, replicate: int, first: int, count: int) -> Pairs:
        """Draw spans as `Spans.draw` does, of the lines ``first`` to below ``first + count`` in the mixed order.

        These lines are not those of the sequence: a block's spans are spread over as many lines as the block has.
        """
        block, parts = self.block, []
        blocks = range(first // block, (first + count - 1) // block + 1)
        drawn = self.spans.draw(replicate, blocks.start * block, len(blocks) * block)  # all at once: each launch costs time
        cuts = np.searchsorted(drawn.line, np.arange(len(blocks) + 1) * block)
        for number, begin, end in zip(blocks, cuts[:-1], cuts[1:], strict=True):
            own = np.uint32((number - blocks.start) * block)
            rows, line = self._order(replicate, number, drawn.line[begin:end] - own)
            line = line.astype(np.int64) + (number * block - first)
            within = slice(*np.searchsorted(line, (0, count)))
            parts.append((line[within].astype(np.uint32), *(x[begin:end][rows[within]] for x in (drawn.one, drawn.other))))
        line, one, other = (np.concatenate(column) for column in zip(*parts, strict=True))
        return Pairs(line, one, other, self.spans.ends_per_line)

    def _order(self, replicate: int, number: int, line: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the spans of a block in their new order, and the lines that they then belong to."""
        seed = stream(self.spans.seed, replicate, Purpose.MIXING, number)
        generator = np.random.Generator(np.random.Philox(seed))
        spread = np.arange(len(line), dtype=np.uint64) * np.uint64(self.block) // np.uint64(max(len(line), 1))
        return generator.permutation(len(line)), spread
