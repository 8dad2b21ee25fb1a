"""PLY and STL: polygons, colours, names, and one clear error for each fault."""

import warnings

import numpy as np
import pytest
from samples import SQUARE, ply_bytes, ply_text, png, stl_bytes, stl_text

import radiosity as rd
from radiosity.errors import RadiosityWarning, SceneError
from radiosity.scene import Back
from radiosity.scene.formats.mesh.ply import read_ply

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


@pytest.mark.parametrize("tail", [b"\0\0", b"\n", b"made by x" * 20])
@pytest.mark.parametrize("head", [b"made by x", b"solid x facet"])
def test_bytes_after_the_triangles_of_a_stl_file_are_told(tmp_path, head, tail):
    (tmp_path / "x.stl").write_bytes(head + stl_bytes(TRIANGLES)[len(head) :] + tail)
    with pytest.warns(RadiosityWarning) as caught:
        scene = rd.load_scene(tmp_path / "x.stl")
    assert scene.area.tolist() == [1]
    assert str(caught[0].message).endswith(f"x.stl: {len(tail)} bytes after the last of 2 triangles are left out")
    assert len(caught) == 2  # and the missing material


def test_binary_stl_files_may_begin_with_solid(tmp_path):
    data = b"solid tile" + stl_bytes(TRIANGLES)[10:]
    assert load(tmp_path / "tile.stl", data).area.tolist() == [1]


def test_attributes_of_stl_triangles_are_told(tmp_path):
    data = bytearray(stl_bytes(TRIANGLES))
    data[-2:] = b"\x1f\x80"
    (tmp_path / "x.stl").write_bytes(data)
    with pytest.warns(RadiosityWarning) as caught:
        rd.load_scene(tmp_path / "x.stl")
    assert "colours, as some programs write them) of 1 triangles" in str(caught[0].message)


def test_solids_of_a_stl_file(tmp_path):
    """Names of several words, none, twice the same, other line ends, capitals."""
    text = stl_text({"Lamp one": TRIANGLES, "": TRIANGLES + 1.0}) + stl_text({"Lamp one": TRIANGLES + 2.0})
    for ends in ("\n", "\r\n", "\r"):
        (tmp_path / "x.stl").write_bytes(text.replace("facet", "FACET").replace("\n", ends).encode())
        with pytest.warns(RadiosityWarning) as caught:
            scene = rd.load_scene(tmp_path / "x.stl")
        assert scene.names == ("Lamp one", "x", "Lamp one#2")
        assert scene.area.tolist() == [1, 1, 1]
        assert str(caught[0].message).endswith("get numbers (name#2, ...) in the order of the file: 'Lamp one (2)'")


def test_facets_of_four_corners_and_of_two_are_damage(tmp_path):
    rows = "solid a\n" + "".join(
        "facet normal 0 0 1\nouter loop\n" + "vertex 0 0 0\n" * corners + "endloop\nendfacet\n" for corners in (4, 2)
    )
    fails(tmp_path / "x.stl", rows + "endsolid a\n", "facets are complete")
    fails(tmp_path / "x.stl", stl_text({"a": TRIANGLES}).replace("vertex 0 0 0\n", "vertex 0 0\n", 1), "line 4", "three numbers")


def test_a_stl_file_without_its_end_is_told(tmp_path):
    text = stl_text({"a": TRIANGLES})
    (tmp_path / "x.stl").write_text(text[: text.rindex("endsolid")])
    with pytest.warns(RadiosityWarning) as caught:
        assert rd.load_scene(tmp_path / "x.stl").area.tolist() == [1]
    assert "ends without endsolid" in str(caught[0].message)


def test_names_of_stl_solids_in_code_pages(tmp_path):
    (tmp_path / "x.stl").write_bytes(stl_text({"Wände": TRIANGLES}).encode("cp1252"))
    with pytest.warns(RadiosityWarning, match=r"names are read as Latin-1|no material"):
        assert rd.load_scene(tmp_path / "x.stl").names == ("Wände",)


VERTICES = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
FACES = "element face 1\nproperty list uchar int vertex_indices\n"
ROWS, FACE = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n", "4 0 1 2 3\n"
PLY = "ply\nformat ascii 1.0\n{}end_header\n{}"


@pytest.mark.parametrize(
    "content",
    [
        PLY.format(FACES + VERTICES, FACE + ROWS),
        PLY.format("comment data follow end_header\nobj_info end_header soon\n" + VERTICES + FACES, ROWS + FACE),
        PLY.format(VERTICES + "property list uchar float weights\n" + FACES, ROWS.replace("0\n", "0 2 9 9\n") + FACE),
        PLY.format(VERTICES + FACES.replace("uchar int", "int uint"), ROWS + FACE),
        PLY.format(VERTICES + FACES + "property list int float texcoord\nproperty uchar flags\n", ROWS + "4 0 1 2 3 0 7\n"),
    ],
)
def test_ply_headers_of_other_orders_and_types(tmp_path, content):
    for ends in ("\n", "\r\n", "\r"):
        scene = load(tmp_path / "tile.ply", content.replace("\n", ends))
        assert (scene.area.tolist(), scene.normal.tolist()) == ([1], [[0, 0, 1]])


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
def test_binary_ply_headers_of_any_line_end(tmp_path, order, ends):
    """Also where the first byte of the data is that of a line's end."""
    first = np.frombuffer(b"\n\n\n\x3f" if order == "<" else b"\n\x3f\n\n", order + "f4")[0]
    vertices = [[first, 0, 0], *SQUARE[1:]]
    data = ply_bytes(vertices, order=order)
    at = data.index(b"end_header\n") + 11
    assert data[at] == 10
    scene = load(tmp_path / "tile.ply", data[:at].replace(b"\n", ends.encode()) + data[at:])
    assert np.float32(scene.vertices[0, 0]) == first


@pytest.mark.parametrize("order", ["<", ">", ""])
def test_triangle_strips_of_ply(tmp_path, order):
    """Three strips, of odd and even places, a restart in one; all face one way."""
    points = [[x, y, 0] for x in range(4) for y in (0, 1)]
    strips = [[1, 0, 3, 2, 5], [5, 2, 4], [5, 4, 7, -1, 6, 7, 4]]
    head = VERTICES.replace("4", "8") + f"element tristrips {len(strips)}\nproperty list int int vertex_indices\n"
    if order:
        name = {"<": "little", ">": "big"}[order]
        rows = b"".join(np.array([len(s), *s], order + "i4").tobytes() for s in strips)
        content = f"ply\nformat binary_{name}_endian 1.0\n{head}end_header\n".encode()
        content += np.array(points, order + "f4").tobytes() + rows
    else:
        content = PLY.format(head, "".join(" ".join(map(str, row)) + "\n" for row in [*points, *([len(s), *s] for s in strips)]))
    scene = load(tmp_path / "strip.ply", content)
    assert scene.area.sum() == pytest.approx(3)
    np.testing.assert_array_equal(scene.normal, [[0, 0, 1]] * scene.n_faces)


def test_strips_may_have_corners_twice_and_be_short(tmp_path):
    head = VERTICES + "element tristrips 1\nproperty list int int vertex_indices\n"
    scene = load(tmp_path / "s.ply", PLY.format(head, ROWS + "6 0 1 3 3 2 2\n"))
    assert scene.area.tolist() == [0.5]
    fails(tmp_path / "s.ply", PLY.format(head, ROWS + "2 0 1\n"), "no faces")
    fails(tmp_path / "s.ply", PLY.format(head, ROWS + "3 0 1 9\n"), "names vertex 9")


def test_elements_of_ply_that_are_left_out_are_told(tmp_path):
    edges = "element edge 1\nproperty int vertex1\nproperty int vertex2\n"
    strips = "element tristrips 1\nproperty list int int vertex_indices\n"
    (tmp_path / "x.ply").write_text(PLY.format(VERTICES + edges + strips + FACES, ROWS + "0 1\n3 0 1 2\n" + FACE))
    with pytest.warns(RadiosityWarning) as caught:
        assert rd.load_scene(tmp_path / "x.ply").area.tolist() == [1]
    told = [str(w.message).split(": ", 1)[1] for w in caught]
    assert told[:2] == ["elements that are left out: 'edge (1)'", "strips of triangles beside faces are left out: 1"]


def test_ply_faults_of_strangers(tmp_path):
    path = tmp_path / "bad.ply"
    fails(path, PLY.format(VERTICES + FACES.replace("uchar int", "uchar float"), ROWS + "4 0 1 2.5 3\n"), "vertex 2.5", "whole")
    fails(path, PLY.format(VERTICES + VERTICES + FACES, ROWS + ROWS + FACE), "same name", "vertex (2)")
    fails(path, "ply\nformat ascii 1.0\ncomment end_header\n", "no end")
    mixed = ply_bytes(FIVE, MIXED[:2]).replace(b"list uchar", b"list char")
    assert mixed[-13] == 3
    fails(path, mixed[:-13] + b"\xff" + mixed[-12:], "truncated")


def test_data_after_the_last_row_are_told(tmp_path):
    """Mitsuba refuses such files (mitsuba2 57); a header that announces too few faces would lose some in silence."""
    head = "ply\nformat {}\nelement vertex 4\n" + "".join(f"property float {axis}\n" for axis in "xyz")
    head += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "<f4")
    text, path = "\n".join(" ".join(map(str, row)) for row in points.tolist()) + "\n3 0 1 2\n", tmp_path / "more.ply"
    face = b"\x03" + np.array([0, 1, 2], "<i4").tobytes()
    ascii_head, binary_head = (head.format(kind).encode() for kind in ("ascii 1.0", "binary_little_endian 1.0"))
    binary = binary_head + points.tobytes() + face
    for data, told in (
        (ascii_head + text.encode() + b"\n \n", None),
        (ascii_head + text.encode() + b"3 0 2 3\n", "4 numbers after the last row"),
        (binary + b"\n\0", None),
        (binary + face, "13 bytes after the last row"),
    ):
        path.write_bytes(data)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            assert rd.load_scene(path).n_faces == 1
        found = [str(one.message) for one in caught if "after the last row" in str(one.message)]
        assert len(found) == (told is not None)
        assert not found or told in found[0]


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("count", ["uchar", "short", "uint"])
def test_lists_of_many_lengths_are_read_row_by_row(tmp_path, order, count, random):
    """Beside other properties, and other lists, one of them empty; in either order of bytes."""
    kinds = {"uchar": "u1", "short": "i2", "uint": "u4"}
    points = np.column_stack([np.cos(np.arange(7)), np.sin(np.arange(7)), np.zeros(7)])
    sizes = [3, 4, 3, 5, 3, 6]
    faces = [np.sort(random.choice(7, size, replace=False)) for size in sizes]
    head = f"ply\nformat binary_{'little' if order == '<' else 'big'}_endian 1.0\nelement vertex 7\n"
    head += "".join(f"property double {axis}\n" for axis in "xyz") + f"element face {len(faces)}\nproperty uchar red\n"
    head += f"property list {count} int vertex_indices\nproperty list uchar float more\nproperty double last\nend_header\n"
    data = head.encode() + points.astype(order + "f8").tobytes()
    for face in faces:
        data += b"\x07" + np.array(len(face), order + kinds[count]).tobytes() + face.astype(order + "i4").tobytes()
        data += bytes([len(face) % 3]) + np.ones(len(face) % 3, order + "f4").tobytes() + np.array(1.5, order + "f8").tobytes()
    path = tmp_path / "many.ply"
    path.write_bytes(data)
    columns = read_ply(path).columns["face"]
    lists = columns.lists["vertex_indices"]
    assert lists.sizes.tolist() == sizes
    assert lists.values.tolist() == np.concatenate(faces).tolist()
    assert columns.lists["more"].sizes.tolist() == [size % 3 for size in sizes]
    assert (columns.lists["more"].values == 1).all()
    assert (columns.numbers["last"] == 1.5).all()
    assert (columns.numbers["red"] == 7).all()
    path.write_bytes(data[:-9])
    with pytest.raises(rd.SceneError, match="ends within the 6 rows of element 'face'"):
        read_ply(path)
