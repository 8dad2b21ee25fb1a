"""Which lines of a batch are traced in packets of like lines (coherent firing): whole rounds of patches that fire many.

A round of a patch holds 16 lines of each box of directions (`sampling.numbers.strata`). Its packets hold lines of one patch and
one box, which start at one face and go the same way. All other lines are traced as without packets. The finest boxes come first:
they take as many rounds as a patch has lines for, then coarser ones take of what is left.

The first lines of a patch may have a randomisation of its own, which moves their boxes to another place (`own_lines`). So a round
lies on one side of that border. Rounds before it begin with the first line, and those behind it end with the last. So what is
left are consecutive lines.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import upload
from ..sampling.numbers import strata
from .boxes import SHIFT, Boxes
from .lanes import Batch, sums
from .line_tracer import LineTracer

LEAST = 1 << 16  # lines in rounds of one size: fewer gain less than their launches take
FACES = 75  # in one box, in the mean: more of them, and lines that go the same way meet too many of them (measured)
BESIDE = 64  # faces that parallel lines from all of a patch may pass: more of them, and the lines of a packet part (measured)


@dataclass(frozen=True)
class Rounds:
    """The rounds that pay in a scene.

    Attributes:
        sizes: of boxes, from `strata.SIZES`, the coarsest first.
        small: Bool of each row, that it is small enough; None: all are.
    """

    sizes: tuple[tuple[int, int], ...]
    small: Any = None

    @staticmethod
    def of(tracer: LineTracer, fewest: int) -> "Rounds | None":
        """Return the rounds for a tracer's scene; None where none pay.

        In a box there are faces by their area: ``sum(area)**2 / sum(area**2)`` are as many as there are where all are equal, and
        few where walls are large and things small. Beside the lines of a patch there are as many as its share of the area of all.

        Args:
            fewest: lines of the smallest rounds, see `coherent_costs`.
        """
        patches = tracer.geometry.patches
        area = patches.scene.area
        faces = area.sum() ** 2 / (area**2).sum()
        sizes = tuple(size for size in strata.SIZES if strata.lines(*size) >= fewest and faces <= FACES * strata.boxes(*size))
        small = np.ones(tracer.n, bool)  # lights, too
        small[: len(patches)] = patches.area * len(area) <= BESIDE * area.sum()
        if not sizes or not small.any():
            return None
        return Rounds(sizes, None if small.all() else upload(tracer.types.Bool, small))

    def split(self, tracer: LineTracer, batch: Batch, shifts: tuple[int, ...]) -> list[Batch]:
        """Return batches of the same lines: rounds of each size, then what is left, with ``shifts`` as in `Batch.filled`."""
        types, counts, least = tracer.types, batch.counts, strata.lines(*self.sizes[0])
        if batch.total << max(shifts, default=0) < LEAST:  # lanes have no more lines than that; to count them the host would wait
            return [batch]
        if self.small is not None:
            counts = dr.select(dr.gather(types.Bool, self.small, tracer.row(batch.numbers)), counts, 0)
        if sums(types, dr.select(counts >= least, counts, 0))[0] < LEAST:
            return [batch]
        before = dr.select(batch.fired < tracer.own_lines, tracer.own_lines - batch.fired, 0)
        if batch.blocks is not None:
            before = dr.select(batch.blocks == 0, before, 0)
        before = dr.minimum(counts, before)
        left, ends = [before, counts - before], [batch.fired, batch.fired + counts]
        result = []

        def take(size: tuple[int, int], side: int, lines) -> None:
            start = ends[side] if side == 0 else ends[side] - lines
            left[side] = left[side] - lines
            ends[side] = start + lines if side == 0 else start
            dr.eval(start, lines, left[side], ends[side])
            given = {"blocks": batch.blocks, "boxes": Boxes.of(types, size, start, lines)}
            result.append(Batch.of(types, batch.numbers, lines, start, tracer.record, batch.start, SHIFT, **given))

        for size in reversed(self.sizes):
            each = strata.lines(*size)
            rounds = [some // each * each for some in left]
            dr.schedule(*rounds)
            for side, total in enumerate(sums(types, *rounds)):
                if total >= LEAST:
                    take(size, side, rounds[side])
        rest = left[0] + left[1] + (batch.counts - counts)
        rest = Batch.filled(types, batch.numbers, rest, ends[0], tracer.record, batch.start, shifts, batch.blocks)
        return result if rest is None else [*result, rest]
