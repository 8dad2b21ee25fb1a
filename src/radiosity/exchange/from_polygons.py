"""View factors between groups from exact factors of polygons and the visible share of each pair.

Pairs of patches that would see each other have exact factors, 1e-7 or better (`factors.polygons.kernel`). Rays find their visible
shares, few for most pairs, and more where some arrive and others do not (`visible_shares`). What escapes and is lost is found by
local lines (`factors.missed`): by a few, and where these find something by more. Rows of such factors sum to one but for the
errors of these shares, so that they are closed at once (`closing`). What is certain stays as it is.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..device import memory
from ..errors import MethodError
from ..factors.missed import missed
from ..factors.polygons.kernel import LANES, PairKernel
from ..sampling.streams import Seed
from ..tracing.geometry import Geometry
from ..tracing.pair_rays import PairRays
from .apart import apart
from .closing import Measured, closed, opened
from .groups import Groups
from .restoration import LEAST_SQUARES, SAMPLED, SCALING
from .view_factors import ViewFactors
from .visible_shares import Pairs, Shares, visible_shares

PAIR = 160  # bytes of a pair of patches that face each other, and of two of groups
BETWEEN = 48  # bytes of two groups, in full matrices and in the table of factors
EXACT = 1e-7  # relative error of exact factors
LEAST = 1e-36  # m⁴: smaller variances would be zero in single precision
FEW_LINES = 1 << 14  # lines of all patches that look for what escapes or is lost; where they find something there are more


@dataclass(frozen=True, eq=False)
class FacingPairs:
    """Pairs of patches that would see each other if nothing stood between.

    Attributes:
        one, other: (m,) uint32, one < other, ascending.
        values: (m,) m², exact A_i F_ij without obstacles.
    """

    geometry: Geometry
    one: np.ndarray
    other: np.ndarray
    values: np.ndarray

    @staticmethod
    def of(geometry: Geometry, groups: int, facing: float | None = None) -> "FacingPairs":
        """Find all of a scene.

        Args:
            groups: between which factors are asked for; their matrices count as memory.
            facing: how many pairs face each other, if it is known.

        Raises:
            MethodError: they do not fit in memory.
        """
        n = len(geometry.patches)
        memory.refuse(wanted(n, groups, facing), f"pairs of {n} patches", "take method='lines', or fewer patches")
        kernel = PairKernel(geometry.patches, geometry.device)
        step = max(LANES // max(n, 1), 1)
        found = [kernel.rows(begin, min(begin + step, n)) for begin in range(0, n, step)]
        one, other, values = (np.concatenate(x) for x in zip(*found, strict=True))
        return FacingPairs(geometry, one, other, values)

    @cached_property
    def rays(self) -> PairRays:
        return PairRays(self.geometry)

    def shares(self, weight: np.ndarray, rays: int, replicates: int, seed: Seed) -> Shares:
        """Return unbiased visible shares of the exact factors, see `visible_shares`.

        Args:
            weight: (m,) what the square of the error of a pair's share counts.
        """
        pairs = Pairs(self.one, self.other, self.values, weight)
        return visible_shares(self.rays, pairs, rays, max(replicates, 2), seed)


def wanted(patches: int, groups: int, facing: float | None = None) -> float:
    """Return the bytes that a run takes."""
    return PAIR * (patches * (patches - 1) / 2 if facing is None else facing) + BETWEEN * groups * groups


def from_polygons(
    pairs: FacingPairs, groups: Groups, rays: int, lines: int, replicates: int, seed: Seed, provenance: dict
) -> ViewFactors:
    """Return restored view factors.

    Args:
        rays: of all pairs together.
        lines: of each patch and replicate, which find what is missed.

    Raises:
        MethodError: backs let lines pass, so that the exact factor times one share does not hold both ways.
    """
    geometry = pairs.geometry
    if geometry.some_backs_pass:
        raise MethodError("polygons: backs of this scene let lines pass (sides 1 of MGF), one way only; take method='lines'")
    if geometry.panes is not None:
        raise MethodError(
            "polygons: some surfaces let light through (transmittance), so that few pairs are seen whole; take method='lines'"
        )
    patches, n = geometry.patches, len(groups.names)
    area = groups.area(patches)
    one, other = (x if n == len(patches) and _same(groups) else groups.labels[x] for x in (pairs.one, pairs.other))
    inverse = 1 / area**2
    weight = inverse[one] + inverse[other]
    weight *= pairs.values * pairs.values
    shares = pairs.shares(weight, rays, replicates, seed)
    del weight
    code = one.astype(np.int64) * n
    code += other
    del one, other
    values = _between(code, pairs.values * shares.values, n, np.float64)
    square = shares.variances + EXACT**2
    square *= pairs.values
    square *= pairs.values
    variances = _between(code, np.maximum(square, LEAST), n, np.float64 if n <= SAMPLED else np.float32)
    del code, square
    variances[np.diag_indices(n)] *= 2  # both directions of a pair are one number
    gone, of_gone, one_line, traced = _gone(geometry, groups, area, lines, replicates, seed)
    np.maximum(values, 0, out=values)
    measured = opened(Measured(values, variances, gone, of_gone, area), one_line)
    found, closes = closed(measured)
    return _table(found, groups, patches, replicates, shares.rays + traced, provenance | {"closes": closes})


def _same(groups: Groups) -> bool:
    return bool((groups.labels == np.arange(len(groups.labels))).all())


def _between(code: np.ndarray, values: np.ndarray, n: int, kind) -> np.ndarray:
    """Return sums between groups, (n, n), symmetric; what is within one counts twice, once each way.

    Args:
        code: (m,) row * n + column of each value, ascending where each is there once.
    """
    if len(code) and (code[1:] > code[:-1]).all():
        result = np.zeros(n * n, kind)
        result[code] = values
    else:
        result = np.bincount(code, values, n * n).astype(kind, copy=False)
    result = result.reshape(n, n)
    for at in range(0, n, step := max((1 << 20) // n, 1)):  # by parts of rows: an array plus its transpose would be copied
        low, high = slice(at, at + step), slice(at + step, n)
        own = result[low, low]
        result[low, low] = own + own.T
        result[low, high] += result[high, low].T
        result[high, low] = result[low, high].T
    return result


def _gone(geometry: Geometry, groups: Groups, area: np.ndarray, lines: int, replicates: int, seed: Seed):
    """Return what escapes and is lost, (2, n) m², its variances, what one line stands for, (n,) m², and the lines traced."""
    patches, n, labels = geometry.patches, len(groups.names), groups.labels

    def of_groups(count: int, replicate: int) -> np.ndarray:
        return np.array([np.bincount(labels, x * patches.area, n) for x in missed(geometry, count, seed.number_of(replicate))])

    few = min(max(FEW_LINES // len(patches), 1), lines)
    first, traced = of_groups(few, 0), few * len(patches)
    largest = np.zeros(n)
    np.maximum.at(largest, labels, patches.area)
    if not first.any():
        return first, np.zeros((2, n)), largest / few, traced
    out = np.array([of_groups(lines, replicate) for replicate in range(replicates)])
    traced += lines * replicates * len(patches)
    mean, one_line = out.mean(axis=0), largest / (lines * replicates)
    variance = out.var(axis=0, ddof=1) / replicates if replicates > 1 else (0.01 * mean) ** 2
    return mean, np.where((out > 0).any(axis=0), np.maximum(variance, one_line**2), 0), one_line, traced


def _table(found: Measured, groups: Groups, patches, replicates: int, rays: int, provenance: dict) -> ViewFactors:
    """Return the entries that are not certainly zero."""
    n, area = len(groups.names), found.area
    share = 1 / area
    found.values[...] *= share[:, None]
    found.variances[...] *= (share * share)[:, None].astype(found.variances.dtype)
    there = found.variances > 0
    there |= found.values > 0  # closure alone may give a value, which is then certain
    counts, columns = there.sum(axis=1), np.flatnonzero(there)
    values, errors = found.values.ravel()[columns], np.sqrt(found.variances.ravel()[columns]).astype(np.float64)
    columns -= np.repeat(np.arange(n) * n, counts)
    rows = np.repeat(np.arange(n), counts)
    for code, (gone, variance) in enumerate(zip(found.gone, found.gone_variances, strict=True)):
        some = np.flatnonzero(variance > 0)
        if len(some):
            place = np.searchsorted(rows, some, side="right")  # after all others of the row
            rows, columns = np.insert(rows, place, some), np.insert(columns, place, n + code)
            values = np.insert(values, place, (gone * share)[some])
            errors = np.insert(errors, place, (np.sqrt(variance) * share)[some])
    inside = slice(None) if not found.gone_variances.any() else columns < n
    closes = provenance.pop("closes")
    return ViewFactors(
        names=groups.names,
        area=area,
        rows=rows,
        columns=columns,
        values=values,
        errors=errors if replicates > 1 else np.full(len(rows), np.nan),
        replicates=replicates,
        samples=None,
        line=np.full(n, np.nan),
        hits=np.full(len(rows), -1),
        apart=apart(patches, groups, (rows * n + columns)[inside]),
        method="polygons",
        restoration=LEAST_SQUARES if closes and n <= SAMPLED else SCALING,
        rays=rays,
        provenance=provenance,
    )
