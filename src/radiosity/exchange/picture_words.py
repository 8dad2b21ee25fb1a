"""What pictures of exchange share: which surfaces they show, and how numbers are written."""

import numpy as np

MOST = 24  # surfaces; those that exchange least are left out
LONGEST = 24  # characters of a name


def most_active(watts: np.ndarray) -> tuple[np.ndarray, bool]:
    """Return the rows that exchange most, ascending, and whether others exchange heat, too.

    Args:
        watts: (n, n) W from row to column, less what comes back.
    """
    size = np.abs(watts).sum(axis=1)
    rows = np.sort(np.argsort(-size, kind="stable")[:MOST])
    rows = rows[size[rows] > 0] if size.any() else rows
    return rows, bool((size > 0).sum() > len(rows))


def in_watts(value: float) -> str:
    """Return three digits at least, and no exponent below a million: 3,020 rather than 3.02e+03."""
    return f"{value:,.0f}" if 100 <= abs(value) < 1e6 else f"{value:.3g}"
