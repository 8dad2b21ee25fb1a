"""Damaged mesh and TOML files: an error of our own or a scene that makes sense, never anything else."""

import base64
import json
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from samples import MIXED, MTL, OBJ, SQUARE, TOML, TRIANGLES, box_gltf, ply_bytes, ply_text, png, stl_bytes, stl_text

import radiosity as rd
from radiosity.errors import RadiosityError, RadiosityWarning


def _gltf_text() -> bytes:
    gltf = box_gltf()
    uri = "data:application/octet-stream;base64," + base64.b64encode(gltf.data).decode()
    gltf.tree["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]
    gltf.node(camera=0, translation=[0, 0, 9], rotation=[0, 0, 0, 1])
    return json.dumps({**gltf.tree, "buffers": [{"byteLength": len(gltf.data), "uri": uri}]}).encode()


VALID = {
    "box.glb": box_gltf().glb(),
    "box.gltf": _gltf_text(),
    "box.obj": OBJ.encode(),
    "text.ply": ply_text([*SQUARE, [0, 0, 1]], MIXED, colors=np.arange(15).reshape(5, 3)).encode(),
    "mixed.ply": ply_bytes([*SQUARE, [0, 0, 1]], MIXED),
    "equal.ply": ply_bytes(),
    "binary.stl": stl_bytes(TRIANGLES),
    "text.stl": stl_text({"a": TRIANGLES, "b": TRIANGLES + 1}).encode(),
    "scene.toml": TOML.encode(),
    "box.mtl": (MTL + "map_Kd -s 2 2 1 wall.png\nillum 2\nKs 0.1 0.1 0.1\nd 1\n").encode(),
    "wall.png": png(np.arange(48).reshape(4, 4, 3)),
}
TEXTURED = OBJ.replace("f -4 -3 -2 -1", "f -4/1 -3/2 -2/3 -1/4")
CUTS = st.lists(
    st.tuples(st.integers(0, 2**20), st.sampled_from(["flip", "cut", "drop", "copy", "digit"]), st.integers(0, 255)), max_size=4
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fuzz")
    (folder / "lamp.stl").write_bytes(stl_bytes(TRIANGLES))
    (folder / "room.ply").write_text(ply_text())
    return folder


def damaged(data: bytes, cuts) -> bytes:
    """Bytes changed, left out or repeated at some places; digits stay digits, so that text stays well formed."""
    for place, how, value in cuts:
        if not data:
            break
        at = place % len(data)
        if how == "flip":
            data = data[:at] + bytes([value]) + data[at + 1 :]
        elif how == "cut":
            data = data[:at]
        elif how == "drop":
            data = data[:at] + data[at + value % 16 :]
        elif how == "copy":
            data = data[: at + value % 16] + data[at:]
        else:
            digits = [i for i in range(at, min(at + 200, len(data))) if data[i : i + 1].isdigit()]
            for i in digits[:1]:
                data = data[:i] + str(value * value).encode() + data[i + 1 :]
    return data


def takes(path) -> None:
    """Load; what comes out must make sense."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RadiosityWarning)
        try:
            patches = rd.subdivide(rd.load_scene(path), cells=1)
        except RadiosityError:
            return
    assert ((patches.reflectance >= 0) & (patches.reflectance < 1)).all()
    assert np.isfinite(patches.emission).all()
    assert (patches.area > 0).all()


@pytest.mark.parametrize("name", VALID)
@settings(max_examples=60)
@given(cuts=CUTS)
def test_damaged_files(folder, name, cuts):
    if name in ("box.mtl", "wall.png"):
        (folder / "box.obj").write_text(TEXTURED.replace("usemtl white", "usemtl light"))
        for other in ("box.mtl", "wall.png"):
            (folder / other).write_bytes(damaged(VALID[other], cuts if other == name else ()))
        takes(folder / "box.obj")
    else:
        (folder / "box.mtl").write_text(MTL)
        (folder / name).write_bytes(damaged(VALID[name], cuts))
        takes(folder / name)


@pytest.mark.parametrize("suffix", [".glb", ".gltf", ".obj", ".ply", ".stl", ".toml"])
@settings(max_examples=30)
@given(data=st.binary(max_size=200), head=st.sampled_from([b"", b"glTF\2\0\0\0", b"ply\n", b"solid ", b"{}", b"v 0 0 0\nf "]))
def test_random_bytes(folder, suffix, data, head):
    path = folder / f"random{suffix}"
    path.write_bytes(head + data)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RadiosityWarning)
        with pytest.raises(RadiosityError):
            rd.load_scene(path)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**40), 2**40) | st.floats() | st.sampled_from(["", "VEC3", "x"]),
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(["mesh", "index", "children", "v"]), inner, max_size=3)
    ),
    max_leaves=6,
)


@settings(max_examples=200)
@given(place=st.integers(0, 2**20), value=JSON)
def test_json_values_of_any_kind(folder, place, value):
    """Any one value of a valid glTF tree replaced by any other."""
    tree = json.loads(VALID["box.gltf"])
    spots = []

    def collect(node):
        for key in node if isinstance(node, dict) else range(len(node)):
            spots.append((node, key))
            if isinstance(node[key], (dict, list)):
                collect(node[key])

    collect(tree)
    holder, key = spots[place % len(spots)]
    holder[key] = value
    path = folder / "values.gltf"
    path.write_text(json.dumps(tree))
    takes(path)
