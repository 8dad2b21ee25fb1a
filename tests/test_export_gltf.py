"""GLB files, read back by trimesh and as JSON."""

import json
import struct

import numpy as np
import pytest
from image_samples import UTM, far_room, quad_scene, solution

import radiosity as rd
from radiosity.image import export, gltf
from radiosity.image.look import Look

trimesh = pytest.importorskip("trimesh")


@pytest.fixture(scope="module")
def result():
    return solution(rd.subdivide(rd.load_scene("cornell-box"), cells=3))


def tree(path):
    data = path.read_bytes()
    magic, version, length, size, kind = struct.unpack("<4sIII4s", data[:20])
    assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
    assert struct.unpack("<I4s", data[20 + size : 28 + size]) == (len(data) - 28 - size, b"BIN\0")
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def accessor(document, data, index):
    info = document["accessors"][index]
    view = document["bufferViews"][info["bufferView"]]
    dtype = {5126: "<f4", 5123: "<u2", 5125: "<u4"}[info["componentType"]]
    values = np.frombuffer(data[view["byteOffset"] :][: view["byteLength"]], dtype)
    return values.reshape(info["count"], {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[info["type"]])


@pytest.mark.parametrize("smooth", [True, False])
def test_trimesh_reads_the_same_geometry_and_values(result, tmp_path, smooth):
    export(result, tmp_path / "a.glb", smooth=smooth, scale=0.125)
    read = trimesh.load(tmp_path / "a.glb", process=False)
    patches = result.patches
    assert set(read.geometry) == set(patches.scene.names)
    np.testing.assert_allclose(read.bounds, patches.scene.bounds, atol=1e-6)
    for i, name in enumerate(patches.scene.names):
        mesh = read.geometry[name]
        rows = patches.surface == i
        assert mesh.area == pytest.approx(patches.area[rows].sum(), rel=1e-5)
        assert mesh.metadata["scale"] == 0.125
        assert mesh.metadata["unit"] == "W/m²"
        values = np.stack([mesh.vertex_attributes[f"_RADIOSITY_{band}"] for band in range(3)], axis=-1).reshape(-1, 3)
        assert values.min() >= result.radiosity[rows].min() - 1e-5
        assert values.max() <= result.radiosity[rows].max() + 1e-5
        if not smooth:
            at = mesh.faces[:, 0]
            np.testing.assert_allclose(np.unique(values[at], axis=0), np.unique(result.radiosity[rows], axis=0), rtol=1e-6)


def test_colours_are_values_times_scale_within_their_sixteen_bits(result, tmp_path):
    export(result, tmp_path / "a.glb", scale=0.2)
    document, data = tree(tmp_path / "a.glb")
    clipped = 0
    for mesh in document["meshes"]:
        attributes = mesh["primitives"][0]["attributes"]
        colour = accessor(document, data, attributes["COLOR_0"]) / 65535
        values = np.concatenate([accessor(document, data, attributes[f"_RADIOSITY_{band}"]) for band in range(3)], axis=1)
        np.testing.assert_allclose(colour[:, :3], np.minimum(values * 0.2, 1), atol=0.51 / 65535)
        assert (colour[:, 3] == 1).all()
        clipped += (values * 0.2 > 1).sum()
    assert clipped > 0


def test_the_tree_is_unlit_single_sided_and_records_the_scale(result, tmp_path):
    export(result, tmp_path / "a.glb", exposure=1, scale=0.25)
    document, data = tree(tmp_path / "a.glb")
    assert document["extensionsUsed"] == ["KHR_materials_unlit"]
    assert document["materials"][0]["extensions"] == {"KHR_materials_unlit": {}}
    assert document["materials"][0]["doubleSided"] is False
    assert document["asset"]["extras"] == {
        "quantity": "radiosity",
        "unit": "W/m²",
        "bands": ["red", "green", "blue"],
        "scale": 0.5,
        "colour": "linear colour = value x scale, clipped to 1",
        "up": "y",
        "smoothed": True,
    }
    assert document["buffers"][0]["byteLength"] == len(data)
    for info in document["accessors"]:
        assert document["bufferViews"][info["bufferView"]]["byteOffset"] % 4 == 0


def test_scenes_that_are_z_up_are_turned_to_y_up(tmp_path):
    patches = rd.subdivide(rd.load_scene("room"), cells=1)
    export(solution(patches), tmp_path / "a.glb")
    bounds = trimesh.load(tmp_path / "a.glb").bounds
    np.testing.assert_allclose(bounds, [[0, 0, -4], [6, 3, 0]], atol=1e-6)


def test_rooms_far_from_the_origin_keep_shape_and_place(tmp_path):
    scene = far_room()
    patches = rd.subdivide(scene, cells=8)
    export(solution(patches), tmp_path / "a.glb")
    document, _ = tree(tmp_path / "a.glb")
    assert all("translation" in node for node in document["nodes"][1:])
    read = trimesh.load(tmp_path / "a.glb", process=False)
    turned = scene.bounds[:, [0, 2, 1]] * [1, 1, -1]  # y up
    np.testing.assert_allclose(read.bounds, np.sort(turned, axis=0), rtol=0, atol=1e-6)
    for i, name in enumerate(scene.names):
        mesh = read.geometry[name]
        assert mesh.area == pytest.approx(patches.area[patches.surface == i].sum(), rel=1e-5)
        assert mesh.area_faces.min() > 1e-3 * patches.area.min()
    with pytest.warns(rd.RadiosityWarning, match="unlit materials"):
        back = rd.load_scene(tmp_path / "a.glb")
    # y up, as the file says; the z axis of the room is its second
    np.testing.assert_allclose(back.bounds[0][[0, 1]], [UTM[0], UTM[2]], rtol=0, atol=1e-6)
    np.testing.assert_allclose(back.bounds[1][2], -UTM[1], rtol=0, atol=1e-6)


def test_rooms_at_the_origin_have_no_translations(tmp_path):
    export(solution(rd.subdivide(rd.load_scene("room"), cells=1)), tmp_path / "a.glb")
    moved = {node["name"] for node in tree(tmp_path / "a.glb")[0]["nodes"] if "translation" in node}
    assert not moved


def test_the_automatic_scale_leaves_lamps_out():
    patches = rd.subdivide(rd.load_scene("room"), cells=2)
    bright = np.where(patches.emission[:, 0] > 0, 1000.0, 2.0)
    document, _ = gltf.document(gltf.coloured(solution(patches, bright), Look()))
    assert document["asset"]["extras"]["scale"] == pytest.approx(0.85 / 2)


def test_one_band_is_grey_and_unknown_values_are_dark(tmp_path):
    export(solution(rd.subdivide(quad_scene(), cells=2), [0.5, np.nan, 0.25, 1]), tmp_path / "a.glb", smooth=False, scale=1.0)
    document, data = tree(tmp_path / "a.glb")
    colour = accessor(document, data, document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"])
    assert colour[::4].tolist() == [[v, v, v, 65535] for v in (32768, 0, 16384, 65535)]


def test_more_than_four_gigabytes_are_refused(result, tmp_path, monkeypatch):
    class Long(bytes):
        def __len__(self):
            return 2**32

    monkeypatch.setattr(gltf, "document", lambda mesh: ({}, [Long()]))
    with pytest.raises(rd.OutputError, match="holds 4"):
        export(result, tmp_path / "a.glb")
    assert not list(tmp_path.iterdir())
