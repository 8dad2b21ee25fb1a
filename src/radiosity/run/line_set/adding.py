"""The sum of two line sets: other replicates, or other seeds, of the same patches (contract 16)."""

from dataclasses import replace
from typing import Any

import numpy as np

from ...errors import MethodError
from ...factors.counts import WORD
from ..part import Part
from ..same import SAME, differences

FACTS = tuple(key for key in SAME if key not in ("seed", "replicates", "first_replicate", "all_replicates"))
PARTS = ("seed", "replicates", "first_replicate", "parts")  # of a provenance: which replicates there are


def fields_of_sum(one: Any, other: Any) -> dict[str, Any]:
    """Return the fields of the sum of two line sets that differ from those of the first.

    Replicates are put in the order of seeds and their numbers, so that the order of sums does not matter.

    Raises:
        MethodError: replicates overlap, or what was traced differs.
    """
    different = differences(other.provenance, one.provenance, FACTS, ("in the second", "in the first"))
    if one.quanta != other.quanta:
        different.append(f"quanta ({other.quanta} in the second, {one.quanta} in the first)")
    if one.both_ways != other.both_ways:
        different.append("one counts lines at both ends, the other where they begin")
    if different:
        raise MethodError(f"cannot add line sets that differ: {'; '.join(different)}. Trace all with the same, and quanta=")
    pieces = sorted([*_pieces(one), *_pieces(other)], key=lambda piece: (piece[0].seed.value, piece[0].first))
    n, before, keys, parts = np.uint64(len(one.patches)), 0, [], []
    for part, some, _ in pieces:
        last: Part | None = parts[-1] if parts else None
        if last is not None and last.seed.value == part.seed.value and part.first < last.end:
            raise MethodError(
                f"cannot add line sets whose replicates overlap: of seed {part.seed.value} one has {last.range}, the other "
                f"{part.range}; trace one of them with first_replicate={last.end}, or with another seed"
            )
        keys.append(some + (np.uint64(before) * n << WORD))
        before += part.replicates
        if last is not None and last.seed.value == part.seed.value and part.first == last.end:
            parts[-1] = Part(last.seed, last.replicates + part.replicates)
        else:
            parts.append(part)
    counts = np.concatenate([some for _, _, some in pieces])
    return {
        "pairs": replace(one.pairs, keys=np.concatenate(keys), counts=counts, replicates=before),
        "rays": one.rays + other.rays,
        "seconds": one.seconds + other.seconds,
        "status": next((status for status in (one.status, other.status) if status != "complete"), "complete"),
        "parts": tuple(parts),
        "provenance": {key: value for key, value in one.provenance.items() if key not in PARTS} | _facts(parts),
    }


def _pieces(lines: Any):
    """Yield the parts of a line set, each with its keys, counted from its own first replicate, and its counts."""
    n, before = len(lines.patches), 0
    for part in lines.parts:
        begin, end = (np.uint64(number * n) << WORD for number in (before, before + part.replicates))
        first, last = np.searchsorted(lines.pairs.keys, np.array([begin, end]))
        yield part, lines.pairs.keys[first:last] - begin, lines.pairs.counts[first:last]
        before += part.replicates


def _facts(parts: list[Part]) -> dict:
    if len(parts) == 1:
        return parts[0].facts()
    return {
        "seed": parts[0].seed.value,
        "replicates": sum(p.replicates for p in parts),
        "parts": [part.facts() for part in parts],
    }
