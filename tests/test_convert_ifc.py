"""IFC models that are written read back with the same names, sides, areas and reflectances; the rest is told by name."""

import importlib
import sys

import numpy as np
import pytest
from test_convert import again, check_same

import radiosity as rd
from radiosity.image.tone import srgb
from radiosity.scene.formats.ifc import ONE_SIDED, OWN, Reader
from radiosity.scene.formats.ifc.run import Product

CUBE = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
RGB = ("red", "green", "blue")
INWARD = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (1, 5, 7, 3), (3, 7, 6, 2), (2, 6, 4, 0)])


def scene_of(back: int = 0, **values) -> rd.Scene:
    """A closed box whose fronts look inward, with a floor of two materials below it."""
    corners = np.concatenate([CUBE, [(0, 0, -1), (1, 0, -1), (0, 1, -1), (3, 0, -1)]])
    faces = [*INWARD.tolist(), [8, 9, 10, -1], [9, 11, 10, -1]]
    values = {"surface": [0] * 6 + [1, 1], "names": ["box", "floor 'β'"], "bands": RGB, "back": back} | values
    return rd.Scene.from_arrays(corners, faces, [[0.1, 0.2, 0.9]] * 7 + [[0.5, 0.5, 0.5]], 0.0, **values)


def test_without_ifcopenshell_the_extra_is_named_and_nothing_is_written(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "ifcopenshell", None)
    with pytest.raises(rd.OutputError, match=r"needs 'ifcopenshell'; pip install 'radiosity\[ifc\]'"):
        rd.save_scene(scene_of(), tmp_path / "x.ifc")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("side", [ONE_SIDED, "BOTH"])
def test_own_surfaces_keep_names_fronts_and_sides(side):
    """A closed shell of another program gets its front outside and one side; ours stay as they are, panes with their colour."""
    triangles = np.concatenate([INWARD[:, [0, 1, 2]], INWARD[:, [0, 2, 3]]])
    style = {"name": "box", "color": srgb(np.array([0.25, 0.25, 0.25])).tolist(), "transparency": 0.3, "side": side}
    reader = Reader()
    for kind in (OWN, None):
        product = Product("IfcBuildingElementProxy", "a box", (), (style,), CUBE, triangles, np.zeros(12, int), kind, 14)
        reader.add(product)
    own, other = reader.parts
    assert own.name == "a box"
    np.testing.assert_array_equal(own.faces, triangles)
    assert own.material.reflectance == pytest.approx((0.25,))
    assert own.material.transmittance == 0.3
    assert own.material.back == (rd.Back.ABSORBS if side == ONE_SIDED else rd.Back.RADIATES)
    assert other.name == "IfcBuildingElementProxy/a box/box"
    np.testing.assert_array_equal(other.faces, triangles[:, ::-1])
    assert list(reader.lost) == ["a box (2 of 14)"]


@pytest.mark.parametrize("back", [0, 1])
def test_scenes_read_back_as_they_are(back, tmp_path):
    pytest.importorskip("ifcopenshell", reason="ifcopenshell is not installed: pip install 'radiosity[ifc]'")
    scene = scene_of(back)
    read, told = again(scene, tmp_path / "x.ifc")
    assert not told
    assert read.names == scene.names
    check_same(scene, read, 1e-12)
    assert (read.back == back).all()
    inward = read.normal[read.surface == 0] * (read.frames[0] + read.frames[1] / 2 + read.frames[2] / 2 - 0.5)[read.surface == 0]
    assert (inward.sum(axis=1) < 0).all()


def test_a_scene_whose_y_is_up_stands_upright(tmp_path):
    pytest.importorskip("ifcopenshell", reason="ifcopenshell is not installed: pip install 'radiosity[ifc]'")
    level = rd.Scene.from_arrays([(0, 1, 0), (0, 1, 2), (3, 1, 0)], [(0, 1, 2)], 0.5, 0.0, names=["floor"])
    read, told = again(level, tmp_path / "x.ifc")
    assert any("the scene, whose y is up, is turned" in text for text in told)
    np.testing.assert_allclose(read.normal, [(0, 0, 1)], atol=1e-12)
    assert read.bounds[:, 2] == pytest.approx(1.0)


def test_the_file_is_valid_and_what_it_cannot_hold_is_told(tmp_path):
    ifc = pytest.importorskip("ifcopenshell", reason="ifcopenshell is not installed: pip install 'radiosity[ifc]'")
    validate = importlib.import_module("ifcopenshell.validate")
    clear = np.repeat([0.6, 0.0], [6, 2])
    scene = scene_of(1, back_reflectance=0.05, transmittance=np.where(clear, 0.05, 0), names=["x" * 300, "b\nc"])
    read, told = again(scene, tmp_path / "x.ifc")
    assert read.names == ("surface 0", "b c", "b c (back)")
    assert read.transmittance is not None
    np.testing.assert_allclose(read.transmittance, np.where(read.surface == 0, 0.05, 0), rtol=1e-12)
    assert any("names that the format cannot hold are changed" in text and "b c" in text for text in told)
    log = validate.json_logger()
    validate.validate(str(tmp_path / "x.ifc"), log)
    assert not log.statements
    file = ifc.open(str(tmp_path / "x.ifc"))
    assert {one.is_a() for one in file.by_type("IfcSpatialStructureElement")} == {"IfcSite", "IfcBuilding", "IfcBuildingStorey"}
    studio = rd.load_scene("studio")
    read, told = again(studio, tmp_path / "y.ifc")
    text = "\n".join(told)
    for words in ("emission is left out: 'lantern', 'lamp'", "cameras are left out", "patch sizes are left out"):
        assert words in text
    assert read.area.sum() == pytest.approx(studio.area.sum() + 0.6)  # the back of the lamp
