"""The glTF reader: names, transforms, colours, light, sides, cameras, and one clear error for each fault."""

import json

import numpy as np
import pytest
from samples import CORNERS, HALVES, SQUARE, Gltf, box_gltf, png

import radiosity as rd
from radiosity.errors import RadiosityWarning, SceneError
from radiosity.scene import Back

GREY = {"name": "grey", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}}


def srgb(value):
    return ((value / 255 + 0.055) / 1.055) ** 2.4


def one(tmp_path, material=GREY, node=None, **mesh):
    """A scene of one square."""
    gltf = Gltf()
    gltf.node(mesh=gltf.mesh(material=material, **mesh), name="square", **(node or {}))
    return rd.load_scene(gltf.write(tmp_path / "one.glb"))


def fails(path, *words):
    with pytest.raises(SceneError) as caught:
        rd.load_scene(path)
    for word in (path.name, *words):
        assert word in str(caught.value)


def test_box_with_texture_colours_strength_and_two_sides(tmp_path):
    scene = rd.load_scene(box_gltf().write(tmp_path / "box.glb"))
    assert scene.names == ("box/paper",)
    assert scene.n_faces == 6
    assert scene.is_quad.all()
    assert scene.area.sum() == pytest.approx(2 * (6 + 8 + 12))
    assert (scene.back == Back.RADIATES).all()
    assert scene.bands == ("red", "green", "blue")
    assert not scene.photometric
    patches = rd.subdivide(scene, cells=2)
    assert len(patches) == 48
    np.testing.assert_allclose(patches.reflectance, np.tile(np.array([0.8, 0.6, 0.4]) * 0.5 * srgb(188), (48, 1)), rtol=1e-6)
    np.testing.assert_allclose(patches.emission, np.tile(np.pi * np.array([10, 5, 2.5]), (48, 1)))


def test_texture_is_sampled_per_patch_the_right_way_up(tmp_path):
    gltf = Gltf()
    pixels = [[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]]  # the top row first
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": gltf.image(np.kron(pixels, np.ones((8, 8, 1))))}}}
    gltf.node(mesh=gltf.mesh(material=material, attributes={"TEXCOORD_0": gltf.accessor(CORNERS)}))
    with pytest.warns(RadiosityWarning, match="above 0.95"):
        patches = rd.subdivide(rd.load_scene(gltf.write(tmp_path / "t.glb")), cells=4)
    assert patches.scene.is_quad.all()  # the halves of the square are one face, texture and all
    found = {}
    for (x, y, _), value in zip(patches.centroid, patches.reflectance, strict=True):
        if abs(abs(x - 0.5) - 0.375) < 1e-9 and abs(abs(y - 0.5) - 0.375) < 1e-9:  # away from where colours blend
            found[x > 0.5, y > 0.5] = value
    top_left, top_right, low_left, low_right = found[0, 1], found[1, 1], found[0, 0], found[1, 0]
    assert top_left.argmax() == 0
    assert top_right.argmax() == 1
    assert low_left.argmax() == 2
    assert low_right.min() > 0.6


def test_white_texture_factor_is_not_lowered_in_silence(tmp_path):
    gltf = Gltf()
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": gltf.image(np.full((2, 2, 3), 200))}}}
    gltf.node(mesh=gltf.mesh(material=material, attributes={"TEXCOORD_0": gltf.accessor(CORNERS)}))
    scene = rd.load_scene(gltf.write(tmp_path / "w.glb"))  # a warning would be an error here
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, srgb(200), rtol=1e-6)


def test_texture_transform(tmp_path):
    """The example of the extension: the lower left quadrant, rotated clockwise by 90 degrees."""
    gltf = Gltf()
    pixels = np.kron([[[10, 10, 10], [60, 60, 60]], [[200, 200, 200], [120, 120, 120]]], np.ones((8, 8, 1)))
    move = {"KHR_texture_transform": {"offset": [0, 1], "rotation": np.pi / 2, "scale": [0.5, 0.5]}}
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": gltf.image(pixels), "extensions": move}}}
    gltf.node(mesh=gltf.mesh(material=material, attributes={"TEXCOORD_0": gltf.accessor(CORNERS)}))
    gltf.tree["extensionsRequired"] = ["KHR_texture_transform"]
    patches = rd.subdivide(rd.load_scene(gltf.write(tmp_path / "m.glb")), cells=8)
    inner = (np.abs(patches.centroid[:, :2] - 0.5) < 0.35).all(axis=1)
    np.testing.assert_allclose(patches.reflectance[inner], srgb(200), rtol=1e-5)


def test_normalised_and_sparse_accessors(tmp_path):
    gltf = Gltf()
    colors = gltf.accessor(np.full((4, 4), 51), "u1", normalized=True)
    place, new = gltf.view(np.array([2], "<u2").tobytes()), gltf.view(np.array([[2, 2, 0]], "<f4").tobytes())
    mesh = gltf.mesh(material=GREY, attributes={"COLOR_0": colors})
    position = gltf.tree["accessors"][gltf.tree["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"]]
    sparse = {"count": 1, "indices": {"bufferView": place, "componentType": 5123}, "values": {"bufferView": new}}
    position["sparse"] = sparse
    gltf.node(mesh=mesh)
    scene = rd.load_scene(gltf.write(tmp_path / "s.glb"))
    assert scene.bounds[1].tolist() == [2, 2, 0]
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, 0.5 * 0.2, rtol=1e-6)
    position["sparse"] = {**sparse, "count": 3}
    fails(gltf.write(tmp_path / "s.glb"), "accessor", "needs 3 elements")


def test_transforms_names_and_instances(tmp_path):
    gltf = Gltf()
    mesh = gltf.mesh(material=GREY, name="tile")
    half = float(np.sqrt(0.5))
    child = gltf.node(mesh=mesh, translation=[1, 0, 0], name="child")
    gltf.node(name="parent", rotation=[0, 0, half, half], scale=[2, 2, 2], children=[child])
    gltf.node(mesh=mesh, translation=[0, 0, 5])
    gltf.node(mesh=mesh, matrix=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 7, 1], name="tile")
    with pytest.warns(RadiosityWarning, match=r"same name get numbers \(name#2, ...\).*: 'tile \(2\)'"):
        scene = rd.load_scene(gltf.write(tmp_path / "n.glb"))
    assert scene.names == ("child/grey", "tile/grey", "tile#2/grey")
    corners = scene.vertices[scene.faces]
    # x to y by the quarter turn, then times 2: from (1..2, 0..1) to (-2..0, 2..4)
    np.testing.assert_allclose(corners[0].min(axis=0), [-2, 2, 0], atol=1e-12)
    np.testing.assert_allclose(corners[0].max(axis=0), [0, 4, 0], atol=1e-12)
    assert corners[1, 0, 2] == 5
    assert corners[2, 0, 2] == 7


def test_rotations_are_those_of_their_quaternions(tmp_path, random):
    """About any axis, also where a quaternion is not of unit length; against scipy."""
    from scipy.spatial.transform import Rotation

    for quaternion in random.normal(size=(5, 4)):
        node = {"rotation": quaternion.tolist(), "scale": [2, 3, 4], "translation": [5, 6, 7]}
        scene = one(tmp_path, node=node)
        expected = Rotation.from_quat(quaternion).apply(np.array(SQUARE) * [2, 3, 4]) + np.array([5, 6, 7])
        found = scene.vertices[scene.faces[0]]
        assert np.abs(found[:, None] - expected).max(axis=2).min(axis=0).max() < 1e-6  # each corner is there
        np.testing.assert_allclose(scene.normal[0], Rotation.from_quat(quaternion).apply([0, 0, 1]), atol=1e-6)


def test_a_mirrored_instance_keeps_its_front(tmp_path):
    assert one(tmp_path).normal[0].tolist() == [0, 0, 1]
    assert one(tmp_path, node={"scale": [-1, 1, 1]}).normal[0].tolist() == [0, 0, 1]
    np.testing.assert_allclose(one(tmp_path, node={"scale": [1, 1, -1]}).normal[0], [0, 0, -1], atol=1e-15)


def test_sides_and_radiance(tmp_path):
    scene = one(tmp_path, {**GREY, "emissiveFactor": [1, 1, 1]})
    assert scene.back.tolist() == [Back.ABSORBS]
    assert scene.emission[0, 0] == pytest.approx(np.pi)
    assert scene.bands == ("grey",)
    assert one(tmp_path, {**GREY, "doubleSided": True}).back.tolist() == [Back.RADIATES]


def test_emission_texture_with_its_own_coordinates(tmp_path):
    gltf = Gltf()
    glow = {"index": gltf.image(np.full((2, 2, 3), 188)), "texCoord": 1}
    base = {"index": gltf.image(np.full((2, 2, 3), 100))}
    material = {"pbrMetallicRoughness": {"baseColorTexture": base}, "emissiveTexture": glow, "emissiveFactor": [1, 1, 1]}
    attributes = {"TEXCOORD_0": gltf.accessor(CORNERS), "TEXCOORD_1": gltf.accessor(np.multiply(CORNERS, 3))}
    gltf.node(mesh=gltf.mesh(material=material, attributes=attributes))
    patches = rd.subdivide(rd.load_scene(gltf.write(tmp_path / "e.glb")), cells=1)
    np.testing.assert_allclose(patches.emission, np.pi * srgb(188), rtol=1e-6)
    np.testing.assert_allclose(patches.reflectance, srgb(100), rtol=1e-6)
    assert np.ptp(patches.scene.emission_paint.uv, axis=(0, 1)) == pytest.approx([3, 3])
    assert np.ptp(patches.scene.reflectance_paint.uv, axis=(0, 1)) == pytest.approx([1, 1])


def test_texture_without_coordinates_is_taken_by_its_mean(tmp_path):
    gltf = Gltf()
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": gltf.image([[[0, 0, 0], [255, 255, 255]]])}}}
    gltf.node(mesh=gltf.mesh(material=material), name="wall")
    with pytest.warns(RadiosityWarning, match="no texture coordinates.*'wall/material 0'"):
        scene = rd.load_scene(gltf.write(tmp_path / "m.glb"))
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, 0.5, rtol=1e-6)


@pytest.mark.parametrize(("mode", "index"), [(5, [0, 1, 3, 2]), (6, [0, 1, 2, 3])])
def test_strips_and_fans(tmp_path, mode, index):
    scene = one(tmp_path, faces=index, mode=mode)
    assert scene.n_faces == 1
    assert scene.area[0] == pytest.approx(1)
    assert scene.normal[0].tolist() == [0, 0, 1]


def test_without_indices(tmp_path):
    assert one(tmp_path, vertices=np.array(SQUARE)[np.ravel(HALVES)], faces=None).area.tolist() == [1]


def test_camera(tmp_path):
    gltf = Gltf(cameras=[{"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 1.5, "znear": 0.1}}])
    gltf.node(mesh=gltf.mesh(material=GREY))
    gltf.node(camera=0, translation=[0, 0, 5], children=[gltf.node(mesh=0, name="below a camera")])
    scene = rd.load_scene(gltf.write(tmp_path / "c.glb"))
    (camera,) = scene.cameras
    assert camera.origin == (0, 0, 5)
    assert camera.target == (0, 0, 4)
    assert camera.up == (0, 1, 0)
    assert camera.fov == pytest.approx(np.rad2deg(0.5))
    assert (camera.width, camera.height) == (900, 600)
    assert scene.bounds[1, 2] == 5  # the child of the camera is there


def test_habits_are_named_once(tmp_path):
    def warnings_of(material, **more):
        with pytest.warns(RadiosityWarning) as caught:
            one(tmp_path, material, **more)
        return [str(w.message) for w in caught]

    (text,) = warnings_of(None)
    assert "no material for 'square'" in text
    (text,) = warnings_of({"name": "m", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 1}})
    assert "not diffuse" in text
    assert "'square/m'" in text
    (text,) = warnings_of({**GREY, "alphaMode": "BLEND"})
    assert "transparency" in text
    assert "'grey'" in text
    (text,) = warnings_of({"name": "white"})  # glTF's default: white metal
    assert "without a base colour" in text
    assert "reflectance 0.5 taken for 'white'" in text


@pytest.mark.parametrize(
    ("finish", "glossy"),
    [
        ({}, False),
        ({"metallicFactor": 0, "roughnessFactor": 0.29}, True),
        ({"metallicFactor": 0, "roughnessFactor": 0.3}, False),
        ({"metallicFactor": 0.1}, True),
        ({"metallicFactor": 0, "roughnessFactor": 0.1, "metallicRoughnessTexture": {}}, False),  # of a texture, which is not read
        ({"metallicRoughnessTexture": {}}, True),  # the default of such materials is metal
        ({"metallicFactor": 0, "metallicRoughnessTexture": {}}, False),
    ],
    ids=str,
)
def test_what_counts_as_not_diffuse(tmp_path, recwarn, finish, glossy):
    colour = {"baseColorFactor": [0.5, 0.5, 0.5, 1]}
    one(tmp_path, {"name": "m", "pbrMetallicRoughness": colour | finish})
    assert ["not diffuse" in str(warning.message) for warning in recwarn] == [True] * glossy


def test_interleaved_values_are_read_with_their_stride(tmp_path):
    """Positions and colours side by side in one view, as most programs write them."""
    gltf = Gltf()
    rows = np.concatenate([np.array(SQUARE, "<f4"), np.tile(np.array([0.1, 0.2, 0.3], "<f4"), (4, 1))], axis=1)
    view = gltf.view(rows.tobytes())
    gltf.tree["bufferViews"][view]["byteStride"] = 24
    for offset in (0, 12):
        info = {"bufferView": view, "byteOffset": offset, "componentType": 5126, "count": 4, "type": "VEC3"}
        gltf.tree["accessors"].append(info)
    primitive = {"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": gltf.accessor(np.ravel(HALVES), "u2")}
    gltf.tree["meshes"].append({"primitives": [primitive]})
    gltf.node(mesh=0)
    scene = rd.load_scene(gltf.write(tmp_path / "i.glb"))
    assert scene.area.tolist() == [1]
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance[0], [0.1, 0.2, 0.3], rtol=1e-6)


def test_vertex_colours_without_a_material(tmp_path):
    gltf = Gltf()
    gltf.node(mesh=gltf.mesh(attributes={"COLOR_0": gltf.accessor([[0.1, 0.2, 0.3]] * 4)}))
    scene = rd.load_scene(gltf.write(tmp_path / "v.glb"))
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance[0], [0.1, 0.2, 0.3], rtol=1e-6)


def test_gltf_with_files_beside_it(tmp_path):
    gltf = box_gltf()
    tree = {**gltf.tree, "buffers": [{"byteLength": len(gltf.data), "uri": "my%20data.bin"}]}
    tree["images"] = [{"uri": "paper.png"}]
    path = tmp_path / "box.gltf"
    path.write_text(json.dumps(tree))
    fails(path, "my%20data.bin", "buffer 0")
    (tmp_path / "my data.bin").write_bytes(gltf.data)
    fails(path, "paper.png", "image 0")
    (tmp_path / "paper.png").write_bytes(b"no image")
    fails(path, "image 0", "decoded")
    (tmp_path / "paper.png").write_bytes(png(np.full((2, 2, 3), 188)))
    scene = rd.load_scene(path)
    assert scene.hash != rd.load_scene(gltf.write(tmp_path / "box.glb")).hash  # another image size, else
    np.testing.assert_allclose(rd.subdivide(scene).reflectance[0], np.array([0.8, 0.6, 0.4]) * 0.5 * srgb(188), rtol=1e-6)
    (tmp_path / "my data.bin").write_bytes(gltf.data[:100])
    fails(path, "truncated", "100 bytes")


def test_outer_faults(tmp_path):
    good = box_gltf().glb()
    path = tmp_path / "bad.glb"
    for data, words in (
        (b"", ["empty"]),
        (good[:10], ["truncated"]),
        (good[:-8], ["truncated", str(len(good))]),
        (b"PK" + good, ["does not begin"]),
        (good[:12] + b"\xff\xff\x00\x00" + good[16:], ["chunk at byte 12"]),
        (good.replace(b'"asset"', b'"asset('), ["JSON"]),
        (good.replace(b'"2.0"', b'"1.0"'), ["version 1.0"]),
        (good[:4] + b"\x01" + good[5:], ["version 1"]),
        (good[:16] + b"BIN\0" + good[20:], ["first chunk"]),
    ):
        path.write_bytes(data)
        fails(path, *words)


def test_inner_faults(tmp_path):
    path = tmp_path / "bad.glb"

    def check(change, *words):
        gltf = Gltf()
        gltf.node(mesh=gltf.mesh(material=GREY), name="square")
        change(gltf.tree)
        fails(gltf.write(path), *words)

    accessor = {"bufferView": 0, "componentType": 5126, "count": 10**9, "type": "VEC3"}
    check(lambda t: t.update(extensionsRequired=["KHR_draco_mesh_compression"]), "KHR_draco_mesh_compression")
    check(lambda t: t.update(extensionsRequired=["EXT_meshopt_compression"]), "EXT_meshopt_compression")
    check(lambda t: t["accessors"].__setitem__(0, accessor), "accessor 0", "1000000000")
    check(lambda t: t["accessors"].__setitem__(0, {**accessor, "bufferView": 9}), "bufferViews 9")
    check(lambda t: t["accessors"].__setitem__(0, {"componentType": 5126, "count": 10**12, "type": "VEC3"}), "without bytes")
    check(lambda t: t["accessors"][0].update(componentType=7), "componentType")
    check(lambda t: t["accessors"][0].update(type="MAT5"), "'MAT5'")
    check(lambda t: t["accessors"][0].update(count=-1), "count of accessor 0 is -1")
    check(lambda t: t["accessors"][0].update(count=2), "names vertex 2", "there are 2")
    check(lambda t: t["bufferViews"][0].update(byteLength=10**6), "buffer view 0")
    check(lambda t: t["nodes"][0].update(mesh=4), "meshes 4")
    check(lambda t: t["nodes"][0].update(children=[0]), "no faces")  # its own child: there is no root
    check(lambda t: t["nodes"][0].update(children=[0]) or t.update(scenes=[{"nodes": [0]}]), "own ancestor")
    check(lambda t: t["nodes"][0].update(scale=[1, 2]), "scale of node 0")
    check(lambda t: t["nodes"][0].update(translation=[float("nan"), 0, 0]), "translation of node 0")
    check(lambda t: t["nodes"][0].update(rotation=[0, 0, 0, 0]), "rotation of node 0")
    check(lambda t: t["nodes"][0].update(scale=[0, 0, 0]), "no area", "square/grey")
    check(lambda t: t["materials"][0].update(emissiveFactor=[-1, 0, 0]), "emission of surface 'square/grey'", "-3.14")
    check(lambda t: t["materials"][0].update(emissiveFactor="x"), "emissiveFactor")
    check(lambda t: t["meshes"][0]["primitives"][0]["attributes"].pop("POSITION"), "POSITION")
    with pytest.warns(RadiosityWarning, match="points and lines are left out: 'square'"):
        check(lambda t: t["meshes"][0]["primitives"][0].update(mode=1), "no faces")
    check(lambda t: t.update(nodes=[]), "no faces")
    check(lambda t: t.update(scenes=[{"nodes": [3]}]), "nodes 3")
    check(lambda t: t.update(meshes={}), "meshes")


def test_vertices_that_are_no_numbers(tmp_path):
    gltf = Gltf()
    gltf.node(mesh=gltf.mesh(vertices=[[0, 0, 0], [1, 0, np.nan], [0, 1, 0], [1, 1, 1]], material=GREY), name="square")
    fails(gltf.write(tmp_path / "n.glb"), "vertex 1", "square/grey", "nan")


def test_faces_without_area_are_counted(tmp_path):
    with pytest.warns(RadiosityWarning, match="1 face without area left out.*'square/grey'"):
        scene = one(tmp_path, faces=[[0, 1, 2], [0, 2, 3], [0, 1, 1]])
    assert scene.n_faces == 1
    assert scene.area.tolist() == [1]


@pytest.mark.parametrize("extra", [{}, {"translation": [0, 0, 1]}, {"scale": [-1, 1, 1]}])
def test_vertices_that_many_primitives_share_are_not_copied_for_each(tmp_path, extra):
    """Some programs write one accessor of all vertices (assimp 4998). A primitive takes those that it uses, and their values."""
    k, n = 12, 5
    x, y = (values.ravel() for values in np.meshgrid(np.arange(k), np.arange(k), indexing="ij"))
    points = np.column_stack([x, y, 0.1 * x * y])
    uv, color = np.column_stack([x, y]) / k, np.column_stack([x / k, y / k, 0 * x + 0.5])
    pixels = np.random.default_rng(1).integers(0, 200, (8, 8, 3))
    at = np.arange(n) * (k + 1) + 1
    faces = [[[i, i + k, i + 1], [i + 1, i + k, i + k + 1]] for i in at]

    def scene(shared: bool) -> rd.Scene:
        gltf = Gltf()
        material = {"name": "m", "pbrMetallicRoughness": {"baseColorTexture": {"index": gltf.image(pixels)}, "metallicFactor": 0}}
        whole = {"TEXCOORD_0": gltf.accessor(uv), "COLOR_0": gltf.accessor(color)}
        mesh = gltf.mesh(points, faces[0], material, whole)
        first = gltf.tree["meshes"][mesh]["primitives"][0]
        for some in faces[1:]:
            one = {**first, "indices": gltf.accessor(np.ravel(some), "u2")}
            if not shared:
                used = np.unique(some)
                values = {"POSITION": points[used], "TEXCOORD_0": uv[used], "COLOR_0": color[used]}
                index = gltf.accessor(np.searchsorted(used, np.ravel(some)), "u2")
                one |= {"attributes": {name: gltf.accessor(value) for name, value in values.items()}, "indices": index}
            gltf.tree["meshes"][mesh]["primitives"].append(one)
        gltf.node(mesh=mesh, name="all", **extra)
        return rd.load_scene(gltf.write(tmp_path / "shared.glb"))

    one, other = scene(True), scene(False)
    assert len(one.vertices) == len(other.vertices) == 4 * n
    assert one.hash == other.hash


def test_bytes_as_vertex_colours_are_told_by_all_of_them(tmp_path):
    """Some vertices may have small numbers alone, which would be taken for shares of 1."""
    gltf = Gltf()
    points = np.column_stack([np.arange(30) % 3, np.arange(30) // 3, np.zeros(30)])
    color = np.full((30, 3), 255.0)
    color[:4] = 1.0  # of the only face that is there: 1 of 255
    mesh = gltf.mesh(points, [[0, 1, 3]], GREY, {"COLOR_0": gltf.accessor(color)})
    gltf.node(mesh=mesh, name="dark")
    with pytest.warns(RadiosityWarning, match="255"):
        scene = rd.load_scene(gltf.write(tmp_path / "bytes.glb"))
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, 0.5 / 255, rtol=1e-6)


def test_copies_that_do_not_fit_in_memory_are_refused_as_they_are_read(tmp_path, monkeypatch):
    """A small file may name one mesh in thousands of nodes; what it takes is told before it takes it."""
    gltf = Gltf()
    mesh = gltf.mesh(material=GREY)
    for number in range(1000):
        gltf.node(mesh=mesh, name=f"tile {number}", translation=[2 * number, 0, 0])
    path = gltf.write(tmp_path / "tiles.glb")
    monkeypatch.setenv("RADIOSITY_MEMORY", "100K")
    fails(path, "'tile 290', one of 1000 nodes, there are 582 faces, which take about 0.0977 MiB", "RADIOSITY_MEMORY=16G")
    monkeypatch.setenv("RADIOSITY_MEMORY", "none")
    assert rd.load_scene(path).n_faces == 1000
