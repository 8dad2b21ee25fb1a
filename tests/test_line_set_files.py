"""Line sets in files and in sums: to the bits of one run, and one clear error for what does not fit."""

import json
import signal
from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.matrix import algorithm as matrix


@pytest.fixture(scope="module")
def room():
    return rd.subdivide(rd.load_scene("room"), cells=1)


@pytest.fixture(scope="module")
def whole(room):
    return rd.trace_lines(room, quanta=2_000, replicates=4, sources={"light": "front"})


def part(room, first: int, replicates: int, **choices) -> rd.LineSet:
    given = {"quanta": 2_000, "sources": {"light": "front"}} | choices
    return rd.trace_lines(room, replicates=replicates, first_replicate=first, **given)


def equal(one: rd.LineSet, other: rd.LineSet) -> bool:
    return np.array_equal(one.pairs.keys, other.pairs.keys) and np.array_equal(one.pairs.counts, other.pairs.counts)


def test_a_file_holds_all_of_it(room, whole, tmp_path):
    whole.save(tmp_path / "lines.npz")
    loaded = rd.load_lines(tmp_path / "lines.npz")
    assert equal(loaded, whole)
    for name in ("rays", "quanta", "seconds", "status", "method", "parts", "sources", "both_ways", "replicates", "seed"):
        assert getattr(loaded, name) == getattr(whole, name)
    assert loaded.provenance == json.loads(json.dumps(whole.provenance))
    assert np.array_equal(loaded.solve().irradiance_standard_error, whole.solve().irradiance_standard_error)
    assert str(loaded) == str(whole)
    whole.one_way.save(tmp_path / "plain.npz")
    assert not rd.load_lines(tmp_path / "plain.npz").both_ways
    more = rd.trace_lines(room, quanta=3_000, replicates=4, sources={"light": "front"}, resume=loaded)
    assert equal(more, part(room, 0, 4, quanta=3_000))


def test_parts_of_a_seed_are_added_to_the_bits_of_one_run(room, whole):
    one, other = part(room, 0, 1), part(room, 1, 3)
    for found in (one + other, other + one, sum([one, other])):  # type: ignore[arg-type]
        assert equal(found, whole)
        assert (found.parts, found.rays, found.replicates) == (whole.parts, whole.rays, 4)
        assert found.provenance == whole.provenance
        assert np.array_equal(found.solve().irradiance_standard_error, whole.solve().irradiance_standard_error)
    more = rd.trace_lines(room, quanta=3_000, replicates=4, sources={"light": "front"}, resume=one + other)
    assert equal(more, part(room, 0, 4, quanta=3_000))


def test_other_seeds_are_added_as_other_replicates(room, whole, tmp_path):
    other = part(room, 0, 2, seed=9)
    found = other + whole
    assert [(p.seed.value, p.first, p.replicates) for p in found.parts] == [(0, 0, 4), (9, 0, 2)]
    assert equal(found, whole + other)
    power = [lines.solve().surface_power for lines in (whole, other, found)]
    assert np.array_equal(power[2], np.concatenate(power[:2], axis=1))
    found.save(tmp_path / "sum.npz")
    loaded = rd.load_lines(tmp_path / "sum.npz")
    assert loaded.parts == found.parts
    assert "seed 9 replicates 0 to 1" in str(loaded)
    with pytest.raises(rd.MethodError, match="cannot go on from a sum"):
        rd.trace_lines(room, quanta=3_000, replicates=6, resume=loaded)
    again = loaded + part(room, 2, 2, seed=9)
    assert [(p.seed.value, p.first, p.replicates) for p in again.parts] == [(0, 0, 4), (9, 0, 4)]


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"first": 3}, r"overlap: of seed 0 one has 0 to 3, the other 3 to 4; .*first_replicate=4"),
        ({"quanta": 1_999}, r"quanta \(1999 in the second, 2000 in the first\)"),
        ({"sources": None}, r"sources \(\[\] in the second"),
        ({"numbers": "sobol"}, r"numbers \(sobol in the second"),
        ({"both_ways": False}, "one counts lines at both ends"),
    ],
)
def test_what_differs_or_overlaps_is_not_added(room, whole, choices, message):
    other = part(room, choices.pop("first", 4), 2, **choices)
    with pytest.raises(rd.MethodError, match=message):
        whole + other


def test_other_geometries_are_not_added(room, whole):
    moved = replace(room.scene, vertices=room.scene.vertices * 1.01)
    for patches, word in ((rd.subdivide(moved, cells=1), "geometry"), (rd.subdivide(room.scene, cells=2), "cut")):
        with pytest.raises(rd.MethodError, match=word):
            whole + part(patches, 4, 1)
    with pytest.raises(TypeError):
        whole + 1  # type: ignore[operator]


@pytest.mark.parametrize(
    ("choices", "word"), [({"seed": 1}, "seed"), ({"replicates": 3}, "replicates"), ({"sources": None}, "sources")]
)
def test_no_run_goes_on_from_another(room, whole, choices, word):
    given = {"quanta": 3_000, "replicates": 4, "sources": {"light": "front"}, "resume": whole}
    with pytest.raises(rd.MethodError, match=rf"cannot go on from that line set: .*{word} \("):
        rd.trace_lines(room, **(given | choices))


def test_an_interrupted_run_keeps_all_its_lines_and_so_does_its_checkpoint(room, whole, tmp_path, monkeypatch):
    """Ctrl-C within the first stage, between two launches: the lines so far are those of a run of as many."""
    monkeypatch.setattr(matrix, "LAUNCH", 400)
    stages = []

    def listen(state):
        stages.append((state.stage, state.message))
        if len(stages) == 8:
            signal.raise_signal(signal.SIGINT)

    given = {"quanta": 2_000, "sources": {"light": "front"}, "replicates": 4}
    kept = tmp_path / "kept.npz"
    found = rd.trace_lines(room, progress=listen, checkpoint=kept, checkpoint_every=0, **given)
    assert (found.status, stages[-1][0]) == ("interrupted", 0)
    assert 400 < found.quanta < 2_000
    assert equal(found, part(room, 0, 4, quanta=found.quanta))
    assert found.solve().status == "interrupted"
    for before in (found, rd.load_lines(kept)):
        assert equal(rd.trace_lines(room, resume=before, **given), whole)


def test_an_interruption_before_the_first_line_leaves_nothing(room):
    def listen(state):
        if state.message == "compiling":
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        rd.trace_lines(room, quanta=2_000, progress=listen)


def test_files_of_other_kinds_say_what_reads_them(room, whole, tmp_path):
    whole.solve().save(tmp_path / "solution.npz")
    whole.save(tmp_path / "lines.npz")
    with pytest.raises(rd.SceneError, match=r"solution\.npz: holds a solution, not a line set; load_solution reads it"):
        rd.load_lines(tmp_path / "solution.npz")
    with pytest.raises(rd.SceneError, match=r"lines\.npz: holds a line set, not a solution; load_lines reads it"):
        rd.load_solution(tmp_path / "lines.npz")
    np.savez(tmp_path / "foreign.npz", a=np.zeros(3))
    (tmp_path / "text.npz").write_text("no archive")
    content = (tmp_path / "lines.npz").read_bytes()
    for cut in (1, 100, len(content) // 2, len(content) - 1):
        (tmp_path / f"cut{cut}.npz").write_bytes(content[:cut])
    for path in (tmp_path / "foreign.npz", tmp_path / "text.npz", *tmp_path.glob("cut*.npz")):
        with pytest.raises(rd.SceneError, match=r"is no line set of this program, or damaged .*; trace the lines again"):
            rd.load_lines(path)
    with pytest.raises(rd.SceneError, match=r"no such file; trace the lines of a scene with -o none\.npz first"):
        rd.load_lines(tmp_path / "none.npz")


def changed(name: str, change):
    def of(arrays: dict, meta: dict) -> None:
        arrays[name] = change(arrays[name].copy(), meta)

    return of


def last(value):
    def of(array, meta):
        array[-1] = value(array, meta)
        return array

    return of


DAMAGE = {
    "a vertex that has moved": (changed("scene_vertices", lambda a, m: a * 1.001), "its geometry is not the one"),
    "another cut": (lambda arrays, meta: meta["provenance"].update(cut="?"), "its cut is not the one"),
    "a pair of no patch": (changed("pairs_keys", last(lambda a, m: a[-1] | np.uint64(0xFFFF))), "patches that there are not"),
    "a row of no patch": (changed("pairs_keys", last(lambda a, m: np.uint64(10**6 << 32))), "patches that there are not"),
    "pairs out of order": (changed("pairs_keys", lambda a, m: a[::-1].copy()), "not in order"),
    "a pair without lines": (changed("pairs_counts", last(lambda a, m: 0)), "not in order"),
    "a line more": (changed("pairs_counts", last(lambda a, m: a[-1] + 1)), "other lines than it says"),
    "counts of another kind": (changed("pairs_counts", lambda a, m: a.astype(float)), "other counts"),
    "a replicate more": (lambda arrays, meta: meta.update(replicates=5), "other replicates"),
    "other patches": (lambda arrays, meta: meta.update(patches=10**12), "results for 18 patches"),
    "both ways of lines that count one way": (lambda arrays, meta: meta.update(both_ways="yes"), "both ways"),
    "a provenance without a device": (lambda arrays, meta: meta["provenance"].pop("device"), "damaged .'device'"),
    "a budget that is a number": (lambda arrays, meta: meta["provenance"].update(budget=3), "provenance has the budget 3"),
    "a format to come": (lambda arrays, meta: meta.update(format=9), "written in format 9; this version reads 1"),
    "a method that counts nothing": (lambda arrays, meta: meta["method"].update(order="breadth-first"), "counts no lines"),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_file_is_refused(whole, tmp_path, damage):
    change, message = DAMAGE[damage]
    whole.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as file:
        arrays = {name: file[name] for name in file.files}
    meta = json.loads(str(arrays["meta"]))
    change(arrays, meta)
    np.savez(tmp_path / "b.npz", **(arrays | {"meta": np.array(json.dumps(meta))}))
    with pytest.raises(rd.SceneError, match=message):
        rd.load_lines(tmp_path / "b.npz")
