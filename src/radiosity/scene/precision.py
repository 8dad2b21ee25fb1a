"""The resolution of single precision: the centre of coordinates, and the size of an ulp about it.

Lines are traced in single precision, about the scene's centre. The centre is a median, so that an object far away does not change
the precision of all others. The rounding at a point depends on the numbers near it, not on the size of the scene.
"""

from dataclasses import dataclass

import numpy as np

from ..pieces import of_pieces

EPSILON = float(np.finfo(np.float32).eps)
OFFSET = 8 * EPSILON  # of the largest number that places a point or its plane: lines begin this far in front of it
BINS, FEW = 1 << 12, 1 << 14  # of the search of a median
TIE = 1e-9  # share of the area: where less decides, the lower of two medians is taken, however sums are rounded


def weighted_median(values: np.ndarray, weights: np.ndarray) -> float:
    """Return the lowest value up to which half of the weights lie, less `TIE`.

    Values are counted in bins, then those of the bin where the median lies, until few are left, which are sorted.

    Args:
        values: (n,)
        weights: (n,) not negative, with a sum above zero.
    """
    goal, before = weights.sum() / 2 * (1 - TIE), 0.0
    while len(values) > FEW and (low := values.min()) < (high := values.max()):
        bins = _Bins(values, low, BINS / (high - low))
        sums = before + np.cumsum(
            sum(of_pieces(lambda part, b=bins, w=weights: np.bincount(b.of(part), w[part], BINS), len(values)))
        )
        at = min(int(np.searchsorted(sums, goal)), BINS - 1)
        before = float(sums[at - 1]) if at else before
        inside = np.concatenate(of_pieces(lambda part, b=bins, at=at: part.start + np.flatnonzero(b.of(part) == at), len(values)))
        if len(inside) in (0, len(values)):
            break
        values, weights = values[inside], weights[inside]
    order = np.argsort(values, kind="stable")
    sums = before + np.cumsum(weights[order])
    return float(values[order[min(int(np.searchsorted(sums, goal)), len(order) - 1)]])


@dataclass(frozen=True, eq=False)
class _Bins:
    """Bins of equal width of values, from the lowest on."""

    values: np.ndarray
    low: float
    scale: float

    def of(self, part: slice) -> np.ndarray:
        """Return the bin of each value of a part; the highest value is in the last bin."""
        return np.minimum((self.values[part] - self.low) * self.scale, BINS - 1).astype(np.int32)


def plane_reach(normal: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return the size of the numbers that place a face's plane, (m,) float64: its shift by their rounding, over an ulp of one.

    For a face that stands across an axis it is the distance along that axis, however far the face reaches.

    Args:
        normal: (m, 3).
        corners: (m, k, 3) about the centre.
    """
    return np.einsum("mi,mi->m", np.abs(normal), np.abs(corners).max(axis=1))


def ulp(points: np.ndarray, centre: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Return an ulp of single precision of the largest number that places a point or its face's plane, (m,) float64 metres.

    Args:
        points: (m, 3) metres.
        centre: (3,) metres, the centre of the scene.
        reach: (m,) metres, the `plane_reach` of the face of each point.
    """
    return EPSILON * np.maximum(np.abs(points - centre).max(axis=1), reach)
