"""Bases of polynomials on patches: light as a polynomial of total degree 0, 1 or 2 of the place on each patch.

A patch is a parallelogram or a triangle, so a place on it has two coordinates (a, b), and all patches of a kind share one basis.
Parallelograms have 0 <= a, b <= 1. Triangles have a, b >= 0 and a + b <= 1; an inverted one is an upright one turned by half a
circle. The functions are orthonormal in the mean over a patch, (1/A) integral phi_k phi_l = 1 where k = l, else 0, and the first
is 1. So the first coefficient of a polynomial is its mean, and the sum of all squares is its mean square (docs/bases.md).
"""

from dataclasses import dataclass
from functools import cached_property
from math import factorial
from typing import Any

import numpy as np

ZERO = 1e-9  # coefficients of this size are rounding
POWERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))  # of a and b, by total degree


@dataclass(frozen=True)
class Basis:
    """The polynomials of a total degree.

    Attributes:
        name: as `Method.basis` has it.
        degree: the total degree, 0 to 2.
    """

    name: str
    degree: int

    @property
    def size(self) -> int:
        """The number K of functions: 1, 3 or 6."""
        return (self.degree + 1) * (self.degree + 2) // 2

    @property
    def powers(self) -> tuple[tuple[int, int], ...]:
        """The powers of a and b in each monomial, K pairs."""
        return POWERS[: self.size]

    @cached_property
    def on_quad(self) -> np.ndarray:
        """Coefficients of the functions in monomials on parallelograms, (K, K) float64, lower triangular."""
        return _orthonormal([[1 / ((p[0] + q[0] + 1) * (p[1] + q[1] + 1)) for q in self.powers] for p in self.powers])

    @cached_property
    def on_triangle(self) -> np.ndarray:
        """Coefficients of the functions in monomials on triangles, (K, K) float64, lower triangular."""
        return _orthonormal([[_on_half(p[0] + q[0], p[1] + q[1]) for q in self.powers] for p in self.powers])

    @cached_property
    def largest(self) -> np.ndarray:
        """The largest absolute values of the functions, of parallelograms and triangles together, (K,) float64."""
        a, b = (x.ravel() for x in np.meshgrid(*2 * [np.linspace(0, 1, 17)]))
        half = a + b <= 1
        values = [self.at(a, b, np.array(True)), self.at(a[half], b[half], np.array(False))]
        return np.abs(np.concatenate(values)).max(axis=0)

    def functions(self, a: Any, b: Any, select) -> list:
        """Return the values of the K functions at places, arrays of numpy or Dr.Jit; the first is the number 1.

        Args:
            a, b: coordinates of the places.
            select: takes two numbers, and returns the first where a patch is a parallelogram, else the second.
        """
        monomials = [None, a, b, a * a, a * b, b * b][: self.size] if self.degree > 1 else [None, a, b][: self.size]
        found: list = [1.0]
        for quad, triangle in zip(self.on_quad[1:], self.on_triangle[1:], strict=True):
            value = select(float(quad[0]), float(triangle[0]))
            for one, other, monomial in zip(quad[1:], triangle[1:], monomials[1:], strict=True):
                if one or other:
                    value = value + select(float(one), float(other)) * monomial
            found.append(value)
        return found

    def at(self, a: np.ndarray, b: np.ndarray, is_quad: np.ndarray) -> np.ndarray:
        """Return the values of the functions at places, (..., K) float64, from coordinates and kinds of patches of one shape."""
        a, b, is_quad = np.broadcast_arrays(np.asarray(a, float), np.asarray(b, float), np.asarray(is_quad, bool))
        columns = self.functions(a, b, lambda one, other: np.where(is_quad, one, other))
        return np.stack([np.broadcast_to(column, a.shape) for column in columns], axis=-1)


def _on_half(p: int, q: int) -> float:
    """The mean of a^p b^q over a triangle."""
    return 2 * factorial(p) * factorial(q) / factorial(p + q + 2)


def _orthonormal(means: list) -> np.ndarray:
    """Return coefficients of orthonormal functions from the means of products of monomials."""
    found = np.linalg.inv(np.linalg.cholesky(np.array(means)))
    return np.where(np.abs(found) > ZERO, found, 0.0)


CONSTANT = Basis("constant", 0)
BASES = {"constant": CONSTANT, "linear": Basis("linear", 1), "quadratic": Basis("quadratic", 2)}


def of_size(size: int) -> Basis:
    """Return the basis with a number of functions."""
    return next(basis for basis in BASES.values() if basis.size == size)
