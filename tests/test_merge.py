"""Runs of parts of the replicates, merged, are one run of them all, to the bit; what is no part of one run is refused."""

import os
import signal
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from iterations import open_room

import radiosity as rd
from radiosity.algorithms.firing.state import FiringState
from radiosity.algorithms.merging import merge as merge_states
from radiosity.algorithms.state import Sizes
from radiosity.run import budget

ALL, SPLIT = 5, 3  # replicates 0 to 2, and 3 to 4
FIRST = 1 << 14  # quanta of the first stage of all replicates: 4096 for each of 5 or 3, but 8192 of 2
ONE, SEVERAL = 3_000, 3 << 12  # quanta: within the first stage; stages at 4096, 8192 and 12288
PARTS = {
    "firing": rd.Method(),
    "depth-first": rd.Method(order="depth-first"),
    "random numbers": rd.Method(numbers="random"),
    "continuous": rd.Method(equation="continuous"),
    "survival": rd.Method(equation="continuous", estimator="survival"),
    "fractional": rd.Method(absorption="fractional"),
    "gathering": rd.Method(estimator="gathering"),
    "density": rd.PRESETS["density-estimation"].method,
    "regular": rd.Method(order="regular"),
    "control variate": rd.Method(order="regular", control_variate=True),
    "two ends": rd.Method(order="regular", estimator="bidirectional"),
    "multipath": rd.Method(lines="global", order="multipath"),
    "first shot": rd.Method(lines="spans", order="multipath", first_shot=0.3),
    "local matrix": rd.Method(order="matrix"),
    "gather": rd.Method(order="gather"),
    "gather, linear": rd.Method(order="gather", basis="linear"),
    "global matrix": rd.Method(lines="spans", order="matrix"),
}
MATRICES = {
    "lines": rd.Baseline(factors="lines", samples=16),
    "polygons": rd.Baseline(samples=4),
    "hemicube": rd.Baseline(factors="hemicube", resolution=16),
}
INCREMENTAL = {
    "incremental": rd.Method(order="incremental"),
    "incremental, two ends": rd.Method(order="incremental", estimator="bidirectional"),
    "incremental, control variate": rd.Method(order="incremental", control_variate=True),
}
TOGETHER = {
    "pooled": rd.Method(lines="bundles", order="regular"),
    "warm-up": rd.Method(order="regular", warm_up=True),
    "coherent": rd.Method(coherent=True),
    "progressive": rd.Baseline("progressive"),
    "hierarchical": rd.Baseline("hierarchical"),
}
FIELDS = (
    "irradiance",
    "irradiance_standard_error",
    "arrivals",
    "surface_power",
    "side_power",
    "side_bias",
    "irradiance_coefficients",
)
pytestmark = pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning")  # of few lines


@pytest.fixture(scope="module")
def grey():
    return rd.subdivide(open_room(two_sided=True), cells=1)


@pytest.fixture(scope="module")
def coloured():
    return rd.subdivide(rd.load_scene("cornell-box"), cells=1)


@pytest.fixture
def short(monkeypatch):
    """Several stages at few lines."""
    monkeypatch.setattr(budget, "FIRST_STAGE", FIRST)


def solved(patches, method, first=0, count=ALL, **options) -> rd.Solution:
    return rd.solve(patches, method, first_replicate=first, replicates=count, **{"seed": 3, "all_replicates": ALL} | options)


def halves(patches, method, **options) -> list[rd.Solution]:
    return [solved(patches, method, 0, SPLIT, **options), solved(patches, method, SPLIT, ALL - SPLIT, **options)]


def assert_same(one: rd.Solution, other: rd.Solution) -> None:
    for name in FIELDS:
        ours, theirs = getattr(one, name), getattr(other, name)
        assert (ours is None) == (theirs is None), name
        assert ours is None or np.array_equal(ours, theirs, equal_nan=True), name
    for name in ("rays", "quanta", "replicates", "books", "status", "provenance"):
        assert getattr(one, name) == getattr(other, name), name
    assert set(one.state) == set(other.state)
    for name, value in one.state.items():
        assert value.dtype == other.state[name].dtype, name
        assert np.array_equal(value, other.state[name]), name


# ---- the bits of one run ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", PARTS)
def test_parts_are_the_whole(grey, short, name):
    whole = solved(grey, PARTS[name], quanta=SEVERAL)
    assert_same(rd.merge(halves(grey, PARTS[name], quanta=SEVERAL)), whole)


@pytest.mark.parametrize(
    "name", ["firing", "continuous", "fractional", "gathering", "regular", "first shot", "local matrix", "gather, linear"]
)
def test_parts_are_the_whole_in_colour(coloured, short, name):
    whole = solved(coloured, PARTS[name], quanta=SEVERAL)
    assert_same(rd.merge(halves(coloured, PARTS[name], quanta=SEVERAL)), whole)


@pytest.mark.parametrize("name", INCREMENTAL)
def test_one_stage_of_incremental_iterations_is_the_whole(coloured, name):
    method = INCREMENTAL[name]
    assert_same(rd.merge(halves(coloured, method, quanta=ONE)), solved(coloured, method, quanta=ONE))


@pytest.mark.parametrize("seed", [4, 6])
def test_a_merged_run_has_made_the_steps_of_the_part_that_needed_most(grey, seed):
    method, parts = INCREMENTAL["incremental"], halves(grey, INCREMENTAL["incremental"], quanta=ONE, seed=seed)
    steps = [int(part.state["step"]) for part in parts]
    assert (steps[1] > steps[0]) == (seed == 4)
    assert_same(rd.merge(parts), solved(grey, method, quanta=ONE, seed=seed))


@pytest.mark.parametrize("name", MATRICES)
def test_parts_of_a_full_matrix_are_the_whole(grey, name):
    assert_same(rd.merge(halves(grey, MATRICES[name])), solved(grey, MATRICES[name]))


def test_a_run_has_the_replicates_that_it_is_told(grey):
    whole, part = solved(grey, rd.Method(), quanta=ONE), solved(grey, rd.Method(), 2, 2, quanta=ONE)
    for name in ("arrivals", "fired"):
        assert np.array_equal(part.state[name], whole.state[name][2:4])
    assert not np.array_equal(whole.state["arrivals"][0], whole.state["arrivals"][2])


def test_any_order_and_several_steps_through_files(grey, coloured, tmp_path, short):
    for patches in (grey, coloured):
        parts = []
        for first, count in ((3, 2), (0, 2), (2, 1)):
            solved(patches, "random-walk", first, count, quanta=SEVERAL).save(tmp_path / "part.npz")
            parts.append(rd.load_solution(tmp_path / "part.npz"))
        some = rd.merge(parts[1:])
        assert some.provenance["all_replicates"] == ALL
        some.save(tmp_path / "some.npz")
        merged = rd.merge([parts[0], rd.load_solution(tmp_path / "some.npz")])
        assert_same(merged, solved(patches, "random-walk", quanta=SEVERAL))
        assert merged.seconds == pytest.approx(sum(part.seconds for part in parts))
        merged.save(tmp_path / "merged.npz")
        assert_same(rd.load_solution(tmp_path / "merged.npz"), merged)


@pytest.mark.parametrize("name", ["firing", "continuous", "regular", "first shot", "local matrix"])
def test_a_merged_run_goes_on_to_the_bits_of_one(coloured, name, short):
    merged = rd.merge(halves(coloured, PARTS[name], quanta=1 << 13))
    more = solved(coloured, PARTS[name], quanta=1 << 14, resume=merged)
    assert_same(more, solved(coloured, PARTS[name], quanta=1 << 14))


def test_a_part_goes_on_as_a_part(coloured, short):
    few = solved(coloured, "random-walk", SPLIT, 2, quanta=1 << 12)
    more = solved(coloured, "random-walk", SPLIT, 2, quanta=1 << 13, resume=few)
    other = solved(coloured, "random-walk", 0, SPLIT, quanta=1 << 13)
    assert_same(rd.merge([more, other]), solved(coloured, "random-walk", quanta=1 << 13))


def test_fresh_processes_solve_parts(tmp_path):
    code = (
        "import sys, radiosity as rd; first = int(sys.argv[1]); patches = rd.subdivide(rd.load_scene('room'), cells=1); "
        "rd.solve(patches, 'random-walk', quanta=5000, replicates=2, first_replicate=first, seed=1).save(sys.argv[2])"
    )
    paths = [tmp_path / f"{first}.npz" for first in (0, 2)]
    for first, path in zip((0, 2), paths, strict=True):
        subprocess.run([sys.executable, "-c", code, str(first), str(path)], check=True)
    whole = rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), "random-walk", quanta=5000, replicates=4, seed=1)
    assert_same(rd.merge(map(rd.load_solution, paths)), whole)


def test_one_solution_is_itself(grey):
    whole = solved(grey, "random-walk", quanta=ONE)
    assert_same(rd.merge([whole]), whole)


def test_a_whole_run_says_nothing_of_parts(grey):
    whole = rd.solve(grey, "random-walk", quanta=ONE, replicates=2, first_replicate=0, all_replicates=2)
    assert not {"first_replicate", "all_replicates"} & set(whole.provenance)


# ---- what is refused ----------------------------------------------------------------------------------------------------


def test_states_in_another_order_are_another_run():
    """Here nobody knows whose replicates they are; `rd.merge` sorts them."""
    sizes = Sizes(1, 2, 1)
    one, other = (
        FiringState(sizes=sizes, quanta=7, arrivals=value, fired=value, missed=np.zeros((2, 1), np.uint32))
        for value in (np.array([[1, 2]], np.uint32), np.array([[3, 4]], np.uint32))
    )
    assert merge_states([one, other]).arrivals.tolist() == [[1, 2], [3, 4]]
    assert merge_states([other, one]).arrivals.tolist() == [[3, 4], [1, 2]]
    assert merge_states([one, other]).sizes == Sizes(2, 2, 1)
    with pytest.raises(rd.MethodError, match="state 2 has 8"):
        merge_states([one, replace(other, quanta=8)])
    with pytest.raises(rd.MethodError, match="2 rows in 1 groups of bands, state 2 has 3 in 1"):
        merge_states([one, replace(other, sizes=Sizes(1, 3, 1))])
    with pytest.raises(rd.MethodError, match="no state"):
        merge_states([])


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (((0, 3), (2, 2)), r"overlap: solution 1 has 0 to 2, solution 2 has 2 to 3; .*first_replicate=3"),
        (((0, 2), (0, 2)), r"overlap: solution 1 has 0 to 1, solution 2 has 0 to 1"),
        (((3, 2), (0, 2)), r"leave a gap: solution 2 has 0 to 1, solution 1 has 3 to 4; .*first_replicate=2"),
    ],
)
def test_replicates_follow_each_other(grey, parts, message):
    with pytest.raises(rd.MethodError, match=message):
        rd.merge([solved(grey, "random-walk", *part, quanta=ONE) for part in parts])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"seed": 4}, r"seed \(4 in solution 2, 3 in solution 1\)"),
        ({"quanta": ONE + 1}, r"quanta \(3001 in solution 2, 3000 in solution 1\)"),
        ({"numbers": "sobol"}, r"numbers \(sobol in solution 2, halton in solution 1\)"),
        ({"order": "regular"}, r"order \(regular in solution 2, breadth-first in solution 1\)"),
    ],
    ids=str,
)
def test_other_runs_are_refused(grey, options, message):
    with pytest.raises(rd.MethodError, match=message):
        rd.merge([solved(grey, "random-walk", 0, 3, quanta=ONE), solved(grey, "random-walk", 3, 2, **{"quanta": ONE} | options)])


def test_other_scenes_and_cuts_are_refused(grey):
    one = solved(grey, "random-walk", 0, 3, quanta=ONE)
    for other in (rd.subdivide(grey.scene, cells=2), rd.subdivide(open_room(), cells=1)):
        with pytest.raises(rd.MethodError, match=r"(scene|cut) \(.* in solution 2"):
            rd.merge([one, solved(other, "random-walk", 3, 2, quanta=ONE)])


@pytest.mark.parametrize(
    ("facts", "message"),
    [
        ({"device": "cuda"}, r"device \(cuda in solution 2, cpu in solution 1\)"),
        ({"versions": {"radiosity": "0.0.1"}}, r"radiosity 0\.0\.1 in solution 2"),
        ({"first_replicate": -1}, "first_replicate is -1"),
        ({"first_replicate": "x"}, "first_replicate is 'x'"),
        ({"all_replicates": 4}, "all_replicates is 4, and this run has replicates 3 to 4; it must be 5 or more"),
        ({"seed": None}, "seed is None"),
    ],
    ids=str,
)
def test_provenance_must_fit(grey, facts, message):
    one, other = halves(grey, "random-walk", quanta=ONE, device="cpu")
    changed = {**other.provenance, **facts, "versions": {**other.provenance["versions"], **facts.get("versions", {})}}
    with pytest.raises(rd.MethodError, match=message):
        rd.merge([one, replace(other, provenance=changed)])


def test_another_version_of_the_program_is_refused(grey):
    parts = halves(grey, "random-walk", quanta=ONE)
    old = [
        replace(part, provenance=part.provenance | {"versions": {**part.provenance["versions"], "drjit": "0.1"}})
        for part in parts
    ]
    with pytest.raises(rd.MethodError, match=r"drjit 0\.1 then, .* now; solve them anew"):
        rd.merge(old)


def test_damaged_choices_and_states_are_refused(grey):
    one, other = halves(grey, "random-walk", quanta=ONE)
    strange = [replace(s, provenance=s.provenance | {"choices": {"colour": "red"}}) for s in (one, other)]
    with pytest.raises(rd.MethodError, match="no method of this version"):
        rd.merge(strange)
    with pytest.raises(rd.MethodError, match=r"lacks the integers of its run \(missed\)"):
        rd.merge([one, replace(other, state={k: v for k, v in other.state.items() if k != "missed"})])
    with pytest.raises(rd.MethodError, match="other sizes"):
        rd.merge([one, replace(other, state=other.state | {"fired": other.state["fired"][:1]})])
    with pytest.raises(rd.MethodError, match="solution 2 holds no integers"):
        rd.merge([one, replace(other, state={})])


DAMAGE = {  # a kind of run, an array of its state, and what becomes of it; None: it is gone
    "no powers of bands": ("firing", "received", None),
    "quanta in words": ("firing", "quanta", lambda value: np.array("x")),
    "broken quanta": ("firing", "quanta", lambda value: np.array(1.5)),
    "counts in words": ("firing", "arrivals", lambda value: value.astype(str)),
    "no scores": ("continuous", "received", None),
    "other sums": ("gathering", "met", lambda value: value[..., :1]),
    "no powers of a shot's bands": ("first shot", "shot_sent", None),
    "another ledger": ("first shot", "ledger", lambda value: value[:, :3]),
    "a source too few": ("two ends", "source", lambda value: value[: value.size // 2]),
    "a sequence too few": ("two ends", "fired_apart", lambda value: value[:1]),
    "no weights": ("two ends", "weights", None),
    "fewer counts than pairs": ("local matrix", "counts", lambda value: value[1:]),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_damaged_states_are_refused(coloured, damage):
    """Whatever a file lacks or holds in another shape: no run goes on from it, and no part is merged."""
    name, key, change = DAMAGE[damage]
    part = solved(coloured, PARTS[name], SPLIT, 2, quanta=ONE)
    state = {one: value for one, value in part.state.items() if one != key}
    damaged = replace(part, state=state if change is None else state | {key: change(part.state[key])})
    with pytest.raises(rd.MethodError, match="start anew"):
        solved(coloured, PARTS[name], SPLIT, 2, quanta=2 * ONE, resume=damaged)
    with pytest.raises(rd.MethodError, match="start anew"):
        rd.merge([solved(coloured, PARTS[name], 0, SPLIT, quanta=ONE), damaged])


@pytest.mark.parametrize("given", [[], [1], None, "one"], ids=str)
def test_what_is_no_solution_is_refused(grey, given):
    with pytest.raises(rd.MethodError, match="merge"):
        rd.merge(rd.solve(grey, "random-walk", quanta=64) if given == "one" else given)


@pytest.mark.parametrize("name", ["firing", "continuous", "regular", "multipath", "local matrix"])
def test_an_unfinished_stage_is_refused(coloured, name, short, monkeypatch):
    from radiosity.algorithms.global_lines import multipath
    from radiosity.algorithms.matrix import algorithm as matrix
    from radiosity.tracing import lanes

    for module, setting in ((lanes, "CHUNK"), (lanes, "CORE_CHUNK"), (multipath, "BATCH"), (matrix, "LAUNCH")):
        monkeypatch.setattr(module, setting, 1 << 12)

    def listen(progress):
        if progress.stage >= 1 and progress.message == "tracing":
            os.kill(os.getpid(), signal.SIGINT)

    other = solved(coloured, PARTS[name], 3, 2, quanta=1 << 14, progress=listen)
    assert other.status == "interrupted"
    assert other.quanta < int(other.state["quanta"])
    one = solved(coloured, PARTS[name], 0, 3, quanta=other.quanta)
    with pytest.raises(rd.MethodError, match=r"replicates 3 to 4: they are within the stage of \d+ quanta.*resume"):
        rd.merge([one, other])
    none_yet = replace(other, quanta=0)
    with pytest.raises(rd.MethodError, match="solution 2 has no results yet"):
        rd.merge([one, none_yet])


def test_stages_of_parts_must_be_those_of_the_whole(coloured, grey, short):
    parts = halves(coloured, "random-walk", quanta=SEVERAL, all_replicates=None)
    with pytest.raises(rd.MethodError, match=r"replicates 3 to 4 begin at 8192 quanta, .* 5 at 4096; .*all_replicates=5"):
        rd.merge(parts)
    assert_same(
        rd.merge(halves(coloured, "random-walk", quanta=ONE, all_replicates=None)),
        solved(coloured, "random-walk", quanta=ONE),
    )
    assert_same(  # integers do not depend on stages
        rd.merge(halves(grey, "random-walk", quanta=SEVERAL, all_replicates=None)), solved(grey, "random-walk", quanta=SEVERAL)
    )


def test_later_stages_of_incremental_iterations_are_refused(grey, short):
    method = INCREMENTAL["incremental"]
    with pytest.raises(rd.MethodError, match=r"cannot be solved in parts, .*quanta=4096 or fewer"):
        solved(grey, method, 3, 2, quanta=SEVERAL)
    one, other = halves(grey, method, quanta=ONE)
    assert one.state["step"] != other.state["step"]  # why: all replicates of a run make equally many
    one, other = (solved(grey, method, 0, count, quanta=SEVERAL, all_replicates=None) for count in (3, 2))
    one, other = (
        replace(s, provenance=s.provenance | {"all_replicates": ALL, "first_replicate": first})
        for s, first in ((one, 0), (other, 3))
    )
    with pytest.raises(rd.MethodError, match=r"cannot merge .* at 12288 quanta: all replicates of a run .*quanta=4096 or fewer"):
        rd.merge([one, other])


@pytest.mark.parametrize("name", TOGETHER)
def test_what_has_no_parts_says_so_before_it_begins(grey, name):
    options = {} if isinstance(TOGETHER[name], rd.Baseline) else {"quanta": ONE}
    for first, count in ((1, 1), (0, 1)):
        with pytest.raises(rd.MethodError, match=r"cannot be solved in parts, since .*in one run"):
            solved(grey, TOGETHER[name], first, count, **options)


def test_pooled_states_are_refused(grey):
    parts = [rd.solve(grey, TOGETHER["pooled"], quanta=ONE, replicates=2, seed=seed) for seed in (3, 3)]
    moved = replace(parts[1], provenance=parts[1].provenance | {"first_replicate": 2})
    with pytest.raises(rd.MethodError, match="balances the power of all replicates together"):
        rd.merge([parts[0], moved])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"first": -1}, "first_replicate is -1; it must be a whole number of 0 or more"),
        ({"first": 1.5}, "first_replicate is 1.5"),
        ({"first": 4, "count": 2}, "all_replicates is 5, and this run has replicates 4 to 5; it must be 6 or more"),
        ({"all_replicates": 0}, "all_replicates is 0"),
    ],
    ids=str,
)
def test_senseless_parts_are_refused(grey, options, message):
    with pytest.raises(rd.MethodError, match=message):
        solved(grey, "random-walk", quanta=ONE, **options)


def test_going_on_as_other_replicates_is_refused(grey):
    part = solved(grey, "random-walk", 3, 2, quanta=ONE)
    with pytest.raises(rd.MethodError, match=r"first_replicate \(3 then, 0 now\)"):
        solved(grey, "random-walk", 0, 2, quanta=2 * ONE, resume=part)
    with pytest.raises(rd.MethodError, match=r"all_replicates \(5 then, 6 now\)"):
        solved(grey, "random-walk", 3, 2, quanta=2 * ONE, resume=part, all_replicates=6)
