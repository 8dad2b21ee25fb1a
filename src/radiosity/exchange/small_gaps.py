"""Gaps that no line has found, in factors of polygons whose rows do not close without them.

Where no line finds that something escapes, nothing does, and rows close without it. If that moves a factor by much more than its
error, as between two plates 1e-5 of their width apart, a little may escape after all.
"""

from dataclasses import replace

import numpy as np

from .restored import restored
from .view_factors import ViewFactors

MOVED = 6  # standard errors that closure may move a factor by


def closed(raw: ViewFactors, one_line: np.ndarray) -> ViewFactors:
    """Return restored factors; from where rows do not close otherwise, something escapes that no line found.

    Args:
        one_line: (n,) share of one of the lines that look for what escapes.
    """
    found = restored(raw)
    codes, known = (f.rows * (len(f) + 2) + f.columns for f in (raw, found))
    inside = (raw.columns < len(raw)) & (raw.errors > 0)
    place = np.minimum(np.searchsorted(known, codes[inside]), len(known) - 1)
    moved = np.abs(np.where(known[place] == codes[inside], found.values[place], 0) - raw.values[inside])
    return restored(_opened(raw, one_line)) if (moved > MOVED * raw.errors[inside]).any() else found


def _opened(raw: ViewFactors, one_line: np.ndarray) -> ViewFactors:
    """Return factors with an entry of zero, give or take one line, for what escapes from each group without such an entry."""
    n = len(raw)
    more = np.setdiff1d(np.arange(n), raw.rows[raw.columns == n])
    rows, columns = np.append(raw.rows, more), np.append(raw.columns, np.full(len(more), n))
    order, none = np.lexsort((columns, rows)), np.zeros(len(more))
    assert raw.samples is not None
    return replace(
        raw,
        rows=rows[order],
        columns=columns[order],
        values=np.append(raw.values, none)[order],
        errors=np.append(raw.errors, one_line[more])[order],
        samples=np.concatenate([raw.samples, np.tile(none, (raw.replicates, 1))], axis=1)[:, order],
        hits=np.full(len(rows), -1),
    )
