"""Patch i fires c_i lines that carry what they are told to: the primitive that iterations are made of.

The k-th line of a patch is a function of (seed, replicate, patch, k), counted over the whole run, as in contract 2; where there
are several sequences, each counts its own lines and has points of its own, independent of the others'. What is
received is summed in 64-bit fixed point, so no sum depends on an order or on threads. Numbers of patches and slots are those
of `firing`: replicate r of patch i is r n + i; then two slots a replicate, for lines escaped and lines lost.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import frozen, upload
from ...method import Method
from ...problem.quanta import Source
from ...sampling.streams import Purpose, stream
from ...tally.hit_tally import DENSE
from ...tracing.geometry import Geometry
from ...tracing.lanes import Batch, Launch
from ..firing.counters import FEW, Engine

Pairs = Callable[[np.ndarray, np.ndarray], None]


@dataclass(frozen=True)
class Ends:
    """What both ends of a line from i to j score: j ``carried_i`` / (``density_i`` + ``density_j``), and i the same of j.

    Attributes:
        density: (slots,) Float, expected lines of each patch by its area, any unit; positive where it fires; 0 behind patches.
        carried: (slots * n_groups,) Float, the power by area, in fixed point units times the unit of density; 0 behind patches.
    """

    density: Any
    carried: Any


class Shooter:
    """Counters of lines, and the kernel that fires them.

    Attributes:
        engine: an `Engine` of which ``arrivals`` and ``fired`` are used, and what knows lines.
        received: (slots * n_groups,) Int64, of the last shot, group g of slot s at s * n_groups + g.
    """

    def __init__(
        self, geometry: Geometry, source: Source, method: Method, seed: int, replicates: int, n_groups: int, sequences: int = 1
    ):
        self.engine = Engine(geometry, source, method, seed, replicates)
        self.types, self.total, self.groups = self.engine.types, self.engine.total, n_groups
        self.slots = self.total + 2 * replicates
        self.received = dr.opaque(self.types.Int64, 0, self.slots * n_groups) if n_groups else None
        self.sequence, self._randomisations, self._fired = 0, [self.engine.randomisation], [self.engine.fired]
        for more in range(1, sequences):
            streams = [stream(seed, r, Purpose.SEQUENCE, more) for r in range(replicates)]
            drawn = [self.engine.numbers.randomisation(one) for one in streams]
            self._randomisations.append(upload(self.types.UInt32, np.array(drawn, np.uint32)))
            self._fired.append(dr.opaque(self.types.UInt32, 0, self.total))

    def take(self, sequence: int) -> None:
        """Fire lines of this sequence from now on."""
        self._fired[self.sequence] = self.engine.fired
        self.engine.fired, self.engine.randomisation = self._fired[sequence], self._randomisations[sequence]
        self.sequence = sequence

    def shoot(self, counts, weights=None, ends: Ends | None = None, pairs: Pairs | None = None) -> int:
        """Fire, and return how many lines that were.

        Args:
            counts: (total,) UInt32, lines of each patch number now.
            weights: (total * n_groups,) Int32, what each of them brings to where it lands.
            ends: what lines bring to both ends, in place of ``weights``.
            pairs: called for every launch with patch numbers and the slots where their lines landed, (m,) uint32 each; they
                may be looked at until it returns.
        """
        types, engine = self.types, self.engine
        if self.groups:
            self.received = dr.opaque(types.Int64, 0, self.slots * self.groups)
        dr.eval(counts, weights)
        rows: Any = dr.compress(counts > 0)
        if dr.width(rows) == 0:
            return 0
        columns = dr.gather(types.UInt32, counts, rows), dr.gather(types.UInt32, engine.fired, rows)
        largest = dr.max(columns[0] + columns[1])
        batch = Batch.of(types, rows, *columns, engine.record)
        # launches of few lines share one kernel, whatever their indices
        bits = engine.numbers.bits_for(int(largest[0]))
        mode = dr.ReduceMode.Expand if batch.total > DENSE * self.total else dr.ReduceMode.Direct
        for launch in batch.launches(types):
            self._fire(launch, 32 if batch.total <= FEW else bits, weights, ends, pairs, mode)
        dr.scatter(engine.fired, batch.fired + batch.counts, batch.numbers, active=batch.counts > 0)
        dr.eval(engine.fired)
        return batch.total

    def _fire(self, launch: Launch, bits: int, weights, ends: Ends | None, pairs: Pairs | None, mode) -> None:
        types, engine = self.types, self.engine
        number, index, record = launch.read(types)
        landed = engine.trace(number, index, record, bits)
        real = launch.mask(types)
        dr.scatter_add(engine.arrivals, types.UInt32(1), landed, active=real, mode=mode)
        for g in range(self.groups):
            here, there = number * self.groups + g, landed * self.groups + g
            if ends is None:
                self._add(types.Int64(dr.gather(types.Int, weights, here)), there, real, mode)
                continue
            both = dr.gather(types.Float, ends.density, number) + dr.gather(types.Float, ends.density, landed)
            forth, back = (dr.gather(types.Float, ends.carried, at) / both for at in (here, there))
            self._add(types.Int64(dr.round(forth)), there, real, mode)
            self._add(types.Int64(dr.round(back)), here, real, mode)
        if pairs is not None:
            dr.schedule(number, landed)
        dr.eval(engine.arrivals, self.received)
        if pairs is not None:
            pairs(frozen(number)[: launch.lanes], frozen(landed)[: launch.lanes])

    def _add(self, value, index, real, mode) -> None:
        dr.scatter_add(self.received, value, index, active=real, mode=mode)

    def capture(self) -> dict[str, np.ndarray]:
        """arrivals and fired (replicates, n_patches), missed (2, replicates); where there are several sequences
        fired_apart, (sequences, replicates, n_patches), of which fired is the sum."""
        arrivals, fired, missed = self.engine.counters()
        if len(self._fired) == 1:
            return {"arrivals": arrivals, "fired": fired, "missed": missed}
        self.take(self.sequence)
        apart = np.stack([np.array(column).reshape(fired.shape) for column in self._fired])
        return {"arrivals": arrivals, "fired": apart.sum(axis=0, dtype=np.uint32), "missed": missed, "fired_apart": apart}

    def restore(self, state: dict[str, np.ndarray]) -> None:
        """Put captured counters back."""
        self.engine.arrivals = upload(self.types.UInt32, np.concatenate([state["arrivals"].ravel(), state["missed"].ravel()]))
        self._fired = [upload(self.types.UInt32, column) for column in state.get("fired_apart", state["fired"][None])]
        self.engine.fired = self._fired[self.sequence]
