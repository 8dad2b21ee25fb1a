"""The integers of a run between two sweeps: all that is needed to go on, on this or a like machine (contract 6)."""

import numpy as np

from ...device.backend import frozen, upload
from ...errors import MethodError

OLDER = {"randomisation": "shared"}  # of solutions written before there was a choice
SAME = ("scene", "cut", "seed", "replicates", "device", "tracing")  # like devices give like bits


def capture(engine) -> dict[str, np.ndarray]:
    """An engine's counters on the host, as they are now.

    Keys: quanta, arrivals and fired (replicates, n_patches), missed (2, replicates). Where bands differ also received
    and sent (replicates, n_patches, groups), received_missed (2, replicates, groups) and fired_power (groups, replicates); and,
    within a stage, the key within.
    """
    arrivals, fired, missed = engine.counters()
    state = {"quanta": np.array(engine.quanta), "arrivals": arrivals, "fired": fired, "missed": missed}
    bands = engine.bands
    if bands is None:
        return state
    received = frozen(bands.received)
    split, shape = engine.total * bands.n, (engine.replicates, engine.n)
    state["received"] = received[:split].reshape(*shape, bands.n)
    state["received_missed"] = received[split:].reshape(2, engine.replicates, bands.n)
    state["sent"] = frozen(bands.sent).reshape(*shape, bands.n)
    state["fired_power"] = frozen(bands.fired).reshape(bands.n, engine.replicates)
    if engine.has_due:
        state["within"] = np.array(True)
    return state


def restore(engine, state: dict[str, np.ndarray]) -> None:
    """Put counters back, at the state's number of quanta.

    Raises:
        MethodError: the state is empty or of another shape.
    """
    wanted = {"quanta", "arrivals", "fired", "missed"}
    if engine.bands is not None:
        wanted |= {"received", "received_missed", "sent", "fired_power"}
    missing = sorted(wanted - set(state))
    if missing or state["arrivals"].shape != (engine.replicates, engine.n):
        raise MethodError(
            f"the solution to go on from lacks the integers of its run ({', '.join(missing) or 'other sizes'}); start anew"
        )
    types = engine.types
    engine.arrivals = upload(types.UInt32, np.concatenate([state["arrivals"].ravel(), state["missed"].ravel()]))
    engine.fired = upload(types.UInt32, state["fired"])
    bands = engine.bands
    if bands is not None:
        bands.received = upload(types.UInt64, np.concatenate([state["received"].ravel(), state["received_missed"].ravel()]))
        bands.sent = upload(types.UInt64, state["sent"])
        bands.fired = upload(types.UInt64, state["fired_power"])
    engine.set_quanta(int(state["quanta"]))


def check_same(before: dict, now: dict) -> None:
    """Refuse to go on from a run of another scene, method, seed or number of replicates, by their provenance.

    Raises:
        MethodError: what differs.
    """
    choices, chosen = OLDER | (before.get("choices") or {}), now["choices"]
    different = [f"{key} ({before.get(key)} then, {now[key]} now)" for key in SAME if before.get(key) != now[key]]
    different += [f"{key} ({choices.get(key)} then, {value} now)" for key, value in chosen.items() if choices.get(key) != value]
    versions = before.get("versions", {})
    different += [f"{name} {versions.get(name)} then, {v} now" for name, v in now["versions"].items() if versions.get(name) != v]
    if different:
        raise MethodError(f"cannot go on from that solution: {'; '.join(different)}")
