"""View factors between groups from counted lines: the rows of the groups' own lines."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..errors import MethodError, shown
from ..factors.counted import CountedPairs
from ..factors.counts import WORD, split
from ..solution.intervals import least_error
from .apart import apart
from .groups import Groups
from .restoration import SAMPLED
from .view_factors import ViewFactors


def from_lines(pairs: CountedPairs, groups: Groups, rays: int, provenance: dict, status: str = "complete") -> ViewFactors:
    """Return F_ij = n_ij / n_i, patches of a group weighted by their area.

    Every row comes from its own lines alone. So its sum, escaped and lost among it, is one by counting, and the errors of F_ij
    and F_ji are independent.

    Raises:
        MethodError: a group fired no line in some replicate.
    """
    patches, n, width = pairs.patches, len(groups.names), len(groups.names) + 2
    area, parts = groups.area(patches), []
    count = len(patches)
    bounds = np.searchsorted(pairs.keys, np.arange(pairs.replicates + 1).astype(np.uint64) * np.uint64(count) << WORD)
    for replicate, (begin, end) in enumerate(pairwise(bounds)):
        keys, counts = pairs.keys[begin:end] - (np.uint64(replicate * count) << WORD), pairs.counts[begin:end]
        rows, columns = split(keys)
        fired = np.bincount(rows, weights=counts, minlength=count)
        weight = np.where(fired > 0, patches.area, 0.0)
        whole = np.bincount(groups.labels, weight, n)
        if not whole.all():
            without = [groups.names[i] for i in np.flatnonzero(whole == 0)]
            raise MethodError(f"no line left {shown(without)} in replicate {replicate}: take more rays, or fewer replicates")
        codes = groups.labels[rows] * width + np.where(
            columns < count, np.append(groups.labels, [0, 0])[columns], columns - count + n
        )
        some, values, lines = gathered(codes, width, weight[rows] * counts / np.maximum(fired, 1)[rows], counts)
        parts.append((some, values / whole[some // width], lines.astype(np.uint32)))
    codes, values, errors, samples = combined(parts, n <= SAMPLED)
    numbers = np.zeros(len(codes))
    for some, _, lines in parts:
        numbers[np.searchsorted(codes, some)] += lines
    del parts
    with np.errstate(divide="ignore"):
        each = patches.area / pairs.lines.sum(axis=0)
    line = np.zeros(n)
    np.maximum.at(line, groups.labels, np.where(np.isfinite(each), each, 0.0))
    line /= area
    rows, columns = np.divmod(codes, width)
    if pairs.replicates > 1:
        ones = np.ones(len(codes))
        errors = least_error(values[:, None], errors[:, None], numbers, ones, line[rows, None], pairs.replicates)[:, 0]
    return ViewFactors(
        names=groups.names,
        area=area,
        rows=rows,
        columns=columns,
        values=values,
        errors=errors,
        replicates=pairs.replicates,
        samples=samples,
        line=line,
        hits=numbers.astype(np.int64),
        apart=apart(patches, groups, (rows * n + columns)[columns < n]),
        reciprocal=not pairs.directed,
        rays=rays,
        status=status,
        provenance=provenance,
    )


def gathered(codes: np.ndarray, width: int, *values: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return ascending codes, each once, and the sums of some values of each."""
    if width * width <= 4 * len(codes):
        found = np.flatnonzero(np.bincount(codes, minlength=width * width))
        return found, *(np.bincount(codes, value, width * width)[found] for value in values)
    found, place = np.unique(codes, return_inverse=True)
    return found, *(np.bincount(place, value, len(found)) for value in values)


def combined(parts: Sequence[tuple[np.ndarray, ...]], sampled: bool):
    """Return codes, values, standard errors (m,) and samples (replicates, m) or None, of the codes and values of replicates."""
    codes = parts[0][0]
    for some, *_ in parts[1:]:
        codes = np.union1d(codes, some)
    count = len(parts)
    mean, squares, met = np.zeros(len(codes)), np.zeros(len(codes)), np.zeros(len(codes))
    for some, values, *_ in parts:
        mean[np.searchsorted(codes, some)] += values
    mean /= count
    for some, values, *_ in parts:
        place = np.searchsorted(codes, some)
        squares[place] += (values - mean[place]) ** 2
        met[place] += 1
    squares += (count - met) * mean**2  # replicates without the entry
    errors = np.sqrt(squares / (count * (count - 1))) if count > 1 else np.full(len(codes), np.nan)
    if not sampled:
        return codes, mean, errors, None
    samples = np.zeros((count, len(codes)))
    for row, (some, values, *_) in zip(samples, parts, strict=True):
        row[np.searchsorted(codes, some)] = values
    return codes, mean, errors, samples
