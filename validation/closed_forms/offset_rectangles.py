"""A F between rectangles with parallel edges, anywhere: sums over both rectangles' corners of the kernel's fourth antiderivative.

J. R. Ehlert and T. F. Smith, "View factors for perpendicular and parallel rectangular plates", Journal of Thermophysics and
Heat Transfer 7(1), 1993.
"""

from itertools import product

import numpy as np

Span = tuple[float, float]


def parallel(x: Span, y: Span, other_x: Span, other_y: Span, distance: float) -> float:
    """A F between x by y and other_x by other_y, in parallel planes that face each other."""
    total, z = 0.0, distance
    for i, j, k, l in product((0, 1), repeat=4):
        a, b = x[i] - other_x[k], y[j] - other_y[l]
        one, two = np.hypot(a, z), np.hypot(b, z)
        value = b * one * np.arctan(b / one) + a * two * np.arctan(a / two) - z * z / 2 * np.log(a * a + b * b + z * z)
        total += (-1) ** (i + j + k + l) * value
    return float(total / (2 * np.pi))


def perpendicular(out: Span, along: Span, up: Span, other_along: Span) -> float:
    """A F between a floor that spans ``out`` from the planes' common line and ``along`` it, and a wall that spans ``up`` and
    ``other_along``."""
    total = 0.0
    for i, j, k, l in product((0, 1), repeat=4):
        square, b = out[i] ** 2 + up[k] ** 2, along[j] - other_along[l]
        root = np.sqrt(square)
        value = b * root * np.arctan(b / root) if root > 0 else 0.0
        sum_ = square + b * b
        value -= (square - b * b) * np.log(sum_) / 4 if sum_ > 0 else 0.0
        total += (-1) ** (i + j + k + l) * value
    return float(total / (2 * np.pi))
