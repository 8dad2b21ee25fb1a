"""Global multipath (Sbert, Pueyo, Neumann, Purgathofer 1996): power waits on patches for the next line that crosses them.

Of L lines a patch expects L e_i span ends, e_i = A_i / (2 pi R^2). The paper fixes L, lets a patch emit E_i A_i / (L e_i) at
each end, and adds up powers. All of that is proportional to 1 / L: so here a patch emits E_i A_i / e_i at each end, and sums are
divided by L when they are read. Then L need not be known beforehand, a run may go on from where it is, and what it holds after L
lines is what the paper's method gives for L, to the bit. `docs/global-lines.md` has more.
"""

from math import ceil

import numpy as np

from ...device.backend import frozen, upload
from ...problem.quanta import Source
from ...tally.wraps import Wraps
from ...tracing.global_lines.spans import ONE_WAY, Spans
from ..base import AbstractAlgorithm, Swept
from ..state import Arrays, Sizes
from . import first_shot
from .exchange import LEDGER, Exchange
from .first_shot import FirstShot
from .landed import Landed, unit
from .mixing import Mixed
from .state import MultipathState

SPANS = 1 << 27  # between two looks at sums: each brings 2^HIGHEST units at most
WARM_UP, MOST_WARM_UP = 4, 64  # span ends of a mean patch, the first times 1 / (1 - mean reflectance)
BATCH = 1 << 21  # spans of all replicates between two looks at the clock


class Multipath(AbstractAlgorithm[MultipathState]):
    """Global multipath. N is the number of global lines of a replicate (of spans, where they are drawn one by one).

    The number of all lines is proportional to N: each line has a fixed expected number of ends, and a first shot has its share of
    all.

    Without a first shot the state after N lines depends on N alone. With one, the first shot is made finer at each stage, from
    N/2 to N for example, and the global lines of that stage start from what it has left by then: an average, weighted by
    lines, of unbiased results.
    """

    def __init__(self, *arguments):
        super().__init__(*arguments)
        patches, groups, types = self.geometry.patches, self.problem.groups, self.geometry.device.types
        self.spans = Spans(self.geometry, self.method, self.seed, self.replicates)
        self.mixed = Mixed(self.spans)
        self.shot = None
        if self.method.first_shot:
            self.shot = FirstShot(self.geometry, self.problem, self.method, self.seed, self.replicates)
        self.n, self.total = len(patches), len(patches) * self.replicates
        self._quanta, self.done, self.unseen = 0, 0, 0
        self.ends = np.zeros((self.replicates, self.n), np.int64)
        self.ledger = [{name: [0] * self.replicates for name in LEDGER} for _ in range(groups.n_groups)]
        emitted = [self._fixed(groups.emission[:, g] * patches.area, g) for g in range(groups.n_groups)]
        self.exchanges = [
            Exchange(
                types,
                self.geometry.some_backs_pass,
                upload(types.UInt32, Source.fixed(groups.reflectance[:, g])),
                upload(types.UInt64, np.tile(emitted[g], self.replicates)),
                dr_zeros(types, self.total),
                dr_zeros(types, self.total),
                Wraps(types, 64),
            )
            for g in range(groups.n_groups)
        ]

    @property
    def quanta(self) -> int:
        return self._quanta

    @property
    def stage_independent(self) -> bool:
        return self.shot is None

    def advance(self, quanta: int, swept: Swept) -> None:
        self._quanta = quanta
        if self.shot is not None:
            self._shoot(quanta, swept)
        if self.done == 0:
            self._begin()
        while self.done < quanta:
            swept(self._carry(min(self._batch - self.done % self._batch, quanta - self.done)))

    @property
    def _batch(self) -> int:
        """The number of lines of a replicate between two looks at the clock: whole blocks."""
        spans_a_line = max(float(self.spans.ends_per_line.sum()) / 2, 1e-3)
        return max(1, round(BATCH / spans_a_line / self.replicates / self.mixed.block)) * self.mixed.block

    def _begin(self) -> None:
        """Put power on the patches, as much as they hold in the long run.

        It is first what they reflect of a uniform irradiance that balances what is emitted, and then what the first lines make of
        it. Without it, the power that patches hold would be missing from all sums: about 1 / (1 - rho) of the ends that a patch
        has had, three standard errors in the labyrinth of reflectance 0.9.
        """
        types, groups, area = self.geometry.device.types, self.problem.groups, self.geometry.patches.area
        for g, exchange in enumerate(self.exchanges):
            rho = groups.reflectance[:, g]
            source = frozen(exchange.source).reshape(self.replicates, self.n).astype(float)
            # one by one: a sum over all would differ in its last bits with the number of replicates
            mean = np.array([row @ area for row in source]) / float((1 - rho) @ area)
            exchange.unshot = upload(types.UInt64, np.floor(mean[:, None] * rho).astype(np.uint64))
        visits = WARM_UP / (1 - float(np.average(groups.reflectance.max(axis=1), weights=area)))
        lines = ceil(min(visits, MOST_WARM_UP) / float(self.spans.ends_per_line.mean()) / self.mixed.block) * self.mixed.block
        while self.done < lines:
            self._carry(min(self._batch, lines - self.done))
        self.done, self.ends[:] = 0, 0
        for exchange, ledger in zip(self.exchanges, self.ledger, strict=True):
            exchange.landed, exchange.upper = dr_zeros(types, self.total), Wraps(types, 64)
            ledger.update({name: [0] * self.replicates for name in LEDGER})

    def _shoot(self, quanta: int, swept: Swept) -> None:
        """Refine the first shot, and let patches emit what they reflect of it."""
        shot = self.shot
        assert shot is not None
        shot.fire(first_shot.lines_for(self.method.first_shot, quanta * float(self.spans.ends_per_line.sum())), swept)
        landed = shot.capture()
        for g, exchange in enumerate(self.exchanges):
            power, _ = first_shot.landed(self.problem, landed, g)
            source = self._fixed(power * self.problem.groups.reflectance[:, g], g)
            exchange.source = upload(self.geometry.device.types.UInt64, source)

    def _carry(self, count: int) -> int:
        """Carry power along the next lines of each replicate, and return the number of their ends."""
        drawn = [self.mixed.draw(replicate, self.done, count) for replicate in range(self.replicates)]
        UInt32 = self.geometry.device.types.UInt32
        both = [np.concatenate([getattr(pairs, end) for pairs in drawn]) for end in ("one", "other")]
        before = int(self.ends.sum())
        for row, pairs in zip(self.ends, drawn, strict=True):
            for end in (pairs.one, pairs.other):
                row += np.bincount(end[end < ONE_WAY], minlength=self.n)
        lengths = np.array([len(pairs.one) for pairs in drawn])
        if lengths.any():
            one, other = (upload(UInt32, np.append(end, end[-1:])) for end in both)  # never one entry
            for exchange, ledger in zip(self.exchanges, self.ledger, strict=True):
                for name, sums in zip(LEDGER, exchange.run(one, other, lengths, self.n), strict=True):
                    ledger[name] = [old + int(new) for old, new in zip(ledger[name], sums, strict=True)]
            self.unseen += len(one)
            if self.unseen > SPANS:
                self.unseen = 0
                for exchange in self.exchanges:
                    exchange.upper.look(exchange.landed)
        self.done += count
        return int(self.ends.sum()) - before

    def _fixed(self, power: np.ndarray, group: int) -> np.ndarray:
        """Return what patches emit at each span end, in units, from their power, (..., n_patches) W or lm."""
        return np.round(power / self.spans.ends_per_line / unit(self.problem, self.spans.ends_per_line, group)).astype(np.uint64)

    def capture(self) -> MultipathState:
        shape = (len(self.exchanges), self.replicates, self.n)
        limbs = [[[divmod(x, 2**32) for x in ledger[name]] for name in LEDGER] for ledger in self.ledger]
        upper = [x.upper.read(x.landed) for x in self.exchanges]
        if any(one is not None for one in upper):
            above = np.stack([np.zeros(self.total, np.uint32) if one is None else one for one in upper]).reshape(shape)
        else:
            above = None
        return MultipathState(
            sizes=self.sizes,
            quanta=self._quanta,
            lines_done=self.done,
            ends=self.ends.copy(),
            ends_per_line=self.spans.ends_per_line,
            ledger=np.array(limbs, np.uint64),
            unshot=np.stack([frozen(x.unshot) for x in self.exchanges]).reshape(shape),
            landed=np.stack([frozen(x.landed) for x in self.exchanges]).reshape(shape),
            landed_upper=above,
            shot=None if self.shot is None else self.shot.capture(),
        )

    def read(self, arrays: Arrays, sizes: Sizes) -> MultipathState:
        return first_shot.read(MultipathState, arrays, sizes, shot=self.shot is not None, lacks="the sums of its multipath run")

    def restore(self, state: MultipathState) -> None:
        UInt64 = self.geometry.device.types.UInt64
        self._quanta, self.done, self.ends = state.quanta, state.lines_done, state.ends.astype(np.int64)
        for g, exchange in enumerate(self.exchanges):
            exchange.unshot = upload(UInt64, state.unshot[g])
            upper = None if state.landed_upper is None else state.landed_upper[g]
            exchange.landed = upload(UInt64, exchange.upper.of(state.landed[g], upper))
            self.ledger[g] = {
                name: [(int(high) << 32) + int(low) for high, low in rows]
                for name, rows in zip(LEDGER, state.ledger[g], strict=True)
            }
        if self.shot is not None and state.shot is not None:
            self.shot.restore(state.shot)

    @property
    def tally(self) -> Landed:
        return Landed()


def dr_zeros(types, width: int):
    """Return zeros to scatter into: `dr.zeros` would be a literal."""
    import drjit as dr

    return dr.opaque(types.UInt64, 0, width)
