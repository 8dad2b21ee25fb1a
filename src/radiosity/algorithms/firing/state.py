"""The integers of a run between two sweeps: all that is needed to go on, on this or a like machine (contract 6)."""

import numpy as np

from ...device.backend import frozen, upload
from ...errors import MethodError
from .counters import FiringCounters


def capture(counters: FiringCounters) -> dict[str, np.ndarray]:
    """Counters on the host, as they are now.

    Keys: quanta, arrivals and fired (replicates, n_patches), missed (2, replicates). Where bands differ also received
    and sent (replicates, n_patches, groups), received_missed (2, replicates, groups) and fired_power (groups, replicates); and,
    within a stage, the key within.
    """
    arrivals, fired, missed = counters.counters()
    state = {"quanta": np.array(counters.quanta), "arrivals": arrivals, "fired": fired, "missed": missed}
    bands = counters.bands
    if bands is None:
        return state
    received = frozen(bands.received)
    split, shape = counters.total * bands.n, (counters.tracer.replicates, counters.tracer.n)
    state["received"] = received[:split].reshape(*shape, bands.n)
    state["received_missed"] = received[split:].reshape(2, counters.tracer.replicates, bands.n)
    state["sent"] = frozen(bands.sent).reshape(*shape, bands.n)
    state["fired_power"] = frozen(bands.fired).reshape(bands.n, counters.tracer.replicates)
    if counters.has_due:
        state["within"] = np.array(True)
    return state


def restore(counters: FiringCounters, state: dict[str, np.ndarray]) -> None:
    """Put counters back, at the state's number of quanta.

    Raises:
        MethodError: the state is empty or of another shape.
    """
    wanted = {"quanta", "arrivals", "fired", "missed"}
    if counters.bands is not None:
        wanted |= {"received", "received_missed", "sent", "fired_power"}
    missing = sorted(wanted - set(state))
    if missing or state["arrivals"].shape != (counters.tracer.replicates, counters.tracer.n):
        raise MethodError(
            f"the solution to go on from lacks the integers of its run ({', '.join(missing) or 'other sizes'}); start anew"
        )
    types = counters.types
    counters.hits.write(state["arrivals"], state["missed"])
    counters.fired = upload(types.UInt32, state["fired"])
    bands = counters.bands
    if bands is not None:
        bands.received = upload(types.UInt64, np.concatenate([state["received"].ravel(), state["received_missed"].ravel()]))
        bands.sent = upload(types.UInt64, state["sent"])
        bands.fired = upload(types.UInt64, state["fired_power"])
    counters.set_quanta(int(state["quanta"]))
