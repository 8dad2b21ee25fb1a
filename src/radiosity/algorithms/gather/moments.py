"""Moments of what lines of a gather bring: times the functions of a basis at the places where the lines leave their patch.

A line that leaves place x of patch i, and finds the value v, adds v phi_k(x) to moment k of i. Places are uniform on the patch,
so the mean over lines is the coefficient of the irradiance. Sums are whole numbers of 64 bits, in columns group by group, the K
functions of the basis in each.
"""

import drjit as dr

from ...patches.bases import Basis
from ...tracing.spots import Spot

COARSER = 2.0**-3  # units of moments after the first, in those of the mean: functions are below 8, so sums hold as many lines


def units(basis: Basis) -> list[float]:
    """Return the fixed point units of each moment, in those of the mean, K numbers."""
    return [1.0] + [COARSER] * (basis.size - 1)


def products(basis: Basis, spot: Spot, values: list, scale) -> list:
    """Return moments that lines add, whole numbers of each column; called in a kernel.

    Args:
        spot: where each line leaves its patch.
        values: what it finds, of each group of bands.
        scale: fixed point units of the value 1.
    """
    functions = basis.functions(spot.a, spot.b, spot.select)
    parts = [function * unit for function, unit in zip(functions, units(basis), strict=True)]
    return [dr.round(value * scale * part) for value in values for part in parts]


def light_at(basis: Basis, spot: Spot, coefficients: list) -> list:
    """Return the values of polynomials at places, of each group; called in a kernel.

    Args:
        coefficients: K of each group, group by group.
    """
    functions = basis.functions(spot.a, spot.b, spot.select)
    parts = (coefficients[at : at + basis.size] for at in range(0, len(coefficients), basis.size))
    return [sum(c * value for c, value in zip(part, functions, strict=True)) for part in parts]
