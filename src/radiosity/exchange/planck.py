"""Planck's law: the share of a black surface's emission in bands of wavelength.

With z = c2 / (lambda T), the share below lambda is F = 15 / pi^4 times the integral of t^3 / (e^t - 1) from z to infinity. For
large z that is a series of exponentials, for small z a power series with Bernoulli's numbers (both in S.-L. Chang and K. T. Rhee,
"Blackbody radiation functions", Int. Communications in Heat and Mass Transfer 11, 1984).
"""

import math

import numpy as np

SIGMA = 5.670374419e-8  # W/(m² K⁴), exact to these digits since 2019
C2 = 14387.768775  # µm K
WHOLE = 15 / math.pi**4
EXPONENTIALS = 42  # for z >= 1: the next term is below 1e-18
BERNOULLI = (1 / 6, -1 / 30, 1 / 42, -1 / 30, 5 / 66, -691 / 2730, 7 / 6, -3617 / 510, 43867 / 798, -174611 / 330)


def emissive_power(temperature):
    """Return what a black surface emits, W/m²."""
    return SIGMA * np.asarray(temperature, float) ** 4


def share_below(product) -> np.ndarray:
    """Return the share of a black surface's emission below a wavelength.

    Args:
        product: wavelength times temperature, µm K, not negative; infinity is all of it.
    """
    product = np.asarray(product, float)
    with np.errstate(divide="ignore"):
        z = C2 / product
    result = np.where(z == 0, 1.0, 0.0)
    large = (z >= 1) & np.isfinite(z)
    result[large] = _exponentials(z[large])
    small = (z > 0) & (z < 1)
    result[small] = 1 - _powers(z[small])
    return result


def band_shares(edges, temperature) -> np.ndarray:
    """Return the share of the emission in each band, (n_edges + 1, ...).

    Args:
        edges: (n_edges,) µm, ascending; the first band is below the first edge, the last one above the last.
        temperature: (...,) K.
    """
    temperature = np.asarray(temperature, float)
    below = [share_below(edge * temperature) for edge in edges]
    ends = np.stack([np.zeros(temperature.shape), *below, np.ones(temperature.shape)])
    return np.diff(ends, axis=0)


def band_slopes(edges, temperature) -> np.ndarray:
    """Return d(band's emission) / d(whole emission) where the temperature changes, (n_edges + 1, ...); their sum is 1."""
    temperature = np.asarray(temperature, float)
    below = []
    for edge in edges:
        product = edge * temperature
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            z = C2 / product
            more = WHOLE * z**4 / np.expm1(z) / 4  # x F'(x) / 4
        below.append(share_below(product) + np.where(np.isfinite(more), more, 0.0))
    ends = np.stack([np.zeros(temperature.shape), *below, np.ones(temperature.shape)])
    return np.diff(ends, axis=0)


def _exponentials(z: np.ndarray) -> np.ndarray:
    total = np.zeros_like(z)
    for n in range(EXPONENTIALS, 0, -1):
        total += np.exp(-n * z) * (z**3 / n + 3 * z**2 / n**2 + 6 * z / n**3 + 6 / n**4)
    return WHOLE * total


def _powers(z: np.ndarray) -> np.ndarray:
    total = 1 / 3 - z / 8
    for k, number in enumerate(BERNOULLI, 1):
        total += number * z ** (2 * k) / ((2 * k + 3) * math.factorial(2 * k))
    return WHOLE * z**3 * total
