"""A filter of the noise of final gathers.

Each pixel becomes a mean over pixels around it in the same plane of the same surface. One whose neighbourhood differs by more
than the noise of both counts less: A. Buades, B. Coll, J. M. Morel, "A non-local algorithm for image denoising", CVPR 2005, with
the variances of F. Rousselle, C. Knaus, M. Zwicker, "Adaptive rendering with non-local means filtering", SIGGRAPH Asia 2012.
Pixels across edges stay as they are.
"""

from itertools import product

import numpy as np

from .picture import Picture

REACH = 5  # pixels on each side
NEAR = 1  # pixels on each side whose differences are compared
WIDE = 2  # pixels on each side over which variances are means
DAMPING = 1.0  # of the standard deviation: the difference that counts
FLOOR = 1e-10  # of the largest value, squared


def denoised(picture: Picture) -> np.ndarray:
    """Return values of a picture without most of their noise, (height, width, n) float64."""
    values, flat = np.nan_to_num(picture.values), picture.flat
    variance = _smoothed(picture.variance, flat)
    around = [_wider(array, REACH) for array in (values, variance, flat)]
    total, weights = values.copy(), np.ones(flat.shape)
    floor = FLOOR * float(np.square(values).max(initial=0.0)) + 1e-300
    for place in product(range(2 * REACH + 1), repeat=2):
        if place == (REACH, REACH):
            continue
        other, spread, alike = (_part(array, place, flat.shape) for array in around)
        same = ((flat >= 0) & (alike == flat)).astype(float)
        apart = np.square(values - other) - (variance + np.minimum(variance, spread))
        apart = (apart / (floor + DAMPING**2 * (variance + spread))).mean(axis=-1)
        near = _box(apart * same, NEAR) / np.maximum(_box(same, NEAR), 1.0)
        weight = same * np.exp(-np.clip(near, 0, 50))
        total += weight[..., None] * other
        weights += weight
    return np.where(np.isnan(picture.values), np.nan, total / weights[..., None])


def _smoothed(values: np.ndarray, flat: np.ndarray) -> np.ndarray:
    """Return means over neighbours in the same plane, (height, width, n)."""
    total, count = values.copy(), np.ones(flat.shape)
    around = _wider(values, WIDE), _wider(flat, WIDE)
    for place in product(range(2 * WIDE + 1), repeat=2):
        if place != (WIDE, WIDE):
            other, alike = (_part(array, place, flat.shape) for array in around)
            same = (flat >= 0) & (alike == flat)
            total += np.where(same[..., None], other, 0.0)
            count += same
    return total / count[..., None]


def _wider(values: np.ndarray, reach: int) -> np.ndarray:
    """Return a picture with a margin, which repeats its outermost pixels."""
    return np.pad(values, [(reach, reach)] * 2 + [(0, 0)] * (values.ndim - 2), mode="edge")


def _part(wider: np.ndarray, place: tuple[int, ...], shape: tuple[int, ...]) -> np.ndarray:
    """Return the part of a picture with a margin that begins at a place, (height, width, ...)."""
    return wider[place[0] : place[0] + shape[0], place[1] : place[1] + shape[1]]


def _box(values: np.ndarray, reach: int) -> np.ndarray:
    """Return sums over squares around pixels, (height, width)."""
    wide, (height, width) = _wider(values, reach), values.shape
    rows = np.sum([wide[at : at + height] for at in range(2 * reach + 1)], axis=0)
    return np.sum([rows[:, at : at + width] for at in range(2 * reach + 1)], axis=0)
