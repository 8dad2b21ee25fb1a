"""Restored view factors: reciprocal, closed, none negative, and as near to what was measured as errors tell.

The unknowns are the exchange areas X_ij = X_ji = A_i F_ij of pairs that a line joined, and what each group sends out of the scene
and onto backs. They minimise the sum of (A_i F_ij - X_ij)² / var_ij over all entries, both directions of each pair among them,
such that X is not negative and each row, with what escapes and is lost, sums to A_i (`least_squares`). Pairs that no line joined
stay zero.

The variance of a counted entry is known badly from few replicates. It is the mean, weighted by degrees of freedom, of what
replicates show and of Poisson's, X_ij / (lines of the row over its area), times one number for the whole matrix: how much less
than Poisson's errors are on the whole. Where few lines went, Poisson's counts alone.

Least squares need a matrix of the groups. With more of them the symmetric scaling of `factors.balance` takes its place.
"""

import warnings
from dataclasses import replace

import numpy as np

from ..errors import MethodError, RadiosityWarning
from ..solution.errors import mean_and_error
from ..solution.intervals import FEW, by_luck
from .codes import Codes
from .least_squares import Nearest, Unknowns, nearest
from .restoration import LEAST_SQUARES, RAW, SAMPLED
from .restored_many import by_scaling

PRIOR = 64  # degrees of freedom of Poisson's variance: weights that follow the replicates make stated errors too small
LEAST = 1e-9  # relative: no counted or integrated value is more accurate


def restored(factors):
    """Return reciprocal and closed factors; factors that are restored already as they are.

    Args:
        factors: the `ViewFactors` to restore.

    Raises:
        MethodError: backs let lines pass, so that the true factors are not reciprocal.
    """
    if factors.restoration != RAW:
        return factors
    if not factors.reciprocal:
        raise MethodError(
            "backs of this scene let lines pass (sides 1 of MGF), so that a group may see another that does not see it: its view "
            "factors are not reciprocal, and cannot be restored; take them as they are"
        )
    if len(factors) > SAMPLED or factors.samples is None:
        return by_scaling(factors)
    return _by_least_squares(factors)


def _by_least_squares(factors):
    n, rows, columns = len(factors), factors.rows, factors.columns
    inside = columns < n
    low, high = np.where(inside, np.minimum(rows, columns), rows), np.where(inside, np.maximum(rows, columns), columns)
    code = low * (n + 2) + high
    pairs = Codes.of(code, (n + 2) ** 2)
    place, (one, other) = pairs.place(code), np.divmod(pairs.each, n + 2)
    area = factors.area[rows]
    variance = np.maximum(_variance(factors, place), (LEAST * factors.values) ** 2) * area**2
    trust = np.where(variance > 0, 1 / np.where(variance > 0, variance, 1), 0)
    whole = np.bincount(place, trust)
    missing = inside & (rows != columns)  # a direction without an entry was measured as zero
    single = (np.bincount(place, missing) == 1) & (one != other) & (other < n)
    whole = whole + np.where(single, _trust_of_none(factors, place, one, other, variance), 0)

    def together(values: np.ndarray) -> np.ndarray:
        return np.divide(np.bincount(place, values * area * trust), whole, out=np.zeros(len(whole)), where=whole > 0)

    unknowns = Unknowns(
        one,
        np.where(other < n, other, one),
        together(factors.values),
        np.divide(1, whole, out=np.zeros(len(whole)), where=whole > 0),
        factors.area,
    )
    found = nearest(unknowns)
    if not found.closes:
        warnings.warn(
            "no reciprocal view factors close within the pairs that lines joined (a group may have met too few lines): they were "
            "restored by scaling, and rows or reciprocity are off by what is left; take more lines",
            RadiosityWarning,
            stacklevel=4,
        )
        return by_scaling(factors)
    assert factors.samples is not None
    return _from(factors, found, one, other, np.array([together(row) for row in factors.samples]), place)


def _variance(factors, place: np.ndarray) -> np.ndarray:
    """Return the variance of each entry, (m,), see the head of this file."""
    model = _poisson(factors, place)
    if factors.replicates < 2:
        return model
    seen = factors.errors**2
    share = seen[factors.hits >= FEW].sum() / max(model[factors.hits >= FEW].sum(), np.finfo(float).tiny)
    share = share if share > 0 else 1.0
    degrees = factors.replicates - 1
    mixed = (degrees * seen + PRIOR * share * model) / (degrees + PRIOR)
    return np.where(factors.hits >= FEW, mixed, model)


def _poisson(factors, place: np.ndarray) -> np.ndarray:
    """Return Poisson's variance of each entry: its share of both directions together, times the share of a line."""
    n, line = len(factors), factors.line[factors.rows]
    weight = 1 / (line * factors.area[factors.rows])
    power = factors.values * factors.area[factors.rows]
    of_pair = np.bincount(place, power * weight)[place]
    back = np.where(factors.columns < n, 1 / (factors.line * factors.area)[np.minimum(factors.columns, n - 1)], 0)
    back = np.where(factors.columns == factors.rows, 0, back)
    return of_pair / (weight + back) / factors.area[factors.rows] * line


def _trust_of_none(factors, place, one, other, variance) -> np.ndarray:
    """Return the reciprocal variance of a direction in which no line went, where one went the other way, (pairs,) 1/m⁴."""
    there = np.zeros(len(one), np.int64)
    there[place] = factors.rows
    back = np.where(there == one, np.minimum(other, len(factors) - 1), one)
    own = np.bincount(place, variance)  # of the one direction that has an entry
    ratio = (factors.line * factors.area)[back] / (factors.line * factors.area)[there]
    return np.divide(1, own * ratio, out=np.zeros(len(own)), where=own > 0)


def _share_of_a_line(factors, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Return the share that one line makes of an entry, both directions together, (k,)."""
    n, own = len(factors), 1 / (factors.line * factors.area)
    back = np.where((columns < n) & (columns != rows), own[np.minimum(columns, n - 1)], 0)
    return 1 / (own[rows] + back) / factors.area[rows]


def _from(factors, found: Nearest, one, other, samples: np.ndarray, place: np.ndarray):
    """Return the factors of exchange areas: both directions of each pair that is not zero."""
    twice = (other < len(factors)) & (other != one)
    rows, columns = np.concatenate([one, other[twice]]), np.concatenate([other, one[twice]])
    pair = np.concatenate([np.arange(len(one)), np.flatnonzero(twice)])
    order = np.lexsort((columns, rows))
    rows, columns, pair = rows[order], columns[order], pair[order]
    area = factors.area[rows]
    values = found.values[pair] / area
    of_samples = found.of_samples(samples)[:, pair] / area
    hits = np.bincount(place, factors.hits)[pair].astype(np.int64)
    if factors.replicates > 1:
        mean, spread = mean_and_error(samples[:, pair])
        lucky = by_luck(mean, spread) & (hits >= 0) & (hits < FEW)  # few counts that agree by chance
        least = np.where(lucky, np.sqrt(found.unknowns.variance[pair]) / area, LEAST * values)
        errors = np.maximum(mean_and_error(of_samples)[1], least)
        fixed = by_luck(values, errors - least) & ~lucky  # closure alone gives the value: lines know it to a whole line
        share = _share_of_a_line(factors, rows, columns) * np.sqrt(factors.replicates / 12)
        errors = np.where(fixed & (values > 0), np.maximum(errors, share), errors)
    else:
        errors = np.full(len(rows), np.nan)
    return replace(
        factors,
        rows=rows,
        columns=columns,
        values=values,
        errors=errors,
        samples=of_samples,
        hits=hits,
        restoration=LEAST_SQUARES,
    )
