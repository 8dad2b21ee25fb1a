"""Contract 2: the order does not change a single integer; the seed does. (Threads and stages: `test_axis_order.py`.)"""

import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.firing import fire as firing
from radiosity.algorithms.firing.orders import breadth_first
from radiosity.device.backend import choose, upload
from radiosity.problem.quanta import Source, phases, target_counts
from radiosity.run import budget as budgets
from radiosity.tracing import lanes, rounds

QUANTA = 40_000


@pytest.fixture(scope="module")
def patches():
    """A scene with every kind of side: absorbing, radiating with its own back, and an opening."""
    scene = rd.load_scene("room")
    keep = scene.surface != scene.names.index("north wall")
    return rd.subdivide(scene.take(keep), cells=6)


def counters(patches, **choices):
    state = rd.solve(patches, **({"method": "random-walk", "quanta": QUANTA, "replicates": 3, "seed": 5} | choices)).state
    return state["arrivals"], state["fired"], state["missed"]


def equal(one, two):
    return all(np.array_equal(a, b) for a, b in zip(one, two, strict=True))


@pytest.mark.parametrize("numbers", ["halton", "random"])
def test_orders_end_in_equal_integers(patches, numbers):
    assert equal(counters(patches, numbers=numbers), counters(patches, numbers=numbers, order="depth-first"))


def test_seed_matters_and_replicates_do_not(patches):
    three, one = counters(patches), counters(patches, replicates=1)
    assert np.array_equal(three[0][0], one[0][0])
    assert np.array_equal(three[1][0], one[1][0])
    assert not np.array_equal(three[0][0], three[0][1])
    assert not np.array_equal(three[0], counters(patches, seed=6)[0])


def test_patches_owe_what_the_contract_says(patches):
    arrivals, fired, missed = counters(patches)
    source = Source.of(patches, patches.emission[:, 0], patches.reflectance[:, 0])
    assert np.array_equal(fired, target_counts(source, QUANTA, arrivals, phases(5, 3, len(patches))))
    assert np.array_equal(fired.sum(axis=1), arrivals.sum(axis=1) + missed.sum(axis=0))
    assert missed[0].min() > 0  # through the opening


def test_replicates_and_patches_have_independent_phases():
    phase = phases(5, 3, 10_000) * 2.0**-32
    # correlations of independent numbers have a standard error of 0.01; 5 of them
    assert np.abs(np.corrcoef(phase) - np.eye(3)).max() < 0.05
    assert np.abs([np.corrcoef(row[1:], row[:-1])[0, 1] for row in phase]).max() < 0.05


def test_quanta_replay_a_run_bit_for_bit(monkeypatch):
    monkeypatch.setattr(budgets, "FIRST_STAGE", 1 << 17)
    for scene in ("room", "cornell-box"):
        patches = rd.subdivide(rd.load_scene(scene), cells=5)
        for budget in ({"seconds": 0.2}, {"error": 0.03}, {"rays": 1_000_000}):
            first = rd.solve(patches, replicates=2, **budget)
            again = rd.solve(patches, replicates=2, quanta=first.quanta)
            assert np.array_equal(first.irradiance, again.irradiance)
            assert np.array_equal(first.irradiance_standard_error, again.irradiance_standard_error)
    assert first.quanta > budgets.first_stage(2, len(patches))  # several stages were replayed


@pytest.mark.parametrize("method", ["random-walk", "gather"])
def test_quanta_a_little_above_a_rung_are_met(method):
    """A run to so many lines may end at a rung within a hundredth of them. One to quanta repeats a run, and may not."""
    patches = rd.subdivide(rd.load_scene("room"), cells=2)
    quanta = 66_000  # a rung is at 2^16
    found = rd.solve(patches, method, quanta=quanta, replicates=16)
    assert found.quanta == quanta
    at_once = rd.solve(patches, method, rays=found.rays, replicates=16)
    again = rd.solve(patches, method, quanta=at_once.quanta, replicates=16)
    assert again.quanta == at_once.quanta
    np.testing.assert_array_equal(again.irradiance, at_once.irradiance)


@pytest.mark.parametrize("colored", [False, True])
def test_coherent_firing_traces_the_same_lines(monkeypatch, colored):
    """Few other hits, at ties alone; launches may end anywhere, and rounds begin anywhere."""
    took, of = [], lanes.Batch.of

    def batch(*arguments, **choices):
        took.append(of(*arguments, **choices))
        return took[-1]

    patches = rd.subdivide(rd.load_scene("cornell-box" if colored else "labyrinth-0.5"), cells=1)
    found = {}
    for coherent in (False, "always"):
        with monkeypatch.context() as patched:
            patched.setattr(rounds, "LEAST", 1)
            patched.setattr(lanes.Batch, "of", batch)
            method = rd.Method(coherent=coherent)
            begun = None if colored else rd.solve(patches, method, quanta=300_001, replicates=2)
            found[coherent] = rd.solve(patches, method, quanta=2_000_000, replicates=2, resume=begun)
        assert all(book["closes"] for book in found[coherent].books)
        assert (sum(one.boxes is not None for one in took) > 5) == (coherent == "always")
    counts = [one.state["arrivals"].astype(np.int64) for one in found.values()]
    assert np.abs(counts[0] - counts[1]).sum() < 1e-5 * found[False].rays
    assert found["always"].provenance["choices"]["coherent"] == "always"


@pytest.mark.parametrize("colored", [False, True])
def test_launches_may_end_anywhere(monkeypatch, colored):
    """A sweep's last launch may hold one line: nothing is counted twice, and nothing that was not fired."""
    from enclosures import cube

    emission = np.zeros((6, 3 if colored else 1))
    emission[0] = 1.0
    reflectance = [[0.5, 0.4, 0.2]] * 3 + [[0.1, 0.3, 0.6]] * 3 if colored else 0.5
    cut = rd.subdivide(cube(reflectance, emission), cells=1)
    for quanta in (2**14, 2**14 + 1, 2**14 + 2, 2**15 - 1, 2**15 + 1):
        whole = rd.solve(cut, "random-walk", quanta=quanta, replicates=1)
        with monkeypatch.context() as patched:
            patched.setattr(lanes, "CHUNK", 2**14)
            patched.setattr(lanes, "CORE_CHUNK", 1)
            parts = rd.solve(cut, "random-walk", quanta=quanta, replicates=1)
        assert all(book["closes"] for book in (*whole.books, *parts.books))
        assert all(np.array_equal(parts.state[key], whole.state[key]) for key in whole.state)
        assert parts.state["fired"].sum() == parts.state["arrivals"].sum() + parts.state["missed"].sum()


@pytest.mark.parametrize("colored", [False, True])
@pytest.mark.parametrize("shift", [1, 2, 3])
def test_lanes_of_several_lines_end_in_equal_integers(patches, monkeypatch, shift, colored):
    """Where lanes are full, where patches fire fewer lines than a lane holds, and where a launch ends in between."""
    cut = rd.subdivide(rd.load_scene("cornell-box"), cells=2) if colored else patches
    took, of = [], lanes.Batch.of

    def batch(*arguments, **choices):
        took.append(of(*arguments, **choices))
        return took[-1]

    monkeypatch.setattr(lanes.Batch, "of", batch)
    monkeypatch.setattr(lanes, "CHUNK", 2**13 + 3)
    monkeypatch.setattr(lanes, "CORE_CHUNK", 1)
    monkeypatch.setattr(firing, "MUCH", 2**40)
    monkeypatch.setattr(breadth_first, "TAILS", {"cpu": 2**13, "cuda": 2**13})
    one = rd.solve(cut, "random-walk", quanta=2**18, replicates=3)
    assert not any(b.several for b in took)
    monkeypatch.setattr(firing, "MUCH", 0)
    monkeypatch.setattr(firing, "SHIFTS", (shift,))
    monkeypatch.setattr(lanes, "fullest", lambda lines, taken: max(taken.items()))
    several = rd.solve(cut, "random-walk", quanta=2**18, replicates=3)
    assert sum(b.several and int(b.each[0]) == 2**shift for b in took) > 5
    assert equal(several.state.values(), one.state.values())


def test_half_empty_lanes_are_none():
    types = choose("cpu").types
    for counts, each in (
        ([8, 8, 16], 8),
        ([5, 6, 7], 8),
        ([1, 1, 1], 1),
        ([9, 9, 9], 4),
        ([100, 1, 1], 8),
        ([1, 0, 0], 1),
        ([3, 4, 3], 4),
        ([2, 2, 1], 2),
        ([1, 2, 1], 2),
        ([2**32 - 1], 8),
    ):
        column = upload(types.UInt32, np.array(counts, np.uint32))
        taken = {shift: int(np.array(lanes.lanes_of(column, shift)).sum(dtype=np.int64)) for shift in range(4)}
        assert taken == {shift: sum(-(-count // 2**shift) for count in counts) for shift in range(4)}
        assert lanes.fullest(sum(counts), taken) == (each.bit_length() - 1, taken[each.bit_length() - 1])


@pytest.mark.parametrize("two_sided", [False, True])
def test_faces_that_are_not_cut_take_a_shorter_way_to_the_same_integers(two_sided, monkeypatch):
    from radiosity.tracing.geometry import Geometry

    scene = rd.load_scene("room")
    tetrahedron = np.array([(0.3, 0.3, 0.2), (0.5, 0.3, 0.2), (0.3, 0.5, 0.2), (0.3, 0.3, 0.4)])
    corners, first = np.concatenate([scene.vertices, tetrahedron]), len(scene.vertices)
    sides = np.column_stack([first + np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]), np.full(4, -1)])
    faces = np.concatenate([scene.faces, sides])
    made = rd.Scene.from_arrays(corners, faces, 0.5, np.r_[1.0, np.zeros(len(faces) - 1)], two_sided=two_sided)
    patches = rd.subdivide(made, cells=1)
    assert Geometry(patches, None).whole_faces
    short = counters(patches)
    monkeypatch.setattr(Geometry, "whole_faces", False)
    assert equal(short, counters(patches))
