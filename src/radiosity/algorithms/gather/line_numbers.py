"""Numbers of the lines of a gather: the points of the unit cube that cosine lines and shadow rays take."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...method import Method
from ...sampling.blocks import BLOCK, Blocks, parts
from ...sampling.numbers import AbstractNumbers, ready
from ...sampling.streams import Seed
from ...tracing.ray_generation import place_number


@dataclass(frozen=True, eq=False)
class LineNumbers:
    """Makes the numbers of the lines of each patch, in blocks that are randomised each by itself.

    Attributes:
        types: Dr.Jit's array types of the device.
        sequence: the points of the unit cube.
        by_patch: each patch moves them by a shift of its own.
        streams: randomisations of the replicates, for cosine lines and for shadow rays.
        keys: those of the first block of each.
    """

    types: Any
    sequence: AbstractNumbers
    by_patch: bool
    streams: tuple[Blocks, Blocks]
    keys: tuple[Any, Any]

    @staticmethod
    def of(method: Method, types: Any, seed: Seed | int, replicates: int, purposes) -> "LineNumbers":
        """Make the numbers of a method.

        Args:
            purposes: of the streams of cosine lines and of shadow rays.
        """
        sequence = ready(method.points, types)
        one, other = (Blocks(sequence, types, seed, replicates, purpose) for purpose in purposes)
        return LineNumbers(types, sequence, method.randomisation == "by-patch", (one, other), (one.words(), other.words()))

    def parts(self, kind: int, done: np.ndarray, counts: np.ndarray) -> list[tuple[Any, Any, Any]]:
        """Return randomisation, lines so far and lines now of each block; one part where all are in the first block.

        Args:
            kind: 0 for cosine lines, 1 for shadow rays.
            done, counts: of each packet, the lines of each patch so far, and now.
        """
        if int((done + counts).max()) < BLOCK:
            return [(self.keys[kind], done, counts)]
        stream = self.streams[kind]
        found = parts(done, counts)
        return [(self.keys[kind] if block == 0 else stream.words(block), begin, more) for block, begin, more in found]

    def points_of(self, keys, replicate, record, patch, start, most: int) -> Callable[[Any], Any]:
        """Return a function from the number of a line to its point.

        Args:
            keys: the randomisation of the block.
            replicate, record, patch, start: of each lane; the first of its lines has the index ``start``.
            most: the largest index.
        """
        halves = [dr.gather(self.types.Array4u, keys, replicate * 2 + half) for half in (0, 1)]
        words = [word for half in halves for word in half]
        if self.by_patch:
            words = self.sequence.of_patch(words, place_number(record))
        bits = self.sequence.bits_for(most)
        return lambda number: self.sequence.points(start + number + 1, patch, words, bits)


def largest(done: np.ndarray, counts: np.ndarray) -> int:
    """Return the largest index of a block."""
    return min(int((done + counts).max()), BLOCK - 1)
