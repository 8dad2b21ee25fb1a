"""Visible shares of pairs of patches, unbiased, with variances: few rays a pair, and more where neighbours are seen in part.

Patches are taken in blocks of eight, in order, so a pair is in a block of up to 64 pairs. First each pair gets a ray, or a
quarter of all where there are more: where a sixth is hidden, one ray for each of 16 pairs finds nothing in one run of 20. What
others of its block say gives its expected variance, and by this, and by its exact factor, the other rays are shared out. A pair's
own first rays have no say in how many follow. Where they have, they are left out of its mean. So the mean has no bias.

A share is c + the mean of (v - c) w, where v is 1 for rays that arrive, w is their weight, whose mean is one, and c is what
others of the block see. Where nothing is in between it is exactly one. What is hidden or seen of pairs that touch keeps its true
weight.

The variance of one pair is known badly from its few rays. It is mixed with the mean of a class: of pairs with as many rays, in
blocks that are seen to about the same share. That of pairs without more rays follows from their own first rays.
"""

from dataclasses import dataclass

import numpy as np

from ..sampling.streams import Seed
from ..tracing.pair_rays import PairRays, Sums

BLOCK = 3  # bits: patches of a block are 8
CLEAR = 16  # pairs of a block that tell, if all arrive, that it is clear
FIRST, MOST_FIRST = 16, 64  # first rays of a pair that tell of it, too, and at most; the work suffices for four times as many
UNKNOWN = 0.1  # rays: what is believed of a block before the first one
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
        prior: (k,) variance of a ray that one pair more of the class is believed to have.
    """

    first: int
    own: bool
    centre: np.ndarray
    variance: np.ndarray
    kind: np.ndarray
    prior: np.ndarray


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
    first = min(1 << int(np.log2(max(rays / (4 * m), 1))), MOST_FIRST)
    own = first >= FIRST
    pilot = caster.cast(pairs.one, pairs.other, pairs.values, first, 0, number)
    hides = _hidden(pilot, first)
    code, hidden, met = _blocks(hides, pairs, len(caster.geometry.patches))
    blocked = hidden[code]
    clear = np.zeros(m, bool) if own else _clear(hides, code, hidden, met)
    part = 1 - float(((blocked == 0) | (blocked == met[code])).mean())
    some = np.flatnonzero(~clear)
    told = _told(pilot.take(some), code[some], hidden, met, first, own, part)
    taken = pairs.take(some)
    more = _more(np.sqrt(taken.weight * told.variance), rays - first * m, 2 if own else 0)
    found = _mean(caster, taken, pilot.take(some), told, more, batches, number)
    values, variances = _sum(pilot, 1.0, first) / first, np.full(m, _of_clear(pilot, pairs.weight, clear, first, part > 0))
    values[some], variances[some] = found.values, found.variances
    return Shares(values, variances, first * m + found.rays)


def _of_clear(pilot: Sums, weight: np.ndarray, clear: np.ndarray, first: int, hides_more: bool) -> float:
    """Return the variance of the share of a pair whose block looks clear: its own rays had no say in that, and may be hidden.

    Where something stands between others, one more ray of these pairs may be: that none was found does not mean that none is.
    """
    lost = (pilot.squares - pilot.arriving_squares)[clear].astype(np.float64)
    here = weight[clear]
    whole = float(here.sum())
    if not whole > 0:
        return 0.0
    one = float(np.median(here))  # a usual pair: those with the largest factors are too near for anything to stand between
    return (float(here @ lost) + one * hides_more) / (whole + one) / first**2


def _hidden(pilot: Sums, first: int) -> np.ndarray:
    """Return the share of the first rays of each pair that is hidden, (m,) float64; bool where it is one ray."""
    if first == 1:
        return pilot.arriving < pilot.weights
    seen = np.divide(pilot.arriving, pilot.weights, out=np.ones(len(pilot.weights)), where=pilot.weights > 0, dtype=np.float64)
    return 1 - seen


def _blocks(hides: np.ndarray, pairs: Pairs, patches: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the block of each pair, (m,), and how many pairs of each block are hidden, and are there."""
    wide = (patches >> BLOCK) + 1
    code = (pairs.one >> BLOCK).astype(np.int64 if wide > 1 << 15 else np.int32) * wide + (pairs.other >> BLOCK)
    if wide * wide > 4 * len(code) + 1024:
        code = np.unique(code, return_inverse=True)[1]
    met = np.bincount(code)
    return code, np.bincount(code[hides], minlength=len(met)) if hides.dtype == bool else np.bincount(code, hides), met


def _clear(hides: np.ndarray, code: np.ndarray, hidden: np.ndarray, met: np.ndarray) -> np.ndarray:
    """Return which pairs are in blocks of which all other pairs are seen, (m,) bool."""
    return (hidden[code] == hides) & (met[code] >= CLEAR)


def _told(pilot: Sums, code, hidden, met, first: int, own: bool, part: float) -> Told:
    seen = np.divide(pilot.arriving, pilot.weights, out=np.ones(len(code)), where=pilot.weights > 0)
    if own:
        known, share = float(first), seen
    else:
        others = met[code] - 1.0
        lost = hidden[code] - _hidden(pilot, first)
        share = np.clip(1 - np.divide(lost, others, out=np.zeros(len(code)), where=others > 0), 0, 1)
        known = first * others
    q = (known * share + UNKNOWN / 2) / (known + UNKNOWN)
    kind = np.searchsorted(KINDS, np.minimum(share, 1 - share), side="right")
    prior = max(part, (part > 0) / max(len(code), 1)) * q * (1 - q)
    if part > 0:  # one ray more of all of a class may not do as all others did
        prior = np.where(kind == 0, np.maximum(prior, 1 / first), prior)
    return Told(first, own, share, q * (1 - q), kind, prior)


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


def _mean(caster: PairRays, pairs: Pairs, pilot: Sums, told: Told, more: np.ndarray, batches: int, seed: int) -> Shares:
    """Return the shares of some pairs."""
    first, k = told.first, len(more)
    value, total = _sum(pilot, told.centre, first), np.full(k, float(first))
    variance, of_one, rays = np.zeros(k), np.zeros(k), 0
    levels = np.flatnonzero(np.bincount(more, minlength=1))
    for count in levels[levels > 0].tolist():
        some = np.flatnonzero(more == count)
        sets = batches if count >= 2 * batches else 2
        each = count // sets
        mean, of_mean, of_ray = _batches(caster, pairs.take(some), told.centre[some], sets, each, seed)
        prior, weight, kind = told.prior[some], pairs.weight[some], told.kind[some]
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
    few = np.flatnonzero(more == 0)
    if len(few):
        square = _squares(pilot.take(few), told.centre[few]) / first
        variance[few] = _by_class(square, pairs.weight[few], told.kind[few], told.prior[few]) / first
    return Shares(value / total, variance, rays)


def _squares(sums: Sums, centre: np.ndarray) -> np.ndarray:
    """Return sums of ((v - c) w)² over rays, (m,)."""
    return sums.arriving_squares * (1 - 2 * centre) + centre**2 * sums.squares


def _batches(caster: PairRays, pairs: Pairs, centre: np.ndarray, sets: int, each: int, seed: int):
    """Return means over independent batches of rays, their variances, and those of single rays, (k,) each."""
    means, square = np.zeros((sets, len(centre))), np.zeros(len(centre))
    for batch in range(sets):
        found = caster.cast(pairs.one, pairs.other, pairs.values, each, batch + 1, seed)
        means[batch] = _sum(found, centre, each) / each
        square += _squares(found, centre)
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
