"""Discretisation error apart from sampling error."""

from types import SimpleNamespace

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli.app import run as command
from radiosity.patches.bases import CONSTANT
from radiosity.patches.nesting import halved, parents
from radiosity.run import run
from radiosity.solution.refinement import RefineCheck


@pytest.mark.parametrize(("name", "cells"), [("room", 3), ("cornell-box", 2)])
def test_children_fill_their_parents(name, cells):
    coarse = rd.subdivide(rd.load_scene(name), cells=cells)
    fine = halved(coarse)
    parent = parents(fine, coarse)
    assert (np.bincount(parent) == 4).all()
    assert np.bincount(parent, fine.area) == pytest.approx(coarse.area)
    middle = np.stack([np.bincount(parent, fine.area * axis) for axis in fine.centroid.T], axis=1) / coarse.area[:, None]
    assert middle == pytest.approx(coarse.centroid, abs=1e-12)


def test_backs_have_parents_of_their_own():
    scene = rd.Scene.from_arrays([[0, 0, 0], [2, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.5, 1.0, two_sided=True)
    coarse = rd.subdivide(scene, cells=3)
    fine = halved(coarse)
    parent = parents(fine, coarse)
    assert np.array_equal(coarse.is_back[parent], fine.is_back)
    assert (np.bincount(parent) == 4).all()


def test_estimates_have_no_bias(random):
    """Of a known field and independent noise on 10 000 patches: squared errors of means and within patches, within 5 standard
    errors of the mean over patches. What patches of one coarse one share is told from what each has for itself."""
    side = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    coarse = rd.subdivide(rd.Scene.from_arrays(side, [[0, 1, 2, 3]], 0.5, 0.0), cells=100)
    fine, slope = halved(coarse), 3.0
    parent = parents(fine, coarse)
    shared, own, before = 0.02, 0.03, 0.05  # noise of a coarse patch's children together, of each of them, and of the coarse run
    value = 5 + slope * fine.centroid[:, 0]
    value += shared * random.normal(size=len(coarse))[parent] + own * random.normal(size=len(fine))
    error = np.sqrt(shared**2 + own**2)
    moved = 0.04  # how much means change when patches are halved: a half of the error, as errors fall with the patch size
    solved = [
        SimpleNamespace(
            patches=patches, basis=CONSTANT, radiosity=values[:, None], standard_error=np.full((len(patches), 1), noise)
        )
        for patches, values, noise in (
            (coarse, 5 + slope * coarse.centroid[:, 0] - moved + before * random.normal(size=len(coarse)), before),
            (fine, value, error),
        )
    ]
    known = np.full((len(coarse), 1), np.sqrt(shared**2 + own**2 / 4))
    check = RefineCheck(solved[0], solved[1], parent, known)
    within = slope**2 * 0.01**2 / 12  # of a linear field over a patch of a hundredth
    for found, expected in ((check.square_of_means, (2 * moved) ** 2), (check.square_within, within)):
        assert abs(found.mean() - expected) < 5 * found.std() / 100
        assert found.std() / 100 < 0.05 * max(expected, own**2)  # precise enough to tell


def test_a_furnace_has_no_discretisation_error():
    """Its solution is one everywhere on any mesh: all change is noise, and the check says so."""
    found = rd.refine_check(rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1), "random-walk", rays=2_000_000)
    apart = found.change / found.change_error
    assert np.mean(apart**2) < 2.5  # of Student's squares with seven degrees and more: 1.4 or less
    assert np.abs(found.change).max() > 0
    row = found.table()[0]
    assert row["discretisation"] < 2 * row["sampling"]
    assert row["within"] < 2 * row["sampling"]
    assert found.coarse.provenance["seed"] != found.fine.provenance["seed"]  # else their noise is no one's but both's


def test_errors_of_the_room_fall_with_the_patches():
    rows = [
        rd.refine_check(rd.subdivide(rd.load_scene("room"), cells=k), "random-walk", rays=3_000_000).table()[0] for k in (2, 6)
    ]
    assert rows[1]["within"] < 0.6 * rows[0]["within"]  # 0.44 where it falls with h^0.75
    assert rows[1]["discretisation"] < rows[0]["discretisation"]
    assert rows[1]["sampling"] < 0.3 * rows[1]["discretisation"]


def test_it_finds_the_known_error_of_a_mesh():
    """Against a mesh of four times as many cells along each edge."""
    coarse = rd.subdivide(rd.load_scene("room"), cells=1)
    finest = rd.subdivide(rd.load_scene("room"), cells=8)
    truth = rd.solve(finest, "random-walk", rays=4_000_000).radiosity
    of = parents(finest, coarse)
    mean = np.bincount(of, finest.area * truth[:, 0]) / coarse.area
    found = rd.refine_check(coarse, "random-walk", rays=2_000_000)
    exact = np.sqrt(coarse.area @ (mean - found.coarse.radiosity[:, 0]) ** 2)
    stated = np.sqrt(coarse.area @ np.maximum(found.square_of_means[:, 0], 0))
    assert 0.5 < stated / exact < 2
    within = np.sqrt(finest.area @ (truth[:, 0] - mean[of]) ** 2)
    assert 0.5 < np.sqrt(coarse.area @ np.maximum(found.square_within[:, 0], 0)) / within < 2


def test_of_runs_whose_last_stage_was_left_unfinished(monkeypatch):
    """Time is up within a second stage: what the first one left is read."""
    monkeypatch.setattr(run, "PATIENCE", -1e9)
    found = rd.refine_check(rd.subdivide(rd.load_scene("room"), cells=2), "random-walk", seconds=60)
    assert found.coarse.status == "complete"
    assert 0 < found.coarse.seconds < 30
    assert np.isfinite(found.change_error).all()


@pytest.mark.parametrize(("choices", "says"), [({"replicates": 1}, "2 or more"), ({"method": "full-matrix"}, "baselines")])
def test_what_cannot_be_checked(choices, says):
    with pytest.raises(rd.MethodError, match=says):
        rd.refine_check(rd.load_scene("room"), **choices, rays=1000)


def test_on_the_command_line(tmp_path, capsys):
    out = tmp_path / "a.csv"
    assert command(["solve", "room", "--cells", "2", "--rays", "300k", "--refine-check", "-o", str(out)]) == 0
    assert "the whole scene" in capsys.readouterr().out
    lines = (tmp_path / "a.refine.csv").read_text().splitlines()
    assert lines[0] == "surface,patches,sampling,discretisation,within,change"
    assert len(lines) == 1 + 1 + 9
    assert command(["solve", "room", "--refine-check", "--resume", str(out)]) == 2
    assert "--resume" in capsys.readouterr().err


@pytest.mark.filterwarnings("ignore:.*quanta for.*patches")
@pytest.mark.parametrize(("quanta", "known"), [(20, False), (20_000, True)])
def test_what_no_line_tells_is_a_question_mark(quanta, known):
    """Of a lamp, a plate far above it, and one beside it that no light reaches."""
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 9), (0, 1, 9), (1, 1, 9), (1, 0, 9)]
    corners += [(5, 0, 0), (6, 0, 0), (6, 1, 0), (5, 1, 0)]
    scene = rd.Scene.from_arrays(
        corners, np.arange(12).reshape(3, 4), [0, 0.2, 0.5], [1.0, 0, 0], surface=range(3), names=["lamp", "far", "never"]
    )
    found = rd.refine_check(rd.subdivide(scene, cells=1), "random-walk", quanta=quanta, replicates=2)
    assert (found.coarse.arrivals[1] > 0) == known
    text, rows = found.report(), {row["surface"]: row for row in found.table()}
    assert "nan" not in text
    assert text.splitlines()[-1] == "?: unknown, since nothing is reflected there, or no line hit it"
    assert np.isnan(rows["never"]["sampling"])
    assert np.isnan(rows["never"]["discretisation"])
    assert rows["lamp"]["sampling"] == 0  # black: its radiosity is its own light
    assert np.isnan(rows["the whole scene"]["sampling"]) != known
    assert np.isnan(rows["far"]["sampling"]) != known
