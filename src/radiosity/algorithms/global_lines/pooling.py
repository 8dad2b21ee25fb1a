"""Stochastic iteration on global lines (after L. Neumann, "Monte Carlo radiosity", Computing 55, 1995).

In an iteration every span end gathers the radiosity that the other end has at that time. What a patch receives is the mean over
its ends. The mean is pooled over iterations, since small patches may have no end in one iteration. `docs/global-lines.md` says
why the result is consistent.
"""

import numpy as np

from ...sampling.streams import Seed
from ...tally.unmet import means, sides
from ...tracing.global_lines.ends import Ends, of_lines
from ...tracing.global_lines.spans import ESCAPED, LOST, Pairs, Spans
from ..base import AbstractAlgorithm, Interrupted, Swept
from ..state import Arrays, Sizes
from . import first_shot
from .first_shot import FirstShot
from .pooled import Pooled, units
from .state import HALVES, PoolingState, lines_of_half

ENDS = 2  # least span ends of a mean patch in an iteration
LEAST = 1 << 8  # least lines of an iteration
MEMORY, BUNDLES = 16, 64  # least iterations, or bundles, that count for the radiosity which lines carry
SHARE = 8  # or an eighth of all iterations so far, where that is more
BATCH = 1 << 20  # spans of all replicates between two looks at the clock
WARM = 1 << 21  # most lines of all halves together in the warm-up, but at least one iteration
FULL = 1 << 61  # units of a sum: one more batch adds less, and 2^63 do not fit
SWEEPS, SETTLED = 200, 1e-4  # most steps of the warm-up; it ends earlier where the whole change is this share of 1 - rho
ARRAYS = ("carried", "recent", "recent_ends", "fresh", "fresh_ends", "received", "ends", "escaped", "lost")


class Pooling(AbstractAlgorithm[PoolingState]):
    """Stochastic iteration. N is the number of global lines of a replicate (of spans, where they are drawn one by one).

    An iteration is one bundle; with other lines it is a power of two of lines, such that a mean patch has ENDS ends or more.

    A replicate has two halves with numbers of their own, N / 2 lines each, and each carries what the other has found. So what
    is carried does not depend on the lines that carry it. In one sequence it would: a low discrepancy sequence avoids
    its earlier points, and the irradiance of a small light came out too small by eight standard errors.

    Arrays hold one half of a replicate after the other, (n_groups, halves * n_patches) or (halves * n_patches):
        carried: radiosity that lines carry, whole numbers of the group's `units`: all of it, or what is reflected where there
            was a first shot.
        recent, recent_ends: radiosity of other ends, and ends, in the last iterations; later iterations have more weight.
        fresh, fresh_ends: int64, radiosity and ends of the iteration that is not complete.
        received, ends: int64, radiosity and ends of all iterations with equal weight: the result. Whole numbers do not depend
            on where a stage ended.
        escaped, lost: ends that see nothing, or an absorbing back.

    Without a first shot the state after N lines depends on N alone; with a first shot, see `Multipath`.
    """

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.halves, self.n = HALVES * self.replicates, len(self.geometry.patches)
        self.spans = Spans(self.geometry, self.method, Seed.of(self.seed).split(HALVES), self.halves)
        self.shot = None
        if self.method.first_shot:
            self.shot = FirstShot(self.geometry, self.problem, self.method, self.seed, self.replicates)
        groups, total = self.problem.groups, self.halves * self.n
        self.n_groups = groups.n_groups
        self._quanta, self.done = 0, 0
        self.rho, self.emission = (np.tile(x.T, self.halves) for x in (groups.reflectance, groups.emission))
        self.direct = np.zeros((self.n_groups, total)) if self.shot is not None else None
        self.units, self.sides = units(self.problem), sides(self.problem.patches)
        self.carried, self.recent = (np.zeros((self.n_groups, total)) for _ in range(2))
        self.fresh, self.received = (np.zeros((self.n_groups, total), np.int64) for _ in range(2))
        self.recent_ends = np.zeros(total)
        self.fresh_ends, self.ends, self.escaped, self.lost = (np.zeros(total, np.int64) for _ in range(4))

    @property
    def iteration(self) -> int:
        """The number of lines of an iteration."""
        if self.method.lines == "bundles":
            return self.spans.bundle
        return max(LEAST, 1 << int(np.ceil(np.log2(ENDS / float(self.spans.ends_per_line.mean())))))

    @property
    def memory(self) -> int:
        """The least number of iterations that count for what lines carry."""
        return BUNDLES if self.method.lines == "bundles" else MEMORY

    @property
    def quanta(self) -> int:
        return self._quanta

    @property
    def stage_independent(self) -> bool:
        return self.shot is None

    def advance(self, quanta: int, swept: Swept) -> None:
        self._quanta = quanta
        if self.shot is not None:
            self.shot.fire(first_shot.lines_for(self.method.first_shot, quanta * float(self.spans.ends_per_line.sum())), swept)
            shot, area = self.shot.capture(), self.geometry.patches.area
            landed = [first_shot.landed(self.problem, shot, g)[0] / area for g in range(self.n_groups)]
            self.direct = np.stack([np.repeat(power, HALVES, axis=0).ravel() for power in landed])
        if self.done == 0:
            self._warm_up()
        spans = max(float(self.spans.ends_per_line.sum()) / 2, 1e-3) * self.iteration * self.halves
        batch = max(1, round(BATCH / spans)) * self.iteration
        while self.done < lines_of_half(quanta):
            self._check()
            swept(self._gather(min(batch - self.done % batch, lines_of_half(quanta) - self.done)))

    @property
    def source(self) -> np.ndarray:
        """The radiosity before any reflection along global lines, in `units`, (n_groups, halves * n_patches)."""
        return (self.emission if self.direct is None else self.rho * self.direct) / self.units[:, None]

    def _warm_up(self) -> None:
        """Solve for what the first lines of each half see.

        Without it the iteration would begin at zero, and need 1 / (1 - reflectance) times its memory to forget that.
        """
        ends = Ends.of(self._drawn(0, min(self.memory, max(1, WARM // self.halves // self.iteration)) * self.iteration), self.n)
        self.recent_ends = ends.number(self.recent_ends.size).astype(float)
        area = np.tile(self.geometry.patches.area, self.halves)
        # for each group: the total power that a radiosity in proportion to reflectance would still have to send and absorb
        balance = ((self.rho - self.rho * self._mean(ends.received(self.rho))) @ area)[:, None]
        settled = SETTLED * (1 - np.average(self.rho, axis=1, weights=area))
        self.carried = self.source.copy()
        for _ in range(SWEEPS):
            self.recent = ends.received(self.carried)
            change = self.source + self.rho * self._mean(self.recent) - self.carried
            # add at once as much of it as balances the power: the steps then only find how it is distributed
            change += self.rho * ((change @ area)[:, None] / np.maximum(balance, 1e-300))
            self.carried = self.carried + change
            if (np.abs(change) @ area <= settled * (self.carried @ area)).all():
                break
        self.carried = np.round(self.carried)

    def _mean(self, received: np.ndarray) -> np.ndarray:
        """Return means over the recent ends from sums, (n_groups, halves * n_patches).

        Patches without ends take the mean of their face.
        """
        shape = (self.n_groups, self.halves, self.n)
        return means(received.reshape(shape), self.recent_ends.reshape(shape[1:]), self.sides).reshape(received.shape)

    def _drawn(self, first: int, count: int) -> list[Pairs]:
        """Draw the spans of each half of each replicate."""
        return [self.spans.draw(half, first, count) for half in range(self.halves)]

    def _gather(self, count: int) -> int:
        """Gather along the next lines of each half, and return the number of their ends."""
        drawn, step, ends_before, at = self._drawn(self.done, count), self.iteration, int(self.ends.sum()), 0
        for half, pairs in enumerate(drawn):
            here = slice(half * self.n, (half + 1) * self.n)
            for near, far in ((pairs.one, pairs.other), (pairs.other, pairs.one)):
                for code, counts in ((ESCAPED, self.escaped), (LOST, self.lost)):
                    counts[here] += np.bincount(near[far == code], minlength=self.n)
        while at < count:
            length = min(step - (self.done + at) % step, count - at)
            batch = Ends.of([of_lines(pairs, at, at + length) for pairs in drawn], self.n)
            # a half carries what the other half has found
            ends, received = batch.number(self.ends.size), batch.received(self._exchanged(self.carried)).astype(np.int64)
            self.ends += ends
            self.received += received
            # an incomplete iteration is kept until the rest of it is traced
            self.fresh += received
            self.fresh_ends += ends
            at += length
            if (self.done + at) % step == 0:
                self.recent += self.fresh
                self.recent_ends += self.fresh_ends
                self.fresh[:], self.fresh_ends[:] = 0, 0
                self.carried = np.round(self.source + self.rho * self._mean(self.recent))
                kept = 1 - 1 / max(self.memory, (self.done + at) // step // SHARE)
                self.recent *= kept
                self.recent_ends *= kept
        self.done += count
        return int(self.ends.sum()) - ends_before

    def _check(self) -> None:
        """End the run before sums of 64 bits are full.

        Raises:
            Interrupted: they are.
        """
        if int(self.received.max(initial=0)) >= FULL:
            raise Interrupted(
                f"the sums of global lines are full after {self.done:,} lines of half a replicate; take more replicates, "
                "or local lines"
            )

    def _exchanged(self, values: np.ndarray) -> np.ndarray:
        """Return values with the two halves of each replicate exchanged."""
        return values.reshape(self.n_groups, self.replicates, HALVES, self.n)[:, :, ::-1].reshape(values.shape)

    def capture(self) -> PoolingState:
        return PoolingState(
            sizes=self.sizes,
            quanta=self._quanta,
            lines_done=self.done,
            replicates=self.replicates,
            shot=None if self.shot is None else self.shot.capture(),
            **{name: getattr(self, name).copy() for name in ARRAYS},
        )

    def read(self, arrays: Arrays, sizes: Sizes) -> PoolingState:
        return first_shot.read(PoolingState, arrays, sizes, shot=self.shot is not None, lacks="the sums of its iterations")

    def restore(self, state: PoolingState) -> None:
        for name in ARRAYS:
            setattr(self, name, getattr(state, name).copy())
        self._quanta, self.done = state.quanta, state.lines_done
        if self.shot is not None and state.shot is not None:
            self.shot.restore(state.shot)

    @property
    def tally(self) -> Pooled:
        return Pooled()
