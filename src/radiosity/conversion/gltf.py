"""glTF 2.0, as .glb or as .gltf with all its data inside: a node for each surface, with materials, textures, lights and cameras.

Coordinates are 32-bit numbers; those of a surface far from the origin are relative to a point near it, to which its node moves
them. glTF is y-up: a root node turns scenes that are z-up.
"""

import base64
import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..image.glb import TURN, Buffer, save
from ..scene.model import Back, Scene
from ..scene.paint import Paint
from ..scene.up import up_axis
from ..solution.whole import whole_file
from .gltf_lights import PUNCTUAL, lights_of, matrix, turn
from .gltf_materials import Materials
from .pieces import Piece, called, painted, pieces, tell_of_rest, triangles
from .rounding import tell_of_rounding
from .told import Told

HOLDS = frozenset({"names", "reflectance", "emission", "backs", "panes", "diffusing panes", "textures", "lights", "cameras"})
FAR = 8.0  # sizes of a surface: one farther away has coordinates of its own


def write(scene: Scene, path: Path, told: Told) -> None:
    """Write the file.

    Raises:
        OutputError: it cannot be written.
    """
    holds = HOLDS | ({"units"} if scene.lights.luminaires or scene.lights.suns else set())
    tell_of_rest(scene, told, holds)
    told.add("backs that let lines pass become backs that absorb", called(scene, scene.back == Back.PASSES))
    contents, blocks, _ = document(scene, told, whole=True)
    if path.suffix.lower() == ".glb":
        save(path, contents, blocks)
        return
    data = base64.b64encode(b"".join(block.tobytes() for block in blocks)).decode()
    contents["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{data}"
    with whole_file(path) as file:
        file.write(json.dumps(contents, indent=1).encode())


def write_geometry(scene: Scene, path: Path, told: Told) -> list[str]:
    """Write faces and materials alone, in the scene's own axes, and return the name of each piece.

    Raises:
        OutputError: the file cannot be written.
    """
    contents, blocks, names = document(scene, told, whole=False)
    save(path, contents, blocks)
    return names


def document(scene: Scene, told: Told, *, whole: bool) -> tuple[dict, list, list[str]]:
    """Return the JSON document, the buffer's parts in order, and the name of each piece.

    Args:
        whole: with lights and cameras, turned to y-up.
    """
    buffer = Buffer()
    materials = Materials(scene, buffer, told)
    parts = _named(pieces(scene, told), told)
    nodes, meshes = [], []
    for name in dict.fromkeys(piece.name for piece in parts):
        own = [piece for piece in parts if piece.name == name]
        used = np.unique(np.concatenate([piece.corners[piece.corners >= 0] for piece in own]))
        origin = _origin(scene.vertices[used])
        for piece in own:
            halves = triangles(piece.corners)
            corners = scene.vertices[np.take_along_axis(piece.corners[halves[:, 0]], halves[:, 1:], axis=1)] - origin
            tell_of_rounding(told, [name], np.zeros(len(halves), np.int64), corners)
        primitives = [one for piece in own for one in _primitives(scene, piece, origin, buffer, materials, told)]
        move = {"translation": origin.tolist()} if origin.any() else {}
        nodes.append({"name": name, "mesh": len(meshes), **move})
        meshes.append({"name": name, "primitives": primitives})
    contents: dict = {"asset": {"version": "2.0", "generator": "radiosity"}, "scene": 0, "scenes": [{"nodes": [0]}]}
    used_extensions = set(materials.used)
    if whole:
        lights, places = lights_of(scene.lights, told)
        nodes += places
        if lights:
            contents["extensions"] = {PUNCTUAL: {"lights": lights}}
            used_extensions.add(PUNCTUAL)
        if scene.cameras:
            contents["cameras"] = [_lens(camera) for camera in scene.cameras]
            nodes += [_camera_node(i, camera) for i, camera in enumerate(scene.cameras)]
    turned = {"rotation": [float(x) for x in TURN]} if whole and up_axis(scene) == "z" else {}
    contents["nodes"] = [{"name": "scene", "children": list(range(1, len(nodes) + 1)), **turned}, *nodes]
    contents |= {"meshes": meshes, "materials": materials.materials}
    for key in ("images", "samplers", "textures"):
        if getattr(materials, key):
            contents[key] = getattr(materials, key)
    contents |= buffer.entries()
    if used_extensions:
        contents["extensionsUsed"] = sorted(used_extensions)
    return contents, buffer.blocks, [piece.name for piece in parts]


def _named(parts: list[Piece], told: Told) -> list[Piece]:
    """Return pieces with names that are not empty: nodes without one get it from readers."""
    taken, result = {piece.name for piece in parts}, []
    for piece in parts:
        name = piece.name or f"surface {piece.surface}"
        while not piece.name and name in taken:
            name += "'"
        if name != piece.name:
            told.add("names that the format cannot hold are changed", [f"{piece.name} -> {name}"])
        result.append(replace(piece, name=name))
    return result


def _origin(points: np.ndarray) -> np.ndarray:
    """The point that a surface's coordinates are relative to: the origin, unless the surface is small and far away."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    return middle if np.abs(middle).max() > FAR * (high - low).max() else np.zeros(3)


def _primitives(scene: Scene, piece: Piece, origin, buffer: Buffer, materials: Materials, told: Told):
    """Yield a primitive for each pair of images on the faces of a piece."""
    images = np.column_stack([_images(paint, piece.rows) for paint in (scene.reflectance_paint, scene.emission_paint)])
    for pair in np.unique(images, axis=0):
        here = np.flatnonzero((images == pair).all(axis=1))
        halves = triangles(piece.corners[here])
        row, corner = here[halves[:, 0]], halves[:, 1:]
        number = np.take_along_axis(piece.corners[row], corner, axis=1)
        attributes = {}
        if any(painted(paint, piece.rows[here]) for paint in (scene.reflectance_paint, scene.emission_paint)):
            keys = np.column_stack([np.repeat(row, 3), corner.ravel()])  # each corner of a face is a vertex of its own
            some, index = np.unique(keys, axis=0, return_inverse=True)
            vertex = piece.corners[some[:, 0], some[:, 1]]
            attributes = _painted(scene, piece, some, pair, buffer, told)
        else:
            vertex, index = np.unique(number.ravel(), return_inverse=True)
        attributes["POSITION"] = buffer.vertices(scene.vertices[vertex] - origin, limits=True)
        yield {
            "attributes": attributes,
            "indices": buffer.indices(index.reshape(-1)),
            "material": materials.add(piece, (int(pair[0]), int(pair[1]))),
        }


def _images(paint: Paint | None, rows: np.ndarray) -> np.ndarray:
    return np.full(len(rows), -1) if paint is None else paint.image[rows]


def _painted(scene: Scene, piece: Piece, some: np.ndarray, pair, buffer: Buffer, told: Told) -> dict[str, int]:
    """Texture coordinates and colours of vertices, which are corners (row of the piece, 0 to 3) of faces."""
    face, corner = piece.rows[some[:, 0]], some[:, 1]
    flipped = (piece.corners[:, 1] != scene.faces[piece.rows, 1])[some[:, 0]]
    quad = scene.is_quad[face]
    corner = np.where(flipped & (corner > 0), np.where(quad, 4, 3) - corner, corner)  # as the paint counts them
    attributes: dict[str, int] = {}
    for which, (what, number) in enumerate(zip(("reflectance", "emission"), pair, strict=True)):
        paint = getattr(scene, f"{what}_paint")
        if paint is None:
            continue
        if number >= 0:
            uv = paint.uv[face, corner].astype(np.float64)
            attributes[f"TEXCOORD_{which}"] = buffer.vertices(np.column_stack([uv[:, 0], 1 - uv[:, 1]]))
        colour = np.broadcast_to(paint.color[face, corner], (len(face), 3))
        if (colour == 1).all():
            continue
        if what == "emission":
            told.add("vertex colours of emission are left out", [piece.name])
        else:
            attributes["COLOR_0"] = buffer.vertices(colour)
    return attributes


def _lens(camera) -> dict:
    lens = {"yfov": float(np.radians(camera.fov)), "aspectRatio": camera.width / camera.height, "znear": 0.01}
    return {"type": "perspective", "perspective": lens}


def _camera_node(number: int, camera) -> dict:
    rotation = turn(np.subtract(camera.target, camera.origin), np.asarray(camera.up, np.float64))
    return {"name": f"camera {number}", "camera": number, "matrix": matrix(rotation, np.asarray(camera.origin))}
