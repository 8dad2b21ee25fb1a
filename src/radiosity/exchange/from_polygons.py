"""View factors between groups from exact factors of polygons and the visible share of each pair.

A pair of patches that sees each other whole has its exact factor, 1e-7 or better. The visible shares of others are found by
`tracing.visibility`, with other numbers in each replicate. What escapes and is lost is found by local lines (`factors.missed`).
Rows of such factors sum to one but for the errors of these shares, so that they are restored at once. What is certain stays as
it is.

The variance of a share in part is known badly from few replicates: it is mixed with that of independent rays, as in `restored`.
Where all rays of a pair agree its share is one or none, but something small may still be in between. Where other pairs of the
scene are seen in part, the error of such a pair is that of one ray, times the root of the share of pairs seen in part.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..device import memory
from ..errors import MethodError
from ..factors.missed import missed
from ..factors.polygons import exchange
from ..sampling.streams import Seed
from ..tracing.geometry import Geometry
from ..tracing.visibility import Polygons, kernel_means, visible_share
from .apart import apart, in_front
from .from_lines import combined, gathered
from .groups import Groups
from .restored import PRIOR
from .small_gaps import closed
from .view_factors import ViewFactors

CHUNK = 1 << 18  # pairs at a time
PAIR = 162  # bytes of a pair of patches that face each other, and 8 more in each replicate
EXACT = 1e-7  # relative error of exact factors


@dataclass(frozen=True, eq=False)
class FacingPairs:
    """Pairs of patches that would see each other if nothing stood between.

    Attributes:
        one, other: (m,) int64, one < other.
        values: (m,) m², exact A_i F_ij without obstacles.
    """

    geometry: Geometry
    one: np.ndarray
    other: np.ndarray
    values: np.ndarray

    @staticmethod
    def of(geometry: Geometry, replicates: int) -> "FacingPairs":
        """Find all of a scene.

        Raises:
            MethodError: they do not fit in memory.
        """
        patches, polygons = geometry.patches, Polygons.of(geometry.patches)
        n, found = len(patches), []
        memory.refuse(n * n / 2 * (PAIR + 8 * replicates), f"pairs of {n} patches", "take method='lines', or fewer patches")
        facing = in_front(patches)
        facing &= facing.T
        for begin in range(0, n, step := max(CHUNK // max(n, 1), 1)):
            one, other = (x.ravel() for x in np.meshgrid(np.arange(begin, min(begin + step, n)), np.arange(n), indexing="ij"))
            some = (one < other) & facing[one, other]
            one, other = one[some], other[some]
            values = exchange(polygons.corners[one], polygons.corners[other])
            some = values > 0
            found.append((one[some], other[some], values[some]))
        return FacingPairs(geometry, *(np.concatenate(x) for x in zip(*found, strict=True)))

    @cached_property
    def polygons(self) -> Polygons:
        return Polygons.of(self.geometry.patches)

    def visible(self, rays: int, seed: int, rows: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Return the visible share of these pairs, (k,)."""
        one, other = (self.polygons.take(x[rows]) for x in (self.one, self.other))
        return visible_share(self.geometry, one, other, rays, seed)

    def shares(self, rays: int, replicates: int, seed: Seed) -> np.ndarray:
        """Return unbiased visible shares of the exact factors, (replicates, m); below 0 or above 1 by chance in a replicate.

        The kernel is integrated over what is hidden, or over what is seen, whichever is less of it. What is hidden is far from
        the edges that polygons share, where the kernel has no bound; a ratio of seen to all points would have a bias there.
        """
        one, other = (self.polygons.take(x) for x in (self.one, self.other))
        means = kernel_means(self.geometry, one, other, rays, [seed.number_of(r) for r in range(replicates)])
        whole, part = means[:, 0], means[:, 1]
        area = self.geometry.patches.area
        unit = area[self.one] * area[self.other] / (np.pi * self.values)
        mostly = 2 * part.sum(axis=0) >= whole.sum(axis=0)
        return np.where(mostly, 1 - (whole - part) * unit, part * unit)


def from_polygons(
    pairs: FacingPairs, groups: Groups, rays: int, lines: int, replicates: int, seed: Seed, provenance: dict
) -> ViewFactors:
    """Return restored view factors.

    Args:
        rays: of each pair and replicate.
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
    patches, n, width = geometry.patches, len(groups.names), len(groups.names) + 2
    area, labels = groups.area(patches), groups.labels
    shares = pairs.shares(rays, replicates, seed)
    out = [missed(geometry, lines, seed.number_of(r)) for r in range(replicates)]
    one, other = labels[pairs.one], labels[pairs.other]
    ways = np.concatenate([one * width + other, other * width + one])
    rims = [labels * width + n + code for code in (0, 1)]
    gone = np.concatenate([labels[(np.array([x[code] for x in out]) > 0).any(axis=0)] * width + n + code for code in (0, 1)])
    seen = np.concatenate([ways, gone])
    parts = []
    for share, (escaped, lost) in zip(shares, out, strict=True):
        codes = np.concatenate([seen, *rims])
        power = np.concatenate(
            [np.tile(pairs.values * share, 2), np.zeros(len(gone)), escaped * patches.area, lost * patches.area]
        )
        some, values = gathered(codes, width, power)
        parts.append((some, values / area[some // width]))
    known, values, errors, samples = combined(parts, width * width, sampled=True)
    assert samples is not None
    codes, at, rows, columns = known.each, known.place(ways), *np.divmod(known.each, width)

    def of_pairs(variance: np.ndarray) -> np.ndarray:
        return np.bincount(at, np.tile(variance, 2), len(codes)) / area[rows] ** 2

    if replicates > 1:
        mean = np.clip(shares.mean(axis=0), 0, 1)
        model = of_pairs(pairs.values**2 * mean * (1 - mean) / (rays * replicates))
        seen = np.where(columns < n, errors, 0) ** 2
        model *= seen.sum() / max(model.sum(), np.finfo(float).tiny)
        mixed = ((replicates - 1) * seen + PRIOR * model) / (replicates - 1 + PRIOR)
        errors = np.sqrt(np.where(columns < n, mixed, errors**2))
    errors = np.sqrt(errors**2 + of_pairs(_of_one_ray(pairs, shares, rays) ** 2 + (EXACT * pairs.values) ** 2))
    one_line = _of_one_line(patches.area, labels, area, lines * replicates)
    errors = np.where(columns >= n, np.maximum(errors, one_line[rows]), errors)
    some = np.isin(columns, np.unique(columns[(values > 0) & (columns >= n)])) | (columns < n)
    raw = ViewFactors(
        names=groups.names,
        area=area,
        rows=rows[some],
        columns=columns[some],
        values=values[some],
        errors=errors[some],
        replicates=replicates,
        samples=samples[:, some],
        line=np.full(n, np.nan),
        hits=np.full(int(some.sum()), -1),
        apart=apart(patches, groups, (rows * n + columns)[columns < n]),
        method="polygons",
        rays=replicates * (rays * len(pairs.one) + lines * len(patches)),
        provenance=provenance,
    )
    return closed(raw, one_line)


def _of_one_ray(pairs: FacingPairs, shares: np.ndarray, rays: int) -> np.ndarray:
    """Return the error of pairs whose rays all agree, (m,) m²; zero of the others, whose replicates show it."""
    agree = (shares == 1).all(axis=0) | (shares == 0).all(axis=0)
    part = 1 - agree.mean() if len(agree) else 0.0
    return np.where(agree, pairs.values * np.sqrt(part) / (rays * len(shares)), 0.0)


def _of_one_line(patch_area: np.ndarray, labels: np.ndarray, area: np.ndarray, lines: int) -> np.ndarray:
    """Return the share of a group that one of the lines makes which find what is missed, (n,).

    Args:
        lines: of each patch, replicates together.
    """
    largest = np.zeros(len(area))
    np.maximum.at(largest, labels, patch_area)
    return largest / area / lines
