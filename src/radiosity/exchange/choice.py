"""The choice between counted lines and polygons: which has the smaller error after as much work.

Work is counted in lines, so that no clock decides. A ray of a visible share costs about as much as a line. The test whether two
patches face each other, and an exact factor with all that follows from it, cost as many lines as was measured (`FACES`, `EXACT`).
Where the work does not suffice for a ray of each pair, or memory does not for the pairs, lines are taken. Otherwise the errors
are predicted, as the root of the summed variances of all factors, as they stand in the table. That of polygons follows from the
visible shares of some pairs, drawn at random. That of lines follows, between few groups, from the standard errors of a pilot that
traces a sixteenth of them or fewer, and from what they leave out of narrow faces. Between many, where a line is one more count in
a row, it follows from the numbers of lines alone.
"""

from dataclasses import dataclass

import numpy as np

from ..device import memory
from ..factors.polygons.kernel import PairKernel
from ..sampling.streams import Purpose, Seed, stream
from ..tracing.geometry import Geometry
from ..tracing.pair_rays import PairRays
from .from_polygons import wanted
from .groups import Groups
from .narrow import left_out
from .view_factors import ViewFactors

FACES, EXACT = 0.2, 1  # lines: work of a pair of patches, and of one that face each other, without rays
PILOT = 16  # the pilot's share of lines is one over this
MANY = 64  # groups: between more, lines are predicted without a pilot
COUNTED = 0.32  # variance of lines between many groups, restored, over that of random lines as counted
SLOPE = 1.1  # variance falls with this power of the number of lines; 1 with random numbers
RAY_SLOPE = 1.5  # variance of polygons: that of one ray falls with this power of the rays of a pair, since few need more
DRAWN, DRAWN_RAYS = 2048, 16  # pairs of patches that tell of all, and rays of each
MOST = 8192  # rays of a pair, in the mean
FEWEST_LINES, MOST_LINES = 64, 4096  # lines of a patch and replicate, which find what is missed


@dataclass(frozen=True)
class Rays:
    """How the work of polygons is spent.

    Attributes:
        pair: rays of each pair that faces, in the mean; below one where the work does not suffice.
        missed: lines of each patch and replicate, where something escapes or is lost.
    """

    pair: float
    missed: int

    @staticmethod
    def of(work: float, patches: int, facing: float, replicates: int) -> "Rays":
        """Return the rays for a work in lines."""
        left = work - FACES * patches * (patches - 1) / 2 - EXACT * facing
        lines = _power_of_two(left / 4 / max(patches * replicates, 1), FEWEST_LINES, MOST_LINES)
        return Rays(min(max(left, 0) / max(facing, 1), MOST), lines)


def _power_of_two(number: float, least: int, most: int) -> int:
    return int(np.clip(2 ** int(np.floor(np.log2(max(number, 1)))), least, most))


@dataclass(frozen=True, eq=False)
class Sample:
    """Pairs drawn at random, which tell of all.

    Attributes:
        one, other, values: those of them that face each other, see `FacingPairs`.
        each: how many pairs of all one of them stands for.
    """

    geometry: Geometry
    one: np.ndarray
    other: np.ndarray
    values: np.ndarray
    each: float

    @staticmethod
    def of(geometry: Geometry, seed: Seed) -> "Sample":
        """Draw pairs of a scene's patches."""
        n, draw = len(geometry.patches), np.random.Generator(np.random.Philox(stream(seed, 0, Purpose.VIEW_FACTORS)))
        whole = n * (n - 1) / 2
        if whole <= DRAWN:
            one, other = np.triu_indices(n, 1)
        else:
            one = draw.integers(0, n, DRAWN)
            other = (one + draw.integers(1, n, DRAWN)) % n
        values = PairKernel(geometry.patches, geometry.device).values(one, other)
        some = np.flatnonzero(values > 0)
        return Sample(geometry, one[some], other[some], values[some], whole / max(len(one), 1))

    @property
    def facing(self) -> float:
        """The number of pairs that face each other."""
        return self.each * len(self.one)

    def variance(self, groups: Groups, seed: Seed) -> float:
        """Return the summed variances of all factors for one ray a pair."""
        if not len(self.one):
            return 0.0
        sums = PairRays(self.geometry).cast(self.one, self.other, self.values, DRAWN_RAYS, 0, seed.value)
        share = np.clip(sums.arriving / np.maximum(sums.weights, np.finfo(np.float32).tiny), 0, 1).astype(np.float64)
        area = groups.area(self.geometry.patches)[groups.labels]
        square = self.each * self.values**2 * (1 / area[self.one] ** 2 + 1 / area[self.other] ** 2)
        return float((square * share * (1 - share)).sum()) * DRAWN_RAYS / (DRAWN_RAYS - 1)


@dataclass(frozen=True, eq=False)
class Choice:
    """Lines or polygons for a scene and a work in lines. `of` is None where polygons cannot be taken, or the work is too little.

    Attributes:
        sample: some pairs.
        spent: how the work would be spent on polygons.
    """

    sample: Sample
    spent: Rays

    @staticmethod
    def of(geometry: Geometry, groups: Groups, work: float, replicates: int, seed: Seed) -> "Choice | None":
        """Look at some pairs."""
        n = len(geometry.patches)
        if geometry.some_backs_pass or geometry.panes is not None or n < 2 or replicates < 2 or work < FACES * n * (n - 1) / 2:
            return None
        sample = Sample.of(geometry, seed)
        spent = Rays.of(work, n, sample.facing, replicates)
        fits = wanted(n, len(groups.names), sample.facing) <= memory.room()
        return Choice(sample, spent) if spent.pair >= 1 and fits else None

    def by_counts(self, groups: Groups, work: float, seed: Seed) -> dict[str, float]:
        """Return the errors of lines and of polygons between many groups: roots of summed variances."""
        area = groups.area(self.sample.geometry.patches)
        of_pairs = self.sample.variance(groups, seed)
        of_lines = COUNTED * float((area.sum() / (work * area)).sum())
        return {"lines": float(np.sqrt(of_lines)), "polygons": float(np.sqrt(of_pairs / self.spent.pair**RAY_SLOPE))}

    def by_pilot(self, pilot: ViewFactors, groups: Groups, work: float, seed: Seed) -> dict[str, float]:
        """Return the errors of lines and of polygons between few groups: roots of summed variances.

        Args:
            pilot: factors of some lines, restored.
        """
        geometry, spent, replicates = self.sample.geometry, self.spent, pilot.replicates
        off = (left_out(geometry, groups)[pilot.rows] * pilot.values) ** 2
        lines = float(np.sqrt(np.nansum(pilot.errors**2) * (pilot.rays / work) ** SLOPE + off.sum()))
        gone = (pilot.escaped * (1 - pilot.escaped) + pilot.lost * (1 - pilot.lost))[groups.labels]
        of_pairs = self.sample.variance(groups, seed) / spent.pair**RAY_SLOPE
        share = geometry.patches.area / pilot.area[groups.labels]
        of_missed = float((share**2 * gone).sum()) / (replicates * spent.missed)
        if not (pilot.escaped.any() and pilot.lost.any()):  # closure then tells it as well as the pairs are known
            of_missed = min(of_missed, of_pairs)
        return {"lines": lines, "polygons": float(np.sqrt(of_pairs + of_missed))}
