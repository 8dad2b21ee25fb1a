"""Faces whose outline crosses itself are told by name and number, in every format that has polygons."""

import numpy as np
import pytest
from samples import SQUARE, ply_bytes, ply_text

import radiosity as rd

BOW = [0, 2, 1, 3]
ARROW = [[0, 0, 0], [2, 1, 0], [0, 2, 0], [1, 1, 0]]
RING = [[np.cos(a), np.sin(a), 0] for a in 2 * np.pi * np.arange(5) / 5]
STAR = [0, 2, 4, 1, 3]
EIGHT = [[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0], [-1, 0.5, 0], [-1, 0.5, 0]]
GREY = "newmtl m\nKd 0.5 0.5 0.5\n"


def obj(points, faces):
    rows = ["mtllib m.mtl", *(f"v {x} {y} {z}" for x, y, z in points), "o good", "usemtl m", "f 1 2 3", "o bad"]
    return "\n".join([*rows, *("f " + " ".join(str(i + 1) for i in face) for face in faces), ""])


def mgf(points, faces):
    rows = [f"v p{i} =\n\tp {x} {y} {z}" for i, (x, y, z) in enumerate(points)]
    rows += ["o bad", *("f " + " ".join(f"p{i}" for i in face) for face in faces), "o", ""]
    return "\n".join(["m wall =\n\tsides 2\n\trd 0.5", *rows])


def texts(path, content):
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    (path.parent / "m.mtl").write_text(GREY)
    with pytest.warns(rd.RadiosityWarning) as caught:
        scene = rd.load_scene(path)
    return scene, [str(w.message).split(": ", 1)[1] for w in caught]


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("x.obj", obj(SQUARE, [[0, 1, 2, 3], BOW]), "(first: face 2; surfaces 'bad/m')"),
        ("x.ply", ply_text(faces=[[0, 1, 2, 3], BOW]), "(first: face 1; surfaces 'x')"),
        ("x.mgf", mgf(SQUARE, [[0, 1, 2, 3], BOW]), "(first: face 1; surfaces 'bad/wall')"),
    ],
)
def test_quadrilaterals(tmp_path, name, content, told):
    scene, texts_of = texts(tmp_path / name, content)
    found = [text for text in texts_of if "crosses itself" in text]
    assert len(found) == 1
    assert "1 quadrilaterals whose outline crosses itself became two triangles that face opposite ways " + told in found[0]
    assert scene.is_quad.sum() == 1


def test_quadrilaterals_of_arrays():
    with pytest.warns(rd.RadiosityWarning, match=r"first: face 0; surfaces 'surface'"):
        scene = rd.Scene.from_arrays(SQUARE, [BOW], 0.5, 0.0)
    assert sorted(scene.normal[:, 2]) == [-1, 1]


@pytest.mark.parametrize("shape", [SQUARE, ARROW, [[0, 0, 0], [1, 0, 0], [1, 1, 0.9], [0, 1, 0]]])
@pytest.mark.parametrize("turn", range(4))
def test_convex_concave_and_bent_ones_do_not_cross(shape, turn):
    rd.Scene.from_arrays(shape, [np.roll([0, 1, 2, 3], turn)], 0.5, 0.0)  # a warning is an error


@pytest.mark.parametrize(("points", "face"), [(RING, STAR), (EIGHT, [0, 1, 2, 3, 4])])
@pytest.mark.parametrize("kind", ["obj", "ply", "binary", "mitsuba-obj", "mitsuba-ply"])
def test_larger_polygons(tmp_path, kind, points, face):
    faces = [[0, 1, 2], face]
    content = obj(points, faces) if "obj" in kind else ply_bytes(points, faces) if kind == "binary" else ply_text(points, faces)
    path = tmp_path / f"x.{'obj' if 'obj' in kind else 'ply'}"
    if kind.startswith("mitsuba"):
        path.write_text(content)
        shape = f'<shape type="{path.suffix[1:]}"><string name="filename" value="{path.name}"/><bsdf type="diffuse"/></shape>'
        path, content = tmp_path / "x.xml", f'<scene version="3.0.0">{shape}</scene>'
    _, told = texts(path, content)
    found = [text for text in told if "crosses itself" in text]
    name = "bad/m (face 1)" if kind == "obj" else "x (face 2)" if kind == "mitsuba-obj" else "x (face 1)"
    assert found == [f"faces whose outline crosses itself are cut into triangles that may be other ones than meant: '{name}'"]


def test_a_polygon_that_cancels_itself_is_no_triangle(tmp_path):
    """Two equal loops that run opposite ways: its vector area is zero, and none of its corners may stand for it."""
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [-1, 0, 0]]
    scene, told = texts(tmp_path / "x.ply", ply_text(points, [[0, 1, 2], [1, 2, 0, 3, 4, 0]]))
    assert [text.split(" ")[0:4] for text in told if "material" not in text] == [
        ["faces", "whose", "outline", "crosses"],
        ["1", "face", "without", "area"],
    ]
    assert scene.area.tolist() == [0.5]
