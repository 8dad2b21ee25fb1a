"""The TOML scene: looks by surface name, units, powers, and one clear error for each fault."""

from pathlib import Path

import numpy as np
import pytest
from samples import MTL, OBJ, box_gltf, ply_text, stl_bytes

import radiosity as rd
from radiosity.errors import RadiosityWarning, SceneError
from radiosity.scene import Back, Camera
from radiosity.scene.assemble import ReadOptions
from radiosity.scene.formats import read, toml
from radiosity.scene.formats.toml.schema import REQUIRED, TABLES, SceneFile

TRIANGLES = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]])


@pytest.fixture
def load(tmp_path):
    (tmp_path / "room.obj").write_text(OBJ)
    (tmp_path / "box.mtl").write_text(MTL)
    (tmp_path / "lamp.stl").write_bytes(stl_bytes(TRIANGLES * 100))
    box_gltf().write(tmp_path / "box.glb")

    def write(text):
        (tmp_path / "scene.toml").write_text(text)
        return rd.load_scene(tmp_path / "scene.toml")

    return write


def test_units_scales_and_names(load):
    scene = load("""
        geometry = ["room.obj", {file = "lamp.stl", unit = "mm", scale = 2, name = "ceiling lamp"}]
        unit = "ft"
        [[surface]]
        name = "*lamp"
        reflectance = 0.2
    """)
    assert scene.names == ("room/floor/white", "room/lamp/light", "ceiling lamp")
    np.testing.assert_allclose(scene.area, [0.3048**2, 0.3048**2, 0.2**2])
    assert scene.reflectance[2].tolist() == [0.2] * 3
    assert scene.source.endswith("scene.toml")


def test_later_entries_win_value_by_value(load):
    scene = load("""
        geometry = "room.obj"
        [[surface]]
        name = "*"
        reflectance = 0.3
        patch_size = 0.5
        emission = 7
        [[surface]]
        name = "*/white"
        reflectance = [0.1, 0.2, 0.3]
        sides = 1
        [[surface]]
        name = "room/lamp/light"
        radiance = 2
        back = "passes"
    """)
    assert scene.reflectance.tolist() == [[0.1, 0.2, 0.3], [0.3, 0.3, 0.3]]
    np.testing.assert_allclose(scene.emission, [[7] * 3, [2 * np.pi] * 3])
    assert scene.back.tolist() == [Back.ABSORBS, Back.PASSES]
    assert scene.patch_size.tolist() == [0.5, 0.5]
    assert len(rd.subdivide(scene)) == 8


def test_power_is_spread_over_all_radiating_area(load):
    scene = load("""
        geometry = ["room.obj", {file = "lamp.stl", unit = "cm", name = "lamp"}]
        [[surface]]
        name = "*lamp*"
        reflectance = 0
        power = 60
        [[surface]]
        name = "lamp"
        sides = 1
    """)
    patches = rd.subdivide(scene, cells=3)
    power = (patches.emission * patches.area[:, None]).sum(axis=0)
    np.testing.assert_allclose(power, 60)
    np.testing.assert_allclose(scene.emission[1:], 20)  # three sides of 1 m²


@pytest.mark.parametrize(
    ("later", "exitance"), [("emission = 7", 7), ("radiance = 2", 2 * np.pi), ("power = 3", 1), ("sides = 2", 20)]
)
def test_a_later_entry_takes_the_place_of_a_power(load, later, exitance):
    """Of whatever kind it is; the lamp has 1.5 m² on each of two sides, and one that gives no light leaves the power."""
    scene = load(f"""
        geometry = [{{file = "lamp.stl", unit = "cm", scale = 1.224744871391589}}]
        [[surface]]
        name = "lamp"
        reflectance = 0
        power = 60
        [[surface]]
        name = "la*"
        {later}
    """)
    np.testing.assert_allclose(scene.emission, exitance)
    np.testing.assert_allclose(scene.back_emission, exitance)


def test_reflectance_replaces_texture_and_colours_but_not_light(load):
    scene = load('geometry = ["box.glb"]\n[[surface]]\nname = "box/*"\nreflectance = 0.25\n')
    patches = rd.subdivide(scene, cells=1)
    assert (patches.reflectance == 0.25).all()
    assert patches.emission[0, 0] == pytest.approx(10 * np.pi)
    dark = load('geometry = ["box.glb"]\n[[surface]]\nname = "box/*"\nemission = 0\n')
    assert (rd.subdivide(dark, cells=1).emission == 0).all()
    assert rd.subdivide(dark, cells=1).reflectance[0, 0] == pytest.approx(0.8 * 0.5 * 0.5, rel=0.01)


def test_textured_and_plain_files_together(load):
    scene = load("""
        geometry = [{file = "lamp.stl", name = "lamp"}, {file = "box.glb", scale = 2, name = "big"}, "box.glb"]
        [[surface]]
        name = "lamp"
        reflectance = 0.5
    """)
    patches = rd.subdivide(scene, cells=1)
    textured = np.array([0.8, 0.6, 0.4]) * 0.5 * ((188 / 255 + 0.055) / 1.055) ** 2.4
    np.testing.assert_allclose(patches.reflectance[patches.surface == 0], 0.5)
    assert scene.names == ("lamp", "big/box/paper", "box/paper")
    np.testing.assert_allclose(patches.reflectance[patches.surface == 1], np.tile(textured, (12, 1)), rtol=1e-6)
    np.testing.assert_allclose(patches.reflectance[patches.surface == 2], np.tile(textured, (12, 1)), rtol=1e-6)
    assert scene.area[scene.surface == 1].sum() == pytest.approx(4 * scene.area[scene.surface == 2].sum())


def test_reflectances_follow_the_bound_for_files(load, tmp_path):
    text = 'geometry = ["lamp.stl"]\n[[surface]]\nname = "lamp"\nreflectance = 1\n'
    with pytest.warns(RadiosityWarning, match="reflectance above 0.95.*'lamp'"):
        assert load(text).reflectance.tolist() == [[0.95]]
    with pytest.warns(RadiosityWarning, match="above 0.5"):
        assert read(tmp_path / "scene.toml", ReadOptions(max_reflectance=0.5)).reflectance.tolist() == [[0.5]]


def test_the_reader_alone_says_who_reads_geometry(tmp_path):
    (tmp_path / "lamp.stl").write_bytes(stl_bytes(TRIANGLES))
    (tmp_path / "scene.toml").write_text('geometry = ["lamp.stl"]')
    with pytest.raises(SceneError, match=r"scene\.formats\.read"):
        toml.read(tmp_path / "scene.toml", ReadOptions())


SHINY = '[[surface]]\nname = "*"\nreflectance = 0.97\nemission = 12.6\n'  # an emissivity of 0.03


def test_reflectances_of_the_user_s_own_below_one_stay(load, tmp_path):
    """In a scene with textures and colours too, where other surfaces are cut; emission and reflectance stay consistent."""
    scene = load(f'geometry = ["lamp.stl"]\n{SHINY}')
    assert scene.reflectance.tolist() == [[0.97]]
    assert scene.emission.tolist() == [[12.6]]
    (tmp_path / "painted.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float red\n"
        "property float green\nproperty float blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 1 1 1\n1 0 0 1 1 1\n1 1 0 1 .5 1\n3 0 1 2\n"
    )
    text = 'geometry = ["lamp.stl", "painted.ply"]\n[[surface]]\nname = "lamp"\nreflectance = [0.999, 0.97, 0.96]\n'
    with pytest.warns(RadiosityWarning, match=r"painted\.ply: reflectance above 0\.95.*: 'painted'"):
        patches = rd.subdivide(load(text), cells=1)
    assert patches.reflectance[0].tolist() == [0.999, 0.97, 0.96]
    assert patches.reflectance[patches.surface == 1].max() == 0.95


def test_a_cut_reflectance_names_the_file_that_set_it(tmp_path):
    (tmp_path / "white.mtl").write_text("newmtl white\nKd 0.98 0.98 0.98\n")
    (tmp_path / "a.obj").write_text("mtllib white.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl white\nf 1 2 3\n")
    (tmp_path / "a.toml").write_text('geometry = "a.obj"\n[[surface]]\nname = "none"\nreflectance = 0.5\n')
    for name in ("a.obj", "a.toml"):
        with pytest.warns(RadiosityWarning) as caught:
            rd.load_scene(tmp_path / name)
        (cut,) = (str(w.message) for w in caught if "brought down" in str(w.message))
        assert cut.startswith(f"{tmp_path / 'white.mtl'}: reflectance above 0.95 brought down to it (at most 0.98): 'a/white'")
    (tmp_path / "b.toml").write_text('geometry = "a.obj"\n[[surface]]\nname = "*"\nreflectance = 1.2\n')
    with pytest.warns(RadiosityWarning, match=rf"^{tmp_path / 'b.toml'}: reflectance above 0.95 .*1.2"):
        rd.load_scene(tmp_path / "b.toml")


def test_a_cut_reflectance_of_an_included_mgf_names_that_file(tmp_path):
    (tmp_path / "materials.mgf").write_text("m white =\n\tsides 1\n\trd 0.99\n")
    corners = "".join(f"v v{i} =\n\tp {x} {y} 0\n" for i, (x, y) in enumerate(((0, 0), (1, 0), (1, 1))))
    (tmp_path / "a.mgf").write_text(f"i materials.mgf\n{corners}m white\nf v0 v1 v2\n")
    with pytest.warns(RadiosityWarning, match=r"materials\.mgf: reflectance above 0\.95"):
        rd.load_scene(tmp_path / "a.mgf")


def test_a_name_that_matches_nothing(load):
    with pytest.warns(RadiosityWarning, match="no surface is called 'wall.*'; there are 'room/floor/white', 'room/lamp/light'"):
        load('geometry = ["room.obj"]\n[[surface]]\nname = "wall*"\nreflectance = 0.5\n')


def test_names_with_brackets_match_themselves(load, tmp_path):
    (tmp_path / "a[1].ply").write_text(ply_text())
    scene = load('geometry = ["a[1].ply"]\n[[surface]]\nname = "a[1]"\nreflectance = 0.1\n')
    assert scene.reflectance.tolist() == [[0.1]]


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize(("name", "other"), [("lamp[1]", "lamp1"), ("lamp?", "lamp2"), ("*", "desk"), ("[a]*", "ab")])
def test_a_name_of_a_surface_is_no_pattern_for_others(load, tmp_path, name, other, order):
    """Whichever file comes first; the pattern that means both is written out."""
    for file in (name, other):
        (tmp_path / f"{file}.ply").write_text(ply_text())
    files = [f"{name}.ply", f"{other}.ply"][::order]
    begin = f'geometry = {files}\n[[surface]]\nname = "[!z]*"\nreflectance = 0.3\nemission = 1\n'
    scene = load(f'{begin}[[surface]]\nname = "{name}"\nreflectance = 0.1\npower = 5\npatch_size = 0.2\nsides = 1\n')
    assert scene.names == tuple([name, other][::order])
    assert scene.reflectance[::order].tolist() == [[0.1], [0.3]]
    assert scene.emission[::order].tolist() == [[5], [1]]  # 5 W on one side of 1 m²
    assert scene.back[::order].tolist() == [Back.ABSORBS, Back.RADIATES]
    np.testing.assert_array_equal(scene.patch_size[::order], [0.2, np.nan])
    scene = load(f'{begin}[[surface]]\nname = "{other}"\nreflectance = 0.1\n')
    assert scene.reflectance[::order].tolist() == [[0.3], [0.1]]


def test_names_that_are_patterns_too_are_warned_of_once(load, tmp_path, recwarn):
    for file in ("lamp[1]", "lamp1"):
        (tmp_path / f"{file}.ply").write_text(ply_text())
    with pytest.warns(RadiosityWarning, match="no surface is called 'x'") as told:
        load(
            'geometry = ["lamp[1].ply", "lamp1.ply"]\n[[surface]]\nname = "lamp[1]"\nreflectance = 0.1\n'
            '[[surface]]\nname = "lamp1"\nreflectance = 0.2\n[[surface]]\nname = "x"\nreflectance = 0.1\n'
        )
    assert len(told) == 1


def test_cameras_and_photometric(load):
    scene = load("""
        geometry = ["room.obj"]
        photometric = true
        [[camera]]
        origin = [0, 1, 2]
        target = [1, 1, 2]
        fov = 60
    """)
    assert scene.photometric
    assert scene.cameras == (Camera((0, 1, 2), (1, 1, 2), (0, 0, 1), 60.0, 800, 600),)


def sensor(origin: str, target: str) -> str:
    return (
        f'<scene version="3.0.0"><shape type="rectangle"><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape><sensor '
        f'type="perspective"><float name="fov" value="45"/><film type="hdrfilm"><integer name="width" value="32"/>'
        f'<integer name="height" value="24"/></film><transform name="to_world"><lookat origin="{origin}" target="{target}" '
        f'up="0,1,0"/></transform></sensor></scene>'
    )


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254), ("ft", 0.3048)])
@pytest.mark.parametrize("format", ["xml", "glb"])
def test_units_scale_the_cameras_of_files_as_they_scale_their_faces(load, tmp_path, unit, metres, format):
    """Where a camera stands and what it looks at are lengths; up and the field of view are none, and [[camera]] is in metres."""
    if format == "xml":
        (tmp_path / "seen.xml").write_text(sensor("1,2,30", "1,2,0"))
    else:
        gltf = box_gltf()
        gltf.tree["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "aspectRatio": 1.5}}]
        gltf.node(camera=0, translation=[1, 2, 30])
        gltf.write(tmp_path / "seen.glb")
    alone = rd.load_scene(tmp_path / f"seen.{format}")
    text = f'unit = "{unit}"\nscale = 2\ngeometry = ["seen.{format}"]\n[[camera]]\norigin = [1, 2, 3]\ntarget = [4, 5, 6]\n'
    scene, factor = load(text), 2 * metres
    ours, theirs = scene.cameras
    assert (ours.origin, ours.target) == ((1, 2, 3), (4, 5, 6))
    expected = alone.cameras[0]
    assert expected.origin == pytest.approx((1, 2, 30))
    assert theirs.origin == pytest.approx(np.multiply(factor, expected.origin))
    assert theirs.target == pytest.approx(np.multiply(factor, expected.target))
    assert theirs.up == expected.up
    assert (theirs.fov, theirs.width, theirs.height) == (expected.fov, expected.width, expected.height)
    np.testing.assert_allclose(scene.bounds, factor * alone.bounds, rtol=1e-6)
    own = load(f'geometry = [{{file = "seen.{format}", unit = "{unit}", scale = 2}}, "room.obj"]\nunit = "ft"\n')
    assert own.cameras == (theirs,)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ["empty"]),
        ("[[surface", ["no TOML", "array declaration"]),
        ('geometri = ["room.obj"]', ["geometry is missing", "geometri: unknown key", "'geometry'"]),
        ('unit = "m"', ['geometry is missing; write a list of files of shapes, such as geometry = ["room.obj"]']),
        ('[[geometry]]\nunit = "m"', ["geometry 1, file is missing; write a file of shapes"]),
        ('geometry = ["room.obj"]\n[[camera]]\nfov = 40', ["camera 1, origin is missing; write where", "camera 1, target is"]),
        ('geometry = ["room.obj"]\n[[opening]]', ["opening 1, corners is missing; write three or four points"]),
        ("geometry = []", ["geometry is empty; write a list of files of shapes"]),
        ('[geometry]\nfile = "room.obj"', ["write a list of files", 'geometry = ["room.obj"]', "[[geometry]] with two brackets"]),
        ("geometry = true", ["geometry 1", "write a table", "it is True"]),
        ('geometry = ["room.obj"]\n[surface]\nname = "x"', ["surface: write [[surface]] with two brackets"]),
        ('geometry = ["room.obj"]\n[camera]\nfov = 3', ["camera: write [[camera]] with two brackets"]),
        ('geometry = ["room.obj"]\nsurface = ["x"]', ["surface 1", "write a table", "it is 'x'"]),
        ('geometry = ["gone.stl"]', ["scene.toml", "gone.stl", "does not exist; paths are relative"]),
        ('geometry = ["scene.toml"]', ["scene.toml", ".toml file"]),
        ('geometry = ["room.xyz"]', ["room.xyz"]),
        ('geometry = ["room.obj", 3]', ["geometry 2", "it is 3"]),
        ('geometry = [{file = "room.obj", unit = "km"}]', ["geometry 1, unit", "'mm'", "'km'"]),
        ('geometry = ["room.obj"]\nscale = 0', ["scale", "greater than 0"]),
        (
            'geometry = ["room.obj"]\n[[surface]]\nname = "x"\nreflectence = 1',
            ["surface 1 ('x')", "reflectence", "'reflectance'"],
        ),
        ('geometry = ["room.obj"]\n[[surface]]\nname = "x"\nreflectance = -0.1', ["surface 1 ('x')", "reflectance", "-0.1"]),
        ('geometry = ["room.obj"]\n[[surface]]\nname = "x"\nemission = nan', ["emission", "finite"]),
        ('geometry = ["room.obj"]\n[[surface]]\nname = "x"\nreflectance = [1, 2]', ["reflectance", "one number or"]),
        ('geometry = ["room.obj"]\n[[surface]]\nname = "x"\nemission = 1\npower = 2', ["surface 1", "emission and power"]),
        ('geometry = ["room.obj"]\n[[surface]]\nname = "x"\nsides = 1\nback = "passes"', ["sides and back"]),
        ('geometry = ["room.obj"]\n[[surface]]\nsides = 3', ["name is missing; write the surfaces that it is about", "sides"]),
        ('geometry = ["room.obj"]\n[[camera]]\norigin = [0, 0, 0]\ntarget = [0, 0, 1]', ["camera 1", "up"]),
        ('geometry = ["room.obj"]\n[[camera]]\norigin = [0, 0]\ntarget = [0, 0, 1]', ["camera 1, origin"]),
    ],
)
def test_faults(load, text, words):
    with pytest.raises(SceneError) as caught:
        load(text)
    for word in words:
        assert word in str(caught.value)


def test_every_key_that_must_be_there_says_what_to_write():
    wanted = {(table, key) for table, model in ({"": SceneFile} | TABLES).items() for key in _required(model)}
    assert wanted == set(REQUIRED)


def _required(model) -> list[str]:
    return [key for key, field in model.model_fields.items() if field.is_required()]


def test_power_without_area(load, tmp_path):
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\ng good\nf 1 2 3\ng flat\nf 1 2 2\n")
    text = 'geometry = ["flat.obj"]\n[[surface]]\nname = "*"\nreflectance = 0\n[[surface]]\nname = "flat"\npower = 1\n'
    with (
        pytest.raises(SceneError, match=r"surface 2 \('flat'\) has a power but no area"),
        pytest.warns(RadiosityWarning, match="1 face without area"),
    ):
        load(text)


def test_looks_for_other_formats(tmp_path, strangers):
    """The entries reach a scene in MGF before its own values are looked at."""
    (tmp_path / "scene.toml").write_text(f"""
        geometry = ['{strangers / "renderpark" / "cube.mgf"}']
        unit = "cm"
        [[surface]]
        name = "*"
        reflectance = 0.25
    """)
    # no warning: what is not diffuse there was said anew
    scene = rd.load_scene(tmp_path / "scene.toml", allow_outside=True)
    with pytest.warns(RadiosityWarning, match="not diffuse"):
        plain = rd.load_scene(strangers / "renderpark" / "cube.mgf")
    assert (scene.reflectance == 0.25).all()
    assert scene.photometric == plain.photometric
    np.testing.assert_allclose(scene.area, plain.area * 1e-4)
    np.testing.assert_allclose(scene.emission, plain.emission)


def test_the_example_of_the_documentation(load, tmp_path):
    document = Path(__file__).resolve().parents[1] / "docs" / "scene-toml.md"
    example = document.read_text().split("```toml\n")[1].split("```")[0]
    (tmp_path / "box.mtl").write_text(MTL.replace("white", "oak"))
    (tmp_path / "room.obj").write_text(OBJ.replace("usemtl white", "usemtl oak"))
    (tmp_path / "scene.toml").write_text(example)
    scene = rd.load_scene(tmp_path / "scene.toml")
    assert scene.names == ("room/floor/oak", "room/lamp/light", "lamp")
    np.testing.assert_allclose(scene.reflectance, [[0.45, 0.30, 0.18], [0.5] * 3, [0] * 3])
    np.testing.assert_allclose(scene.emission[2], 40 / 0.01)
    assert len(scene.cameras) == 1


def test_not_text(load, tmp_path):
    path = tmp_path / "bytes.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(SceneError, match="no TOML"):
        rd.load_scene(path)


def test_open_lamps_hide_nothing(tmp_path):
    (tmp_path / "lamp.stl").write_bytes(stl_bytes(TRIANGLES))
    text = 'geometry = "lamp.stl"\n[[surface]]\nname = "lamp"\nradiance = 1\nback = "open"\nreflectance = {}\n'
    (tmp_path / "scene.toml").write_text(text.format(0))
    assert rd.load_scene(tmp_path / "scene.toml").back.tolist() == [rd.Back.OPEN]
    (tmp_path / "scene.toml").write_text(text.format(0.5))
    with pytest.raises(rd.SceneError, match=r"surface 'lamp'\) is open.*0.5"):
        rd.load_scene(tmp_path / "scene.toml")


def test_surfaces_of_the_same_name_in_several_files_are_told(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "lamp.stl").write_bytes(stl_bytes(TRIANGLES))
    looks = '[[surface]]\nname = "*"\nreflectance = 0.5\n'
    (tmp_path / "scene.toml").write_text(f'geometry = ["a/lamp.stl", "b/lamp.stl"]\n{looks}')
    with pytest.warns(RadiosityWarning, match=r"same name in several geometry files become one; .*\[\[geometry\]\]: 'lamp'$"):
        assert rd.load_scene(tmp_path / "scene.toml").names == ("lamp",)
    named = '[[geometry]]\nfile = "a/lamp.stl"\nname = "one"\n[[geometry]]\nfile = "b/lamp.stl"\nname = "two"\n'
    (tmp_path / "scene.toml").write_text(named + looks)
    assert rd.load_scene(tmp_path / "scene.toml").names == ("one", "two")


@pytest.mark.parametrize("codec", ["cp932", "utf-16"])
def test_toml_of_other_encodings_says_what_to_do(tmp_path, codec):
    (tmp_path / "scene.toml").write_bytes('geometry = "機能.stl"'.encode(codec))
    with pytest.raises(SceneError, match=r"is no TOML.*save it as UTF-8"):
        rd.load_scene(tmp_path / "scene.toml")
