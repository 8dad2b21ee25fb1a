"""Line sets: lines counted once, and solved for any light; against closed forms, and to the bit against the matrix method.

About 15 comparisons at 5 standard errors (Student with 15 degrees of freedom: p below 2e-4 each), and seeds are fixed.
"""

from dataclasses import replace

import numpy as np
import pytest
from enclosures import cube, cube_irradiance, parallel_squares

import radiosity as rd
from radiosity.factors.solve import of_both_ways

SAME = ("irradiance", "irradiance_standard_error", "arrivals", "surface_power")


@pytest.fixture(scope="module")
def room():
    return rd.subdivide(rd.load_scene("room"), cells=2)


@pytest.fixture(scope="module")
def lines(room):
    return rd.trace_lines(room, quanta=8_000, sources={"light": "front"})


def equal(one: rd.LineSet, other: rd.LineSet) -> bool:
    return np.array_equal(one.pairs.keys, other.pairs.keys) and np.array_equal(one.pairs.counts, other.pairs.counts)


def dark(scene: rd.Scene) -> rd.Scene:
    """The same geometry without light, in other colours."""
    bare = {name: np.zeros_like(scene.emission) for name in ("emission", "back_emission")}
    return replace(scene, reflectance=0.5 * scene.reflectance, **bare)


def test_the_furnace_is_exact():
    """In a closed room where E = 1 - rho everywhere B is 1, whatever rho is, since rows sum to one."""
    lines = rd.trace_lines(rd.subdivide(cube(0.5, 0.0), cells=3), rays=20_000)
    reflectance = np.random.default_rng(1).uniform(0, 0.95, (len(lines.patches), 4))
    solution = lines.solve(emission=1 - reflectance, reflectance=reflectance)
    assert solution.radiosity == pytest.approx(np.ones((54, 4)), abs=1e-8)
    assert solution.bands == ("band 0", "band 1", "band 2", "band 3")
    assert [abs(book["rounding"]) < 1e-8 for book in solution.books] == [True] * 4


def test_a_black_lamp_lights_the_square_before_it_by_the_exact_form_factor():
    scene, exact = parallel_squares()
    names = scene.names
    lines = rd.trace_lines(rd.subdivide(dark(scene), cells=1), rays=100_000, replicates=16)
    solution = lines.solve(emission={names[0]: 3.0})
    error = solution.irradiance_standard_error[1, 0]
    assert abs(solution.irradiance[1, 0] - 3 * exact) < 5 * error
    assert 0 < error < 0.02 * exact
    other = lines.solve(emission={names[1]: 3.0})
    assert abs(other.irradiance[0, 0] - 3 * exact) < 5 * other.irradiance_standard_error[0, 0]


@pytest.mark.parametrize("seed", [1, 2])
def test_one_set_solves_many_lights_and_colours(seed):
    """Of a cube whose walls are one patch each: the equation with exact form factors."""
    lines = rd.trace_lines(rd.subdivide(cube(0.2, 0.0), cells=1), rays=200_000, replicates=16, seed=seed)
    generator = np.random.default_rng(seed)
    emission, reflectance = generator.uniform(0, 5, (6, 2)), generator.uniform(0, 0.9, (6, 2))
    solution = lines.solve(emission, reflectance, bands=["short", "long"])
    assert solution.bands == ("short", "long")
    exact = np.stack([cube_irradiance(reflectance[:, band], emission[:, band]) for band in range(2)], axis=1)
    assert (np.abs(solution.irradiance - exact) < 5 * solution.irradiance_standard_error).all()
    assert solution.irradiance == pytest.approx(exact, rel=0.02)


def test_it_solves_to_the_bits_of_the_matrix_method(room, lines):
    """With the scene's light, from the same counts: values, errors, energy balance and surfaces."""
    method = rd.solve(room, rd.Method(order="matrix"), quanta=8_000)
    assert np.array_equal(method.state["keys"], lines.pairs.keys)
    assert np.array_equal(method.state["counts"], lines.pairs.counts)
    solution = lines.solve()
    assert all(np.array_equal(getattr(solution, name), getattr(method, name)) for name in SAME)
    assert solution.books == method.books
    assert (solution.rays, solution.quanta, solution.replicates) == (method.rays, method.quanta, method.replicates)
    assert solution.surface_interval()[0] == pytest.approx(method.surface_interval()[0], rel=1e-12)
    assert solution.provenance["line_set"]["sources"] == ["light (front)"]
    assert "matrix" in solution.report()


def test_lines_do_not_depend_on_light(room, lines):
    """A scene that emits nothing has the same lines; a set that goes on from it keeps them."""
    other = rd.subdivide(dark(room.scene), cells=2)
    found = rd.trace_lines(other, quanta=8_000, sources={"light": "front"})
    assert equal(found, lines)
    with pytest.raises(rd.SceneError, match=r"no surface emits; give an emission, such as emission=\{'south wall': 100\}"):
        found.solve()
    solution = found.solve(emission=room.emission, reflectance=room.reflectance)
    assert np.array_equal(solution.irradiance, lines.solve().irradiance)


@pytest.mark.parametrize("kind", ["local", "spans"])
def test_stages_and_resumed_runs_end_in_the_same_bits(room, kind):
    whole = rd.trace_lines(room, quanta=9000, lines=kind, replicates=3)
    half = rd.trace_lines(room, quanta=5000, lines=kind, replicates=3)
    assert not equal(half, whole)
    more = rd.trace_lines(room, quanta=9000, lines=kind, replicates=3, resume=half)
    assert equal(more, whole)
    assert (more.rays, more.quanta, more.provenance) == (whole.rays, 9000, whole.provenance)
    assert equal(rd.trace_lines(room, quanta=500, lines=kind, replicates=3, resume=whole), whole)  # none are taken away


def test_sources_have_a_quarter_of_all_lines_by_area(room):
    lines = rd.trace_lines(room, quanta=40_000, replicates=2, sources=["light", "low*"])
    assert lines.sources == ("light", "low box")
    chosen = np.isin(room.surface, [room.scene.names.index(name) for name in lines.sources])
    area = room.area
    share = 0.75 * area / area.sum() + 0.25 * np.where(chosen, area, 0) / area[chosen].sum()
    assert np.abs(lines.pairs.lines - np.maximum(40_000 * share, 4)).max() <= 1
    plain = rd.trace_lines(room, quanta=40_000, replicates=2)
    assert np.abs(plain.pairs.lines - np.maximum(40_000 * area / area.sum(), 4)).max() <= 1


def test_sources_have_their_share_where_lines_count_one_way(room):
    passing = rd.subdivide(replace(room.scene, back=np.full_like(room.scene.back, int(rd.Back.PASSES))), cells=2)
    lines = rd.trace_lines(passing, quanta=40_000, replicates=2, sources=["light"])
    assert not lines.both_ways
    share = lines.pairs.lines[:, passing.surface == 8].sum() / lines.pairs.lines.sum()
    area = passing.area[passing.surface == 8].sum() / passing.area.sum()
    assert share == pytest.approx(0.25 + 0.75 * area, abs=0.001)


def test_one_way_counts_lines_where_they_begin(room, lines):
    plain = lines.one_way
    assert equal(plain, lines)
    assert (lines.both_ways, plain.both_ways) == (True, False)
    for factors, whole in zip(plain.pairs.factors(), lines.pairs.factors(), strict=True):
        rows, area = factors.dense(), room.area[:, None]
        assert rows.sum(axis=1) + factors.escaped + factors.lost == pytest.approx(np.ones(len(room)), abs=1e-12)
        assert np.abs(area * rows - (area * rows).T).max() > 1e-2  # not reciprocal
        both = area * whole.dense()
        assert np.abs(both - both.T).max() < 1e-4
    direct = rd.trace_lines(room, quanta=8_000, sources={"light": "front"}, both_ways=False)
    assert equal(direct, plain)
    assert np.array_equal(direct.solve().irradiance, plain.solve().irradiance)


def test_stated_intervals_hold_the_exact_irradiance():
    """Of 300 intervals (25 seeds, 6 walls, 2 bands) at 30 lines a patch and replicate, 95 % and no fewer than 92 %."""
    patches, generator = rd.subdivide(cube(0.2, 0.0), cells=1), np.random.default_rng(3)
    emission, reflectance = generator.uniform(0, 5, (6, 2)), generator.uniform(0, 0.9, (6, 2))
    exact = np.stack([cube_irradiance(reflectance[:, band], emission[:, band]) for band in range(2)], axis=1)
    inside = []
    for seed in range(25):
        low, high = rd.trace_lines(patches, quanta=200, seed=seed).solve(emission, reflectance).interval(0.95, "irradiance")
        inside.append(((low <= exact) & (exact <= high)).mean())
    assert 0.92 <= np.mean(inside) <= 0.99


def test_form_factors_are_made_once_for_many_lights(room, lines, monkeypatch):
    from radiosity.factors import counted

    made = []
    monkeypatch.setattr(counted, "of_both_ways", lambda *given: made.append(1) or of_both_ways(*given))
    fresh = replace(lines, pairs=replace(lines.pairs))
    first, second = fresh.solve(), fresh.solve(emission={"light": 80.0})
    assert len(made) == 8
    assert second.irradiance == pytest.approx(2 * first.irradiance, rel=1e-9)
    monkeypatch.setattr(counted, "KEPT", 0)  # too large to be kept
    assert np.array_equal(fresh.solve().irradiance, first.irradiance)
    assert len(made) == 16


def test_lights_that_few_lines_begin_at_are_told(room):
    """By name, where they emit much of the power."""
    lines = rd.trace_lines(room, quanta=3_000)
    text = r"few lines begin at what emits: 'light' \(from 16 lines .*sources=\['light'\]"
    with pytest.warns(rd.RadiosityWarning, match=text):
        lines.solve()
    lines.solve(emission=1.0)  # all surfaces emit, and the light's share is small
    rd.trace_lines(room, quanta=3_000, sources=["light"]).solve()
