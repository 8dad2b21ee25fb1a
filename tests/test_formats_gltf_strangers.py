"""glTF files as other programs write them: skins, morphs, hidden nodes, instances, extensions, and materials without colour."""

import json
from base64 import b64encode

import numpy as np
import pytest
from samples import HALVES, SQUARE, Gltf

import radiosity as rd
from radiosity.errors import RadiosityWarning, SceneError

GREY = {"name": "grey", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}}
UNIT = np.eye(4).ravel()


def one(tmp_path, material=GREY, node=None, tree=None, **mesh):
    """A scene of one square."""
    gltf = Gltf(**(tree or {}))
    gltf.node(mesh=gltf.mesh(material=material, **mesh), name="square", **(node or {}))
    return rd.load_scene(gltf.write(tmp_path / "one.glb"))


def told(tmp_path, *args, **more):
    with pytest.warns(RadiosityWarning) as caught:
        scene = one(tmp_path, *args, **more)
    return scene, [str(w.message) for w in caught]


def box(scene):
    return scene.bounds.tolist()


def skinned(tmp_path, weights=((1, 0, 0, 0),) * 4, numbers=((0, 0, 0, 0),) * 4, bind=(UNIT, UNIT), scale=(0.01,) * 3, **more):
    """A square of 100 units on an armature of scale 0.01 at x = 2, whose second joint is 50 higher; its node stands elsewhere."""
    gltf = Gltf()
    attributes = {"JOINTS_0": gltf.accessor(numbers, "u1"), "WEIGHTS_0": gltf.accessor(weights)}
    mesh = gltf.mesh(np.array(SQUARE) * 100, material=GREY, attributes=attributes)
    gltf.node(mesh=mesh, skin=0, name="door", translation=[7, 0, 0])
    gltf.node(name="armature", scale=list(scale), translation=[2, 0, 0], children=[2, 3])
    gltf.node(name="bone")
    gltf.node(name="upper", translation=[0, 0, 50])
    gltf.tree["skins"] = [{"joints": [2, 3], "inverseBindMatrices": gltf.accessor(bind), **more}]
    return rd.load_scene(gltf.write(tmp_path / "skin.glb"))


def test_joints_place_a_skin_and_its_node_does_not(tmp_path):
    scene = skinned(tmp_path)
    assert box(scene) == [[2, 0, 0], [3, 1, 0]]
    assert scene.area.sum() == pytest.approx(1)
    assert scene.normal[0].tolist() == [0, 0, 1]


def test_weights_blend_joints_and_need_not_sum_to_one(tmp_path):
    scene = skinned(tmp_path, weights=((2, 2, 0, 0),) * 4, numbers=((0, 1, 0, 0),) * 4)
    assert box(scene) == [[2, 0, 0.25], [3, 1, 0.25]]


def test_inverse_bind_matrices_go_first(tmp_path):
    away = np.eye(4)
    away[3, :3] = [-100, 0, 10]  # column after column: a translation
    assert box(skinned(tmp_path, bind=(away.ravel(), UNIT))) == pytest.approx(np.array([[1, 0, 0.1], [2, 1, 0.1]]))


def test_mirroring_joints_leave_the_front_in_front(tmp_path):
    assert skinned(tmp_path, scale=(-0.01, 0.01, 0.01)).normal[0].tolist() == [0, 0, 1]


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"weights": ((0, 0, 0, 0),) * 4}, "weights of vertex 0 of 'door' sum to 0"),
        ({"numbers": ((2, 0, 0, 0),) * 4}, "joint 2; its skin has 2"),
        ({"weights": ((1, 0, 0),) * 4}, r"WEIGHTS_0 of 'door' has shape \(4, 3\)"),
        ({"bind": (UNIT,)}, r"inverseBindMatrices of skin 0 have shape \(1, 16\)"),
        ({"inverseBindMatrices": 0}, "inverseBindMatrices of skin 0"),
        ({"joints": []}, "no joints"),
        ({"joints": [9]}, "nodes 9"),
    ],
)
def test_damaged_skins(tmp_path, change, what):
    with pytest.raises(SceneError, match=what):
        skinned(tmp_path, **change)


def test_a_skin_without_joints_in_its_mesh(tmp_path):
    with pytest.raises(SceneError, match="'square' has a skin but no JOINTS_0"):
        one(tmp_path, node={"skin": 0}, tree={"skins": [{"joints": [0]}]})


@pytest.mark.parametrize(("of_node", "of_mesh", "height"), [(None, [0.5], 1.5), ([2], [0.5], 6), ([0], [1], 0), (None, None, 0)])
def test_morph_weights_of_the_node_or_the_mesh(tmp_path, of_node, of_mesh, height):
    gltf = Gltf()
    up = [{"POSITION": gltf.accessor([[0, 0, 3]] * 4)}]
    mesh = gltf.mesh(material=GREY, targets=up)
    gltf.tree["meshes"][mesh] |= {} if of_mesh is None else {"weights": of_mesh}
    gltf.node(mesh=mesh, **({} if of_node is None else {"weights": of_node}))
    assert box(rd.load_scene(gltf.write(tmp_path / "m.glb"))) == [[0, 0, height], [1, 1, height]]


def test_morphs_that_do_not_fit(tmp_path):
    gltf = Gltf()
    mesh = gltf.mesh(material=GREY, targets=[{"POSITION": gltf.accessor([[0, 0, 3]] * 3)}])
    gltf.node(mesh=mesh, weights=[1], name="face")
    with pytest.raises(SceneError, match=r"morph target 0 of 'face' has shape \(3, 3\)"):
        rd.load_scene(gltf.write(tmp_path / "m.glb"))
    gltf.tree["nodes"][0]["weights"] = [1, 2]
    with pytest.raises(SceneError, match="weights of 'face' is"):
        rd.load_scene(gltf.write(tmp_path / "m.glb"))


@pytest.mark.parametrize("required", [False, True])
def test_hidden_nodes_and_all_below_them_are_left_out(tmp_path, required):
    gltf = Gltf(extensionsUsed=["KHR_node_visibility"], **({"extensionsRequired": ["KHR_node_visibility"]} if required else {}))
    mesh = gltf.mesh(material=GREY)
    lamp = gltf.node(mesh=mesh, name="lamp", extensions={"KHR_node_visibility": {"visible": True}})
    gltf.node(name="cupboard", extensions={"KHR_node_visibility": {"visible": False}}, children=[lamp])
    gltf.node(mesh=mesh, name="floor", extensions={"KHR_node_visibility": {}})
    with pytest.warns(RadiosityWarning, match=r"hidden objects \(KHR_node_visibility\) are left out: 'lamp'$"):
        assert rd.load_scene(gltf.write(tmp_path / "h.glb")).names == ("floor/grey",)


def test_instances_of_a_mesh(tmp_path):
    """Places, turns and sizes of their own within the node; a mirrored one keeps its front."""
    gltf = Gltf(extensionsUsed=["EXT_mesh_gpu_instancing"], extensionsRequired=["EXT_mesh_gpu_instancing"])
    half = float(np.sqrt(0.5))
    attributes = {
        "TRANSLATION": gltf.accessor([[0, 0, 0], [5, 0, 0], [10, 0, 0]]),
        "ROTATION": gltf.accessor([[0, 0, 0, 1], [0, 0, half, half], [0, 0, 0, 1]]),
        "SCALE": gltf.accessor([[1, 1, 1], [2, 1, 1], [-1, 1, 1]]),
    }
    color = {"COLOR_0": gltf.accessor([[0.1, 0.2, 0.3]] * 4)}
    node = {"translation": [0, 0, 9], "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}}
    gltf.node(mesh=gltf.mesh(attributes=color), name="tile", **node)
    scene = rd.load_scene(gltf.write(tmp_path / "i.glb"))
    assert scene.names == ("tile",)
    corners = scene.vertices[scene.faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    np.testing.assert_allclose(low, [[0, 0, 9], [4, 0, 9], [9, 0, 9]], atol=1e-6)
    np.testing.assert_allclose(high, [[1, 1, 9], [5, 2, 9], [10, 1, 9]], atol=1e-6)
    np.testing.assert_allclose(scene.normal, [[0, 0, 1]] * 3, atol=1e-6)
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, np.tile([0.1, 0.2, 0.3], (6, 1)), rtol=1e-6)


def test_instances_that_do_not_fit_or_are_too_many(tmp_path):
    gltf = Gltf()
    attributes = {"TRANSLATION": gltf.accessor([[0, 0, 0]]), "SCALE": gltf.accessor([[1, 1, 1]] * 2)}
    node = {"extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}}
    gltf.node(mesh=gltf.mesh(material=GREY), name="tile", **node)
    with pytest.raises(SceneError, match=r"instances of 'tile'.*equal counts"):
        rd.load_scene(gltf.write(tmp_path / "i.glb"))
    del attributes["SCALE"]
    gltf.tree["accessors"].append({"componentType": 5126, "count": 10_000_000, "type": "VEC3"})
    attributes["TRANSLATION"] = len(gltf.tree["accessors"]) - 1
    with pytest.raises(SceneError, match="instances of 'tile' are 10000000 of 4 faces or vertices"):
        rd.load_scene(gltf.write(tmp_path / "i.glb"))


@pytest.mark.parametrize(
    "material",
    [
        {"name": "paint"},  # as Blender writes a Diffuse BSDF
        {"name": "paint", "emissiveFactor": [1, 1, 1]},
        {"name": "paint", "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 1}},
    ],
)
def test_a_material_without_a_base_colour_is_told(tmp_path, material):
    scene, (text,) = told(tmp_path, material)
    assert "materials without a base colour" in text
    assert "reflectance 0.5 taken for 'paint'" in text
    assert scene.reflectance.tolist() == [[0.5]]
    assert scene.emission.any() == ("emissiveFactor" in material)


def test_vertex_colours_are_a_base_colour(tmp_path):
    gltf = Gltf()
    gltf.node(mesh=gltf.mesh(material={"name": "paint"}, attributes={"COLOR_0": gltf.accessor([[0.1, 0.2, 0.3]] * 4)}))
    scene = rd.load_scene(gltf.write(tmp_path / "v.glb"))
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance[0], [0.1, 0.2, 0.3], rtol=1e-6)


@pytest.mark.parametrize(
    "extension",
    [
        {"KHR_materials_clearcoat": {"clearcoatFactor": 1}},
        {"KHR_materials_sheen": {"sheenColorFactor": [0, 1, 0]}},
        {"KHR_materials_iridescence": {"iridescenceFactor": 1}},
        {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.5, 0.5, 0.5, 1], "glossinessFactor": 0.9}},
    ],
    ids=lambda value: next(iter(value)),
)
def test_what_is_not_diffuse_is_named(tmp_path, extension):
    scene, (text,) = told(tmp_path, {**GREY, "extensions": extension})
    assert "not diffuse" in text
    assert scene.reflectance.tolist() == [[0.5]]


@pytest.mark.parametrize(
    "extension",
    [
        {"KHR_materials_transmission": {}},
        {"KHR_materials_clearcoat": {"clearcoatFactor": 0}},
        {"KHR_materials_ior": {"ior": 1.4}},
        {"KHR_materials_specular": {"specularFactor": 0.5}},
    ],
    ids=lambda value: next(iter(value)),
)
def test_what_adds_nothing_is_not(tmp_path, extension):
    assert one(tmp_path, {**GREY, "extensions": extension}).reflectance.tolist() == [[0.5]]


def test_unlit_materials_variants_animations_and_unknown_extensions_are_told_once(tmp_path):
    tree = {
        "extensionsUsed": ["KHR_materials_unlit", "ACME_smell", "KHR_materials_variants", "KHR_materials_ior"],
        "extensions": {"KHR_materials_variants": {"variants": [{"name": "oak"}, {"name": "elm"}]}},
        "animations": [{"name": "swing"}, {}],
    }
    _, texts = told(tmp_path, {**GREY, "extensions": {"KHR_materials_unlit": {}}}, tree=tree)
    assert [text.split(": ", 1)[1] for text in texts] == [
        "unlit materials are taken as diffuse ones of their base colour: 'grey'",
        "extensions that are not read: 'ACME_smell'",
        "variants of materials are left out, the material of each primitive itself is taken: 'oak', 'elm'",
        "animations are left out, all stands as its nodes say: 'swing', 'animation 1'",
    ]


@pytest.mark.parametrize("how", ["required", "draco", "meshopt"])
def test_compressed_files_say_what_to_do(tmp_path, how):
    gltf = Gltf(**({"extensionsRequired": ["KHR_draco_mesh_compression"]} if how == "required" else {}))
    gltf.node(mesh=gltf.mesh(material=GREY), name="square")
    if how == "draco":
        gltf.tree["meshes"][0]["primitives"][0]["extensions"] = {"KHR_draco_mesh_compression": {"bufferView": 0}}
        del gltf.tree["accessors"][0]["bufferView"]
    path = gltf.write(tmp_path / "packed.glb")
    if how == "meshopt":
        gltf.tree["bufferViews"][0]["buffer"] = 1
        whole = {"byteLength": len(gltf.data), "uri": "data:;base64," + b64encode(gltf.data).decode()}
        packed = {"byteLength": 48, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}
        path = tmp_path / "packed.gltf"
        path.write_text(json.dumps({**gltf.tree, "buffers": [whole, packed]}))
    with pytest.raises(SceneError, match=r"packed.gl.*compressed with '\w+', which is not read.*untick Compression"):
        rd.load_scene(path)


def test_whole_numbers_as_positions(tmp_path):
    """KHR_mesh_quantization, normalised or not."""
    for normalized, size in ((False, 127), (True, 1)):
        gltf = Gltf(extensionsRequired=["KHR_mesh_quantization"])
        position = gltf.accessor(np.array(SQUARE) * 127, "u1", normalized=normalized)
        if normalized:
            size = 127 / 255
        primitive = {"attributes": {"POSITION": position}, "indices": gltf.accessor(np.ravel(HALVES), "u2"), "material": 0}
        gltf.tree |= {"materials": [GREY], "meshes": [{"primitives": [primitive]}]}
        gltf.node(mesh=0)
        assert box(rd.load_scene(gltf.write(tmp_path / "q.glb"))) == pytest.approx(np.array([[0, 0, 0], [size, size, 0]]))


def test_modes_that_do_not_exist(tmp_path):
    with pytest.raises(SceneError, match="mode of primitive 0 of 'square' is 9"):
        one(tmp_path, mode=9)
