"""Choices in kernels: one of a few things, in proportion to weights."""

from dataclasses import dataclass, field
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from .directions import last_at_most

BELOW_ONE = 1 - 2.0**-24


@dataclass(eq=False)
class Choices:
    """Rows of weights, of which each gives one choice.

    Attributes:
        weights: (n_rows, n) float64, not negative; each row has one above zero.
    """

    weights: np.ndarray
    _types: Any = field(default=None, init=False)
    _begin: Any = field(default=None, init=False)

    def prepare(self, types: Any) -> None:
        """Put the sums of weights on a device."""
        sums = np.cumsum(np.pad(self.weights, ((0, 0), (1, 0))), axis=1)
        self._types, self._begin = types, upload(types.Float, (sums / sums[:, -1:]).astype(np.float32))

    def draw(self, row: Any, number: Any, active: Any = True) -> tuple[Any, Any]:
        """Return a choice of a row, a UInt32, from a number in [0, 1), and another such number that is free again."""
        n = self.weights.shape[1]
        start = row * (n + 1)

        def begin(place: Any) -> Any:
            return dr.gather(self._types.Float, self._begin, start + place, active)

        chosen = last_at_most(self._types, n, begin, number)
        low, high = begin(chosen), begin(chosen + 1)
        return chosen, dr.clip((number - low) / dr.maximum(high - low, 1e-30), 0, BELOW_ONE)
