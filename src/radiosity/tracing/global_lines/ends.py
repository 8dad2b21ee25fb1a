"""The ends of spans, and what they gather from the patches at the other ends, replicates side by side."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .spans import ONE_WAY, Pairs


@dataclass(frozen=True, eq=False)
class Ends:
    """Ends of some spans, on patches numbered on from replicate to replicate.

    Attributes:
        counted: (k,) int64, each the patch of an end.
        at, sees: (m,) int64: patch ``at`` receives what patch ``sees`` sends along a span. An end that sees no patch receives
            nothing; a patch that is seen through a passing back receives, though no end of its own is there.
    """

    counted: np.ndarray
    at: np.ndarray
    sees: np.ndarray

    @staticmethod
    def of(drawn: Sequence[Pairs], n_patches: int) -> "Ends":
        """Make the ends of the spans of each replicate."""
        ones, others = ([getattr(pairs, end) for pairs in drawn] for end in ("one", "other"))
        shift = np.repeat(np.arange(len(drawn)) * n_patches, [len(one) for one in ones])
        one, other = (np.concatenate(ends).astype(np.int64) for ends in (ones, others))
        first, second = one < ONE_WAY, other < ONE_WAY
        behind = (other & (ONE_WAY - 1)) < n_patches  # a patch, also one that does not look back
        both, to = first & second, first & behind
        numbered, onward = one + shift, (other & (ONE_WAY - 1)) + shift
        return Ends(
            np.concatenate([numbered[first], onward[second]]),
            np.concatenate([numbered[both], onward[to]]),
            np.concatenate([onward[both], numbered[to]]),
        )

    def number(self, total: int) -> np.ndarray:
        """Return the number of ends on each patch, (total,) int64."""
        return np.bincount(self.counted, minlength=total)

    def received(self, radiosity: np.ndarray) -> np.ndarray:
        """Return sums of the radiosity of the patches at the other ends, (n_groups, total) as ``radiosity`` is.

        They are added in the order of spans, which is the same on every machine.
        """
        return np.stack([np.bincount(self.at, band[self.sees], len(band)).astype(float) for band in radiosity])


def of_lines(pairs: Pairs, first: int, end: int) -> Pairs:
    """Return the spans of the lines ``first`` to below ``end``."""
    rows = slice(*np.searchsorted(pairs.line, (first, end)))
    return Pairs(pairs.line[rows], pairs.one[rows], pairs.other[rows], pairs.ends_per_line)
