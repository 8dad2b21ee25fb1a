"""The light that a line set is solved for: values by patch, surface and name, their errors, and scenes at the edges."""

from dataclasses import replace

import numpy as np
import pytest
from enclosures import cube, cube_irradiance

import radiosity as rd
from radiosity.patches.nesting import halved, parents
from radiosity.patches.relit import relit
from radiosity.scene.paint import Paint


@pytest.fixture(scope="module")
def room():
    """A cube in which wall 5 emits, of two patches a wall."""
    scene = cube(0.5, 0.0)
    emission = np.where(scene.surface[:, None] == 5, 2.0, 0.0)
    scene = replace(scene, emission=emission, back_emission=emission)
    ones = np.ones(6, np.int32)
    return rd.Patches(scene, ones, 2 * ones)


@pytest.fixture(scope="module")
def lines(room):
    return rd.trace_lines(room, quanta=2_000, replicates=3)


def square(back=rd.Back.ABSORBS, emission=0.0, reflectance=0.5, **choices) -> rd.Scene:
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    return rd.Scene.from_arrays(corners, [[0, 1, 2, 3]], reflectance, emission, back=[back], names=["plate"], **choices)


def test_one_number_is_for_all_patches(lines):
    """The furnace."""
    solution = lines.solve(emission=0.3, reflectance=0.7)
    assert solution.radiosity == pytest.approx(np.ones((12, 1)), abs=1e-9)


def test_names_change_some_surfaces_and_leave_the_others(room, lines):
    solution = lines.solve(emission={"wall 0": 3.0}, reflectance={"wall [0-2]": 0.1, "wall 1": 0.2})
    patches, surface = solution.patches, room.surface
    assert np.array_equal(patches.emission[:, 0], np.array([3.0, 0, 0, 0, 0, 2.0])[surface])
    assert np.array_equal(patches.reflectance[:, 0], np.array([0.1, 0.2, 0.1, 0.5, 0.5, 0.5])[surface])
    assert patches.own_emission is None  # the scene says it all
    assert np.array_equal(patches.scene.emission[:, 0], [3.0, 0, 0, 0, 0, 2.0])


@pytest.mark.parametrize("shape", ["surfaces", "surfaces, bands", "patches", "patches, bands", "bands"])
def test_arrays_by_surface_and_by_patch(room, lines, shape):
    values = np.arange(1.0, 7.0)
    by_patch = values[room.surface]
    given = {
        "surfaces": values,
        "surfaces, bands": values[:, None] * [1, 2],
        "patches": by_patch,
        "patches, bands": by_patch[:, None] * [1, 2],
        "bands": [[1.0, 2.0]],
    }[shape]
    expected = np.ones((12, 1)) * [1, 2] if shape == "bands" else by_patch[:, None] * ([1, 2] if "bands" in shape else [1])
    found = relit(room, given)
    assert np.array_equal(found.emission, expected)
    assert found.reflectance.shape == expected.shape
    assert np.array_equal(lines.solve(given).radiosity, lines.solve(expected).radiosity)


def test_values_within_a_face_are_kept_and_survive_a_file(room, lines, tmp_path):
    """Patches of a face that differ have values of their own; the scene has their means."""
    emission, reflectance = np.linspace(0, 3, 24).reshape(12, 2), np.linspace(0.1, 0.9, 12)
    solution = lines.solve(emission, reflectance)
    assert np.array_equal(solution.patches.emission, emission)
    assert np.array_equal(solution.patches.reflectance, np.stack([reflectance, reflectance], axis=1))
    assert solution.patches.scene.emission == pytest.approx(emission.reshape(6, 2, 2).mean(axis=1))
    solution.save(tmp_path / "a.npz")
    loaded = rd.load_solution(tmp_path / "a.npz")
    assert np.array_equal(loaded.radiosity, solution.radiosity)
    assert loaded.patches.hash == solution.patches.hash != room.hash
    again = rd.solve(loaded.patches, rd.Method(order="matrix"), quanta=2_000, replicates=3)
    assert np.abs(again.irradiance - solution.irradiance).max() < 0.2 * solution.irradiance.max()
    solution.export(tmp_path / "a.csv")
    solution.export(tmp_path / "a.glb")


def test_a_refined_mesh_keeps_the_values_of_patches(room):
    """The four parts of a patch have its value, on both sides; so a refine check of such a solution is right."""
    two_sided = replace(room, scene=replace(room.scene, back=np.full(6, int(rd.Back.RADIATES), np.uint8)))
    values = np.linspace(0.1, 0.8, 24)[:, None]
    fine = halved(relit(two_sided, emission=values, reflectance=values))
    assert np.array_equal(fine.reflectance, values[parents(fine, two_sided)])
    assert np.array_equal(fine.emission, fine.reflectance)
    assert fine.area @ fine.emission == pytest.approx(two_sided.area @ values)


def test_bands_may_be_others_than_those_of_the_scene(lines):
    colors = replace(lines.patches.scene, reflectance=np.repeat(lines.patches.scene.reflectance, 3, axis=1))
    assert lines.solve(emission={"wall 0": [1, 2, 3, 4]}).bands == ("band 0", "band 1", "band 2", "band 3")
    assert lines.solve(emission={"wall 0": [1, 2, 3]}).bands == ("red", "green", "blue")
    assert lines.solve(bands=["thermal"]).bands == ("thermal",)
    colors = replace(colors, emission=np.repeat(colors.emission, 3, axis=1), back_emission=np.zeros((6, 3)), bands=tuple("rgb"))
    colors = replace(colors, back_reflectance=colors.reflectance)
    found = rd.trace_lines(rd.Patches(colors, lines.patches.columns, lines.patches.rows), quanta=2_000, replicates=3)
    assert found.solve().bands == ("r", "g", "b")
    assert found.solve(emission=1.0, reflectance=0.5).bands == ("grey",)
    assert np.array_equal(found.solve().irradiance[:, [0]], lines.solve().irradiance)
    for one, other in (("emission", "reflectance"), ("reflectance", "emission")):
        with pytest.raises(rd.SceneError, match="has 2 bands, and there are 3; give emission and reflectance in the same"):
            found.solve(**{one: [[0.1, 0.2]]})
        assert found.solve(**{one: [[0.1, 0.2]], other: 0.5}).irradiance.shape == (12, 2)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"emission": {"lamp": 1}}, "no surface is called 'lamp'; there are 6, such as wall 0"),
        ({"emission": {"wall 0": float("nan")}}, r"emission of patch 0 \(surface 'wall 0', band 0\) is nan; it must be finite"),
        ({"emission": {"wall 1": [1, -2]}}, r"emission of patch 2 \(surface 'wall 1', band 1\) is -2; .*not negative"),
        ({"emission": np.inf}, "is inf; it must be finite"),
        ({"reflectance": {"wall 0": 1}}, r"reflectance of patch 0 .* is 1; it must lie in \[0, 1\): strictly below 1"),
        ({"reflectance": np.full(12, 1.5)}, "is 1.5; it must lie"),
        ({"reflectance": np.full(7, 0.5)}, r"reflectance has shape \(7,\); expected one number"),
        ({"reflectance": np.zeros((12, 0))}, r"reflectance has shape \(12, 0\); expected"),
        ({"emission": "bright"}, "emission cannot be read as numbers"),
        ({"emission": 1j * np.ones(3)}, "complex"),
        ({"emission": {"wall 0": "bright"}}, "emission of 'wall 0' cannot be read as numbers"),
        ({"emission": {"wall 0": [[1]]}}, r"emission of 'wall 0' has shape \(1, 1\)"),
        ({"emission": {"wall 0": []}}, r"emission of 'wall 0' has shape \(0,\)"),
        ({"emission": {0: 1}}, "names a surface 0; it must be a text"),
        ({"emission": {"wall 0": {"top": 1}}}, "has a side 'top'; sides are front and back"),
        ({"emission": {"wall 0": {"back": 1}}}, "its back does not radiate"),
        ({"emission": {"wall 0": {}}}, "has no side"),
        ({"emission": 0.0}, "no surface emits; give an emission"),
        ({"bands": ["a", "b"]}, "2 band names for 1 bands"),
    ],
)
def test_wrong_light_is_one_error(lines, given, message):
    with pytest.raises(rd.RadiosityError, match=message):
        lines.solve(**given)


def test_a_table_by_surface_or_by_patch_must_be_told_apart():
    """Where there are as many patches as surfaces, in another order."""
    scene = cube(0.5, 1.0)
    turned = replace(scene, surface=scene.surface[::-1].copy())
    same, other = rd.subdivide(scene, cells=1), rd.subdivide(turned, cells=1)
    assert np.array_equal(relit(same, np.arange(6.0)).emission[:, 0], np.arange(6.0))
    with pytest.raises(rd.SceneError, match="as many patches as surfaces, in another order; give a dictionary"):
        relit(other, np.arange(6.0))


def test_an_emission_goes_to_the_sides_that_emit():
    """A lamp of two radiating sides whose front alone emits keeps a dark back; where neither emits, both begin to."""
    for front, back, expected in ((1.0, 0.0, [5, 0]), (0.0, 1.0, [0, 5]), (1.0, 1.0, [5, 5]), (0.0, 0.0, [5, 5])):
        patches = rd.subdivide(square(rd.Back.RADIATES, front, back_emission=[back]), cells=1)
        assert relit(patches, {"plate": 5.0}).emission[:, 0].tolist() == expected
        assert relit(patches, {"plate": {"front": 1.0, "back": 2.0}}).emission[:, 0].tolist() == [1, 2]
        assert relit(patches, {"plate": {"back": 2.0}}).emission[:, 0].tolist() == [front, 2]
        assert relit(patches, reflectance={"plate": 0.2}).reflectance[:, 0].tolist() == [0.2, 0.2]


def test_textures_stay_where_they_are_not_replaced():
    """Colours vary within each face; surfaces that are not named keep the means over their patches."""
    scene, color = cube(0.8, 0.0), np.random.default_rng(1).uniform(0.5, 1.0, (6, 4, 1)).astype(np.float32)
    nowhere = Paint((), np.full(6, -1, np.int32), np.zeros((6, 4, 2), np.float32), color, 1.0)
    patches = rd.subdivide(replace(scene, reflectance_paint=nowhere), cells=3)
    assert len(np.unique(patches.reflectance)) == 54
    lines = rd.trace_lines(patches, quanta=5_000, replicates=3)
    only_light = lines.solve(emission=1.0)
    assert only_light.patches.scene.reflectance_paint is patches.scene.reflectance_paint
    assert np.array_equal(only_light.patches.reflectance, patches.reflectance)
    wall = patches.surface == 0
    found = lines.solve(emission=1.0, reflectance={"wall 0": 0.1}).patches
    assert np.array_equal(found.reflectance, np.where(wall[:, None], 0.1, patches.reflectance))
    assert np.array_equal(lines.solve(emission=[[1.0, 2.0]]).patches.reflectance, np.repeat(patches.reflectance, 2, axis=1))
    furnace = lines.solve(emission=1 - patches.reflectance)
    assert furnace.radiosity == pytest.approx(np.ones((54, 1)), abs=1e-8)


def test_one_replicate_has_no_errors_and_says_so(room):
    solution = rd.trace_lines(room, quanta=3_000, replicates=1).solve()
    assert np.isnan(solution.irradiance_standard_error).all()
    assert "unknown (one replicate" in solution.report()
    exact = np.repeat(cube_irradiance(np.full(6, 0.5), np.array([0, 0, 0, 0, 0, 2.0])), 2)
    assert solution.irradiance[:, 0] == pytest.approx(exact, rel=0.3)


@pytest.mark.parametrize("back", [rd.Back.ABSORBS, rd.Back.RADIATES, rd.Back.PASSES])
def test_where_all_lines_escape_nothing_is_received(back):
    """One face, one patch a side."""
    lines = rd.trace_lines(rd.subdivide(square(back), cells=1), rays=10_000, replicates=2)
    solution = lines.solve(emission=3.0)
    sides = 2 if back == rd.Back.RADIATES else 1
    assert solution.irradiance.tolist() == [[0.0]] * sides
    assert solution.books[0]["escaped"] == pytest.approx(3.0 * sides, rel=1e-12)
    assert solution.arrivals.tolist() == [0] * sides
    assert solution.status == "complete"
    assert (solution.irradiance_standard_error > 0).all()  # no line hit: the value is unknown, and not 0 for certain


def test_open_lamps_are_refused():
    with pytest.raises(rd.MethodError, match=r"lines pass through the lamps 'plate' \(null BSDF\)"):
        rd.trace_lines(square(rd.Back.OPEN, reflectance=0.0), rays=1_000)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "give exactly one of rays, seconds and quanta to trace_lines"),
        ({"rays": 100, "seconds": 1}, "give exactly one"),
        ({"rays": -1}, "rays is -1"),
        ({"rays": "many"}, "rays is 'many'"),
        ({"quanta": 2**62}, "would take centuries"),
        ({"rays": 100, "replicates": 0}, "replicates is 0"),
        ({"rays": 100, "seed": -1}, "seed is -1"),
        ({"rays": 100, "first_replicate": 0.5}, "first_replicate is 0.5"),
        ({"rays": 100, "lines": "curved"}, "lines 'curved' does not exist"),
        ({"rays": 100, "numbers": "dice"}, "numbers 'dice' does not exist"),
        ({"rays": 100, "both_ways": "yes"}, "both_ways is 'yes'"),
        ({"rays": 100, "sources": 3}, "sources is 3; it must be a list of names"),
        ({"rays": 100, "sources": [3]}, r"sources is \[3\]"),
        ({"rays": 100, "sources": ["lamp"]}, "no surface is called 'lamp'"),
        ({"rays": 100, "sources": {"wall 0": "back"}}, r"no patch is on 'wall 0' \(back\)"),
        ({"rays": 100, "sources": {"wall 0": "top"}}, "has the side 'top'; known are both, front, back"),
        ({"rays": 100, "sources": ["wall 0"], "lines": "spans"}, "lines 'spans' begin at no surface"),
        ({"rays": 100, "resume": 3}, "resume takes a LineSet, not int"),
        ({"rays": 100, "memory": "1K"}, "would take about .* of memory, and .* are allowed"),
        ({"rays": 100, "checkpoint": "a.txt"}, "a checkpoint is an .npz file"),
    ],
)
def test_wrong_choices_are_one_error(room, given, message):
    with pytest.raises(rd.RadiosityError, match=message):
        rd.trace_lines(room, **given)


def test_other_things_than_scenes_are_refused(room, lines):
    for thing in (3, "room", lines.solve(), lines):
        with pytest.raises(rd.MethodError, match="trace_lines takes a Scene or Patches"):
            rd.trace_lines(thing, rays=100)
    with pytest.raises(rd.MethodError, match="cannot go on from lines of 12 patches with 6"):
        rd.trace_lines(rd.subdivide(room.scene, cells=1), rays=100, resume=lines)


def test_too_many_lines_for_so_few_are_told(room):
    """Each patch has 4 lines in each replicate at least."""
    with pytest.warns(rd.RadiosityWarning, match=r"96 lines were traced, 9.6 times the 10 asked for"):
        rd.trace_lines(room, rays=10, replicates=2)


def test_pairs_beyond_the_limit_are_refused_or_end_the_run(room, monkeypatch):
    from radiosity.algorithms.matrix import algorithm as matrix

    monkeypatch.setattr(matrix, "LIMIT", 30)
    monkeypatch.setattr(matrix, "LAUNCH", 40)
    with pytest.raises(rd.MethodError, match=r"12 patches in 8 replicates may come to .* take fewer replicates, fewer patches"):
        rd.trace_lines(room, quanta=1_000)
    monkeypatch.setattr(matrix, "LIMIT", 120)
    with pytest.warns(rd.RadiosityWarning, match="lines were traced, and no more: the form factors of 12 patches"):
        lines = rd.trace_lines(room, quanta=1_000, replicates=2)
    assert 0 < lines.quanta < 1_000
    assert np.array_equal(lines.pairs.keys, rd.trace_lines(room, quanta=lines.quanta, replicates=2).pairs.keys)
