"""What a number sequence must offer."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np

DIMENSIONS = 4


@dataclass(frozen=True)
class AbstractNumbers(ABC):
    """Points of the four-dimensional unit cube, each a function of (index, randomisation) and nothing else.

    Dimensions 1 and 2 give a line's direction, 3 and 4 its position on the patch. Index 0 is never asked for.
    """

    @abstractmethod
    def randomisation(self, stream: np.random.SeedSequence) -> np.ndarray:
        """(4,) uint32 drawn on the host from a strong generator: one for the scene and replicate."""

    @abstractmethod
    def points(self, index: Any, patch: Any, randomisation: Any, bits: int) -> list[Any]:
        """Four Dr.Jit floats in [0, 1), in a kernel.

        Args:
            index: UInt32, 1 and up, below 2**bits.
            patch: UInt32, the patch that asks (low discrepancy sequences are shared and ignore it).
            randomisation: four UInt32.
            bits: a compile-time bound; a few steps only, so that few kernels are compiled.
        """

    @abstractmethod
    def steps(self) -> tuple[int, ...]:
        """The values that ``bits`` may take, increasing; the last is 32."""

    def bits_for(self, largest_index: int) -> int:
        """The smallest step that holds an index."""
        return next(step for step in self.steps() if largest_index < 2**step)
