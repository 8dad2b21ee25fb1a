"""Public reports about other programs, rebuilt with files of our own: docs/validation/files.md names them."""

import warnings

import numpy as np
import pytest
from samples import CORNERS, SQUARE, TRIANGLES, Gltf, ply_text, png, stl_bytes, stl_text

import radiosity as rd
from radiosity.cli import main
from radiosity.errors import RadiosityWarning, SceneError

GREY = {"name": "grey", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}}
HALF = 0.5028864580325687  # what 188 of 255 is in sRGB
IMAGE = np.full((2, 2, 3), 188)
OBJ = "mtllib m.mtl\n{}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n"
PLAIN = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def read(file):
    """The scene, its power, its mean reflectance by band, and what was told, without the file's name."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RadiosityWarning)
        scene = rd.load_scene(file)
    patches = rd.subdivide(scene, cells=1)
    power = (patches.emission * patches.area[:, None]).sum(axis=0)
    return scene, power, patches.reflectance.mean(axis=0), [str(w.message).split(": ", 1)[1] for w in caught]


@pytest.fixture
def obj(tmp_path):
    def load(text, mtl="newmtl a\nKd 0.5 0.5 0.5\n"):
        (tmp_path / "i.png").write_bytes(png(IMAGE))
        (tmp_path / "m.mtl").write_text(mtl)
        (tmp_path / "x.obj").write_text(text)
        return read(tmp_path / "x.obj")

    return load


@pytest.fixture
def ply(tmp_path):
    """A square with properties behind the coordinates of each vertex."""

    def load(properties, values, face=("", "")):
        head = "".join(f"property {text}\n" for text in ["float x", "float y", "float z", *properties])
        rows = "".join(f"{x} {y} {z} {values}\n" for x, y, z in SQUARE)
        (tmp_path / "x.ply").write_text(
            f"ply\nformat ascii 1.0\nelement vertex 4\n{head}element face 1\nproperty list uchar int vertex_indices\n{face[0]}"
            f"end_header\n{rows}4 0 1 2 3 {face[1]}\n"
        )
        return read(tmp_path / "x.ply")

    return load


def gltf(tmp_path, material=GREY, colors=None, node=None, more=(), tree=None):
    """A square with an image."""
    made = Gltf(**(tree or {}))
    made.image(IMAGE)
    attributes = {"TEXCOORD_0": made.accessor(CORNERS), **({} if colors is None else {"COLOR_0": made.accessor(*colors)})}
    mesh = made.mesh(material=material, attributes=attributes)
    made.node(mesh=mesh, name="square", **(node or {}))
    for other in more:
        made.node(mesh=mesh, **other)
    return read(made.write(tmp_path / "x.glb"))


# an image times a colour of zero


def test_an_image_under_a_black_kd_is_told(obj):
    *_, reflectance, told = obj(OBJ.format(PLAIN), "newmtl a\nKd 0 0 0\nmap_Kd i.png\n")
    assert reflectance.tolist() == [0, 0, 0]
    assert any("a colour of zero makes black" in text and "'a (Kd)'" in text for text in told)


def test_an_image_of_emission_alone_shines(obj):
    """As `map_Kd` alone reflects; under a Ke of zero it is told."""
    _, power, _, told = obj(OBJ.format(PLAIN), "newmtl a\nKd 0.5 0.5 0.5\nmap_Ke i.png\n")
    np.testing.assert_allclose(power, 2 * np.pi * HALF, rtol=1e-6)
    assert not told
    _, power, _, told = obj(OBJ.format(PLAIN), "newmtl a\nKd 0.5 0.5 0.5\nKe 0 0 0\nmap_Ke i.png\n")
    assert power.tolist() == [0]
    assert "'a (Ke)'" in told[0]


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"emissiveTexture": {"index": 0}}, "emissiveFactor"),
        ({"extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}}}, "emissiveFactor"),
        (
            {
                "emissiveTexture": {"index": 0},
                "emissiveFactor": [1, 1, 1],
                "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 0}},
            },
            "emissiveStrength",
        ),
        (
            {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "baseColorTexture": {"index": 0}, "metallicFactor": 0}},
            "baseColorFactor",
        ),
    ],
)
def test_factors_of_zero_are_told(tmp_path, change, word):
    _, power, _, (told,) = gltf(tmp_path, {**GREY, **change})
    assert not power.any()
    assert told.startswith("a colour of zero makes black")
    assert told.endswith(f"'grey ({word})'")


def test_factors_that_change_nothing_are_not_told(tmp_path):
    strong = {"KHR_materials_emissive_strength": {"emissiveStrength": 5}}
    assert not gltf(tmp_path)[3]
    shining = {**GREY, "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0}, "extensions": strong}
    _, power, _, told = gltf(tmp_path, shining)
    assert not told
    np.testing.assert_allclose(power, 5 * np.pi * HALF, rtol=1e-6)


# colours of vertices

RED = [HALF, 0, 0]


@pytest.mark.parametrize(
    ("kind", "names", "value"),
    [
        ("uchar", "r g b", "188 0 0"),  # assimp, Mitsuba
        ("float", "r g b", f"{HALF} 0 0"),
        ("uchar", "diffuse_red diffuse_green diffuse_blue", "188 0 0"),  # scanners
        ("uchar", "Red Green Blue", "188 0 0"),
        ("uchar", "red green blue", "188 0 0"),
        ("int", "red green blue", "188 0 0"),
    ],
)
def test_names_of_ply_colors(ply, kind, names, value):
    *_, reflectance, told = ply([f"{kind} {name}" for name in names.split()], value)
    np.testing.assert_allclose(reflectance, RED, rtol=1e-6)
    assert not told


@pytest.mark.parametrize(("kind", "word"), [("double", "0 to 255"), ("ushort", "have 16 bits")])
def test_ply_colors_of_255_in_wider_numbers(ply, kind, word):
    *_, reflectance, told = ply([f"{kind} red", f"{kind} green", f"{kind} blue"], "188 0 0")
    np.testing.assert_allclose(reflectance, RED, rtol=1e-6)
    assert len(told) == 1
    assert word in told[0]
    *_, reflectance, told = ply(["ushort red", "ushort green", "ushort blue"], "48316 256 0")
    np.testing.assert_allclose(reflectance[0], HALF, rtol=1e-3)
    assert not told
    *_, reflectance, told = ply(["float red", "float green", "float blue"], "0 0 0")
    assert not reflectance.any()
    assert not told


def test_ply_transparency_and_unread_colors_are_told(ply):
    color = ["uchar red", "uchar green", "uchar blue"]
    assert "transparency (alpha of the element 'vertex')" in ply([*color, "uchar alpha"], "188 0 0 10")[3][0]
    assert not ply([*color, "uchar alpha"], "188 0 0 255")[3]
    assert "not read: 'intensity'" in ply(["float intensity"], "0.5")[3][0]
    assert "not read: 'red', 'green'" in ply(["uchar red", "uchar green"], "9 9")[3][0]
    assert not ply([*color, "float quality", "uchar flags"], "188 0 0 0.1 3")[3]
    face = "".join(f"property uchar {name}\n" for name in ("red", "green", "blue")), "0 188 0"
    *_, reflectance, told = ply(color, "188 0 0", face)
    np.testing.assert_allclose(reflectance, RED, rtol=1e-6)
    assert told == ["colours of faces are left out, since vertices have colours too"]


def vertices(tail):
    return "".join(f"v {x} {y} {z} {tail}\n" for x, y, z in SQUARE)


def test_obj_colors_of_255(obj):
    *_, reflectance, told = obj(vertices("188 0 0") + "f 1 2 3 4\n")
    np.testing.assert_allclose(reflectance, RED, rtol=1e-6)
    assert len(told) == 1
    assert "taken as 0 to 255: 'v'" in told[0]
    *_, reflectance, told = obj(vertices("1 0 0") + "f 1 2 3 4\n")  # 0 and 1 are no bytes
    np.testing.assert_allclose(reflectance, [0.95, 0, 0], rtol=1e-6)
    assert "0 to 255" not in told[0]


def test_what_obj_vertices_hold_besides_is_told(obj):
    assert "weights of vertices other than 1" in obj(OBJ.format(vertices("2")))[3][0]
    assert not obj(OBJ.format(vertices("1")))[3]
    assert "vertices of more than 6 numbers (4)" in obj(OBJ.format(vertices("1 1 0 0")))[3][0]
    some = OBJ.format(PLAIN.replace("v 0 0 0", "v 0 0 0 1 0 0"))
    scene, *_, told = obj(some)
    assert scene.reflectance.tolist() == [[0.5]]
    assert told == ["vertex colours are left out where some vertices of a surface have none: 'x/a'"]
    painted = OBJ.format(PLAIN + "#MRGB ffff0000ffff0000ffff0000ffff0000\n")
    assert obj(painted)[3] == ["statements that are left out: '#MRGB (colours of vertices in comments) (1)'"]


def test_mtl_colors_of_two_numbers_are_refused(obj):
    with pytest.raises(SceneError, match=r"m.mtl, line 2: kd is '0.3', '0.4'; expected one number, or red, green and blue"):
        obj(OBJ.format(PLAIN), "newmtl a\nKd 0.3 0.4\n")


def test_gltf_colors_that_are_not_normalized(tmp_path):
    """The bytes are linear in glTF."""
    *_, reflectance, told = gltf(tmp_path, colors=(np.full((4, 4), 188), "u1"), more=[{"name": "other"}])
    np.testing.assert_allclose(reflectance, 0.5 * 188 / 255, rtol=1e-6)
    assert len(told) == 1
    assert told[0].endswith("are taken as 0 to 255: 'square', 'other'")


# places


def test_a_matrix_by_rows_is_refused(tmp_path):
    with pytest.raises(SceneError, match=r"matrix of node 0 has the last row \[3.0, 0.0, 0.0, 1.0\]"):
        gltf(tmp_path, node={"matrix": [1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]})


def test_objects_outside_the_scene_are_told(tmp_path):
    scenes = {"scene": 0, "scenes": [{"nodes": [0]}, {"nodes": [1]}]}
    scene, *_, told = gltf(tmp_path, more=[{"name": "lamp"}], tree=scenes)
    assert scene.names == ("square/grey",)
    assert told == ["objects outside the scene that the file shows are left out: 'lamp'"]


def test_stl_normals_that_point_to_the_back_are_told(tmp_path):
    """The corners hold; zeros, and what is no normal, are not compared."""
    for normal, said in (("0 0 -1", True), *((other, False) for other in ("0 0 1", "0 0 0", "nan 0 0", "1 0 -0.1", ""))):
        (tmp_path / "x.stl").write_text(stl_text({"x": TRIANGLES}).replace("0 0 1\nouter", f"{normal}\nouter"))
        data = bytearray(stl_bytes(TRIANGLES))
        numbers = np.array([float(word) for word in normal.split()] or [0, 0, 0], "<f4").tobytes()
        data[84:96] = data[134:146] = numbers
        (tmp_path / "y.stl").write_bytes(bytes(data))
        for name in ("x.stl", "y.stl"):
            scene, *_, told = read(tmp_path / name)
            assert scene.normal.tolist() == [[0, 0, 1]]
            assert any("normals of 2 of 2 triangles point to the back" in text for text in told) == said


def test_a_colour_in_the_header_of_an_stl_is_told(tmp_path):
    data = bytearray(stl_bytes(TRIANGLES))
    data[:10] = b"COLOR=\xff\x00\x00\xff"
    (tmp_path / "x.stl").write_bytes(bytes(data))
    assert "the colour in the header (COLOR=) is left out" in read(tmp_path / "x.stl")[3]


# units


SAID = [
    ("# File units = millimeters", "mm"),
    ("# Units: inches", "in"),
    ("# unit is cm", "cm"),
    ("# UNITS=Feet", "ft"),
    ("# file units = meters", None),
    ("# unit normals in the end", None),
    ("# units unknown", None),
    ("# 12 unity", None),
]


@pytest.mark.parametrize(("comment", "unit"), SAID)
def test_units_that_files_tell(tmp_path, obj, comment, unit):
    """They are told where lengths are taken otherwise, in all formats that have comments; a .toml that agrees says nothing."""
    files = {"x.obj": comment + "\n" + OBJ.format(PLAIN), "x.stl": stl_text({comment: TRIANGLES})}
    for keyword in ("comment", "obj_info"):
        files[f"{keyword}.ply"] = ply_text(colors=[[9, 9, 9]] * 4, comment=f"{keyword} {comment}\n")
    binary = bytearray(stl_bytes(TRIANGLES))
    binary[: len(comment)] = comment.encode()
    obj(files["x.obj"])
    for name, content in {**files, "y.stl": bytes(binary)}.items():
        (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        told = [text for text in read(tmp_path / name)[3] if "its unit" in text]
        assert len(told) == (unit is not None)
        if unit:
            assert f"its unit is {unit}, and lengths are taken in units of 1 m" in told[0]
            assert f'write unit = "{unit}" in a .toml' in told[0]
        for own in ("mm", "in"):
            (tmp_path / "s.toml").write_text(f'geometry = ["{name}"]\nunit = "{own}"\n')
            told = [text for text in read(tmp_path / "s.toml")[3] if "its unit" in text]
            assert len(told) == (comment == SAID[4][0] or unit not in (None, own))


@pytest.mark.parametrize(("size", "said"), [(0.04, True), (0.06, False), (299, False), (301, True)])
def test_check_tells_of_sizes_that_are_rare(tmp_path, capsys, size, said):
    (tmp_path / "x.stl").write_bytes(stl_bytes(TRIANGLES * size))
    main(["check", str(tmp_path / "x.stl")])
    shown = capsys.readouterr().out
    assert f"extent    {size:g} x {size:g} x 0 m" in shown
    assert ("rare for a scene" in shown) == said
