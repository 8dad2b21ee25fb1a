"""Warnings of a run stay with its solution: in files, in reports, on the command line, and in merged solutions."""

import json
import warnings

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli import main
from radiosity.report_page.quality import to_know

TEXT = "times the 100 asked for: the smallest stage"


def solved(**options) -> rd.Solution:
    """A solution of a run that traces more lines than were asked for, which is told."""
    return rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), "gather", rays=100, replicates=2, **options)


@pytest.mark.parametrize("shown", ["always", "ignore"])
def test_a_solution_keeps_what_its_run_warned_of(shown, tmp_path):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter(shown, rd.RadiosityWarning)
        solution = solved()
    texts = [str(one.message) for one in told]
    assert sum(TEXT in text for text in texts) == (shown == "always")
    assert [TEXT in text for text in solution.warnings] == [True]
    assert shown == "ignore" or list(solution.warnings) == texts
    solution.save(tmp_path / "room.npz")
    read = rd.load_solution(tmp_path / "room.npz")
    assert read.warnings == solution.warnings
    assert f"warning   {solution.warnings[0]}" in read.report()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        assert solved().warnings == solution.warnings  # each time anew, though the filter has shown it before


def test_what_comes_before_a_run_and_after_it_is_not_of_it():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]], [[0, 1, 2], [0, 1, 3]], 0.5, 0)
        assert rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), rays=20_000).warnings == ()


def test_files_of_older_versions_have_none_and_damaged_ones_are_refused(tmp_path):
    path = tmp_path / "room.npz"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        solved().save(path)
    with np.load(path) as file:
        arrays = dict(file)
    meta = json.loads(str(arrays["meta"]))
    for value, works in ((None, True), ([7], False)):
        changed = {name: one for name, one in meta.items() if name != "warnings"} | ({} if value is None else {"warnings": value})
        np.savez(path, **(arrays | {"meta": np.array(json.dumps(changed))}))
        if works:
            assert rd.load_solution(path).warnings == ()
        else:
            with pytest.raises(rd.SceneError, match="warnings that are no texts"):
                rd.load_solution(path)


def test_merged_solutions_keep_those_of_their_parts():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        parts = [solved(first_replicate=first) for first in (0, 2)]
        merged = rd.merge(parts)
    assert [TEXT in text for text in merged.warnings] == [True]


def test_the_command_line_keeps_what_the_reader_told_too(tmp_path, capsys):
    (tmp_path / "a.obj").write_text(
        "mtllib a.mtl\no lamp\nusemtl lamp\nv 0 0 1\nv 0 1 1\nv 1 1 1\nv 1 0 1\nf 1 2 3 4\n"
        "o floor\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl bright\nf 5 6 7 8\n"
    )
    (tmp_path / "a.mtl").write_text("newmtl lamp\nKd 0 0 0\nKe 5 5 5\nnewmtl bright\nKd 0.99 0.99 0.99\n")
    target = str(tmp_path / "a.npz")
    assert main(["solve", str(tmp_path / "a.obj"), "--rays", "20000", "-o", target, "--method", "random-walk"]) == 0
    assert "brought down" in capsys.readouterr().out
    solution = rd.load_solution(target)
    assert any("reflectance above 0.95 brought down" in text for text in solution.warnings)
    assert "reflectance above 0.95 brought down" in to_know(solution, None, [])  # a section of the report for clients
