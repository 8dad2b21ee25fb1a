"""Budgets, files and goings-on of every preset, and what runs of all kinds share."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.run import budget

FIRST = 1 << 15  # quanta of the first stage, so that short runs have several


@pytest.fixture
def short(monkeypatch):
    monkeypatch.setattr(budget, "FIRST_STAGE", FIRST)


@pytest.fixture(scope="module")
def coloured():
    return rd.subdivide(rd.load_scene("cornell-box"), cells=3)


@pytest.mark.parametrize("name", rd.PRESETS)
def test_rays_are_met_within_five_percent_in_colour(name):
    """Bands that differ much: lines follow what the method does with all of them together."""
    scene = rd.load_scene("room")
    reflectance = np.column_stack([scene.reflectance[:, 0], scene.reflectance[:, 0] / 8, np.zeros(scene.n_faces)])
    tinted = rd.Scene.from_arrays(
        scene.vertices, scene.faces, reflectance, scene.emission * [[1.0, 0.0, 2.0]], surface=scene.surface, names=scene.names
    )
    solution = rd.solve(rd.subdivide(tinted, cells=4), name, rays=500_000, replicates=4)
    assert solution.rays == pytest.approx(500_000, rel=0.05)


@pytest.mark.parametrize("name", rd.PRESETS)
def test_rays_are_met_after_several_stages(name, short):
    solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), name, rays=200_000, replicates=2)
    assert solution.rays == pytest.approx(200_000, rel=0.05)


@pytest.mark.parametrize("name", rd.PRESETS)
def test_quanta_replay_the_bits_and_files_keep_them(name, coloured, tmp_path):
    solution = rd.solve(coloured, name, rays=200_000, replicates=3)
    again = rd.solve(coloured, name, quanta=solution.quanta, replicates=3)
    assert np.array_equal(again.irradiance, solution.irradiance)
    solution.save(tmp_path / "run.npz")
    loaded = rd.load_solution(tmp_path / "run.npz")
    assert np.array_equal(loaded.irradiance, solution.irradiance)
    assert loaded.report() == solution.report()


@pytest.mark.parametrize("name", rd.PRESETS)
def test_a_run_goes_on_to_the_bits_of_a_longer_one(name, coloured, short):
    """From a power of two, which every process allows."""
    few = rd.solve(coloured, name, quanta=FIRST // 2, replicates=2)
    more = rd.solve(coloured, name, quanta=FIRST, replicates=2, resume=few)
    assert np.array_equal(more.irradiance, rd.solve(coloured, name, quanta=FIRST, replicates=2).irradiance)


def test_few_ends_for_form_factors_warn(coloured):
    with pytest.warns(rd.RadiosityWarning, match="ends of spans a patch"):
        rd.solve(coloured, "global-form-factors", rays=50_000)


def test_another_order_drops_the_warm_up(coloured):
    solution = rd.solve(coloured, "stochastic-jacobi", order="incremental", rays=100_000)
    assert solution.provenance["method"] == "discrete/local/incremental/halton"
    assert not rd.method.resolve("stochastic-jacobi", lines="global").warm_up


def test_going_on_by_another_method_names_what_differs(coloured):
    solution = rd.solve(coloured, "random-walk", rays=100_000)
    with pytest.raises(rd.MethodError, match=r"numbers \(halton then, sobol now\)") as raised:
        rd.solve(coloured, rays=200_000, numbers="sobol", resume=solution)
    assert "{" not in str(raised.value)
