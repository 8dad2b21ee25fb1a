"""Runs of other replicates of one seed, put together to one run with all of them (contract 16)."""

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from itertools import pairwise

from ..algorithms.in_parts import in_parts
from ..device.memory import limited
from ..device.turn import turn
from ..errors import MethodError
from ..method import Baseline, Method
from ..sampling.streams import Seed
from ..solution.model import Solution
from .budget import Budget
from .part import Part
from .same import SAME, differences
from .whole_number import whole

FACTS = tuple(key for key in SAME if key not in ("replicates", "first_replicate", "all_replicates"))

APART = "the meshes of one scene, which follow the light (solve all on the same patches, or adapt with the same number and seed)"


def merge(solutions: Iterable[Solution], *, memory: str | float | None = None) -> Solution:
    """Put solutions together that have other replicates of one seed, such as from other processes or machines.

    The result is that of one run with all replicates and as many quanta, to the bit: values, errors, hits, rays and energy
    balance. It can be saved, gone on from and merged on.

    Args:
        solutions: in any order, of the same scene, cut, method, seed, quanta, kind of device and versions. Their replicates
            follow each other: ``solve(..., quanta=N, replicates=4)`` and ``solve(..., quanta=N, replicates=4,
            first_replicate=4)``. Where results depend on stages (several bands by counts, fractional absorption, iterations, a
            first shot), each needs ``all_replicates`` as well, so that all climb the stages of the whole run.
        memory: the limit, as of `solve`.

    Returns:
        The merged solution. ``seconds`` is the sum of all.

    Raises:
        MethodError: replicates overlap or leave a gap, solutions differ, one is unfinished, or the method's replicates are not
            independent (pooled global lines, progressive, hierarchical, iterations with a warm-up).

    Example:
        >>> patches = rd.subdivide(rd.load_scene("room"), cells=2)
        >>> parts = [rd.solve(patches, quanta=4096, replicates=4, first_replicate=first) for first in (0, 4)]
        >>> merged = rd.merge(parts)
        >>> merged.replicates, bool((merged.irradiance == rd.solve(patches, quanta=4096, replicates=8).irradiance).all())
        (8, True)
    """
    if not isinstance(solutions, Iterable):
        raise MethodError(f"merge takes a list of Solutions, not a {type(solutions).__name__}")
    given = list(solutions)
    for at, solution in enumerate(given, 1):
        if not isinstance(solution, Solution):
            raise MethodError(
                f"merge takes Solutions, and number {at} is a {type(solution).__name__}; load files with load_solution"
            )
    if not given:
        raise MethodError("merge: there is no solution; give one or more")
    with limited(memory), turn():
        return _merged(given)


def _merged(given: list[Solution]) -> Solution:
    parts = [_part(at, solution) for at, solution in enumerate(given, 1)]
    for at, solution in enumerate(given[1:], 2):
        here, there = f"in solution {at}", "in solution 1"
        different = differences(solution.provenance, given[0].provenance, FACTS, (here, there))
        if solution.quanta != given[0].quanta:
            different.append(f"quanta ({solution.quanta} {here}, {given[0].quanta} {there})")
        if different:
            if _cut_apart(solution, given[0]):
                different.insert(0, APART)
            raise MethodError(f"cannot merge solutions that differ: {'; '.join(different)}. Solve all with the same, and quanta=")
    order = sorted(range(len(given)), key=lambda at: parts[at].first)
    for one, other in pairwise(order):
        _check_follows(one + 1, parts[one], other + 1, parts[other])
    parts, given = [parts[at] for at in order], [given[at] for at in order]
    first, quanta = given[0], given[0].quanta
    from .record import Record
    from .run import Run

    device = first.provenance.get("device", "auto")
    aim = first.provenance.get("importance")
    record = Record if aim is None else partial(Record, importance=(aim, first.provenance["importance_lines"]))
    run = Run(first.patches, _method(first), _budget(given), _whole(parts), device, record=record)
    for solution in given:
        different = differences(solution.provenance, run.record.provenance, FACTS, ("then", "now"))
        if different:
            raise MethodError(f"cannot merge solutions of another program or scene: {'; '.join(different)}; solve them anew")
    merged = run.merged(quanta, [(solution.state, part) for solution, part in zip(given, parts, strict=True)])
    told = dict.fromkeys(text for solution in given for text in solution.warnings)
    return replace(merged, seconds=sum(solution.seconds for solution in given), warnings=tuple(told))


def _cut_apart(one: Solution, other: Solution) -> bool:
    """Return whether two meshes follow the light of one scene, and are not the same."""
    scene, of = one.patches.scene, other.patches.scene
    return scene.cut is not None and of.cut is not None and scene.cut.whole == of.cut.whole and scene.hash != of.hash


def _part(at: int, solution: Solution) -> Part:
    """Which replicates a solution has, by its provenance."""
    facts = solution.provenance
    if solution.quanta == 0 or not solution.state:
        what = "has no results yet" if solution.quanta == 0 else "holds no integers of its run"
        raise MethodError(f"merge: solution {at} {what}; go on with it to the end (resume), or solve it anew")
    if in_parts(solution.state):
        raise MethodError(f"merge: solution {at} is within a stage, as a cluster left it; go on with it to the end (resume)")
    seed = Seed(whole(facts.get("seed"), "seed", 0), whole(facts.get("first_replicate", 0), "first_replicate", 0))
    in_all = facts.get("all_replicates")
    return Part(seed, solution.replicates, None if in_all is None else whole(in_all, "all_replicates", 1))


def _check_follows(at: int, part: Part, other: int, next_part: Part) -> None:
    if next_part.first == part.end:
        return
    what = "overlap" if next_part.first < part.end else "leave a gap"
    raise MethodError(
        f"cannot merge solutions whose replicates {what}: solution {at} has {part.range}, solution {other} has "
        f"{next_part.range}; solve the later one with first_replicate={part.end}"
    )


def _whole(parts: list[Part]) -> Part:
    """All replicates."""
    known, count = {part.in_all for part in parts}, sum(part.replicates for part in parts)
    return Part(parts[0].seed, count, known.pop() if len(known) == 1 else None)


def _budget(solutions: list[Solution]) -> Budget:
    """The one that all were given, where these were quanta; else those that they came to."""
    asked = [solution.provenance.get("budget") for solution in solutions]
    same = all(budget == asked[0] for budget in asked) and isinstance(asked[0], dict) and set(asked[0]) == {"quanta"}
    return Budget(**asked[0]) if same and asked[0] is not None else Budget(quanta=solutions[0].quanta)


def _method(solution: Solution) -> Method | Baseline:
    choices = solution.provenance.get("choices")
    try:
        return (Baseline if solution.by_baseline else Method)(**dict(choices or {}))
    except TypeError:
        raise MethodError(f"merge: choices {choices!r} are no method of this version; solve the parts anew") from None
