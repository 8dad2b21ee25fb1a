"""Links: pairs of elements that exchange light, as flat arrays."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Links:
    """m links; light goes from source to receiver.

    Attributes:
        receiver, source: (m,) int64, elements.
        factor: (m,) float64, F_rs with obstacles: the share of what leaves the receiver that arrives at the source, so that the
            receiver's irradiance is factor times the source's radiosity.
        spread: (m,) float64, how much the factor varies, by which the refinement judges the link (see `oracle`).
    """

    receiver: np.ndarray
    source: np.ndarray
    factor: np.ndarray
    spread: np.ndarray

    @staticmethod
    def none() -> "Links":
        return Links(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0), np.zeros(0))

    def __len__(self) -> int:
        return len(self.receiver)

    def take(self, rows: np.ndarray | slice) -> "Links":
        """Return some of the links (indices, mask or slice)."""
        return Links(*(value[rows] for value in vars(self).values()))

    @staticmethod
    def appended(parts: list["Links"]) -> "Links":
        """Return all links of several parts, one part after the other."""
        return Links(*(np.concatenate([getattr(part, name) for part in parts]) for name in vars(parts[0])))

    @staticmethod
    def joined(parts: list["Links"]) -> "Links":
        """Return all links of several parts, sorted by receiver and source: sums over links then have one order."""
        columns = [np.concatenate([getattr(part, name) for part in parts]) for name in vars(parts[0])]
        order = np.lexsort((columns[1], columns[0]))
        return Links(*(column[order] for column in columns))
