"""View factors between groups from counted lines: the rows of the groups' own lines."""

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
    area, parts, hits = groups.area(patches), [], []
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
        parts.append(gathered(codes, weight[rows] * counts / np.maximum(fired, 1)[rows], width))
        parts[-1] = parts[-1][0], parts[-1][1] / whole[parts[-1][0] // width]
        hits.append(gathered(codes, counts, width))
    codes, values, errors, samples = combined(parts, n <= SAMPLED)
    numbers = np.zeros(len(codes))
    for some, lines in hits:
        numbers[np.searchsorted(codes, some)] += lines
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


def gathered(codes: np.ndarray, values: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return ascending codes, each once, and the sums of their values."""
    if width * width <= 4 * len(codes):
        total, met = np.bincount(codes, values, width * width), np.bincount(codes, minlength=width * width)
        found = np.flatnonzero(met)
        return found, total[found]
    found, place = np.unique(codes, return_inverse=True)
    return found, np.bincount(place, values, len(found))


def combined(parts: list[tuple[np.ndarray, np.ndarray]], sampled: bool):
    """Return codes, values, standard errors (m,) and samples (replicates, m) or None, of the codes and values of replicates."""
    codes = np.unique(np.concatenate([some for some, _ in parts]))
    count, places = len(parts), [np.searchsorted(codes, some) for some, _ in parts]
    mean = np.zeros(len(codes))
    for place, (_, values) in zip(places, parts, strict=True):
        mean[place] += values
    mean /= count
    squares, met = np.zeros(len(codes)), np.zeros(len(codes))
    for place, (_, values) in zip(places, parts, strict=True):
        squares[place] += (values - mean[place]) ** 2
        met[place] += 1
    squares += (count - met) * mean**2  # replicates without the entry
    errors = np.sqrt(squares / (count * (count - 1))) if count > 1 else np.full(len(codes), np.nan)
    if not sampled:
        return codes, mean, errors, None
    samples = np.zeros((count, len(codes)))
    for row, place, (_, values) in zip(samples, places, parts, strict=True):
        row[place] = values
    return codes, mean, errors, samples
