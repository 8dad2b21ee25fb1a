"""Infinitely long surfaces: H. C. Hottel's crossed strings, in the plane across them."""

import numpy as np


def crossed(one: tuple, other: tuple) -> float:
    """F from the segment ``one`` (two ends) to ``other``, both convex to each other, nothing between them: ends are given so that
    first sees first along an uncrossed string."""
    (a, b), (c, d) = (np.asarray(x, float) for x in (one, other))
    length = np.linalg.norm
    return float((length(a - d) + length(b - c) - length(a - c) - length(b - d)) / (2 * length(b - a)))


def triangle(own: float, other: float, third: float) -> float:
    """F between two sides of a triangular duct."""
    return (own + other - third) / (2 * own)


def past_a_plate(width: float, distance: float, plate: float) -> float:
    """F between opposed strips of one width, with a thin plate half way between, parallel to them and in their middle, no wider.

    Light passes on the left or on the right of the plate. Of the strings that bound the left half both crossed ones and an
    uncrossed one bend round the plate's left edge, and what they have in common cancels.
    """
    return float((np.hypot(width - plate, distance) - distance) / width)
