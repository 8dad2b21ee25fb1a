"""Faure's points in base 5 (H. Faure, "Discrépance de suites associées à un système de numération (en dimension s)", Acta
Arithmetica 41, 1982): powers of Pascal's matrix, a (0, 5)-sequence."""

from math import comb

import numpy as np

from .base import DIMENSIONS
from .quinary import BASE, COLUMNS, ROWS, Quinary


def faure() -> Quinary:
    """Return the sequence in the order of its definition."""
    return Quinary(matrices)


def matrices() -> np.ndarray:
    """Return the matrices, (5, 12, 15), see `Quinary`."""
    return np.array([pascal(d)[:ROWS] for d in range(DIMENSIONS)], np.uint8)


def pascal(power: int) -> np.ndarray:
    """Return a power of Pascal's upper triangular matrix modulo 5, (15, 15): binom(column, row) power^(column - row)."""
    entry = [[comb(c, r) * power ** (c - r) % BASE if c >= r else 0 for c in range(COLUMNS)] for r in range(COLUMNS)]
    return np.array(entry, np.int64)
