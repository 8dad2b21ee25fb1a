"""Errors of Gebhart factors that few lines cannot show: a pair of groups that no line joined is not known to exchange nothing.

Replicates agree about such a pair. A count of c lines is known to its square root, and that of no line to one line, as in
`few_lines`. So much of what a group emits may go straight to the other, and be absorbed there, or reflected once.
"""

import numpy as np

from ..factors.counted import CountedPairs
from ..factors.counts import split
from ..solution.intervals import FEW, by_luck
from .apart import MOST, apart
from .groups import Groups


def least_errors(pairs: CountedPairs, groups: Groups, absorbed: np.ndarray, values: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Return standard errors, (n, n + 2), at least those of the counts where lines are few or all replicates agree.

    Args:
        absorbed: (n_patches,) share of what arrives that is absorbed.
        values, errors: (n, n + 2) means and standard errors over replicates; the last columns are escaped and lost.
    """
    n, count, area = len(groups.names), len(pairs.patches), groups.area(pairs.patches)
    rows, columns = split(pairs.keys)
    ends = np.append(groups.labels, [n, n + 1])[columns]
    counts = np.bincount(groups.labels[rows % count] * (n + 2) + ends, pairs.counts, n * (n + 2)).reshape(n, n + 2)
    density = counts.sum(axis=1) / area
    worth = np.repeat(1 / (density * area)[:, None], n + 2, axis=1)
    if pairs.both_ways:
        worth[:, :n] = 1 / (density[:, None] + density) / area[:, None]
        counts[:, :n] += np.where(np.eye(n, dtype=bool), 0, counts[:, :n].T)
    agreed = by_luck(values, errors) * np.sqrt(pairs.replicates / 12)
    lines = np.where(counts < FEW, np.sqrt(np.maximum(counts, 1)), agreed)
    met = np.flatnonzero(counts[:, :n] > 0)
    lines[np.unravel_index(apart(pairs.patches, groups, met), (n, n))] = 0  # planes that look away from each other
    share = np.append(np.bincount(groups.labels, absorbed * pairs.patches.area, n) / area, [1, 1])
    straight = lines * worth  # of view factors
    found = straight * share
    if n <= MOST:
        found += straight[:, :n] * (1 - share[:n]) @ (values + found)
    return np.maximum(errors, found)
