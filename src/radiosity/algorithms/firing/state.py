"""The integers of a run between two wavefronts: all that is needed to continue, on this or a similar machine (contract 6)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...device.backend import frozen, upload
from ...errors import MethodError
from ...tally.bands import BandTally
from ..consistent import check_ends
from ..state import COUNTS, AbstractState, Arrays, Record, Sizes, array, number, part
from .counters import FiringCounters
from .powers_sent import check_sent


@dataclass(frozen=True, eq=False, kw_only=True)
class BandState(Record):
    """Powers of bands, where they differ, uint64 in fixed point (`BandTally`).

    Attributes:
        received, sent: (replicates, n_rows, groups), received and sent power, modulo 2^64.
        received_missed: (2, replicates, groups), escaped and lost power, modulo 2^64.
        fired_power: (groups, replicates), power that left along lines, modulo 2^64.
        received_upper, received_missed_upper, sent_upper, fired_power_upper: uint32, the upper words of these, where some are not
            zero.
        within: True within a stage.
        wavefront_arrivals, wavefront_weights: (replicates, n_rows) and (replicates, n_rows, groups) uint32, within a wavefront
            that is fired in parts: the hit counts when it began, and what its lines carry.
    """

    received: np.ndarray = array("replicates", "rows", "groups", kinds=COUNTS)
    received_missed: np.ndarray = array(2, "replicates", "groups", kinds=COUNTS)
    sent: np.ndarray = array("replicates", "rows", "groups", kinds=COUNTS)
    fired_power: np.ndarray = array("groups", "replicates", kinds=COUNTS)
    received_upper: np.ndarray | None = array("replicates", "rows", "groups", optional=True, zeros=True, kinds=COUNTS)
    received_missed_upper: np.ndarray | None = array(2, "replicates", "groups", optional=True, zeros=True, kinds=COUNTS)
    sent_upper: np.ndarray | None = array("replicates", "rows", "groups", optional=True, zeros=True, kinds=COUNTS)
    fired_power_upper: np.ndarray | None = array("groups", "replicates", optional=True, zeros=True, kinds=COUNTS)
    within: bool | None = number(bool, optional=True)
    wavefront_arrivals: np.ndarray | None = array("replicates", "rows", optional=True, kinds=COUNTS)
    wavefront_weights: np.ndarray | None = array("replicates", "rows", "groups", optional=True, kinds=COUNTS)


@dataclass(frozen=True, eq=False, kw_only=True)
class FiringState(AbstractState):
    """The counters on the host.

    Attributes:
        arrivals, fired: (replicates, n_rows), hit and fired counts, uint32 where that suffices, else uint64.
        missed: (2, replicates), lines that escaped and were lost, uint32 or uint64.
        bands: powers, where bands differ.
    """

    splits_within = True

    arrivals: np.ndarray = array("replicates", "rows", kinds=COUNTS)
    fired: np.ndarray = array("replicates", "rows", kinds=COUNTS)
    missed: np.ndarray = array(2, "replicates", kinds=COUNTS)
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
        powers = BandState(sizes=sizes, within=True if counters.has_due else None, **_powers(bands, sizes))
    return FiringState(sizes=sizes, quanta=counters.quanta, arrivals=arrivals, fired=fired, missed=missed, bands=powers)


def _powers(bands: BandTally, sizes: Sizes) -> dict[str, Any]:
    """Return the powers of bands by the names that a state has."""
    replicates, rows, n = sizes.replicates, sizes.rows, sizes.groups
    shapes = {"received": (replicates, rows, n), "received_missed": (2, replicates, n), "sent": (replicates, rows, n)}
    flat, split, columns = frozen(bands.received), replicates * rows * n, bands.columns
    low = {"received": flat[:split], "received_missed": flat[split:], "sent": frozen(bands.sent)}
    found: dict[str, Any] = {}
    for name, key in zip(shapes, ("received", "missed", "sent"), strict=True):
        upper = bands.upper[key].read(columns[key])
        found[name] = low[name].reshape(shapes[name])
        found[f"{name}_upper"] = None if upper is None else upper.reshape(shapes[name])
    if bands.parted:
        found["wavefront_arrivals"] = frozen(bands.arrivals_before).reshape(replicates, rows)
        found["wavefront_weights"] = frozen(bands.weights).reshape(replicates, rows, n)
    fired = bands.fired_in_all
    words = [np.array([(power >> shift) % 2**64 for power in fired], np.uint64).reshape(n, replicates) for shift in (0, 64)]
    return found | {"fired_power": words[0], "fired_power_upper": words[1].astype(np.uint32) if words[1].any() else None}


def read(arrays: Arrays, sizes: Sizes, weighed: bool) -> FiringState:
    """Return the state from arrays; see `AbstractAlgorithm.read`. ``weighed`` as of `SourceRows`."""
    wanted = ("bands",) if weighed else ()
    lacking = FiringState.lacking(arrays, sizes, wanted)
    if lacking:
        raise MethodError(f"the solution to go on from lacks the integers of its run ({lacking}); start anew")
    state = FiringState.read(arrays, sizes, wanted)
    check_ends(state.arrivals, state.fired, state.missed)
    return state


def restore(counters: FiringCounters, state: FiringState) -> None:
    """Set the counters to those of a state, at its number of quanta.

    Raises:
        MethodError: powers of bands and lines of the state do not belong together.
    """
    types, bands = counters.types, counters.bands
    counters.hits.write(state.arrivals, state.missed)
    counters.fired = upload(types.UInt32, counters.fired_upper.of(state.fired))
    if bands is not None:
        powers = state.bands
        assert powers is not None
        rows = bands.upper["received"].of(powers.received, powers.received_upper)
        missed = bands.upper["missed"].of(powers.received_missed, powers.received_missed_upper)
        bands.received = upload(types.UInt64, np.concatenate([rows, missed]))
        bands.sent = upload(types.UInt64, bands.upper["sent"].of(powers.sent, powers.sent_upper))
        bands.set_fired(np.ravel(powers.fired_power), powers.fired_power_upper)
        before, weights = powers.wavefront_arrivals, powers.wavefront_weights
        bands.parted = before is not None and weights is not None
        if before is not None and weights is not None:
            bands.arrivals_before = upload(types.UInt32, np.ravel(before))
            bands.weights = upload(types.UInt32, np.ravel(weights))
    counters.set_quanta(state.quanta)
    if state.bands is not None:
        check_sent(counters, state.bands)
