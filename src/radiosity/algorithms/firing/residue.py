"""The residue: what whole lines leave unsent (contract 12), and where the lines begin that send it on.

When a stage ends, patch i should have sent x_i = E_i A_i / delta + rho_i h_i packets, and has fired s_i = floor(x_i + phase_i)
lines. The residue r_i = x_i - s_i is known exactly, and h_j - sum_i s_i F_ij has mean zero. So the part D that the mean of h
lacks follows from the means of the residues: D = F^T r + F^T rho D. Where no light comes back to its patch these means are zero,
since phases are uniform. In a narrow gap they are not, and most of the light is missing at few lines. Each band has its own
residue: what a patch should have sent of it, less what its lines have carried.

Residues are summed over groups of consecutive patches, in which most of their noise cancels. They become whole lines by
systematic rounding along the patches: less than a line of a replicate is left unsent. A line carries 1 or -1 of the band that a
group lacks most of (or has too much of), and its share of the others. It begins on a patch of the group, in proportion to what
the patch should have sent, up to one line: the mean of its residue grows in the same way.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...patches.model import Patches
from ...pieces import PIECE, pieces
from ...problem.bands import QUANTUM
from ...problem.model import Problem
from ...problem.quanta import Source
from ...sampling.streams import Purpose, Seed, stream
from .state import FiringState

SHARE = 0.025  # largest share of a replicate's quanta that lines caused by noise should make
MOST = 512  # most patches of a group
TYPICAL = math.sqrt(1 / (3 * math.pi))  # mean size of a normal variable of the variance 1/6, which residues have
ONE = np.uint64(1 << 32)
MUCH = 1 << 30  # lines: sums of two patches' then still have less than 32 bits


@dataclass(frozen=True, eq=False)
class Starts:
    """Lines that send the residue on.

    Attributes:
        replicate, patch: (m,) int64, where they begin, ordered by replicate.
        line: (m,) uint32, the number of the line in its replicate, from 0 on.
        power: (m, n_groups) int64, what they carry, in units of a quantum / `QUANTUM`: plus or minus `QUANTUM` of one group.
    """

    replicate: np.ndarray
    patch: np.ndarray
    line: np.ndarray
    power: np.ndarray

    @staticmethod
    def of(problem: Problem, state: FiringState, phase: np.ndarray, seed: Seed | int) -> "Starts":
        """Return the lines for an algorithm's state after a stage.

        Args:
            phase: (replicates, n_patches) uint32.
        """
        residue, found = Residue.of(problem, state, phase), []
        groups = Groups.of(problem.patches, residue.quanta, problem.rows.n_lights)
        for replicate in range(len(phase)):
            random = np.random.Generator(np.random.Philox(stream(seed, replicate, Purpose.RESIDUE)))
            patch, power = _lines(residue, replicate, groups, random)
            found.append((np.full(len(patch), replicate), patch, np.arange(len(patch), dtype=np.uint32), power))
        return Starts(*(np.concatenate(column) for column in zip(*found, strict=True)))

    @property
    def net(self) -> int:
        """The number of lines that carry positive power, less the number that carry negative power."""
        return int(np.sign(self.power.max(axis=1) + self.power.min(axis=1)).sum())


@dataclass(frozen=True, eq=False)
class Residue:
    """The residue of all patches after a stage.

    Attributes:
        problem: the problem to solve.
        quanta: N.
        emitted: (n_patches,) uint64, E_i A_i / delta times 2^32, modulo 2^64.
        state: the state of the algorithm.
        phase: (replicates, n_patches) uint32.
        much: (n_patches,) bool, where ``emitted`` is many lines; None where neither it nor hits are many anywhere.
    """

    problem: Problem
    quanta: int
    emitted: np.ndarray
    state: FiringState
    phase: np.ndarray
    much: np.ndarray | None = None

    @staticmethod
    def of(problem: Problem, state: FiringState, phase: np.ndarray) -> "Residue":
        """Return the residue of an algorithm's state."""
        quanta = state.quanta
        whole, fraction = problem.source.emitted(quanta)
        much = whole >= MUCH if int(whole.max()) >= MUCH or int(state.arrivals.max()) >= MUCH else None
        return Residue(problem, quanta, (whole.astype(np.uint64) << np.uint64(32)) | fraction, state, phase, much)

    def read(self, replicate: int, part: slice) -> tuple[np.ndarray, np.ndarray]:
        """Return what some patches should have sent, and what is left, both in 2^-32 of a quantum.

        The first is of the scalar problem, (k,) uint64; where it is more than 2^30 lines, all but one of them are left out. The
        second is of each group, (k, n_groups) int64.
        """
        phase = self.phase[replicate, part]
        source, arrivals = self.problem.source, self.state.arrivals[replicate]
        target_counts = source.sent_on(arrivals, part) + self.emitted[part]
        if self.much is not None:  # of so many lines the low words are all that matters
            many = self.much[part] | (source.rho[part] * arrivals[part].astype(np.float64) >= MUCH * float(ONE))
            target_counts = np.where(many, target_counts % ONE + ONE, target_counts)
        bands = self.state.bands
        if bands is None:
            return target_counts, (((target_counts + phase) % ONE).astype(np.int64) - phase)[:, None]
        rows, received = self.problem.rows, bands.about("received", (replicate, part))
        share = rows.emission[part] * (rows.area[part] / self.problem.source.power)[:, None]
        owed_of_each = share * (self.quanta * QUANTUM) + Source.fixed(rows.reflectance[part]) * 2.0**-32 * received
        if rows.through is not None and rows.other is not None:
            beyond = bands.about("received", (replicate, rows.other[part]))
            owed_of_each += Source.fixed(rows.through[part]) * 2.0**-32 * beyond
        return target_counts, 2 * np.round(owed_of_each - bands.about("sent", (replicate, part))).astype(np.int64)


@dataclass(frozen=True, eq=False)
class Groups:
    """Consecutive rows whose residues are summed.

    Attributes:
        n: the number of rows.
        begins: (k,) int64, the first row of each group, increasing; None where each row is a group.
    """

    n: int
    begins: np.ndarray | None

    @staticmethod
    def of(patches: Patches, quanta: int, n_lights: int = 0) -> "Groups":
        """Return the groups at N quanta.

        No group goes beyond the end of a face where there are no more faces than groups, or else of a surface where there are no
        more surfaces than groups. Each light is a group of its own.
        """
        n, size = len(patches), group_size(len(patches), quanta)
        if size == 1:
            return Groups(n + n_lights, None)
        faces, surface = patches.first[:-1].astype(np.int64), patches.scene.surface
        surfaces = faces[np.concatenate([[True], surface[1:] != surface[:-1]])]
        runs = next((runs for runs in (faces, surfaces) if len(runs) * size <= n), np.zeros(1, np.int64))
        length = np.diff(np.append(runs, n))
        count = -(-length // size)
        of = np.repeat(np.arange(len(runs)), count)
        turn = np.arange(len(of)) - (np.cumsum(count) - count)[of]
        begins = runs[of] + turn * length[of] // count[of]
        return Groups(n + n_lights, np.append(begins, n + np.arange(n_lights)))

    def parts(self) -> Iterator[tuple[slice, np.ndarray]]:
        """Yield parts of whole groups, about `PIECE` patches each, and where groups begin in them."""
        if self.begins is None:
            yield from ((part, np.arange(part.stop - part.start)) for part in pieces(self.n))
            return
        step = max(PIECE * len(self.begins) // self.n, 1)
        ends = np.append(self.begins, self.n)
        for group in range(0, len(self.begins), step):
            part = slice(int(ends[group]), int(ends[min(group + step, len(self.begins))]))
            yield part, self.begins[group : group + step] - part.start


def group_size(n_patches: int, quanta: int) -> int:
    """The number of patches whose residues are summed before they become lines, large enough that there are few lines."""
    alone = TYPICAL * n_patches / (SHARE * quanta)
    return min(math.ceil(alone**2), MOST)


def _lines(residue: Residue, replicate: int, groups: Groups, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return the patches where a replicate's lines begin, and what the lines carry."""
    total, found = int(random.integers(0, 1 << 32)), []
    for part, begins in groups.parts():
        target_counts, left = residue.read(replicate, part)
        sums = np.add.reduceat(left, begins)
        most = sums[np.arange(len(sums)), np.abs(sums).argmax(axis=1)]
        reached = np.cumsum(np.append(total, most))
        total = int(reached[-1])
        group = np.repeat(np.arange(len(sums)), np.abs(np.diff(reached >> 32)))
        power = np.round(sums[group] * (QUANTUM / np.abs(most[group]))[:, None]).astype(np.int64)
        found.append((part.start + (group if groups.begins is None else _within(target_counts, begins, group, random)), power))
    patch, power = (np.concatenate(column) for column in zip(*found, strict=True))
    return patch, power


def _within(target_counts: np.ndarray, begins: np.ndarray, group: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Draw a patch of each line's group."""
    weight = np.concatenate([[0], np.cumsum(np.minimum(target_counts, ONE), dtype=np.uint64)])
    low, high = weight[begins[group]], weight[np.append(begins[1:], len(target_counts))[group]]
    at = low + (random.random(len(group)) * (high - low)).astype(np.uint64)
    return np.searchsorted(weight, np.minimum(at, high - np.uint64(1)), side="right") - 1
