"""Local lines: they leave a uniform point of a patch, cosine distributed about its normal (Nusselt's analogy).

The probability that a line hits patch j is the form factor F_ij (Bekaert, Cools, Willems, section 1.2).
"""

import math

import drjit as dr

# coefficients of sin(pi t) / t and cos(pi t) in powers of t^2: Taylor series, whose error is below 6e-8 for |t| <= 1/2
SINE = tuple((-1) ** k * math.pi ** (2 * k + 1) / math.factorial(2 * k + 1) for k in range(6))
COSINE = tuple((-1) ** k * math.pi ** (2 * k) / math.factorial(2 * k) for k in range(7))


def hemisphere(first, second):
    """Return a cosine distributed direction (x, y, z), z along the normal, from two numbers in [0, 1)."""
    sine = dr.sqrt(second)
    x, y = turn(first)
    return x * sine, y * sine, dr.sqrt(1 - second)


def turn(number):
    """Return cosine and sine of 2 pi (number - 1/2), by those of half the angle: half the work of a general sine and cosine."""
    t = number - 0.5
    square = t * t
    sine, cosine = t * _polynomial(square, SINE), _polynomial(square, COSINE)
    return dr.fma(cosine, cosine, -sine * sine), 2 * sine * cosine


def _polynomial(x, coefficients):
    value = type(x)(coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        value = dr.fma(value, x, coefficient)
    return value


def triangle(a, b):
    """Return a uniform point of the unit triangle from one of the unit square.

    The map needs no square root, and neighbours stay neighbours (E. Heitz, "A low-distortion map between triangle and square",
    2019).
    """
    low = a < b
    first, second = dr.select(low, a * 0.5, a - b * 0.5), dr.select(low, b - a * 0.5, b * 0.5)
    return first, second
