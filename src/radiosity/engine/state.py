"""The integers of a run between two sweeps: all that is needed to go on, on this or a like machine (contract 6)."""

import numpy as np

from ..errors import MethodError
from .device import upload

SAME = ("scene", "choices", "seed", "replicates")


def capture(engine) -> dict[str, np.ndarray]:
    """Copy an engine's counters to the host.

    Keys: quanta, arrivals and fired (replicates, n_patches), missed (2, replicates); where bands differ also received,
    before (groups, replicates, n_patches), received_missed (groups, 2, replicates), arrivals_before, quanta_before and
    fired_power (groups, replicates; decimal text, for it may need more than 64 bits).
    """
    arrivals, fired, missed = engine.counters()
    state = {"quanta": np.array(engine.quanta), "arrivals": arrivals, "fired": fired, "missed": missed}
    bands = engine.bands
    if bands is None:
        return state
    shape = (engine.replicates, engine.n)
    received = np.stack([np.array(a) for a in bands.received])
    return state | {
        "received": received[:, : engine.total].reshape(-1, *shape),
        "received_missed": received[:, engine.total :].reshape(-1, 2, engine.replicates),
        "before": np.stack([np.array(a).reshape(shape) for a in bands.before]),
        "arrivals_before": np.array(bands.arrivals_before).reshape(shape),
        "quanta_before": np.array(bands.quanta_before),
        "fired_power": bands.fired.astype(str),
    }


def restore(engine, state: dict[str, np.ndarray]) -> None:
    """Put counters back, at the state's number of quanta.

    Raises:
        MethodError: the state is empty or of another shape.
    """
    wanted = {"quanta", "arrivals", "fired", "missed"}
    if engine.bands is not None:
        wanted |= {"received", "received_missed", "before", "arrivals_before", "quanta_before", "fired_power"}
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
        bands.received = [
            upload(types.UInt64, np.concatenate([a.ravel(), b.ravel()]))
            for a, b in zip(state["received"], state["received_missed"], strict=True)
        ]
        bands.before = [upload(types.UInt64, a) for a in state["before"]]
        bands.arrivals_before = upload(types.UInt32, state["arrivals_before"])
        bands.quanta_before = int(state["quanta_before"])
        bands.fired = np.array([[int(x) for x in row] for row in state["fired_power"]], object)
    engine.set_quanta(int(state["quanta"]))


def check_same(before: dict, now: dict) -> None:
    """Refuse to go on from a run of another scene, method, seed or number of replicates, by their provenance.

    Raises:
        MethodError: what differs.
    """
    different = [f"{key} ({before.get(key)} then, {now[key]} now)" for key in SAME if before.get(key) != now[key]]
    versions = before.get("versions", {})
    different += [f"{name} {versions.get(name)} then, {v} now" for name, v in now["versions"].items() if versions.get(name) != v]
    if different:
        raise MethodError(f"cannot go on from that solution: {'; '.join(different)}")
