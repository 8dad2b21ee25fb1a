"""The choice between counted lines and polygons: which has the smaller error after as much work.

Work is counted in lines, so that no clock decides. A ray of a visible share costs about as much as a line. The test whether two
patches face each other, and an exact factor, cost as many lines as was measured (`FACES`, `EXACT`). The errors are predicted.
That of lines follows from the standard errors of a pilot that traces a sixteenth of them, and from what they leave out of narrow
faces. That of polygons follows from the visible shares of some pairs, drawn at random. Both are the root of the summed
variances of all factors, as they stand in the table.
"""

from dataclasses import dataclass

import numpy as np

from ..factors.polygons import exchange
from ..patches.model import Patches
from ..sampling.streams import Purpose, Seed, stream
from ..tracing.geometry import Geometry
from .from_polygons import FacingPairs
from .groups import Groups
from .narrow import left_out
from .view_factors import ViewFactors

FACES, EXACT = 5, 60  # lines: work of a pair of patches, and of one that face each other
PILOT = 16  # the pilot's share of lines is one over this
SLOPE = 1.1  # variance falls with this power of the number of lines; 1 with random numbers
GAIN = 3  # variance of independent rays over that of polygons: low discrepancy, and what is restored
DRAWN, DRAWN_RAYS = 2048, 64  # pairs of patches that tell of all, and rays of each
FEWEST, MOST = 4, 8192  # rays of a pair and replicate, in steps of the least
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
        return Rays(0 if rays < FEWEST else int(min(rays, MOST)) // FEWEST * FEWEST, lines)


def _power_of_two(number: float, least: int, most: int) -> int:
    return int(np.clip(2 ** int(np.floor(np.log2(max(number, 1)))), least, most))


@dataclass(frozen=True)
class Sample:
    """What pairs drawn at random tell of all.

    Attributes:
        facing: the number of pairs that face each other.
        variance: the summed variances of all factors for one ray a pair.
    """

    facing: float
    variance: float

    @staticmethod
    def of(geometry: Geometry, groups: Groups, seed: Seed) -> "Sample":
        """Draw pairs of a scene's patches."""
        patches = geometry.patches
        n, draw = len(patches), np.random.Generator(np.random.Philox(stream(seed, 0, Purpose.VIEW_FACTORS)))
        whole = n * (n - 1) / 2
        if n < 2:
            return Sample(0.0, 0.0)
        if whole <= DRAWN:
            one, other = np.triu_indices(n, 1)
        else:
            one = draw.integers(0, n, DRAWN)
            other = (one + draw.integers(1, n, DRAWN)) % n
        corners, each = patches.corners, whole / len(one)
        values = exchange(corners[one], corners[other])
        some = np.flatnonzero(values)
        if not len(some):
            return Sample(0.0, 0.0)
        pairs = FacingPairs(geometry, one[some], other[some], values[some])
        share = pairs.visible(DRAWN_RAYS, seed.value)
        area = groups.area(patches)[groups.labels]
        rows = 1 / area[pairs.one] ** 2 + 1 / area[pairs.other] ** 2
        return Sample(each * len(some), float(each * (values[some] ** 2 * share * (1 - share) * rows).sum()))


def polygons_are_better(
    pilot: ViewFactors, geometry: Geometry, groups: Groups, rays: float, replicates: int, seed: Seed
) -> tuple[Rays | None, dict]:
    """Return how to spend the work on polygons, or None where lines are better, and what was predicted.

    Args:
        pilot: factors of some lines, restored.
        rays: lines of the whole run, which is its work.
    """
    patches: Patches = geometry.patches
    if geometry.some_backs_pass or geometry.panes is not None or not 2 <= len(patches) <= LARGEST or replicates < 2:
        return None, {}
    sample = Sample.of(geometry, groups, seed)
    spent = Rays.of(rays, len(patches), sample.facing, replicates)
    off = (left_out(geometry, groups)[pilot.rows] * pilot.values) ** 2
    lines = float(np.sqrt(np.nansum(pilot.errors**2) * (pilot.rays / rays) ** SLOPE + off.sum()))
    whole = float(np.sqrt((pilot.values**2).sum()))
    if spent.pair == 0:
        return None, {"lines": lines / whole, "polygons": "too little work"}
    gone = (pilot.escaped * (1 - pilot.escaped) + pilot.lost * (1 - pilot.lost))[groups.labels]
    of_pairs = sample.variance / GAIN / (replicates * spent.pair)
    of_missed = float(((patches.area / pilot.area[groups.labels]) ** 2 * gone).sum()) / (replicates * spent.missed)
    if not (pilot.escaped.any() and pilot.lost.any()):  # closure then tells it as well as the pairs are known
        of_missed = min(of_missed, of_pairs)
    polygons = float(np.sqrt(of_pairs + of_missed))
    return spent if polygons < lines else None, {"lines": lines / whole, "polygons": polygons / whole}
