"""Visible shares of pairs of patches, unbiased, with variances: few rays a pair, and more where neighbours are seen in part.

Patches are taken in blocks of eight, in order, so a pair is in a block of up to 64 pairs. First each pair gets a ray, or several
where the work allows. What others of its block say gives its expected variance, and by this, and by its exact factor, the other
rays are shared out. A pair's own first ray has no say in how many follow. Where several have, they are left out of its mean. So
the mean has no bias.

A share is c + the mean of (v - c) w, where v is 1 for rays that arrive, w is their weight, whose mean is one, and c is what
others of the block see. Where nothing is in between it is exactly one. What is hidden or seen of pairs that touch keeps its true
weight.

The variance of one pair is known badly from its few rays. It is mixed with the mean of a class: of pairs with as many rays, in
blocks that are seen to about the same share. Some pairs of blocks that agree get rays for that mean alone.
"""

from dataclasses import dataclass

import numpy as np

from ..sampling.streams import Seed
from ..tracing.pair_rays import PairRays, Sums

BLOCK = 3  # bits: patches of a block are 8
CLEAR = 16  # pairs of a block that tell, if all arrive, that it is clear
FIRST, MOST_FIRST = 16, 64  # first rays of a pair, where the work suffices for four times as many; else it is one
UNKNOWN = 0.1  # rays: what is believed of a block before the first one
PROBES, MOST_PROBES = 16, 1 << 14  # of so many pairs without more rays one gets two, which tell the variance of all
LEVELS = 14  # most doublings of a pair's rays
PRIOR = 32  # degrees of freedom of the class, against those of the pair's own batches
KINDS = (0.002, 0.01, 0.04, 0.12, 0.3)  # bounds of classes: the lesser part of a block, seen or hidden


@dataclass(frozen=True, eq=False)
class Shares:
    """Visible shares.

    Attributes:
        values: (m,) float64; of a pair they may be below 0 or above 1.
        variances: (m,) float64.
        rays: of all pairs together.
    """

    values: np.ndarray
    variances: np.ndarray
    rays: int


@dataclass(frozen=True, eq=False)
class Told:
    """What the first rays tell of some pairs.

    Attributes:
        first: first rays of each.
        own: they tell of their own pair, too, and are not in its mean.
        centre: (k,) share that is seen.
        variance: (k,) expected variance of a ray.
        kind: (k,) class.
        part: the share of all pairs that are in blocks whose rays do not agree.
    """

    first: int
    own: bool
    centre: np.ndarray
    variance: np.ndarray
    kind: np.ndarray
    part: float


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of patches, the exact exchange areas without obstacles, and what the square of a share's error counts, (m,) each."""

    one: np.ndarray
    other: np.ndarray
    values: np.ndarray
    weight: np.ndarray

    def take(self, rows) -> "Pairs":
        """Return some of them."""
        return Pairs(self.one[rows], self.other[rows], self.values[rows], self.weight[rows])


def visible_shares(caster: PairRays, pairs: Pairs, rays: int, batches: int, seed: Seed) -> Shares:
    """Return visible shares.

    Args:
        rays: of all pairs together; at least one a pair is cast.
        batches: independent sets of points of pairs with many rays, 2 or more.
    """
    m, number = len(pairs.one), seed.number_of(0)
    if not m:
        return Shares(np.zeros(0), np.zeros(0), 0)
    first = 1 if rays < 4 * FIRST * m else min(1 << int(np.log2(rays / (4 * m))), MOST_FIRST)
    own = first >= FIRST
    pilot = caster.cast(pairs.one, pairs.other, pairs.values, first, 0, number)
    hides = pilot.arriving < pilot.weights
    code, hidden, met = _blocks(hides, pairs, len(caster.geometry.patches))
    blocked = hidden[code]
    clear = np.zeros(m, bool) if own else _clear(hides, code, hidden, met)
    part = 1 - float(((blocked == 0) | (blocked == met[code])).mean())
    some, rest = np.flatnonzero(~clear), np.flatnonzero(clear)
    probes = rest[number % PROBES :: max(PROBES, len(rest) // MOST_PROBES)]
    chosen = np.concatenate([some, probes])
    told = _told(pilot.take(chosen), code[chosen], hidden, met, first, own, clear[chosen], part)
    taken = pairs.take(chosen)
    more = _more(np.sqrt(taken.weight * told.variance)[: len(some)], rays - first * m - 2 * len(probes), 2 if own else 0)
    few = np.flatnonzero(more == 0)
    more[few[number % PROBES :: PROBES]] = 2
    more = np.concatenate([more, np.full(len(probes), 2)])
    found, others = _mean(caster, taken, pilot.take(chosen), told, more, batches, number)
    values, variances = _sum(pilot, 1.0, first) / first, np.full(m, others)
    values[chosen], variances[chosen] = found.values, found.variances
    return Shares(values, variances, first * m + found.rays)


def _blocks(hides: np.ndarray, pairs: Pairs, patches: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the block of each pair, (m,), and how many pairs of each block are hidden, and are there."""
    wide = (patches >> BLOCK) + 1
    code = (pairs.one >> BLOCK).astype(np.int64 if wide > 1 << 15 else np.int32) * wide + (pairs.other >> BLOCK)
    if wide * wide > 4 * len(code) + 1024:
        code = np.unique(code, return_inverse=True)[1]
    met = np.bincount(code)
    return code, np.bincount(code[hides], minlength=len(met)), met


def _clear(hides: np.ndarray, code: np.ndarray, hidden: np.ndarray, met: np.ndarray) -> np.ndarray:
    """Return which pairs are in blocks of which all other pairs are seen, (m,) bool."""
    return (hidden[code] == hides) & (met[code] >= CLEAR)


def _told(pilot: Sums, code, hidden, met, first: int, own: bool, clear: np.ndarray, part: float) -> Told:
    seen = np.divide(pilot.arriving, pilot.weights, out=np.ones(len(code)), where=pilot.weights > 0)
    if own:
        known, share = float(first), seen
    else:
        known = met[code] - 1.0
        lost = hidden[code] - (pilot.arriving < pilot.weights)
        share = 1 - np.divide(lost, known, out=np.zeros(len(code)), where=known > 0)
    q = (known * share + UNKNOWN / 2) / (known + UNKNOWN)
    kind = np.where(clear, 0, 1 + np.searchsorted(KINDS, np.minimum(share, 1 - share), side="right"))
    return Told(first, own, share, q * (1 - q), kind, part)


def _more(need: np.ndarray, rays: float, least: int) -> np.ndarray:
    """Return how many rays follow, (k,) int64: powers of two from 2 on in proportion to the need, or ``least``."""
    top = need.max(initial=0.0)
    if rays <= 0 or not top > 0:
        return np.full(len(need), least, np.int64)
    below = -np.log2(np.maximum(need / top, 2.0**-40))
    quarter = np.arange(4 * 40 + 4)
    counts = np.bincount((4 * below).astype(np.int64), minlength=len(quarter))
    best = np.full(len(quarter), least, np.int64)
    for level in range(4, 4 * (LEVELS + 40)):  # the most needy get 2^(level / 4), rounded down to a power of two
        power = (level - quarter) // 4
        each = np.maximum(np.where(power >= 1, 2.0 ** np.clip(power, 0, LEVELS), 0), least)
        if (each * counts).sum() > rays:
            break
        best = each.astype(np.int64)
    return best[(4 * below).astype(np.int64)]


def _mean(caster: PairRays, pairs: Pairs, pilot: Sums, told: Told, more: np.ndarray, batches: int, seed: int):
    """Return the shares of some pairs, and the variance of pairs of the first class that got no more rays."""
    first, k = told.first, len(more)
    value, total = _sum(pilot, told.centre, first), np.full(k, float(first))
    variance, of_one, rays = np.zeros(k), np.zeros(k), 0
    levels = np.flatnonzero(np.bincount(more, minlength=1))
    for count in levels[levels > 0].tolist():
        some = np.flatnonzero(more == count)
        sets = batches if count >= 2 * batches else 2
        each = count // sets
        mean, of_mean, of_ray = _batches(caster, pairs.take(some), told.centre[some], sets, each, seed)
        prior, weight, kind = told.part * told.variance[some], pairs.weight[some], told.kind[some]
        pooled = _by_class(of_mean, weight, kind, prior / (each * sets))
        of_mean = ((sets - 1) * of_mean + PRIOR * pooled) / (sets - 1 + PRIOR)
        of_one[some] = _by_class(of_ray, weight, kind, prior)
        follow, rays = each * sets, rays + each * sets * len(some)
        if told.own:
            value[some], total[some], variance[some] = follow * mean, follow, of_mean
        else:
            value[some] += follow * mean
            total[some] += follow
            variance[some] = (first * of_one[some] + follow**2 * of_mean) / (first + follow) ** 2
    few, probed, others = np.flatnonzero(more == 0), np.flatnonzero(more == 2), 0.0
    for kind in range(len(KINDS) + 2):
        here, there = few[told.kind[few] == kind], probed[told.kind[probed] == kind]
        if len(here) or (len(there) and not kind):
            own = here if len(here) else there
            square, prior = float(pairs.weight[own].mean()), float(told.part * told.variance[own].mean())
            mean = (pairs.weight[there] @ of_one[there] + square * prior) / max(pairs.weight[there].sum() + square, 1e-300)
            variance[here] = mean / first
            others = others if kind else mean / first
    return Shares(value / total, variance, rays), others


def _batches(caster: PairRays, pairs: Pairs, centre: np.ndarray, sets: int, each: int, seed: int):
    """Return means over independent batches of rays, their variances, and those of single rays, (k,) each."""
    means, square = np.zeros((sets, len(centre))), np.zeros(len(centre))
    for batch in range(sets):
        found = caster.cast(pairs.one, pairs.other, pairs.values, each, batch + 1, seed)
        means[batch] = _sum(found, centre, each) / each
        square += found.arriving_squares * (1 - 2 * centre) + centre**2 * found.squares
    mean = means.mean(axis=0)
    of_mean = ((means - mean) ** 2).sum(axis=0) / (sets * (sets - 1))
    return mean, of_mean, np.maximum(square / (each * sets) - (mean - centre) ** 2 + of_mean, 0)


def _sum(sums: Sums, centre: np.ndarray | float, rays: int) -> np.ndarray:
    return rays * centre + sums.arriving - centre * sums.weights


def _by_class(values: np.ndarray, weight: np.ndarray, kind: np.ndarray, prior: np.ndarray) -> np.ndarray:
    """Return the weighted mean of each pair's class, (k,); one pair more is believed to have the prior."""
    many = np.maximum(np.bincount(kind), 1)
    top = np.bincount(kind, weight * (values + prior / many[kind]))
    bottom = np.bincount(kind, weight) * (1 + 1 / many)
    return np.divide(top, bottom, out=np.zeros(len(top)), where=bottom > 0)[kind]
