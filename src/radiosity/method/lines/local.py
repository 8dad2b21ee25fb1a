"""Local lines: from a uniform point of a patch, cosine distributed about its normal (Nusselt's analogy).

A line's probability to land on patch j is the form factor F_ij (Bekaert, Cools, Willems, section 1.2).
"""

import math

import drjit as dr


def hemisphere(first, second):
    """Cosine distributed direction (x, y, z), z along the normal, from two numbers in [0, 1)."""
    sine = dr.sqrt(second)
    y, x = dr.sincos(first * (2 * math.pi))
    return x * sine, y * sine, dr.sqrt(1 - second)


def triangle(a, b):
    """A uniform point of the unit triangle from one of the unit square (E. Heitz, "A low-distortion map between
    triangle and square", 2019): no square root, and neighbours stay neighbours."""
    low = a < b
    first, second = dr.select(low, a * 0.5, a - b * 0.5), dr.select(low, b - a * 0.5, b * 0.5)
    return first, second
