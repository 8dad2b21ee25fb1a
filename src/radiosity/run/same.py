"""The check that a solution is of the same run, so that a run may go on from it."""

from ..errors import MethodError

OLDER = {"randomisation": "shared", "basis": "constant", "padding": "shuffled"}  # of solutions written before there was a choice
# like devices, like bits; a line set has a geometry and sources in place of a scene: its light does not matter
SAME = (
    "scene",
    "geometry",
    "sources",
    "cut",
    "seed",
    "replicates",
    "first_replicate",
    "all_replicates",
    "device",
    "tracing",
    "importance",
)
WHOLE = {"first_replicate": 0}  # where nothing is said


def check_same(before: dict, now: dict, what: str = "solution") -> None:
    """Refuse to go on from a run of another scene, method, seed or number of replicates, by their provenance.

    Raises:
        MethodError: what differs.
    """
    different = differences(before, now, SAME, ("then", "now"))
    if different:
        raise MethodError(f"cannot go on from that {what}: {'; '.join(different)}")


def differences(before: dict, now: dict, keys: tuple[str, ...], when: tuple[str, str]) -> list[str]:
    """What differs between the provenances of two runs, in words; ``when`` says which is which."""
    one, other = WHOLE | before, WHOLE | now
    then, here = when
    different = [f"{key} ({one.get(key)} {then}, {other.get(key)} {here})" for key in keys if one.get(key) != other.get(key)]
    choices, chosen = OLDER | (before.get("choices") or {}), now.get("choices") or {}
    different += [
        f"{key} ({choices.get(key)} {then}, {value} {here})" for key, value in chosen.items() if choices.get(key) != value
    ]
    versions, versions_now = before.get("versions") or {}, now.get("versions") or {}
    different += [
        f"{name} {versions.get(name)} {then}, {v} {here}" for name, v in versions_now.items() if versions.get(name) != v
    ]
    return different
