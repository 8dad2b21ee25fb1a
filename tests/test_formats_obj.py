"""The OBJ reader: names, polygons, relative numbers, materials, and one clear error for each fault."""

import numpy as np
import pytest
from samples import MTL, OBJ, png

import radiosity as rd
from radiosity.errors import RadiosityWarning, SceneError
from radiosity.scene import Back
from radiosity.scene.assemble import ReadOptions
from radiosity.scene.formats import read

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
KNOWN = "mtllib m.mtl\nusemtl grey\n"


@pytest.fixture
def load(tmp_path):
    """Load OBJ text; a material ``grey`` is there."""
    (tmp_path / "m.mtl").write_text("newmtl grey\nKd 0.5 0.5 0.5\n")

    def write(text, mtl=None, name="x.obj"):
        if mtl is not None:
            (tmp_path / "m.mtl").write_text(mtl)
        (tmp_path / name).write_text(text)
        return rd.load_scene(tmp_path / name)

    return write


def test_groups_that_share_a_material_keep_their_names(load):
    scene = load(SQUARE + KNOWN + "o room\ng floor\nf 1 2 3\ng wall\nf 1 3 4\no grey\nf 1 2 3 4\n")
    assert scene.names == ("room/floor/grey", "room/wall/grey", "grey")
    assert scene.surface.tolist() == [0, 1, 2]
    assert (scene.back == Back.RADIATES).all()


def test_box_file(load, tmp_path):
    (tmp_path / "box.mtl").write_text(MTL)
    scene = load(OBJ)
    assert scene.names == ("room/floor/white", "room/lamp/light")
    assert scene.is_quad.all()
    assert scene.area.tolist() == [1, 1]
    assert scene.vertices[scene.faces[1], 2].tolist() == [2, 2, 2, 2]  # relative numbers count from where they stand
    assert scene.normal[1].tolist() == [0, 0, -1]
    np.testing.assert_allclose(scene.emission, [[0, 0, 0], [3 * np.pi, 2 * np.pi, np.pi]])
    np.testing.assert_allclose(scene.reflectance, [[0.5] * 3, [0] * 3])


def test_polygons_are_cut_also_concave_ones(load):
    letter = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (3, 2), (3, 3), (0, 3)]
    text = "".join(f"v {x} {y} 0\n" for x, y in letter)
    scene = load(text + KNOWN + "f 1 2 3 4 5 6 7 8\n")
    assert scene.area.sum() == pytest.approx(7)
    assert (scene.normal == [0, 0, 1]).all()
    scene = load(text + KNOWN + "f 8 7 6 5 4 3 2 1\n")
    assert scene.area.sum() == pytest.approx(7)
    assert (scene.normal == [0, 0, -1]).all()


@pytest.mark.parametrize("order", [(3, 4, 5), (4, 3, 5), (5, 4, 3), (3, 3), (4, 4), (4, 3)])
def test_polygons_of_a_surface_keep_their_order(load, order):
    """One square metre in front of another along x: its polygon has three, four or five corners."""
    vertices, faces = "", ""
    for at, size in enumerate(order):
        ring = [(0, 0), (1, 0), (1, 1), (0, 1)][:size] + [(-0.5, 0.5)][: size - 4 if size > 4 else 0]
        faces += "f" + "".join(f" {len(vertices.splitlines()) + i}" for i in range(1, size + 1)) + "\n"
        vertices += "".join(f"v {at} {y} {z}\n" for y, z in ring)
    scene = load(vertices + KNOWN + "g all\n" + faces)
    where = scene.vertices[scene.faces[:, 0], 0]
    assert (np.diff(where) >= 0).all()
    assert [scene.area[where == at].sum() for at in range(len(order))] == [{3: 0.5, 4: 1.0, 5: 1.25}[size] for size in order]


def test_quads_that_are_no_parallelograms(load):
    scene = load("v 0 0 0\nv 2 0 0\nv 1 1 0\nv 0 1 0\n" + KNOWN + "f 1 2 3 4\n")
    assert scene.is_quad.tolist() == [False, False]
    assert scene.area.sum() == pytest.approx(1.5)
    arrow = load("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\n" + KNOWN + "f 1 2 3 4\n")
    assert arrow.area.sum() == pytest.approx(1)
    assert (arrow.normal == [0, 0, 1]).all()


def test_vertices_may_follow_their_faces(load):
    assert load(KNOWN + "f 1 2 3 4\n" + SQUARE).area.tolist() == [1]


def test_names_may_hold_blanks_and_hashes(load):
    mtl = "newmtl red#2 paint # old\nKd 0.2 0.2 0.2\n"
    scene = load(SQUARE + "mtllib m.mtl\no big  room # 1\nusemtl red#2  paint\nf 1 2 3 4\n", mtl)
    assert scene.names == ("big room/red#2 paint",)
    assert scene.reflectance.tolist() == [[0.2]]


def test_text_habits(load):
    scene = load("\ufeff# a comment\r\n" + SQUARE.replace("\n", "\r\n") + KNOWN + "s off\nf 1//1 \\\n 2//1 3//1 4//1 # quad\n")
    assert scene.area.tolist() == [1]


def test_texture(load, tmp_path):
    (tmp_path / "my wall.png").write_bytes(png(np.kron([[[50] * 3, [150] * 3], [[200] * 3, [100] * 3]], np.ones((8, 8, 1)))))
    mtl = "newmtl grey\nKd 1 1 1\nmap_Kd -clamp on -s 1 1 1 my wall.png\n"
    text = SQUARE + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + KNOWN
    patches = rd.subdivide(load(text + "f 1/1 2/2 3/3 4/4\n", mtl), cells=4)
    at = {(round(x * 8), round(y * 8)): i for i, (x, y, _) in enumerate(patches.centroid[~patches.is_back])}
    values = [patches.reflectance[at[place], 0] for place in ((1, 7), (7, 7), (1, 1), (7, 1))]
    # clamped, so that the rim has no share of the colours on the other side
    np.testing.assert_allclose(values, [((v / 255 + 0.055) / 1.055) ** 2.4 for v in (50, 150, 200, 100)], rtol=1e-6)
    with pytest.warns(RadiosityWarning, match=r"no texture coordinates.*'x/grey'"):
        plain = load(text + "f 1 2 3 4\n", mtl)
    mean = np.mean([((v / 255 + 0.055) / 1.055) ** 2.4 for v in (50, 150, 200, 100)])
    np.testing.assert_allclose(rd.subdivide(plain, cells=1).reflectance, mean, rtol=1e-6)


@pytest.mark.parametrize(
    ("move", "left", "right"),
    [
        ("", 50, 200),
        ("-s 0.5 1 1", 50, 50),  # the left half of the image on the whole face
        ("-s 0.5 1 1 -o 0.5 0 0", 200, 200),  # scaled, then moved: the right half
        ("-o 0.5 0 0 -s 0.5 1 1", 200, 200),  # in whatever order they are written
        ("-o 0.5 0 0", 200, 50),
        ("-s -1 1 1", 200, 50),
    ],
)
def test_textures_are_scaled_and_then_moved(load, tmp_path, move, left, right):
    (tmp_path / "t.png").write_bytes(png(np.kron([[[50] * 3, [200] * 3]], np.ones((8, 8, 1)))))
    text = SQUARE + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + KNOWN + "f 1/1 2/2 3/3 4/4\n"
    patches = rd.subdivide(load(text, f"newmtl grey\nKd 1 1 1\nmap_Kd {move} t.png\n"), cells=4)
    one, two = (((value / 255 + 0.055) / 1.055) ** 2.4 for value in (left, right))
    blend = (two - one) / 32 if "0.5 1 1" not in move else 0.0  # half a texel beside the other colour, of four that a patch spans
    for place, value in ((3 / 8, one + blend), (5 / 8, two - blend)):
        here = np.abs(patches.centroid[:, 0] - place) < 0.01
        np.testing.assert_allclose(patches.reflectance[here], value, rtol=1e-6)


@pytest.mark.parametrize(
    "option",
    [
        "-blendu on",
        "-blendv off",
        "-boost 2",
        "-mm 0 1",
        "-texres 64",
        "-clamp on",
        "-bm 1",
        "-imfchan l",
        "-type sphere",
        "-cc off",
        "-colorspace sRGB",
        "-o 0",
        "-s 1 1",
        "-t 0 0 0",
        "-mm 0 1 -bm 1 -o 0 0",
    ],
)
def test_values_of_options_are_no_part_of_a_file_s_name(load, tmp_path, option):
    (tmp_path / "t.png").write_bytes(png(np.full((4, 4, 3), 120)))
    text = SQUARE + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + KNOWN + "f 1/1 2/2 3/3 4/4\n"
    scene = load(text, f"newmtl grey\nKd 1 1 1\nmap_Kd {option} t.png\n")  # a texture that is not found would be told of
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, ((120 / 255 + 0.055) / 1.055) ** 2.4, rtol=1e-6)


def test_images_of_16_bits_have_65535_for_white(load, tmp_path):
    from PIL import Image

    Image.fromarray(np.full((4, 4), 30_000, np.uint16)).save(tmp_path / "t.png")
    text = SQUARE + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + KNOWN + "f 1/1 2/2 3/3 4/4\n"
    scene = load(text, "newmtl grey\nKd 1 1 1\nmap_Kd t.png\n")
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, ((30_000 / 65535 + 0.055) / 1.055) ** 2.4, rtol=1e-6)


def test_lost_texture_and_library(load, tmp_path):
    text = SQUARE + "vt 0 0\n" + KNOWN + "f 1/1 2/1 3/1 4/1\n"
    with pytest.warns(RadiosityWarning, match=r"textures that cannot be read.*C:\\pictures\\no\.png"):
        scene = load(text, "newmtl grey\nKd 0.3 0.3 0.3\nmap_Kd C:\\pictures\\no.png\n")
    assert scene.reflectance[0, 0] == 0.3
    with pytest.raises(SceneError, match=r"no\.png"):
        read(tmp_path / "x.obj", ReadOptions(strict=True))
    with pytest.warns(RadiosityWarning) as caught:
        scene = load(text.replace("m.mtl", "gone.mtl"))
    assert [("gone.mtl" in str(w.message), "grey'" in str(w.message), "0.5" in str(w.message)) for w in caught] == [
        (True, False, False),
        (False, True, False),
        (False, True, True),
    ]
    assert scene.reflectance.tolist() == [[0.5]]


def test_what_counts_as_not_diffuse(load):
    text = SQUARE + KNOWN + "f 1 2 3 4\n"
    load(text, "newmtl grey\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nillum 2\n")  # written by habit: no warning
    for more in ("Ks 0.9 0.9 0.9\nillum 2", "Ks 0.1 0.1 0.1\nillum 3", "Pm 1"):
        with pytest.warns(RadiosityWarning, match="not diffuse.*'x/grey'"):
            load(text, f"newmtl grey\nKd 0.8 0.8 0.8\n{more}\n")
    with pytest.warns(RadiosityWarning, match=r"transparency.*'grey'"):
        load(text, "newmtl grey\nKd 0.8 0.8 0.8\nd 0.5\n")
    with pytest.warns(RadiosityWarning, match=r"reflectance above 0\.95.*'x/grey'"):
        assert load(text, "newmtl grey\nKd 1 1 1\n").reflectance.tolist() == [[0.95]]


def test_vertex_colours(load):
    rows = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0 1 0 0\n"
    with pytest.warns(RadiosityWarning, match=r"0\.95"):
        scene = load(rows + "f 1 2 3 4\n")
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, [[0.95, 0, 0]] * 2)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("f 1 2 9", ["line 7", "vertex 9", "there are 4"]),
        ("f 1 2 0", ["line 7", "vertex 0"]),
        ("f 1 2 -5", ["line 7", "vertex -5"]),
        ("f 1/1 2/1 3/1", ["line 7", "texture vertex 1"]),
        ("f 1 2 x", ["line 7", "'f 1 2 x'"]),
        ("v 1 2", ["line 7", "3 numbers"]),
        ("v 1 2 a", ["line 7", "'v 1 2 a'"]),
        ("", ["no faces"]),
        ("v nan 0 0\nf 1 2 5", ["'x/grey'", "nan"]),
        ("v 1e300 0 0\nf 1 2 5", ["1e+300"]),
        ("f 1 1 1", ["no area", "'x/grey'"]),
        ("f 1 1 1 1 1 1", ["no area", "'x/grey'"]),
    ],
)
def test_faults(load, line, words):
    with pytest.raises(SceneError) as caught:
        load(SQUARE + KNOWN + line + "\n")
    for word in ["x.obj", *words]:
        assert word in str(caught.value)


@pytest.mark.parametrize(("line", "word"), [("Kd -1 0 0", "Kd"), ("Kd xyz 0.2 green 0.3", "line 2"), ("Ke nan 0 0", "line 2")])
def test_material_faults(load, line, word):
    with pytest.raises(SceneError, match=r"m\.mtl") as caught:
        load(SQUARE + KNOWN + "f 1 2 3\n", f"newmtl grey\n{line}\n")
    assert word.lower() in str(caught.value).lower()


def test_faces_of_two_corners(load, tmp_path):
    text = SQUARE + KNOWN + "f 1 2\nf 1 2 3 4\n"
    with pytest.warns(RadiosityWarning, match=r"1 face of fewer than three corners left out \(line 7\)"):
        assert load(text).n_faces == 1
    with pytest.raises(SceneError, match="line 7"):
        read(tmp_path / "x.obj", ReadOptions(strict=True))
