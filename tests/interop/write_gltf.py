"""glTF and GLB files with random features."""

import base64
import json
from pathlib import Path

import numpy as np

from .draw import Draw, Sample, Shape, rotation
from .gltf_buffer import Buffer
from .gltf_material import add_materials
from .gltf_skin import add_skin, add_weights

TRIANGLES, STRIP, FAN = 4, 5, 6
HABITS = {
    "mirror": 0.3,
    "uneven scale": 0.4,
    "matrices": 0.4,
    "nested nodes": 0.5,
    "instances": 0.4,
    "quantized": 0.15,
    "interleaved": 0.15,
    "sparse": 0.15,
    "strips": 0.15,
    "fans": 0.15,
    "no indices": 0.2,
    "normals": 0.3,
    "unnamed nodes": 0.12,
    "points and lines": 0.15,
    "several primitives": 0.5,
    "vertex colours": 0.3,
    "no material": 0.1,
    "second scene": 0.15,
    "nodes outside the scene": 0.15,
    "cameras": 0.15,
    "instancing extension": 0.1,
    "morphs": 0.12,
    "skins": 0.12,
    "hidden nodes": 0.1,
    "no base colour": 0.08,
}  # chance that a file has any of it
DEFORMED = {"morphs", "skins"}  # their positions are not quantized


def write(folder: Path, seed: int) -> Sample:
    draw = Draw("gltf", seed)
    for feature, chance in HABITS.items():
        draw.has(feature, chance)
    if {"morphs", "instancing extension"} <= draw.features:
        draw.features.add("instances of morphs")
    buffer = Buffer(draw)
    tree = {"asset": {"version": "2.0"}, "nodes": [], "meshes": []}
    materials = add_materials(draw, tree, buffer, folder, seed)
    meshes = [_mesh(draw, tree, buffer, materials, number) for number in range(int(draw.integers(1, 4)))]
    roots = _nodes(draw, tree, buffer, meshes)
    _scenes(draw, tree, roots)
    tree |= buffer.tree
    return Sample(_store(draw, tree, buffer.data, folder, seed), "gltf", draw.features)


def _mesh(draw: Draw, tree: dict, buffer: Buffer, materials: int, number: int) -> dict:
    """Adds a mesh; the matrix that its nodes need before theirs, and which materials it has."""
    scale = np.eye(4)
    used, primitives = [], []
    count = int(draw.integers(1, 4)) if "several primitives" in draw.features else 1
    for part in range(min(count, materials)):
        shape = draw.shape()
        if "quantized" in draw.features and not draw.features & DEFORMED:
            scale, shape = _quantized(shape)
        primitive = _primitive(draw, buffer, shape)
        if "morphs" in draw.features:
            count = buffer.tree["accessors"][primitive["attributes"]["POSITION"]]["count"]
            moves = [buffer.accessor(draw.normal(0, 0.2, (count, 3)), "f4", bounds=True) for _ in "ab"]
            primitive["targets"] = [{"POSITION": number} for number in moves]
        if "skins" in draw.features and number == 0:
            add_weights(draw, buffer, primitive)
        if not ("no material" in draw.features and part == 0):
            used.append(int(draw.integers(materials)))
            primitive["material"] = used[-1]
        primitives.append(primitive)
    if "points and lines" in draw.features and "morphs" not in draw.features:
        points = buffer.accessor(np.eye(4)[:, :3], "f4", bounds=True)
        primitives.append({"attributes": {"POSITION": points}, "mode": draw.one(0, 1, 3)})
    morphs = {"weights": draw.random(2).tolist()} if "morphs" in draw.features else {}
    tree["meshes"].append({"name": f"mesh{number}", "primitives": primitives, **morphs})
    return {"index": number, "scale": scale}


def _quantized(shape: Shape) -> tuple[np.ndarray, Shape]:
    """Positions in whole numbers of 1/4096, and the matrix that makes them metres."""
    scale = np.diag([1 / 4096, 1 / 4096, 1 / 4096, 1])
    return scale, Shape(np.round(shape.points * 4096), shape.polygons, shape.uv)


def _primitive(draw: Draw, buffer: Buffer, shape: Shape) -> dict:
    triangles = shape.triangles()
    mode, index = TRIANGLES, triangles.ravel()
    if "fans" in draw.features and len(shape.polygons) == 1:
        mode, index = FAN, np.array(shape.polygons[0])
    elif "strips" in draw.features and len(triangles) == 2 and len(shape.points) == 4:
        mode, index = STRIP, np.array(shape.polygons[0])[[0, 1, 3, 2]]
    points, uv = shape.points, shape.uv
    if draw.random() < 0.5 or "no indices" in draw.features:  # every corner a vertex of its own
        points, uv, index = points[index], uv[index], np.arange(len(index))
    quantized = "quantized" in draw.features and not draw.features & DEFORMED
    attributes = {"POSITION": buffer.positions(points, quantized=quantized)}
    if "normals" in draw.features:
        attributes["NORMAL"] = buffer.accessor(np.tile([0.0, 0.0, 1.0], (len(points), 1)), "f4")
    attributes["TEXCOORD_0"] = buffer.coordinates(uv)
    if "second coordinates" in draw.features:
        attributes["TEXCOORD_1"] = buffer.coordinates(uv[:, ::-1] * 0.7)
    if "vertex colours" in draw.features:
        attributes["COLOR_0"] = buffer.colors(len(points))
    primitive: dict = {"attributes": attributes}
    if mode != TRIANGLES or draw.random() < 0.3:
        primitive["mode"] = mode
    if "no indices" not in draw.features:
        primitive["indices"] = buffer.indices(index)
    return primitive


def _nodes(draw: Draw, tree: dict, buffer: Buffer, meshes: list[dict]) -> list[int]:
    """Adds nodes; their roots."""
    count = int(draw.integers(2, 6)) if "instances" in draw.features else len(meshes)
    roots: list[int] = []
    for number in range(count):
        mesh = meshes[number % len(meshes)]
        node: dict = {"mesh": mesh["index"]}
        if "unnamed nodes" not in draw.features:
            node["name"] = f"thing{number}"
        _place(draw, node, mesh["scale"])
        if "instancing extension" in draw.features and number == 0:
            node["name"] = "thing0"
            moves = draw.uniform(-3, 3, (int(draw.integers(1, 4)), 3))
            turned = np.array([draw.quaternion() for _ in moves])
            scales = draw.uniform(0.5, 2, moves.shape) * draw.one(1, 1, -1)
            attributes = {
                "TRANSLATION": buffer.accessor(moves / mesh["scale"][0, 0], "f4"),
                "ROTATION": buffer.accessor(turned, "f4"),
                "SCALE": buffer.accessor(scales, "f4"),
            }
            node["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
            buffer.uses("EXT_mesh_gpu_instancing")
        if "morphs" in draw.features and draw.random() < 0.5:
            node["weights"] = draw.uniform(-0.5, 1, 2).tolist()
        if "skins" in draw.features and mesh["index"] == 0 and "extensions" not in node:
            node["skin"] = 0
        if "hidden nodes" in draw.features and number == count - 1 and number:
            node.setdefault("extensions", {})["KHR_node_visibility"] = {"visible": False}
            buffer.uses("KHR_node_visibility")
        tree["nodes"].append(node)
        index = len(tree["nodes"]) - 1
        if "nested nodes" in draw.features and draw.random() < 0.6:
            for _ in range(int(draw.integers(1, 3))):
                parent: dict = {"name": f"group{len(tree['nodes'])}", "children": [index]}
                _place(draw, parent, np.eye(4))
                tree["nodes"].append(parent)
                index = len(tree["nodes"]) - 1
        roots.append(index)
    if "skins" in draw.features:
        roots += add_skin(draw, tree, buffer)
    if "cameras" in draw.features:
        tree["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}]
        tree["nodes"].append({"name": "eye", "camera": 0, "translation": [0.0, 1.0, 5.0]})
        roots.append(len(tree["nodes"]) - 1)
    return roots


def _place(draw: Draw, node: dict, inner: np.ndarray) -> None:
    """Translation, rotation and scale, or a matrix; ``inner`` is an even scale."""
    scale = np.full(3, draw.uniform(0.5, 1.5)) if "uneven scale" not in draw.features else draw.uniform(0.4, 2.0, 3)
    if "mirror" in draw.features and draw.random() < 0.5:
        scale[int(draw.integers(3))] *= -1
    turn, move = draw.quaternion(), draw.uniform(-2, 2, 3)
    scale = scale * inner[0, 0]
    if "matrices" in draw.features and draw.random() < 0.7:
        matrix = np.eye(4)
        matrix[:3, :3] = rotation(turn) * scale
        matrix[:3, 3] = move
        node["matrix"] = matrix.T.ravel().tolist()
    else:
        node |= {"translation": move.tolist(), "rotation": turn, "scale": scale.tolist()}


def _scenes(draw: Draw, tree: dict, roots: list[int]) -> None:
    if "nodes outside the scene" in draw.features:
        tree["nodes"].append({"name": "outside", "mesh": 0})
    tree["scenes"] = [{"nodes": roots}]
    tree["scene"] = 0
    if "second scene" in draw.features:
        tree["scenes"].insert(0, {"nodes": roots[:1]})
        tree["scene"] = 1


def _store(draw: Draw, tree: dict, data: bytes, folder: Path, seed: int) -> Path:
    kind = draw.one("glb", "gltf with a file", "gltf with a data URI")
    draw.features.add(kind)
    tree["buffers"] = [{"byteLength": len(data)}]
    if kind == "glb":
        text = json.dumps(tree).encode()
        text += b" " * (-len(text) % 4)
        data += b"\0" * (-len(data) % 4)
        body = len(text).to_bytes(4, "little") + b"JSON" + text + len(data).to_bytes(4, "little") + b"BIN\0" + data
        path = folder / f"{seed}.glb"
        path.write_bytes(b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body)
        return path
    if kind == "gltf with a file":
        name = f"bytes of {seed}.bin" if draw.has("buffer name with a blank", 0.2) else f"{seed}.bin"
        (folder / name).write_bytes(data)
        tree["buffers"][0]["uri"] = name.replace(" ", "%20")
    else:
        tree["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    path = folder / f"{seed}.gltf"
    path.write_text(json.dumps(tree))
    return path
