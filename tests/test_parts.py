"""Wavefronts of colours and steps of iterations that are fired in parts: the bits of whole ones, stopped after any part."""

from dataclasses import replace

import numpy as np
import pytest
from kills import assert_same

import radiosity as rd
from radiosity.algorithms.firing import due
from radiosity.algorithms.firing.orders import FIRED, depth_first
from radiosity.run import checkpoint as checkpoints
from radiosity.tally import shooter
from radiosity.tracing import parts

METHODS = {
    "walks": ("random-walk", {}),
    "Sobol": ("random-walk", {"numbers": "sobol"}),
    "ray": ("stochastic-ray", {}),
    "warm-up": ("stochastic-jacobi", {}),
    "incremental": ("stochastic-jacobi-incremental", {}),
    "both ends": ("stochastic-jacobi-bidirectional", {}),
    "control variate": ("stochastic-jacobi-control-variate", {}),
    "incremental control variate": ("stochastic-jacobi-incremental", {"control_variate": True}),
    "linear": ("stochastic-jacobi-control-variate", {"basis": "linear"}),
    "linear, incremental": ("stochastic-jacobi-incremental", {"basis": "linear"}),
    "refined lines": ("stochastic-jacobi", {"refine_lines": 1e-3}),
    "refined lines, both ends": ("stochastic-jacobi-bidirectional", {"refine_lines": 1e-3}),
}


@pytest.fixture(scope="module")
def coloured() -> rd.Patches:
    return rd.subdivide(rd.load_scene("cornell-box"), cells=2)


def most(monkeypatch, lines: int) -> None:
    """Fire so many lines at a time."""
    monkeypatch.setattr(parts, "MOST", {"cpu": (lines, lines), "cuda": (lines, lines)})


def states(patches: rd.Patches, method: str, path, **options) -> tuple[rd.Solution, list[rd.Solution]]:
    """A run's result, and a solution to go on from after each sweep."""
    kept = []
    keeper = checkpoints.Checkpoint(path, 0, lambda solution, _: kept.append(solution))
    return rd.solve(patches, method, checkpoint=keeper, **options), kept


def within(solution: rd.Solution) -> bool:
    """It was stopped between two parts."""
    return any(name.endswith(("shot_done", "wavefront_weights")) for name in solution.state)


@pytest.mark.parametrize("name", METHODS)
def test_parts_bring_what_the_whole_does_wherever_it_is_stopped(coloured, tmp_path, monkeypatch, name):
    method, options = METHODS[name]
    options = {"quanta": 1 << 15, "replicates": 2} | options
    whole = rd.solve(coloured, method, **options)
    most(monkeypatch, 1 << 11)
    monkeypatch.setattr(checkpoints, "TIMES", 0)
    parted, kept = states(coloured, method, tmp_path / "a.npz", **options)
    assert_same(parted, whole)
    between = [solution for solution in kept if within(solution)]
    assert len(between) > 4
    kept[0].save(tmp_path / "b.npz")  # as a file has it
    at = len(between) // 2
    between[at].save(tmp_path / "c.npz")
    for stopped in (*between[:: max(len(between) // 3, 1)], between[-1], rd.load_solution(tmp_path / "c.npz")):
        assert stopped.status == "interrupted"
        assert_same(rd.solve(coloured, method, resume=stopped, **options), whole)
    most(monkeypatch, 1 << 26)  # parts of another size, or none
    assert_same(rd.solve(coloured, method, resume=between[at], **options), whole)


@pytest.mark.parametrize("name", ["walks", "warm-up", "both ends"])
def test_lines_are_told_once(coloured, tmp_path, monkeypatch, name):
    """What a run tells of its lines ends at those that it has traced, stopped within a step or not."""
    method, options = METHODS[name]
    options = {"quanta": 1 << 15, "replicates": 2} | options
    most(monkeypatch, 1 << 11)
    monkeypatch.setattr(checkpoints, "TIMES", 0)
    told = []
    _, kept = states(coloured, method, tmp_path / "a.npz", progress=lambda moment: told.append(moment.rays), **options)
    assert told == sorted(told)
    stopped = next(solution for solution in kept if within(solution))
    again = []
    rd.solve(coloured, method, resume=stopped, progress=lambda moment: again.append(moment.rays), **options)
    assert again == sorted(again)
    assert again[-1] == told[-1]
    assert again[1] < told[-1]


REFINED = {"refine_lines": 1e-3}
DAMAGE = {
    "no weights of lines": ("random-walk", {}, {"wavefront_weights": None}),
    "no hits before them": ("random-walk", {}, {"wavefront_arrivals": None}),
    "no wavefront": ("random-walk", {}, {"wavefront_weights": None, "wavefront_arrivals": None}),
    "a wavefront of no stage": ("random-walk", {}, {"within": None}),
    "other weights": ("random-walk", {}, {"wavefront_weights": lambda value: value + np.uint32(1)}),
    "later hits": ("random-walk", {}, {"wavefront_arrivals": lambda value: value + np.uint32(1000)}),
    "real numbers": ("random-walk", {}, {"arrivals": lambda value: value.astype(float)}),
    "lines that did not end": ("random-walk", {}, {"fired": lambda value: value + np.uint32(1 << 20)}),
    "lines of a step that did not end": ("stochastic-jacobi", {}, {"fired": lambda value: value * np.uint32(2)}),
    "no lines of a step": ("stochastic-jacobi", {}, {"shot_done": None}),
    "nothing that they brought": ("stochastic-jacobi", {}, {"shot_received": None}),
    "less of it": ("stochastic-jacobi", {}, {"shot_received": lambda value: value[:-3]}),
    "more lines": ("stochastic-jacobi", {}, {"shot_done": lambda value: value + np.uint32(1 << 20)}),
    "no blur": ("stochastic-jacobi", REFINED, {"shot_moved": None}),
    "a step after the end": ("stochastic-jacobi", {}, {"progress": lambda value: np.where(np.arange(7) == 1, 1 << 20, value)}),
}


@pytest.fixture(scope="module")
def stopped(coloured, tmp_path_factory):
    """A solution that was stopped within a wavefront or a step, by its method."""
    found = {}

    def of(method, options):
        if str((method, options)) not in found:
            with pytest.MonkeyPatch.context() as patched:
                most(patched, 1 << 10)
                patched.setattr(checkpoints, "TIMES", 0)
                folder = tmp_path_factory.mktemp("parts")
                _, kept = states(coloured, method, folder / "a.npz", quanta=1 << 14, replicates=2, **options)
            found[str((method, options))] = [solution for solution in kept if within(solution)][-1]
        return found[str((method, options))]

    return of


@pytest.mark.parametrize("damage", DAMAGE)
def test_parts_that_do_not_belong_together_are_refused(coloured, stopped, damage):
    """No run goes on from a state that lacks some of its arrays, or has others: neither to wrong numbers nor for ever."""
    method, options, changes = DAMAGE[damage]
    state = dict(stopped(method, options).state)
    for name, change in changes.items():
        value = state.pop(name)
        if change is not None:
            state[name] = change(value)
    with pytest.raises(rd.MethodError, match=r"solution to go on from (lacks|has|is not whole).*(start anew|earlier checkpoint)"):
        rd.solve(coloured, method, resume=replace(stopped(method, options), state=state), quanta=1 << 14, replicates=2, **options)


def test_parts_of_a_run_are_fired_in_parts(coloured, tmp_path, monkeypatch):
    """Replicates apart, stopped within a wavefront, have the bits of all together."""
    whole = rd.solve(coloured, "random-walk", quanta=1 << 15, replicates=4)
    most(monkeypatch, 1 << 11)
    monkeypatch.setattr(checkpoints, "TIMES", 0)
    found = []
    for first in (0, 2):
        options = {"quanta": 1 << 15, "replicates": 2, "first_replicate": first, "all_replicates": 4}
        _, kept = states(coloured, "random-walk", tmp_path / "a.npz", **options)
        stopped = [solution for solution in kept if within(solution)]
        found.append(rd.solve(coloured, "random-walk", resume=stopped[len(stopped) // 2], **options))
    assert_same(rd.merge(found), whole)


@pytest.mark.parametrize("order", FIRED)
def test_walks_are_followed_from_all_lines_that_are_due(monkeypatch, order):
    """Where a part of them is followed to the end of its walks, the others are followed after it."""
    patches, options = rd.subdivide(rd.load_scene("room"), cells=1), {"quanta": 1 << 14, "replicates": 2}
    whole = rd.solve(patches, rd.Method(order=order), **options)
    most(monkeypatch, 1 << 11)
    assert_same(rd.solve(patches, rd.Method(order=order), **options), whole)


def test_lines_that_are_left_out_do_not_pass(monkeypatch):
    """Half of all walks would give half of the light: rounding cannot have taken that."""
    room = rd.subdivide(rd.load_scene("room"), cells=2)
    most(monkeypatch, 1 << 11)
    monkeypatch.setattr(depth_first, "more_is_due", lambda counters: False)
    with pytest.raises(rd.DeviceError, match="the energy balance does not close"):
        rd.solve(room, "random-walk", order="depth-first", quanta=1 << 15, replicates=2)


@pytest.mark.parametrize("kind", ["walks", "steps"])
def test_wrong_parts_are_noticed(coloured, monkeypatch, kind):
    """The next part weighed anew: its balance does not close. Or with the first lines again: other bits."""
    method = "random-walk" if kind == "walks" else "stochastic-jacobi"
    whole = rd.solve(coloured, method, quanta=1 << 14, replicates=2)
    most(monkeypatch, 1 << 11)
    if kind == "walks":
        left = due._left

        def forgotten(counters):
            found = left(counters)
            counters.bands.parted = False
            return found

        monkeypatch.setattr(due, "_left", forgotten)
    else:
        shoot = shooter.Shooter._shoot

        def once_more(self, *given):
            before = type(self.sequences.fired)(self.sequences.fired)
            lines, more = shoot(self, *given)
            self.sequences.fired = before if more is not None else self.sequences.fired
            return lines, more

        monkeypatch.setattr(shooter.Shooter, "_shoot", once_more)
    if kind == "walks":
        with pytest.raises(rd.DeviceError, match="does not close"):
            rd.solve(coloured, method, quanta=1 << 14, replicates=2)
        return
    parted = rd.solve(coloured, method, quanta=1 << 14, replicates=2)
    assert not np.array_equal(parted.irradiance, whole.irradiance)
