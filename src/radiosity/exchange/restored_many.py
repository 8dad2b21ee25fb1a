"""View factors of many groups, restored by symmetric scaling (`factors.balance`).

Rows are exact, and reciprocity holds to about 1e-6 of the area.
"""

from dataclasses import replace

import numpy as np

from ..factors.balance import restored as scaled
from ..factors.model import Factors
from ..factors.solve import SCALINGS
from .restoration import SCALING


def by_scaling(factors):
    """Return factors of which both directions of each pair are one, scaled until rows sum to what did not escape."""
    n, inside = len(factors), factors.columns < len(factors)
    made = Factors(factors.rows[inside], factors.columns[inside], factors.values[inside], factors.escaped, factors.lost)
    counted = factors.method == "lines"
    weight = 1 / (factors.line * factors.area) if counted else None
    new = scaled(made, factors.area, weight, SCALINGS)
    each = np.arange(n)
    rows = np.concatenate([new.rows, each, each])
    columns = np.concatenate([new.columns, np.full(n, n), np.full(n, n + 1)])
    values = np.concatenate([new.values, new.escaped, new.lost])
    some = (values > 0) | (columns < n)
    order = np.flatnonzero(some)[np.lexsort((columns[some], rows[some]))]
    rows, columns, values = rows[order], columns[order], values[order]
    return replace(
        factors,
        rows=rows,
        columns=columns,
        values=values,
        errors=_errors_of_pairs(factors, rows, columns),
        samples=None,
        hits=_of_both(factors, factors.hits.astype(float), rows, columns).astype(np.int64) if counted else np.full(len(rows), -1),
        restoration=SCALING,
    )


def _of_both(factors, values: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Return the sum of both directions of each entry, (k,)."""
    n = len(factors)
    known = factors.rows * (n + 2) + factors.columns

    def at(codes: np.ndarray) -> np.ndarray:
        place = np.minimum(np.searchsorted(known, codes), len(known) - 1)
        return np.where(known[place] == codes, values[place], 0.0)

    there = at(rows * (n + 2) + columns)
    return there + np.where((columns < n) & (columns != rows), at(columns * (n + 2) + rows), 0.0)


def _errors_of_pairs(factors, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Return errors of scaled pairs: those of both directions' weighted mean, as if scaling changed nothing."""
    n = len(factors)
    weight = 1 / (factors.line * factors.area) if factors.method == "lines" else 1 / factors.area
    square = (factors.errors * factors.area[factors.rows] * weight[factors.rows]) ** 2
    both = weight[rows] + np.where((columns < n) & (columns != rows), weight[np.minimum(columns, n - 1)], 0)
    return np.sqrt(_of_both(factors, square, rows, columns)) / both / factors.area[rows]
