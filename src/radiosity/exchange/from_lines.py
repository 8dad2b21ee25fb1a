"""View factors between groups from counted lines: the rows of the groups' own lines."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..errors import MethodError, shown
from ..factors.counted import CountedPairs
from ..factors.counts import WORD, split
from ..solution.intervals import least_error
from .apart import apart
from .codes import Codes
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
    known, values, errors, samples = combined(parts, width * width, n <= SAMPLED)
    codes, numbers = known.each, np.zeros(len(known))
    for some, _, lines in parts:
        numbers[known.place(some)] += lines
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
    known = Codes.of(codes, width * width)
    place = known.place(codes)
    return known.each, *(np.bincount(place, value, len(known)) for value in values)


def combined(parts: Sequence[tuple[np.ndarray, ...]], size: int, sampled: bool):
    """Return codes, values, standard errors (m,) and samples (replicates, m) or None, of the codes and values of replicates.

    Args:
        size: codes are smaller than this.
    """
    known, count = Codes.of(np.concatenate([codes for codes, *_ in parts]), size), len(parts)
    mean, squares, met = np.zeros(len(known)), np.zeros(len(known)), np.zeros(len(known))
    for codes, values, *_ in parts:
        mean[known.place(codes)] += values
    mean /= count
    for codes, values, *_ in parts:
        place = known.place(codes)
        squares[place] += (values - mean[place]) ** 2
        met[place] += 1
    squares += (count - met) * mean**2  # replicates without the entry
    errors = np.sqrt(squares / (count * (count - 1))) if count > 1 else np.full(len(known), np.nan)
    if not sampled:
        return known, mean, errors, None
    samples = np.zeros((count, len(known)))
    for row, (codes, values, *_) in zip(samples, parts, strict=True):
        row[known.place(codes)] = values
    return known, mean, errors, samples
