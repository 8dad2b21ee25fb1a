"""View3D's geometry: what is written reads back with the same sides, emissivities and view factors; the rest is told by name."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from samples import VS3
from test_convert import again, scenes

import radiosity as rd
from radiosity.scene.heat import Heat
from validation.closed_forms.rectangles import parallel

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
PLATES = [[0, 1, 2, 3], [4, 7, 6, 5]]  # a square that looks up, and one above it that looks down


def plates(**values) -> rd.Scene:
    """Two unit squares, 1 m apart, that face each other."""
    values = {"surface": [0, 1], "names": ["low", "high"]} | values
    return rd.Scene.from_arrays(np.concatenate([SQUARE, np.add(SQUARE, (0, 0, 1))]), PLATES, [[0.2], [0.7]], 0.0, **values)


def test_a_file_of_view3d_stays_the_same_scene(tmp_path):
    (tmp_path / "box.vs3").write_text(VS3)
    scene = rd.load_scene(tmp_path / "box.vs3")
    read, told = again(scene, tmp_path / "again.vs3")
    assert not told
    assert (tmp_path / "again.vs3").read_text().count("\nV ") == 8  # corners that faces share
    assert read.names == scene.names
    assert scene.heat is not None
    assert read.heat is not None
    assert read.heat.emissivity == scene.heat.emissivity
    np.testing.assert_array_equal(read.reflectance, scene.reflectance)
    one, other = (rd.view_factors(each, rays=2_000, method="polygons").matrix for each in (scene, read))
    np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("two_sided", [False, True])
def test_view_factors_of_two_squares_are_those_of_the_formula(two_sided, tmp_path):
    """A surface of two sides becomes two: what faces the other square has the factor, the other side has none."""
    read, told = again(plates(two_sided=two_sided), tmp_path / "x.vs3")
    words = "surfaces of two sides become two, the second called NAME_(back): 'low', 'high'"
    assert [words in text for text in told] == [True] * two_sided
    factors = rd.view_factors(read, rays=2_000, method="polygons")
    number = {name: factors.names.index(name) for name in factors.names if "(unlit)" not in name}
    assert factors.matrix[number["low"], number["high"]] == pytest.approx(parallel(1.0, 1.0), rel=1e-6)
    if two_sided:
        assert read.names == ("low", "low_(back)", "high", "high_(back)")
        others = np.array([number["low_(back)"], number["high_(back)"]])
        assert factors.matrix[others][:, list(number.values())] == pytest.approx(0, abs=1e-9)


@given(scenes())
@hypothesis_settings(max_examples=6, deadline=None)
def test_sides_of_all_kinds_read_back(tmp_path_factory, scene):
    """Each side is a face with its emissivity, in the order of the file; colours are told, and means."""
    read, told = again(scene, tmp_path_factory.mktemp("scene") / "x.vs3")
    expected = []
    for surface in range(len(scene.names)):
        rows = scene.surface == surface
        for side in (scene.reflectance, scene.back_reflectance)[: 2 if scene.back[rows][0] == rd.Back.RADIATES else 1]:
            expected.append((scene.area[rows].sum(), side[rows].mean()))
    found = [(read.area[read.surface == i].sum(), read.reflectance[read.surface == i].mean()) for i in range(len(read.names))]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
    assert (read.back == rd.Back.ABSORBS).all()
    assert any("bands become one" in text for text in told) == bool((np.ptp(scene.reflectance, axis=1) > 0).any())
    assert any("panes become opaque" in text for text in told) == bool(scene.panes.any())
    assert any("emission is left out" in text for text in told) == bool((scene.emission > 0).any())


def test_emissivities_are_those_of_heat_and_the_rest_of_it_is_told(tmp_path):
    """The emissivity of a side goes before 1 - reflectance; what View3D has no place for is named."""
    emissivity = {"front": (0.25,), "back": (0.5,)}, (0.0001,)
    heat = replace(Heat.none(2), emissivity=emissivity, temperature=np.array([300, np.nan]), surroundings=280.0)
    scene = replace(plates(two_sided=[True, False]), heat=heat)
    read, told = again(scene, tmp_path / "x.vs3")
    assert read.heat is not None
    assert read.heat.emissivity == ((0.25,), (0.5,), (0.001,))
    text = "\n".join(told)
    for words in (
        "temperatures and heat flows are left out: 'low'",
        "surroundings is left out: '280 K'",
        "reflectances read back as 1 - emissivity: 'low', 'high'",
        "below 0.001 become 0.001, the least that View3D takes: 'high'",
    ):
        assert words in text


def test_obstructions_stay_obstructions_behind_all_surfaces(tmp_path):
    text = VS3.replace("End of data", "V 9 1 1 1\nV 10 3 1 1\nV 11 3 2 1\nO 8 9 10 11 0\nEnd")
    (tmp_path / "box.vs3").write_text(text)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        scene = rd.load_scene(tmp_path / "box.vs3")
    scene = scene.take(np.argsort(scene.surface != scene.names.index("obstruction"), kind="stable"))  # first in the scene
    read, told = again(scene, tmp_path / "again.vs3")
    assert [text for text in told if "obstructions are black" not in text] == []
    lines = (tmp_path / "again.vs3").read_text().splitlines()
    assert [line.split()[0] for line in lines[-3:]] == ["S", "O", "End"]
    assert sorted(read.names) == sorted(scene.names)
    assert read.area[read.surface == read.names.index("obstruction")] == pytest.approx([1.0])


@pytest.mark.parametrize("name", ["a, b", "! x", "wall\n2", "obstruction"])
def test_names_are_one_word(name, tmp_path):
    """Blanks and commas end a name in View3D, and ``!`` begins a comment."""
    read, told = again(plates(names=[name, "b"]), tmp_path / "x.vs3")
    assert len(read.names) == 2
    assert read.names[1] == "b"
    assert any("names that the format cannot hold" in text for text in told) == (name != "obstruction")
    assert read.reflectance.tolist() == [[1 - 0.8], [1 - 0.30000000000000004]]
