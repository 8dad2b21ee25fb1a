"""How incremental iterations of polynomials end.

What few lines say of the coefficients of a polynomial is mostly noise: one hit gives K functions a root mean square of sqrt(K)
times its power. Sent on in proportion to that, the noise would grow from step to step. With `LINES` lines for each function and
patch it dies out. So a step has that many lines in all, even where little power is left to send, each of which then carries less.

When what is left is small beside the noise of the whole scene, it is dropped with probability 1/2, and else sent twice as strong.
The mean stays what it was, so that what is cut off has no bias.
"""

from typing import Any

import drjit as dr
import numpy as np

from ...sampling.streams import Purpose, stream
from .exchange import LINE, Exchange

LINES = 2  # of a step, for each function of each patch
SMALL = 0.1  # times the root of the number of quanta: less power than this is small beside the noise


def end_of_polynomials(exchange: Exchange, unsent, quanta: int) -> tuple[Any, Any]:
    """Return what a step sends, and the expected number of lines of each patch times LINE, (total,) UInt64.

    Args:
        unsent: (total * columns,) Float64, in units of a quantum / LINE.
        quanta: N of the stage.
    """
    types = exchange.types
    size = types.UInt64(dr.ceil(exchange.largest(unsent)))
    dr.eval(size)
    left = exchange.sums(size).astype(np.float64)
    kept = np.ones(exchange.replicates)
    for replicate in np.flatnonzero((left > 0) & (left < SMALL * np.sqrt(quanta) * LINE)):
        drawn = np.random.Generator(np.random.Philox(stream(exchange.seed, int(replicate), Purpose.REST, exchange.step)))
        kept[replicate] = 2.0 * drawn.integers(0, 2)
    more = kept * np.maximum(1.0, least_lines(exchange) * LINE / np.maximum(left * kept, 1.0))
    unsent = unsent * exchange.by_patch(exchange.by_replicate(kept))
    expected = types.UInt64(dr.ceil(types.Float64(size) * exchange.by_replicate(more)))
    dr.eval(unsent, expected)
    return unsent, expected


def least_lines(exchange: Exchange) -> int:
    """The number of lines of a step in all: with fewer the noise of coefficients would grow."""
    return LINES * exchange.basis.size * exchange.n if exchange.basis.size > 1 else exchange.n
