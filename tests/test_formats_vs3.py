"""View3D's geometry files."""

import numpy as np
import pytest
from samples import VS3
from test_exchange import black

import radiosity as rd
from radiosity.cli import main
from validation.closed_forms.enclosures import net
from validation.closed_forms.rectangles import parallel

FLOOR = "S  1    1  2  3  4   0   0   0.90  floor"


def load(tmp_path, text=VS3, **options) -> rd.Scene:
    (tmp_path / "box.vs3").write_text(text)
    return rd.load_scene(tmp_path / "box.vs3", **options)


def test_names_areas_fronts_and_emissivities(tmp_path):
    scene = load(tmp_path)
    assert scene.names == ("floor", "top!", "walls")  # east, north and west belong to walls
    assert len(scene.vertices) == 4 + 4 + 8  # those of each surface, once
    np.testing.assert_allclose(np.bincount(scene.surface, scene.area), [12, 12, 35], rtol=1e-6)
    assert scene.heat is not None
    assert scene.heat.emissivity == ((0.9,), (0.8,), (0.05,))
    np.testing.assert_allclose(scene.reflectance[scene.surface == 2], 0.95)
    assert (scene.back == rd.Back.ABSORBS).all()
    patches = rd.subdivide(scene, cells=1)
    inward = ((np.array([2, 1.5, 1.25]) - patches.centroid) * patches.normal).sum(axis=1)
    assert (inward > 0).all()


def test_view_factors_and_heat_are_those_of_the_box(tmp_path):
    opposite = parallel(4 / 2.5, 3 / 2.5) * 2.5**2 / 12
    factors = rd.view_factors(load(tmp_path), rays=2_000, method="polygons")
    assert factors.matrix[0, 1] == pytest.approx(opposite, rel=1e-6)
    heat = rd.radiative_exchange(rd.subdivide(load(tmp_path), cells=1), {"floor": 400, "*": 300}, rays=20_000)
    area, side = np.array([12, 12, 35.0]), 1 - opposite
    exact = [[0, opposite, side], [opposite, 0, side], [side * 12 / 35, side * 12 / 35, 1 - side * 24 / 35]]
    watts = net(area, exact, [0.9, 0.8, 0.05], black([400, 300, 300]))  # of walls of one radiosity, which is nearly so
    np.testing.assert_allclose(heat.net, watts, rtol=0.01)


def test_a_toml_keeps_and_replaces_emissivities(tmp_path):
    load(tmp_path)
    text = 'geometry = "box.vs3"\nunit = "mm"\n[[surface]]\nname = "*"\ntemperature = 300\n[[surface]]\nname = "top!"\n'
    (tmp_path / "box.toml").write_text(text + "emissivity = 0.3\n")
    scene = rd.load_scene(tmp_path / "box.toml")
    assert scene.heat is not None
    assert scene.heat.emissivity == ((0.9,), (0.3,), (0.05,))
    np.testing.assert_allclose(scene.area.sum(), 59e-6, rtol=1e-6)


def test_surfaces_of_one_name_and_without_one(tmp_path):
    with pytest.warns(rd.RadiosityWarning, match=r"surfaces of the same name get numbers .*: 'floor \(2\)'"):
        scene = load(tmp_path, VS3.replace("top!  !", "floor  !").replace("0.05  walls", "0.05"))
    assert scene.names == ("floor", "floor#2", "surface 3")


def test_what_only_obstructs_is_told(tmp_path):
    text = VS3.replace("End of data", "V 9 1 1 1\nV 10 3 1 1\nV 11 3 2 1\nO 8 9 10 11 0\nEnd")
    with pytest.warns(rd.RadiosityWarning, match="obstructions are black surfaces called 'obstruction' here.*: 'line 24'"):
        scene = load(tmp_path, text)
    assert scene.names[-1] == "obstruction"
    factors = rd.view_factors(scene, rays=20_000, method="lines")
    assert "obstruction (back)" in factors.names
    assert factors.matrix[0, 1] < parallel(4 / 2.5, 3 / 2.5) * 2.5**2 / 12


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("F 3", "F 3a", "line 3: format F 3a is not read; only F 3 is"),
        ("F 3", "F 2", "line 3: format F 2 is not read"),
        (FLOOR, "S 1 1 2 3 4 2 0 .9 window", r"surfaces within surfaces are not read: 'window \(surface, line 14\)'"),
        (FLOOR, FLOOR.replace("S", "M"), r"not read: 'floor \(mask, line 14\)'"),
        (FLOOR, FLOOR.replace("S", "N"), r"'floor \(null surface, line 14\)'"),
        (FLOOR, "S 1 1 2 3", "line 14: 'S 1 1 2 3' cannot be read; a surface is: S number v1 v2 v3 v4 base cmb emissivity name"),
        (FLOOR, "S 1 1 2 3 9 0 0 .9 floor", "line 14: surface 1 names vertex 9; there are 8 before it"),
        (FLOOR, "S 1 1 2 3 4.5 0 0 .9 floor", "names vertex 4.5"),
        (FLOOR, "S 2 1 2 3 4 0 0 .9 floor", "surface 2 comes where 1 should"),
        ("0.90", "1.5", "the emissivity of surface 1 is 1.5; it must be above 0, and 1 at most"),
        ("0.90", "0", "the emissivity of surface 1 is 0"),
        ("0.90", "nan", "cannot be read"),
        ("V  3   4. 3. 0.", "V  3   4. 3.", "line 7: 'V 3 4. 3.' cannot be read; a vertex is: V number x y z"),
        ("V  3", "V  4", "vertex 4 comes where 3 should"),
        ("0   3   0.05  east", "0   9   0.05  east", "'east' is combined with surface 9; that must be an earlier one"),
        ("0   3   0.05  north", "0   4   0.05  north", "'north' is combined with 'east', which is no surface of its own"),
        (
            "0   3   0.05  east",
            "0   3   0.06  east",
            "'east' has the emissivity 0.06, and 'walls', with which it is combined, 0.05",
        ),
        ("\nS ", "\n! ", "the file holds no surfaces"),
    ],
)
def test_what_cannot_be_read_is_one_error(tmp_path, old, new, told):
    assert old in VS3
    with pytest.raises(rd.SceneError, match=rf"box\.vs3.*{told}"):
        load(tmp_path, VS3.replace(old, new))


def test_other_lines_are_told(tmp_path):
    text = VS3.replace("F 3", "F 3\nX 1 2 3\n/ a comment")
    with pytest.warns(rd.RadiosityWarning, match=r"begin with something else than V, S and O are left out: 'X \(line 4\)'"):
        load(tmp_path, text)
    with pytest.raises(rd.SceneError, match="are left out"):
        load(tmp_path, text, strict=True)


def test_the_command_reads_it(tmp_path, capsys):
    (tmp_path / "box.VS3").write_text(VS3)
    assert main(["factors", str(tmp_path / "box.VS3"), "--rays", "2k", "--method", "lines"]) == 0
    assert "'floor', 'top!', 'walls'" in capsys.readouterr().out
