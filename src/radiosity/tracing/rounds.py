"""Which lines of a batch are traced in packets of like lines (coherent firing): whole rounds of patches that fire many.

A round of a patch holds 16 lines of each box of directions (`sampling.numbers.strata`). Its packets hold lines of one patch and
one box, which start at one face and go the same way. All other lines are traced as without packets. The finest boxes come first:
they take as many rounds as a patch has lines for, then coarser ones take of what is left.

The first lines of a patch may have a randomisation of its own, which moves their boxes to another place (`own_lines`). So a round
lies on one side of that border. Rounds before it begin with the first line, and those behind it end with the last. So what is
left are consecutive lines.
"""

import drjit as dr

from ..patches.model import Patches
from ..sampling.numbers import strata
from .boxes import Boxes
from .lanes import Batch, sums

Size = tuple[int, int]  # of `strata.SIZES`
LEAST = 1 << 16  # lines in rounds of one size: fewer gain less than their launches take
FACES = 75  # in one box, in the mean: more of them, and lines that go the same way meet too many of them (measured)
SHIFT = 3  # 8 lines a lane, of neighbouring boxes: what the lines of a patch have in common is found once for them


def sizes_for(patches: Patches, fewest: int) -> tuple[Size, ...]:
    """Return the sizes of boxes whose rounds pay in a scene, the coarsest first.

    Faces count by their area: ``sum(area)**2 / sum(area**2)`` of them are as many as there are where all are equal, and few where
    walls are large and things small.

    Args:
        fewest: lines of the smallest rounds, see `coherent_costs`.
    """
    area = patches.scene.area
    faces = area.sum() ** 2 / (area**2).sum()
    return tuple(size for size in strata.SIZES if strata.lines(*size) >= fewest and faces <= FACES * strata.boxes(*size))


def split(types, batch: Batch, records, shifts: tuple[int, ...], sizes: tuple[Size, ...], own: int) -> list[Batch]:
    """Return batches of the same lines: rounds of each size, then what is left.

    Args:
        batch: lines of patches; its lanes are not used.
        records, shifts: see `Batch.filled`, of what is left.
        sizes: those that pay, see `sizes_for`.
        own: how many lines of a patch take its own randomisation; of the first block alone.
    """
    least = strata.lines(*sizes[0]) if sizes else 0
    if not sizes or sums(types, dr.select(batch.counts >= least, batch.counts, 0))[0] < LEAST:
        return [batch]
    before = dr.select(batch.fired < own, own - batch.fired, 0)
    if batch.blocks is not None:
        before = dr.select(batch.blocks == 0, before, 0)
    before = dr.minimum(batch.counts, before)
    left, ends = [before, batch.counts - before], [batch.fired, batch.fired + batch.counts]
    result = []

    def take(size: Size, side: int, counts) -> None:
        start = ends[side] if side == 0 else ends[side] - counts
        left[side] = left[side] - counts
        ends[side] = start + counts if side == 0 else start
        dr.eval(start, counts, left[side], ends[side])
        boxes = Boxes.of(types, size, start, counts)
        result.append(
            Batch.of(types, batch.numbers, counts, start, records, batch.start, SHIFT, blocks=batch.blocks, boxes=boxes)
        )

    for size in reversed(sizes):
        lines = strata.lines(*size)
        rounds = [some // lines * lines for some in left]
        dr.schedule(*rounds)
        for side, total in enumerate(sums(types, *rounds)):
            if total >= LEAST:
                take(size, side, rounds[side])
    rest = Batch.filled(types, batch.numbers, left[0] + left[1], ends[0], records, batch.start, shifts, batch.blocks)
    return result if rest is None else [*result, rest]
