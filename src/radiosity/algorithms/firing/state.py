"""The integers of a run between two wavefronts: all that is needed to continue, on this or a similar machine (contract 6)."""

from dataclasses import dataclass

import numpy as np

from ...device.backend import frozen, upload
from ...errors import MethodError
from ..state import AbstractState, Arrays, Record, Sizes, array, number, part
from .counters import FiringCounters


@dataclass(frozen=True, eq=False, kw_only=True)
class BandState(Record):
    """Powers of bands, where they differ, uint64 in fixed point (`BandTally`).

    Attributes:
        received, sent: (replicates, n_rows, groups), received and sent power.
        received_missed: (2, replicates, groups), escaped and lost power.
        fired_power: (groups, replicates), power that left along lines.
        within: True within a stage.
    """

    received: np.ndarray = array("replicates", "rows", "groups")
    received_missed: np.ndarray = array(2, "replicates", "groups")
    sent: np.ndarray = array("replicates", "rows", "groups")
    fired_power: np.ndarray = array("groups", "replicates")
    within: bool | None = number(bool, optional=True)


@dataclass(frozen=True, eq=False, kw_only=True)
class FiringState(AbstractState):
    """The counters on the host.

    Attributes:
        arrivals, fired: (replicates, n_rows) uint32, hit and fired counts.
        missed: (2, replicates) uint32, lines that escaped and were lost.
        bands: powers, where bands differ.
    """

    splits_within = True

    arrivals: np.ndarray = array("replicates", "rows")
    fired: np.ndarray = array("replicates", "rows")
    missed: np.ndarray = array(2, "replicates")
    bands: BandState | None = part(BandState, optional=True)

    @property
    def unfinished(self) -> bool:
        """True within a stage with bands. A stage of integers can continue from anywhere."""
        return self.bands is not None and bool(self.bands.within)


def capture(counters: FiringCounters) -> FiringState:
    """Return the counters as they are now."""
    arrivals, fired, missed = counters.counters()
    tracer, bands = counters.tracer, counters.bands
    sizes = Sizes(tracer.replicates, tracer.n, 1 if bands is None else bands.n)
    powers = None
    if bands is not None:
        received, split = frozen(bands.received), counters.total * bands.n
        powers = BandState(
            sizes=sizes,
            received=received[:split].reshape(*arrivals.shape, bands.n),
            received_missed=received[split:].reshape(2, tracer.replicates, bands.n),
            sent=frozen(bands.sent).reshape(*arrivals.shape, bands.n),
            fired_power=frozen(bands.fired).reshape(bands.n, tracer.replicates),
            within=True if counters.has_due else None,
        )
    return FiringState(sizes=sizes, quanta=counters.quanta, arrivals=arrivals, fired=fired, missed=missed, bands=powers)


def read(arrays: Arrays, sizes: Sizes, weighed: bool) -> FiringState:
    """Return the state from arrays; see `AbstractAlgorithm.read`. ``weighed`` as of `SourceRows`."""
    wanted = ("bands",) if weighed else ()
    lacking = FiringState.lacking(arrays, sizes, wanted)
    if lacking:
        raise MethodError(f"the solution to go on from lacks the integers of its run ({lacking}); start anew")
    return FiringState.read(arrays, sizes, wanted)


def restore(counters: FiringCounters, state: FiringState) -> None:
    """Set the counters to those of a state, at its number of quanta."""
    types, bands = counters.types, counters.bands
    counters.hits.write(state.arrivals, state.missed)
    counters.fired = upload(types.UInt32, state.fired)
    if bands is not None:
        powers = state.bands
        assert powers is not None
        bands.received = upload(types.UInt64, np.concatenate([powers.received.ravel(), powers.received_missed.ravel()]))
        bands.sent = upload(types.UInt64, powers.sent)
        bands.fired = upload(types.UInt64, powers.fired_power)
    counters.set_quanta(state.quanta)
