"""What whole lines leave unsent (contract 12), and where the lines begin that send it on.

When a stage ends, patch i owes x_i = E_i A_i / delta + rho_i h_i and has fired s_i = floor(x_i + phase_i) lines. The residue
r_i = x_i - s_i is known exactly, and h_j - sum_i s_i F_ij has mean zero; so what is missing of the mean of h is the answer D to
the means of the residues: D = F^T r + F^T rho D. Where no light comes back to its patch these are zero, since phases are uniform.
In a narrow gap they are not, and most of the light is missing at few lines.

Residues are summed over groups of consecutive patches, in which most of their noise cancels, and become whole lines of weight 1
or -1 by systematic rounding along the patches: all that is left unsent of a replicate is less than a line. A group's lines begin
on its patches in proportion to what these owe, up to one line: as the means of their residues grow, too.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..patches.model import Patches
from ..pieces import PIECE, pieces
from . import quanta as contract
from .quanta import Source

SHARE = 0.025  # of a replicate's quanta: the lines that noise makes are to be no more
MOST = 512  # patches of a group
TYPICAL = math.sqrt(1 / (3 * math.pi))  # mean size of a normal variable of the variance 1/6, which residues have
ONE = np.uint64(1 << 32)


@dataclass(frozen=True, eq=False)
class Starts:
    """Lines that send the residue on.

    Attributes:
        replicate, patch: (m,) int64, where they begin, replicate by replicate.
        line: (m,) uint32, which of its replicate, from 0 on.
        sign: (m,) int64, 1 or -1.
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
    return min(math.ceil(alone**2), MOST)


def _lines(rho, emitted, arrivals, phase, groups: Groups, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Patches where a replicate's lines begin, and their signs."""
    total, found = int(random.integers(0, 1 << 32)), []
    for part, begins in groups.parts():
        owed = rho[part].astype(np.uint64) * arrivals[part] + emitted[part]
        left = ((owed + phase[part]) % ONE).astype(np.int64) - phase[part]
        sums = np.cumsum(np.append(total, np.add.reduceat(left, begins)))
        total, lines = int(sums[-1]), np.diff(sums >> 32)
        group = np.repeat(np.arange(len(lines)), np.abs(lines))
        sign = np.sign(lines[group])
        found.append((part.start + (group if groups.begins is None else _within(owed, begins, group, random)), sign))
    return tuple(np.concatenate(column) for column in zip(*found, strict=True))


def _within(owed: np.ndarray, begins: np.ndarray, group: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A patch of each line's group."""
    weight = np.concatenate([[0], np.cumsum(np.minimum(owed, ONE), dtype=np.uint64)])
    low, high = weight[begins[group]], weight[np.append(begins[1:], len(owed))[group]]
    at = low + (random.random(len(group)) * (high - low)).astype(np.uint64)
    return np.searchsorted(weight, np.minimum(at, high - np.uint64(1)), side="right") - 1
