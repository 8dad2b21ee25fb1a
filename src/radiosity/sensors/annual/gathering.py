"""The lines of receivers, patches or sensors, into the sky and to patches."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ...algorithms.gather.chances import Chances
from ...algorithms.gather.lamps import Lamps
from ...algorithms.gather.lines import UNITS, Lines
from ...algorithms.gather.packets import Packets
from ...algorithms.gather.stored_lines import StoredLines
from ...method.presets import PRESETS
from ...problem.model import Problem
from ...sampling.streams import Purpose, Seed
from ...scene.lights.sky_patches import SkyPatches
from .bins import Bins

AT_ONCE = 1 << 23  # lines of a launch

Range = tuple[int, int]  # of the lines of each receiver: the first, and the one after the last
Tables = tuple[Bins, Bins]


@dataclass(frozen=True, eq=False)
class Caught:
    """What lines of receivers brought, in whole numbers: no order of sums matters.

    Attributes:
        tables: those of `Gathering.bins`, (lanes * n_sky_patches,) int64 each.
        seen, lost: as of `Gathering`, of these lines alone.
    """

    tables: tuple[np.ndarray, np.ndarray]
    seen: Any
    lost: np.ndarray


@dataclass(eq=False)
class Gathering:
    """Lines of the receivers of one replicate.

    Attributes:
        lines: what traces them.
        of_suns: the same receivers, with the numbers of rays to suns.
        bins: what they bring from sky patches: a table of cosine lines, and one of shadow rays through openings.
        seen: counts of hits, a sparse array (receivers, n_patches).
        counts: cosine lines and shadow rays of each receiver so far.
        lost: (receivers,) cosine lines that met absorbing backs.
        unit: what makes shares of light of fixed point numbers, see `Problem.unit`.
    """

    lines: Lines
    of_suns: Lines
    bins: Tables
    seen: Any
    counts: tuple[int, int]
    lost: np.ndarray
    unit: float

    @staticmethod
    def of(
        packets: Packets,
        problem: Problem,
        seed: Seed,
        purposes: tuple[Purpose, Purpose],
        sky: SkyPatches,
        axes: np.ndarray,
    ) -> "Gathering":
        """Make what traces lines; none is traced yet.

        Args:
            packets: the receivers, of one replicate.
            problem: of one group of bands, whose only light is a sky of radiance 1.
            purposes: of streams, for cosine lines and shadow rays.
            axes: of the sky, see `Bins`.
        """
        from scipy.sparse import csr_array

        chances = Chances(Lamps(packets.geometry, problem), packets)
        lines, of_suns = (
            Lines.of(packets, chances, problem, PRESETS["gather"].method, seed, two)
            for two in (purposes, (Purpose.YEAR_SUN, Purpose.YEAR_SUN))
        )
        one, other = (Bins(sky, axes, packets.lanes, packets.types) for _ in range(2))
        none, lost = csr_array((packets.receivers, packets.n)), np.zeros(packets.receivers)
        return Gathering(lines, of_suns, (one, other), none, (0, 0), lost, float(problem.unit[0]))

    def advance(self, cosine: int, shadow: int) -> int:
        """Trace until each receiver has so many lines of both kinds; return the number of new lines."""
        ranges = self.due(cosine, shadow)
        seen, lost = self._traced(ranges, self.bins)
        return self._note(ranges, seen, lost)

    def due(self, cosine: int, shadow: int) -> tuple[Range, Range]:
        """Return the lines that each receiver lacks, of both kinds, until it has so many."""
        shadow = shadow if self.lines.targets.chances.targets else 0
        now = self.counts
        return (now[0], max(cosine, now[0])), (now[1], max(shadow, now[1]))

    def caught(self, ranges: tuple[Range, Range]) -> Caught:
        """Trace lines, and return what they brought in place of adding it."""
        one, other = (bins.emptied() for bins in self.bins)
        seen, lost = self._traced(ranges, (one, other))
        return Caught((np.array(one.table), np.array(other.table)), seen, lost)

    def add(self, ranges: tuple[Range, Range], parts: list[Caught]) -> int:
        """Add what all lines of some ranges brought in other places; return the number of lines."""
        for number, bins in enumerate(self.bins):
            bins.add(np.sum([one.tables[number] for one in parts], axis=0))
        seen = sum((one.seen for one in parts[1:]), parts[0].seen)
        return self._note(ranges, seen, np.sum([one.lost for one in parts], axis=0))

    def _note(self, ranges: tuple[Range, Range], seen: Any, lost: np.ndarray) -> int:
        self.seen, self.lost = self.seen + seen, self.lost + lost
        self.counts = ranges[0][1], ranges[1][1]
        return lines_of(ranges) * self.lines.packets.receivers

    def _traced(self, ranges: tuple[Range, Range], bins: Tables) -> tuple[Any, np.ndarray]:
        """Trace lines into tables; return what they saw and lost."""
        from scipy.sparse import csr_array

        packets, (cosine, shadow) = self.lines.packets, ranges
        step, seen, lost = max(AT_ONCE // packets.lanes, 1), csr_array(self.seen.shape), np.zeros(packets.receivers)
        for at in range(cosine[0], cosine[1], step):
            more = self._cosine(at, min(at + step, cosine[1]), bins[0])
            seen, lost = seen + more[0], lost + more[1]
        for at in range(shadow[0], shadow[1], step):
            few = np.full(packets.count, at), np.full(packets.count, min(at + step, shadow[1]) - at)
            dr.eval(self.lines.shadow(*few, bins=bins[1]), bins[1].table)
        return seen, lost

    def _cosine(self, begin: int, end: int, bins: Bins) -> tuple[Any, np.ndarray]:
        from scipy.sparse import coo_array

        packets = self.lines.packets
        few = np.full(packets.count, begin), np.full(packets.count, end - begin)
        keep = StoredLines(packets, count=end - begin, first=begin)
        _, (_, lost) = self.lines.cosine(*few, keep=keep, bins=bins)
        dr.eval(bins.table, keep.hits)
        hits = np.array(keep.hits).reshape(end - begin, packets.lanes)[:, packets.place]  # (lines, receivers) numbers
        line, receiver = np.nonzero(hits < packets.n)
        patches = self._patch_at[hits[line, receiver]]
        entries = coo_array((np.ones(len(patches)), (receiver, patches)), shape=self.seen.shape)
        return entries.tocsr(), packets.patch_values(np.array(lost))[0]

    @cached_property
    def _patch_at(self) -> np.ndarray:
        """The patch of each number that `Lines.cosine` keeps, (n_patches,)."""
        packets = self.lines.packets
        return np.argsort(np.array(packets.place_on_device)[: packets.n])

    def from_sky(self) -> np.ndarray:
        """Return what each receiver gets from each sky patch of radiance 1 straight, (receivers, n_sky_patches) sr."""
        packets = self.lines.packets
        scales = self.lines.unit, UNITS
        tables = [
            bins.values()[packets.place] / (max(count, 1) * scale)
            for bins, count, scale in zip(self.bins, self.counts, scales, strict=True)
        ]
        return (tables[0] + tables[1]) * self.unit

    def shares(self) -> Any:
        """Return the share of each receiver's cosine lines that hit each patch, a sparse array (receivers, n_patches)."""
        return self.seen * (1 / max(self.counts[0], 1))


def lines_of(ranges: tuple[Range, Range]) -> int:
    """Return the number of lines of a receiver in ranges of both kinds."""
    return sum(end - begin for begin, end in ranges)
