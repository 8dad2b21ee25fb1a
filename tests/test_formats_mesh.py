"""PLY and STL: polygons, colours, names, and one clear error for each fault."""

import numpy as np
import pytest
from samples import SQUARE, ply_bytes, ply_text, png, stl_bytes, stl_text

import radiosity as rd
from radiosity.errors import RadiosityWarning, SceneError
from radiosity.scene import Back

MIXED = ([0, 1, 2, 3], [0, 1, 4], [4, 3, 2, 1, 0])
FIVE = [*SQUARE, [0, 0, 1]]
TRIANGLES = np.array(SQUARE)[[[0, 1, 2], [0, 2, 3]]]


def load(path, content):
    """The scene, whose missing material is warned of."""
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.warns(RadiosityWarning, match="no material for"):
        return rd.load_scene(path)


def fails(path, content, *words):
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(SceneError) as caught:
        rd.load_scene(path)
    for word in (path.name, *words):
        assert word in str(caught.value)


@pytest.mark.parametrize("content", [ply_text(), ply_bytes(), ply_bytes(order=">"), ply_bytes(faces=[[0, 1, 2], [0, 2, 3]])])
def test_ply_square(tmp_path, content):
    scene = load(tmp_path / "tile.ply", content)
    assert scene.names == ("tile",)
    assert scene.area.tolist() == [1]
    assert scene.normal.tolist() == [[0, 0, 1]]
    assert scene.back.tolist() == [Back.RADIATES]
    assert scene.reflectance.tolist() == [[0.5]]


@pytest.mark.parametrize(
    "content", [ply_text(FIVE, MIXED[:2]), ply_bytes(FIVE, MIXED[:2]), ply_bytes(FIVE, MIXED[:2], order=">")]
)
def test_ply_of_triangles_and_quadrilaterals(tmp_path, content):
    scene = load(tmp_path / "mixed.ply", content)
    assert scene.is_quad.tolist() == [True, False]
    np.testing.assert_allclose(scene.area, [1, 0.5])


@pytest.mark.parametrize("stray", [[np.nan, 0, 0], [0, np.inf, 0], [1e30, 0, 0]])
def test_vertices_that_no_face_uses_may_be_anything(tmp_path, stray):
    scene = load(tmp_path / "stray.ply", ply_bytes([*SQUARE, stray], [[0, 1, 2, 3]]))
    assert scene.area.tolist() == [1]
    np.testing.assert_array_equal(scene.bounds, [[0, 0, 0], [1, 1, 0]])
    if not np.isfinite(stray).all():
        fails(tmp_path / "used.ply", ply_bytes([*SQUARE, stray], [[0, 1, 2, 3], [0, 1, 4]]), "vertex 4")


def test_ply_polygons(tmp_path):
    house = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 0.5, 0], [0, 1, 0]]
    scene = load(tmp_path / "house.ply", ply_bytes(house, [[0, 1, 2, 3, 4]]))
    assert scene.area.sum() == pytest.approx(1.5)
    assert (scene.normal[:, 2] == 1).all()


def test_ply_vertex_colours_are_srgb(tmp_path):
    path = tmp_path / "c.ply"
    path.write_text(ply_text(colors=[[188, 188, 188], [188, 188, 188], [0, 0, 0], [0, 0, 0]]))
    patches = rd.subdivide(rd.load_scene(path), cells=2)
    linear = ((188 / 255 + 0.055) / 1.055) ** 2.4
    height = patches.centroid[:, 1]
    np.testing.assert_allclose(patches.reflectance, np.tile(linear * (1 - height)[:, None], 3), rtol=1e-6)


def test_ply_four_corner_colours_are_bilinear(tmp_path):
    path = tmp_path / "c.ply"
    path.write_text(ply_text(colors=[[0] * 3, [0] * 3, [188] * 3, [0] * 3]))
    patches = rd.subdivide(rd.load_scene(path), cells=2)
    linear = ((188 / 255 + 0.055) / 1.055) ** 2.4
    np.testing.assert_allclose(patches.reflectance[:, 0], linear * patches.centroid[:, 0] * patches.centroid[:, 1], rtol=1e-6)


def test_ply_face_colours(tmp_path):
    text = ply_text(faces=[[0, 1, 2], [0, 2, 3]])
    text = text.replace("vertex_indices\n", "vertex_indices\nproperty float red\nproperty float green\nproperty float blue\n")
    path = tmp_path / "f.ply"
    path.write_text(text.replace("3 0 1 2\n", "3 0 1 2 0.1 0.2 0.3\n").replace("3 0 2 3\n", "3 0 2 3 0.4 0.5 0.6\n"))
    patches = rd.subdivide(rd.load_scene(path), cells=1)
    assert not patches.scene.is_quad.any()  # different colours stay apart
    np.testing.assert_allclose(patches.reflectance[~patches.is_back], [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]], rtol=1e-6)


def test_ply_texture(tmp_path):
    (tmp_path / "wall.png").write_bytes(png(np.kron([[[50] * 3], [[200] * 3]], np.ones((8, 8, 1)))))
    text = ply_text(comment="comment TextureFile wall.png\n").replace(
        "float z\n", "float z\nproperty float s\nproperty float t\n"
    )
    for corner in ("0 0 0", "1 0 0", "1 1 0", "0 1 0"):
        text = text.replace(f"\n{corner}\n", f"\n{corner} {corner[:3]}\n")
    path = tmp_path / "t.ply"
    path.write_text(text)
    patches = rd.subdivide(rd.load_scene(path), cells=4)
    upper = patches.reflectance[np.abs(patches.centroid[:, 1] - 0.625) < 0.01].mean()
    lower = patches.reflectance[np.abs(patches.centroid[:, 1] - 0.375) < 0.01].mean()
    dark, bright = (((value / 255 + 0.055) / 1.055) ** 2.4 for value in (50, 200))
    assert upper == pytest.approx(dark + (bright - dark) / 32, rel=1e-6)  # half a texel of four lies beside the other colour
    assert lower == pytest.approx(bright - (bright - dark) / 32, rel=1e-6)


def test_ply_faults(tmp_path):
    path = tmp_path / "bad.ply"
    good = ply_bytes()
    fails(path, b"", "empty")
    fails(path, b"solid x", "does not begin")
    fails(path, good[:60], "truncated")
    fails(path, good[:-5], "truncated")
    fails(path, ply_bytes(FIVE, MIXED)[:-5], "truncated")
    fails(path, ply_bytes(counts=(2**62, 1)), "announces", "element 'vertex'")
    fails(path, ply_bytes(counts=(4, 2**40)), "announces", "element 'face'")
    fails(path, ply_text().replace("face 1", "face 99999999999"), "announces")
    fails(path, ply_text().replace("vertex 4", "vertex -4"), "header line 'element vertex -4'")
    fails(path, ply_text().replace("float x", "quad x"), "header line 'property quad x'")
    fails(path, ply_text().replace("format ascii 1.0\n", ""), "format")
    fails(path, ply_text().replace("property float z", "property float w"), "x, y, z")
    fails(path, ply_text(faces=[[0, 1, 7]]), "face 0 names vertex 7", "there are 4")
    fails(path, ply_text(faces=[[0, 1, -2]]), "face 0 names vertex -2")
    for row, faces in enumerate(([[8, 0, 1], [0, 1, 2]], [[0, 1, 2, 3], [8, 0, 1]], [[0, 1, 2], [0, 1, 2, 3], [0, 1, 8]])):
        fails(path, ply_text(faces=faces), f"face {row} names vertex 8")
    fails(path, ply_text(faces=[]), "4 points but no faces")
    fails(path, ply_text(vertices=[["nan", 0, 0], *SQUARE[1:]]), "vertex 0", "'bad'", "nan")
    fails(path, ply_text(vertices=[["x", 0, 0], *SQUARE[1:]]), "numbers")
    fails(path, ply_text(vertices=[[0, 0, 0]] * 4, colors=[[90, 90, 90]] * 4), "no area", "'bad'")
    fails(path, ply_bytes().replace(b"\x04\0\0\0\0", b"\xff\0\0\0\0"), "truncated")


def test_stl_binary_and_ascii(tmp_path):
    assert load(tmp_path / "tile.stl", stl_bytes(TRIANGLES)).names == ("tile",)
    scene = load(tmp_path / "two.stl", stl_text({"Lamp one": TRIANGLES, "": TRIANGLES + 1.0}))
    assert scene.names == ("Lamp one", "two")
    assert scene.is_quad.tolist() == [True, True]
    assert (scene.back == Back.RADIATES).all()
    one = load(tmp_path / "x.stl", stl_text({"Named": TRIANGLES}))
    assert one.names == ("Named",)


def test_stl_faults(tmp_path):
    path = tmp_path / "bad.stl"
    text = stl_text({"a": TRIANGLES})
    fails(path, b"", "empty")
    fails(path, stl_bytes(TRIANGLES)[:-1], "announces 2 triangles", "truncated")
    fails(path, stl_bytes(TRIANGLES, count=2**32 - 1), "announces 4294967295 triangles")
    fails(path, b"solid" + stl_bytes(TRIANGLES)[5:-1], "announces 2 triangles")
    fails(path, stl_bytes([]), "no faces")
    fails(path, b"abc", "too short")
    fails(path, text[: len(text) // 2], "truncated")
    fails(path, text.replace("vertex 1", "vertex one", 1), "bad.stl")
    fails(path, text.replace("vertex 1", "vertex nan", 1), "nan", "'a'")
    fails(path, stl_bytes(np.full((2, 3, 3), np.inf)), "'bad'")
    fails(path, "solid a\nendsolid a\n", "no faces")


def test_faces_without_area_are_counted(tmp_path):
    path = tmp_path / "flat.stl"
    path.write_bytes(stl_bytes([*TRIANGLES, np.zeros((3, 3)), np.ones((3, 3))]))
    with pytest.warns(RadiosityWarning) as caught:
        scene = rd.load_scene(path)
    assert scene.n_faces == 1
    assert any("2 faces without area left out" in str(w.message) and "'flat'" in str(w.message) for w in caught)
