"""What whole lines leave unsent (contract 12), and where the lines begin that send it on.

When a stage ends, patch i owes x_i = E_i A_i / delta + rho_i h_i and has fired s_i = floor(x_i + phase_i) lines. The residue x_i - s_i
is known exactly, and h_j - sum_i s_i F_ij has mean zero; so what is missing of E[h] is the answer to a source of the residues'
means: D = F^T r + F^T rho D. Where no line comes back to its patch they are zero, since phases are uniform. Where lines come back
they are not: in a narrow gap most of the light is missing at few lines.

x_i - s_i is frac(x_i + phase_i) - phase_i. Its mean is that of frac(x_i + phase_i) - 1/2, which varies half as much; and it is zero
where nothing was ever owed, or nothing is reflected. These are summed over groups of consecutive patches, in which what is noise
cancels, and become whole lines of weight 1 or -1 by systematic rounding along the patches. A group's lines begin on its
patches in proportion to what these owe, up to one line: as their residues' means grow, too.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..patches.model import Patches
from ..pieces import PIECE, pieces
from . import quanta as contract
from .quanta import Source

SHARE = 0.03  # of a replicate's quanta: lines that noise makes
TYPICAL = math.sqrt(1 / (6 * math.pi))  # mean size of a normal variable of the variance 1/12
ONE, HALF, FRACTION = np.uint64(1 << 32), np.int64(1 << 31), np.uint64(0xFFFFFFFF)


@dataclass(frozen=True, eq=False)
class Starts:
    """Lines that send the residue on.

    Attributes:
        replicate, patch: (m,) int64, where they begin, replicate by replicate.
        line: (m,) uint32, which of its replicate, from 0 on.
        sign: (m,) int32, 1 or -1.
    """

    replicate: np.ndarray
    patch: np.ndarray
    line: np.ndarray
    sign: np.ndarray

    @staticmethod
    def of(source: Source, groups: "Groups", quanta: int, arrivals: np.ndarray, phase: np.ndarray, seed: int) -> "Starts":
        """From the state after a stage of N quanta.

        Args:
            groups: of patches.
            arrivals, phase: (replicates, n_patches) uint32.
        """
        whole, fraction = source.emitted(quanta)
        emitted = (whole.astype(np.uint64) << np.uint64(32)) | fraction
        found = []
        for replicate, (landed, offset) in enumerate(zip(arrivals, phase, strict=True)):
            random = np.random.Generator(np.random.Philox(contract.stream(seed, replicate, contract.RESIDUE)))
            patch, sign = _lines(source.rho, emitted, landed, offset, groups, random)
            found.append((np.full(len(patch), replicate), patch, np.arange(len(patch), dtype=np.uint32), sign))
        return Starts(*(np.concatenate(column) for column in zip(*found, strict=True)))


@dataclass(frozen=True, eq=False)
class Groups:
    """Consecutive patches whose residues are summed.

    Attributes:
        n_patches: in all.
        begins: (n_groups,) int64, the first patch of each, increasing; None where each patch is alone.
    """

    n_patches: int
    begins: np.ndarray | None

    @staticmethod
    def of(patches: Patches, quanta: int) -> "Groups":
        """At N quanta. None reaches over the end of a face, or else of a surface, where these are no more than groups."""
        n, size = len(patches), group_size(len(patches), quanta)
        if size == 1:
            return Groups(n, None)
        faces, surface = patches.first[:-1].astype(np.int64), patches.scene.surface
        surfaces = faces[np.concatenate([[True], surface[1:] != surface[:-1]])]
        runs = next((runs for runs in (faces, surfaces) if len(runs) * size <= n), np.zeros(1, np.int64))
        length = np.diff(np.append(runs, n))
        count = -(-length // size)
        of = np.repeat(np.arange(len(runs)), count)
        turn = np.arange(len(of)) - (np.cumsum(count) - count)[of]
        return Groups(n, runs[of] + turn * length[of] // count[of])

    def parts(self) -> Iterator[tuple[slice, np.ndarray]]:
        """Whole groups, some `PIECE` patches at a time, and where groups begin in them."""
        if self.begins is None:
            yield from ((part, np.arange(part.stop - part.start)) for part in pieces(self.n_patches))
            return
        step = max(PIECE * len(self.begins) // self.n_patches, 1)
        ends = np.append(self.begins, self.n_patches)
        for group in range(0, len(self.begins), step):
            part = slice(int(ends[group]), int(ends[min(group + step, len(self.begins))]))
            yield part, self.begins[group : group + step] - part.start


def group_size(n_patches: int, quanta: int) -> int:
    """Patches whose residues are summed before they become lines: so many that these stay few."""
    alone = TYPICAL * n_patches / (SHARE * quanta)
    return min(max(1, math.ceil(alone**2)), n_patches)


def _lines(rho, emitted, arrivals, phase, groups: Groups, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Patches where a replicate's lines begin, and their signs."""
    sum_before, found = int(random.integers(0, 1 << 32)), []
    for part, begins in groups.parts():
        owed = rho[part].astype(np.uint64) * arrivals[part] + emitted[part]
        left = ((owed + phase[part]) & FRACTION).astype(np.int64) - HALF
        left[(owed == 0) | (rho[part] == 0)] = 0
        sums = np.cumsum(np.add.reduceat(left, begins)) + sum_before
        reached = np.concatenate([[sum_before], sums]) >> 32
        sum_before = int(sums[-1])
        lines = np.diff(reached)
        group = np.repeat(np.arange(len(lines)), np.abs(lines))
        sign = np.sign(lines[group]).astype(np.int32)
        found.append((part.start + (group if groups.begins is None else _within(owed, begins, group, random)), sign))
    return tuple(np.concatenate(column) for column in zip(*found, strict=True))


def _within(owed: np.ndarray, begins: np.ndarray, group: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A patch of each line's group."""
    weight = np.concatenate([[0], np.cumsum(np.minimum(owed, ONE), dtype=np.uint64)])
    low, high = weight[begins[group]], weight[np.append(begins[1:], len(owed))[group]]
    at = low + (random.random(len(group)) * (high - low)).astype(np.uint64)
    return np.searchsorted(weight, np.minimum(at, high - np.uint64(1)), side="right") - 1
