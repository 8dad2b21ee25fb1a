"""The choice between counted lines and polygons: which has the smaller error after as much work.

Work is counted in lines, so that no clock decides. A ray of a visible share costs about as much as a line. The test whether two
patches face each other, and an exact factor, cost as many lines as was measured (`FACES`, `EXACT`). Where the work does not
suffice for a ray of each pair, lines are taken. Otherwise the errors are predicted. That of lines follows from the standard
errors of a pilot that traces a sixteenth of them or fewer, and from what they leave out of narrow faces. That of polygons
follows from the visible shares of some pairs, drawn at random. Both are the root of the summed variances of all factors, as they
stand in the table.
"""

from dataclasses import dataclass

import numpy as np

from ..factors.polygons import exchange
from ..sampling.streams import Purpose, Seed, stream
from ..tracing.geometry import Geometry
from .from_polygons import FacingPairs
from .groups import Groups
from .narrow import left_out
from .view_factors import ViewFactors

FACES, EXACT = 1, 48  # lines: work of a pair of patches, and of one that face each other, without rays
PILOT = 16  # the pilot's share of lines is one over this
SLOPE = 1.1  # variance falls with this power of the number of lines; 1 with random numbers
GAIN, RAY_SLOPE = 0.75, 4 / 3  # variance of polygons: that of one ray over GAIN, falls with this power of the rays of a replicate
DRAWN, DRAWN_RAYS = 2048, 64  # pairs of patches that tell of all, and rays of each
MOST, STEP = 8192, 4  # rays of a pair and replicate, and steps of them; fewer than a step are 2 or 1
FEWEST_LINES, MOST_LINES = 64, 4096  # lines of a patch and replicate, which find what is missed
LARGEST = 5000  # patches: with more, polygons are not thought of


@dataclass(frozen=True)
class Rays:
    """How the work of polygons is spent.

    Attributes:
        pair: rays of each pair that faces and replicate; 0 where the work does not suffice.
        missed: lines of each patch and replicate.
    """

    pair: int
    missed: int

    @staticmethod
    def of(work: float, patches: int, facing: float, replicates: int) -> "Rays":
        """Return the rays for a work in lines."""
        left = work - FACES * patches * (patches - 1) / 2 - EXACT * facing
        lines = _power_of_two(left / 4 / max(patches * replicates, 1), FEWEST_LINES, MOST_LINES)
        rays = (left - lines * patches * replicates) / max(facing * replicates, 1)
        return Rays(int(min(rays, MOST)) // STEP * STEP if rays >= STEP else min(int(max(rays, 0)), 2), lines)


def _power_of_two(number: float, least: int, most: int) -> int:
    return int(np.clip(2 ** int(np.floor(np.log2(max(number, 1)))), least, most))


@dataclass(frozen=True, eq=False)
class Sample:
    """Pairs drawn at random, which tell of all.

    Attributes:
        pairs: those of them that face each other.
        each: how many pairs of all one of them stands for.
    """

    pairs: FacingPairs
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
        corners = geometry.patches.corners
        values = exchange(corners[one], corners[other])
        some = np.flatnonzero(values)
        return Sample(FacingPairs(geometry, one[some], other[some], values[some]), whole / max(len(one), 1))

    @property
    def facing(self) -> float:
        """The number of pairs that face each other."""
        return self.each * len(self.pairs.one)

    def variance(self, groups: Groups, seed: Seed) -> float:
        """Return the summed variances of all factors for one ray a pair."""
        pairs = self.pairs
        if not len(pairs.one):
            return 0.0
        share = pairs.visible(DRAWN_RAYS, seed.value)
        area = groups.area(pairs.geometry.patches)[groups.labels]
        rows = 1 / area[pairs.one] ** 2 + 1 / area[pairs.other] ** 2
        return float(self.each * (pairs.values**2 * share * (1 - share) * rows).sum())


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
    def of(geometry: Geometry, work: float, replicates: int, seed: Seed) -> "Choice | None":
        """Look at some pairs."""
        n = len(geometry.patches)
        if geometry.some_backs_pass or geometry.panes is not None or not 2 <= n <= LARGEST or replicates < 2:
            return None
        sample = Sample.of(geometry, seed)
        spent = Rays.of(work, n, sample.facing, replicates)
        return Choice(sample, spent) if spent.pair else None

    def predicted(self, pilot: ViewFactors, groups: Groups, work: float, seed: Seed) -> dict[str, float]:
        """Return the errors of lines and of polygons, relative to all factors.

        Args:
            pilot: factors of some lines, restored.
        """
        geometry, spent, replicates = self.sample.pairs.geometry, self.spent, pilot.replicates
        off = (left_out(geometry, groups)[pilot.rows] * pilot.values) ** 2
        lines = float(np.sqrt(np.nansum(pilot.errors**2) * (pilot.rays / work) ** SLOPE + off.sum()))
        gone = (pilot.escaped * (1 - pilot.escaped) + pilot.lost * (1 - pilot.lost))[groups.labels]
        of_pairs = self.sample.variance(groups, seed) / GAIN / (replicates * spent.pair**RAY_SLOPE)
        share = geometry.patches.area / pilot.area[groups.labels]
        of_missed = float((share**2 * gone).sum()) / (replicates * spent.missed)
        if not (pilot.escaped.any() and pilot.lost.any()):  # closure then tells it as well as the pairs are known
            of_missed = min(of_missed, of_pairs)
        whole = float(np.sqrt((pilot.values**2).sum()))
        return {"lines": lines / whole, "polygons": float(np.sqrt(of_pairs + of_missed)) / whole}
