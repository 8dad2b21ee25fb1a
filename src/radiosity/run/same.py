"""The check that a solution is of the same run, so that a run may go on from it."""

from ..errors import MethodError

OLDER = {"randomisation": "shared"}  # the choices of solutions written before there was a choice
SAME = ("scene", "cut", "seed", "replicates", "device", "tracing")  # equal kinds of device give equal bits


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
