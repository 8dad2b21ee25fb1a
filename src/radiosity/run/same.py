"""The checks that a run may go on from a solution: it is of the same run, and a longer run comes by its last stage."""

from ..errors import MethodError
from ..method import Baseline, Method
from ..problem.model import Problem
from .budget import on_ladder

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
    "packets",
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


def check_on_ladder(problem: Problem, method: Method | Baseline, quanta: int, rung: int) -> None:
    """Refuse to go on from N after which no longer run has a stage, where results depend on the stages.

    Raises:
        MethodError: why, and where runs that are to go on must end.
    """
    if on_ladder(quanta, rung):
        return
    kind = f"in {problem.groups.n_groups} groups of bands"
    if problem.rows.lines is not None:
        kind += ", with lines through openings,"
    raise MethodError(
        f"a run by {method} {kind} cannot go on from {quanta} quanta "
        "to the bits of one longer run: its results depend on its stages, and the last one was no power of two from "
        f"{rung} on. Start anew; runs to be continued end on such a number (quanta=, --quanta)"
    )


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
