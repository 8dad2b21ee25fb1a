"""Mitsuba XML that is damaged or makes no sense ends in one clear error, never in a dead process."""

import numpy as np
import pytest
from mitsuba_rays import files

import radiosity as rd

HEAD, TAIL = '<scene version="3.0.0">', "</scene>"
WHITE = '<bsdf type="diffuse"><rgb name="reflectance" value="0.7"/></bsdf>'
QUAD = f'<shape type="rectangle">{WHITE}</shape>'
FILE = '<shape type="{}"><string name="filename" value="{}"/></shape>'


@pytest.fixture
def load(tmp_path):
    def of(text):
        (tmp_path / "scene.xml").write_bytes(text if isinstance(text, bytes) else text.encode())
        return rd.load_scene(tmp_path / "scene.xml")

    return of


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "the file is empty"),
        ("no markup", "malformed XML"),
        (HEAD + QUAD, "malformed XML.*truncated"),
        (HEAD + QUAD[:40], "malformed XML"),
        (b"\xff\xfe\0<", "malformed XML|not"),
        (HEAD + TAIL, "no shapes that can be used"),
        (f'<shape version="3.0.0" type="sphere">{WHITE}</shape>', "outermost element must be <scene>"),
        ("<html><body/></html>", "scene.xml"),
        (HEAD + '<shape type="rectangel"/>' + TAIL, r"line 1, col \d+.*no shape of type 'rectangel'"),
        (HEAD + '<shape type="rectangle"><bsdf type="difuse"/></shape>' + TAIL, "no BSDF of type 'difuse'"),
        (HEAD + '<shape type="rectangle"><ref id="gone"/></shape>' + TAIL, "gone"),
        (HEAD + '<include filename="gone.xml"/>' + TAIL, "gone.xml"),
        (HEAD + '<include filename="scene.xml"/>' + TAIL, "scene.xml"),
        (HEAD + '<default name="a" value="$a"/>' + QUAD + TAIL, "undefined parameter"),
        (HEAD + FILE.format("obj", "gone.obj") + TAIL, "'gone.obj' of this 'obj' does not exist"),
        (HEAD + FILE.format("ply", "") + TAIL, "does not exist"),
        (HEAD + '<shape type="linearcurve"/>' + TAIL, r"no shapes.*left out: 'linearcurve \(linearcurve\)'"),
        (HEAD + QUAD.replace("0.7", "-0.1") + TAIL, "reflectance of surface 'rectangle' is -0.1"),
        (HEAD + QUAD.replace("0.7", "nan") + TAIL, "nan"),
        (HEAD + QUAD.replace("0.7", "0.1,0.2") + TAIL, "scene.xml"),
        (HEAD + QUAD.replace("0.7", "green") + TAIL, "green"),
        (HEAD + '<shape type="sphere"><string name="radius" value="big"/></shape>' + TAIL, "'radius' of this 'sphere' is 'big'"),
        (HEAD + '<shape type="sphere"><float name="radius" value="nan"/></shape>' + TAIL, "must be finite"),
        (HEAD + '<shape type="sphere"><float name="radius" value="0"/>' + WHITE + "</shape>" + TAIL, "no face is left|no area"),
        (
            HEAD + '<shape type="cylinder"><float name="radius" value="1e300"/>' + WHITE + "</shape>" + TAIL,
            "check the unit|finite",
        ),
    ],
)
def test_bad_scenes(load, text, what):
    with pytest.raises(rd.SceneError, match=what) as caught:
        load(text)
    assert "scene.xml" in str(caught.value)


@pytest.mark.parametrize("matrix", ["nan" + " 0" * 15, "1e400" + " 0" * 15])
def test_a_transformation_must_be_finite(load, matrix):
    place = f'<transform name="to_world"><matrix value="{matrix}"/></transform>'
    with pytest.raises(rd.SceneError, match=r"scene\.xml"):
        load(HEAD + f'<shape type="rectangle" id="floor">{WHITE}{place}</shape>' + TAIL)


def test_the_missing_radiance_of_a_blackbody_says_what_to_do(load):
    lamp = '<spectrum name="radiance" type="blackbody"><float name="temperature" value="3000"/></spectrum>'
    light = f'<emitter type="area">{lamp}</emitter>'
    with pytest.raises(rd.SceneError, match="'blackbody' as a colour is not read; give an rgb"):
        load(HEAD + QUAD.replace(WHITE, WHITE + light) + TAIL)


def test_negative_radiance(load):
    light = '<emitter type="area"><rgb name="radiance" value="-1"/></emitter>'
    with pytest.raises(rd.SceneError, match=r"emission of surface 'rectangle' is -3\.14"):
        load(HEAD + QUAD.replace(WHITE, WHITE + light) + TAIL)


@pytest.mark.parametrize("depth", [200, 100_000])
def test_deep_nesting_does_not_end_the_process(load, depth):
    with pytest.raises(rd.SceneError, match="nested more than 100 deep"):
        load(HEAD + '<bsdf type="twosided">' * depth + "</bsdf>" * depth + TAIL)


def test_deep_nesting_in_an_included_file(load, tmp_path):
    deep = HEAD + '<bsdf type="twosided">' * 50_000 + "</bsdf>" * 50_000 + TAIL
    (tmp_path / "deep.xml").write_text(deep)
    with pytest.raises(rd.SceneError, match=r"deep\.xml.*nested more than 100 deep"):
        load(HEAD + '<default name="name" value="deep"/><include filename="$name.xml"/>' + TAIL)


def test_entities_are_not_read_from_other_files(load, tmp_path):
    (tmp_path / "secret.txt").write_text("classified")
    head = '<!DOCTYPE scene [<!ENTITY secret SYSTEM "secret.txt">]>'
    for text in (QUAD + "&secret;", QUAD.replace('type="rectangle"', 'type="&secret;"')):
        with pytest.raises(rd.SceneError, match="document type") as caught:
            load(head + HEAD + text + TAIL)
        assert "classified" not in str(caught.value)


def test_references_that_multiply_are_bounded(load, monkeypatch):
    from radiosity.scene.formats import mitsuba as mitsuba_xml

    monkeypatch.setattr(mitsuba_xml, "MOST_SHAPES", 1000)
    groups = "".join(f'<shape type="shapegroup" id="g{i}"><ref id="g{i - 1}"/><ref id="g{i - 1}"/></shape>' for i in range(1, 16))
    first = f'<shape type="shapegroup" id="g0">{QUAD}</shape>'
    with pytest.raises(rd.SceneError, match="more than 1000 shapes"):
        load(HEAD + first + groups + '<shape type="instance"><ref id="g15"/></shape>' + TAIL)


@pytest.mark.parametrize("plugin", ["obj", "ply", "serialized"])
def test_damaged_meshes(load, tmp_path, plugin):
    name = files(tmp_path)[plugin, False]
    whole = (tmp_path / name).read_bytes()
    text = HEAD + FILE.replace("</shape>", WHITE + "</shape>").format(plugin, name) + TAIL
    assert load(text).n_faces == 6
    faces = {"obj": (b"f 1 2 3", b"f 1 2 99"), "ply": (b"3 0 1 2", b"3 0 1 99"), "serialized": (whole[-40:-30], b"damaged...")}
    for damaged in (whole[: len(whole) // 2], whole.replace(*faces[plugin]), b"\0" * 100, b""):
        (tmp_path / name).write_bytes(damaged)
        with pytest.raises(rd.SceneError, match=rf"{name}|no face"):
            load(text)


def test_a_damaged_texture(load, tmp_path):
    (tmp_path / "wood.png").write_bytes(b"\x89PNG not at all")
    texture = '<texture type="bitmap" name="reflectance"><string name="filename" value="wood.png"/></texture>'
    with pytest.raises(rd.SceneError, match=r"wood\.png.*cannot be decoded"):
        load(HEAD + f'<shape type="rectangle"><bsdf type="diffuse">{texture}</bsdf></shape>' + TAIL)


@pytest.mark.parametrize("film", [(0, 10), (10, -1)])
def test_impossible_cameras(load, film):
    size = '<integer name="width" value="{}"/><integer name="height" value="{}"/>'.format(*film)
    with pytest.raises(rd.SceneError, match="film of"):
        load(HEAD + QUAD + f'<sensor type="perspective"><film type="hdrfilm">{size}</film></sensor>' + TAIL)


def test_reflectance_of_one_is_brought_down(load):
    with pytest.warns(rd.RadiosityWarning, match="brought down"):
        scene = load(HEAD + QUAD.replace("0.7", "1.0") + TAIL)
    np.testing.assert_allclose(scene.reflectance, [[0.95]])


@pytest.mark.parametrize(
    ("rotation", "length"),
    [
        ('<rotate x="1" y="1" angle="90"/>', "1.414"),
        ('<rotate x="$two" angle="5"/>', "2"),
        ('<rotate value="0, 0.5, 0" angle="5"/>', "0.5"),
        ('<rotate x="1" angle="5"/>', None),
        ('<rotate x="0.6" z="-0.8" angle="5"/>', None),
        ('<rotate x="0.577" y="0.577" z="0.577" angle="5"/>', None),
        ('<rotate x="3" angle="0"/>', None),
    ],
)
def test_rotations_that_are_none_are_told(load, rotation, length):
    """Mitsuba does not make the axis one of unit length, and its matrix then is no rotation."""
    place = f'<transform name="to_world">{rotation}</transform>'
    text = f'{HEAD}<default name="two" value="2"/>\n<shape type="cube">{WHITE}{place}</shape>{TAIL}'
    if length is None:
        np.testing.assert_allclose(load(text).area.sum(), 24, rtol=2e-3)
        return
    with pytest.warns(rd.errors.RadiosityWarning, match=rf"axis of length 1: 'scene.xml, line 2 \(length {length}\)'"):
        scene = load(text)
    assert abs(scene.area.sum() / 24 - 1) > 0.001
