"""PLY files, read back by hand and by trimesh."""

import numpy as np
import pytest
from image_samples import UTM, far_room, quad_scene, solution

import radiosity as rd
from radiosity.image import display_mesh, export
from radiosity.image.plane_fit import at_vertices
from radiosity.image.tone import srgb


def read(path):
    header, body = path.read_bytes().split(b"end_header\n", 1)
    lines = header.decode("ascii").splitlines()
    count = {line.split()[1]: int(line.split()[2]) for line in lines if line.startswith("element")}
    types = {"float": "<f4", "double": "<f8", "uchar": "u1", "int": "<i4"}
    fields = [(line.split()[2], types[line.split()[1]]) for line in lines if line.startswith("property") and "list" not in line]
    vertex = np.frombuffer(body, np.dtype(fields), count["vertex"])
    face = np.frombuffer(body[vertex.nbytes :], np.dtype([("n", "u1"), ("corners", "<i4", 3)]), count["face"])
    assert vertex.nbytes + face.nbytes == len(body)
    return lines, vertex, face


def test_vertices_carry_colour_values_and_surface(tmp_path):
    result = solution(rd.subdivide(rd.load_scene("cornell-box"), cells=2))
    export(result, tmp_path / "a.ply", scale=0.1)
    lines, vertex, face = read(tmp_path / "a.ply")
    mesh = display_mesh.build(result.patches)
    smooth = at_vertices(result.patches, mesh, result.radiosity)
    np.testing.assert_allclose(np.stack([vertex[axis] for axis in "xyz"], axis=1), mesh.vertices, atol=1e-7)
    for i, band in enumerate(("red", "green", "blue")):
        np.testing.assert_allclose(vertex[f"radiosity_{band}"], smooth[:, i], rtol=1e-6)
        np.testing.assert_allclose(vertex[band], 255 * srgb(0.1 * smooth[:, i]), atol=0.5001)
    assert (face["n"] == 3).all()
    np.testing.assert_array_equal(face["corners"], mesh.triangles()[0])
    np.testing.assert_array_equal(vertex["surface"][face["corners"][:, 0]], mesh.surface[mesh.triangles()[1]])
    assert "comment quantity radiosity unit W/m2 scale 0.1" in lines
    assert "comment surface 4 left wall" in lines


def test_rooms_far_from_the_origin_keep_shape_and_place(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    scene = far_room()
    patches = rd.subdivide(scene, cells=8)
    export(solution(patches), tmp_path / "a.ply")
    lines, vertex, face = read(tmp_path / "a.ply")
    assert [f"property double {axis}" in lines for axis in "xyz"] == [True] * 3
    points = np.column_stack([vertex[axis] for axis in "xyz"])
    np.testing.assert_array_equal([points.min(axis=0), points.max(axis=0)], scene.bounds)
    one, two, three = points[face["corners"]].transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(two - one, three - one), axis=1) / 2
    assert area.min() > 1e-3 * patches.area.min()
    assert area.sum() == pytest.approx(patches.area.sum(), rel=1e-9)
    np.testing.assert_allclose(trimesh.load(tmp_path / "a.ply", process=False).bounds, scene.bounds, rtol=0, atol=1e-9)
    np.testing.assert_allclose(rd.load_scene(tmp_path / "a.ply").bounds[0], UTM, rtol=0, atol=1e-9)


def test_rooms_at_the_origin_are_in_single_precision(tmp_path):
    export(solution(rd.subdivide(rd.load_scene("cornell-box"), cells=1)), tmp_path / "a.ply")
    assert "property float x" in read(tmp_path / "a.ply")[0]


def test_trimesh_reads_it(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    result = solution(rd.subdivide(rd.load_scene("room"), cells=2))
    export(result, tmp_path / "a.ply", smooth=False)
    mesh = trimesh.load(tmp_path / "a.ply", process=False)
    assert mesh.area == pytest.approx(result.patches.area.sum(), rel=1e-5)
    assert len(mesh.vertices) == 4 * len(result.patches)
    assert mesh.visual.kind == "vertex"


def test_names_cannot_break_the_header(tmp_path):
    result = solution(rd.subdivide(quad_scene(("böse\nend_header\n",)), cells=1), [1.0])
    export(result, tmp_path / "a.ply")
    lines, vertex, _ = read(tmp_path / "a.ply")
    assert "comment surface 0 b?se end_header " in lines
    assert vertex["radiosity"].tolist() == [1, 1, 1, 1]


def test_other_quantities_and_single_bands(tmp_path):
    result = solution(rd.subdivide(rd.load_scene("cornell-box"), cells=1))
    export(result, tmp_path / "a.ply", quantity="irradiance", band="green", smooth=False)
    _, vertex, _ = read(tmp_path / "a.ply")
    green = result.irradiance[:, 1].astype(np.float32)
    assert set(vertex["irradiance"].tolist()) == set(green.tolist())
    assert (vertex["red"] == vertex["blue"]).all()
