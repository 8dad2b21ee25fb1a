"""View factors of many groups, restored by symmetric scaling (`factors.balance`).

Rows are exact, and reciprocity holds to about 1e-6 of the area.
"""

from dataclasses import replace

import numpy as np

from ..factors.balance import restored as scaled
from ..factors.model import Factors
from ..factors.solve import SCALINGS
from ..pieces import pieces
from .restoration import SCALING


def by_scaling(factors):
    """Return factors of which both directions of each pair are one, scaled until rows sum to what did not escape."""
    n, inside = len(factors), factors.columns < len(factors)
    inside = slice(None) if inside.all() else inside  # no copies where nothing is missed
    counted = factors.method == "lines"
    weight = 1 / (factors.line * factors.area) if counted else None
    new = scaled(
        Factors(factors.rows[inside], factors.columns[inside], factors.values[inside], factors.escaped, factors.lost),
        factors.area,
        weight,
        SCALINGS,
        counted=counted,
    )
    rows, columns, values = new.rows, new.columns, new.values
    for column, share in ((n, new.escaped), (n + 1, new.lost)):
        some = np.flatnonzero(share)
        if len(some):
            place = np.searchsorted(rows, some, side="right")  # after all others of the row
            rows, columns = np.insert(rows, place, some), np.insert(columns, place, column)
            values = np.insert(values, place, share[some])
    del new
    errors, hits = _errors_and_hits(factors, rows, columns)
    return replace(
        factors, rows=rows, columns=columns, values=values, errors=errors, samples=None, hits=hits, restoration=SCALING
    )


def _errors_and_hits(factors, rows: np.ndarray, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return errors of scaled entries, as if scaling changed nothing, and lines of both directions together, (k,) each.

    The errors are those of both directions' weighted mean.
    """
    n, counted = len(factors), factors.method == "lines"
    weight = 1 / (factors.line * factors.area) if counted else 1 / factors.area
    known = factors.rows * (n + 2)
    known += factors.columns
    errors, hits = np.empty(len(rows)), np.full(len(rows), -1)
    for part in pieces(len(rows)):
        row, column = rows[part], columns[part]
        there, met = _found(known, row * (n + 2) + column)
        again, back = _found(known, column * (n + 2) + row)
        back &= (column < n) & (column != row)
        own, other = factors.area[row] * weight[row], np.append(factors.area * weight, [0, 0])[column]
        square = np.where(met, (factors.errors[there] * own) ** 2, 0.0)
        square += np.where(back, (factors.errors[again] * other) ** 2, 0.0)
        both = weight[row] + np.where((column < n) & (column != row), weight[np.minimum(column, n - 1)], 0)
        errors[part] = np.sqrt(square) / both / factors.area[row]
        if counted:
            hits[part] = np.where(met, factors.hits[there], 0) + np.where(back, factors.hits[again], 0)
    return errors, hits


def _found(known: np.ndarray, codes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return where codes stand among ascending ones, and whether they do, (k,) each."""
    place = np.minimum(np.searchsorted(known, codes), len(known) - 1)
    return place, known[place] == codes
