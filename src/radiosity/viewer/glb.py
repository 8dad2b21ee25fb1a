"""Meshes for the page, as GLB in memory: unlit, with the colours that come out right there."""

import json

import numpy as np

from ..image.glb import ARRAY, ELEMENTS, FLOAT, UINT, packed

TRIANGLES, LINES = 4, 1


def document(points: np.ndarray, given: np.ndarray, elements: np.ndarray, *, opacity: float = 1.0) -> bytes:
    """Return a GLB file with one mesh.

    Args:
        points: (n, 3), the page's coordinates.
        given: (n, 3) colours, as `tone_mapping.before` gives them.
        elements: (m, 3) triangles or (m, 2) lines, vertex numbers.
        opacity: 1: opaque.
    """
    points, given = np.ascontiguousarray(points, "<f4"), np.ascontiguousarray(given, "<f4")
    blocks = [block.reshape(-1).view(np.uint8) for block in (points, given, np.ascontiguousarray(elements, "<u4"))]
    ends = np.cumsum([len(block) for block in blocks]).tolist()
    views = [
        {"buffer": 0, "byteOffset": end - len(block), "byteLength": len(block), "target": target}
        for block, end, target in zip(blocks, ends, (ARRAY, ARRAY, ELEMENTS), strict=True)
    ]
    limits = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
    material = {"doubleSided": elements.shape[1] == 2, "extensions": {"KHR_materials_unlit": {}}}
    if opacity < 1:
        material |= {"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, opacity]}}
    mode = TRIANGLES if elements.shape[1] == 3 else LINES
    primitive = {"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2, "material": 0, "mode": mode}
    contents = {
        "asset": {"version": "2.0", "generator": "radiosity"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [primitive]}],
        "materials": [material],
        "accessors": [
            {"bufferView": 0, "componentType": FLOAT, "count": len(points), "type": "VEC3", **limits},
            {"bufferView": 1, "componentType": FLOAT, "count": len(points), "type": "VEC3"},
            {"bufferView": 2, "componentType": UINT, "count": elements.size, "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": ends[-1]}],
    }
    return b"".join(packed(json.dumps(contents, separators=(",", ":")), blocks))
