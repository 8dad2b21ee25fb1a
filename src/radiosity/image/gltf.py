"""GLB: unlit meshes with linear vertex colours, one for each surface, and the scale of the colours in ``extras``.

The format is Khronos glTF 2.0 with KHR_materials_unlit. COLOR_0 holds radiosity x scale, linear as the standard asks, as 16-bit
fractions that end at 1. ``_RADIOSITY_0`` and so on hold the bands themselves, as 32-bit floats. Each radiating side is single-
sided geometry, so that one can look into closed rooms from outside. Panes are blended, with an alpha of 1 - transmittance. glTF
is y-up: the root node turns scenes that are z-up, and vertices keep the scene's coordinates (metres). Vertices are in single
precision. Those of a surface far from the origin, for its size, are relative to a point near it, to which its node moves them
(JSON holds doubles).
"""

import json
import struct

import numpy as np

from ..errors import OutputError
from ..solution.replacing import replacing
from .look import Look
from .mesh import ColouredMesh, coloured

FLOAT, USHORT, UINT = 5126, 5123, 5125
ARRAY, ELEMENTS = 34962, 34963
TURN = [-np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]  # quaternion: z up to y up


def write(solution, path, look: Look) -> None:
    """Write a GLB file.

    Raises:
        OutputError: the file cannot be written, or would pass the 4 GB that GLB can hold.
    """
    write_glb(path, *document(coloured(solution, look)))


def write_glb(path, contents: dict, blocks: list) -> None:
    """Write a JSON document and the parts of its buffer as a GLB file.

    Raises:
        OutputError: the file cannot be written, or would pass the 4 GB that GLB can hold.
    """
    text = json.dumps(contents, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    size = sum(len(block) for block in blocks)
    if 12 + 8 + len(text) + 8 + size >= 2**32:
        raise OutputError(
            f"{path}: the mesh needs {size / 1e9:.1f} GB, and a GLB file holds 4; export smoothed values or larger patches"
        )
    with replacing(path) as temporary, temporary.open("wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + size))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", size, b"BIN\0"))
        for block in blocks:
            file.write(block)


def document(mesh: ColouredMesh) -> tuple[dict, list]:
    """Return the JSON document, and the buffer's parts in order."""
    views, accessors, meshes, nodes, blocks, length = [], [], [], [], [], 0

    def add(array: np.ndarray, kind: str, component: int, target: int, **more) -> int:
        nonlocal length
        data = np.ascontiguousarray(array)
        blocks.append(data.reshape(-1).view(np.uint8))
        views.append({"buffer": 0, "byteOffset": length, "byteLength": data.nbytes, "target": target})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(data), "type": kind, **more})
        length += data.nbytes
        return len(accessors) - 1

    for part in mesh.by_surface():
        points = (part.vertices - part.origin).astype("<f4")
        tint = np.full((len(points), 4), 65535, "<u2")
        tint[:, 3] = round((1 - part.transmittance) * 65535)
        tint[:, :3] = np.clip(np.nan_to_num(part.linear), 0, 1) * 65535 + 0.5
        limits = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
        attributes = {"POSITION": add(points, "VEC3", FLOAT, ARRAY, **limits)}
        attributes["COLOR_0"] = add(tint, "VEC4", USHORT, ARRAY, normalized=True)
        for band in range(part.values.shape[1]):
            # unknown values are not written: the standard forbids NaN
            attributes[f"_{mesh.key.upper()}_{band}"] = add(
                np.nan_to_num(part.values[:, band]).astype("<f4"), "SCALAR", FLOAT, ARRAY
            )
        indices = add(part.triangles.astype("<u4").ravel(), "SCALAR", UINT, ELEMENTS)
        move = {"translation": part.origin.tolist()} if part.origin.any() else {}
        nodes.append({"name": part.name, "mesh": len(meshes), **move})
        meshes.append(
            {
                "name": part.name,
                "primitives": [{"attributes": attributes, "indices": indices, "material": int(part.transmittance > 0)}],
                "extras": {"scale": mesh.scale, "unit": mesh.unit},
            }
        )
    root = {"name": "scene", "children": list(range(1, len(meshes) + 1)), **({"rotation": TURN} if mesh.up == "z" else {})}
    material = {
        "name": mesh.key,
        "doubleSided": False,
        "extensions": {"KHR_materials_unlit": {}},
        "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 1},
    }
    contents = {
        "asset": {"version": "2.0", "generator": "radiosity", "extras": mesh.facts()},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [root, *nodes],
        "meshes": meshes,
        "materials": [material, {**material, "name": f"{mesh.key}, panes", "alphaMode": "BLEND"}][: 1 + mesh.transmittance.any()],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": length}],
    }
    return contents, blocks
