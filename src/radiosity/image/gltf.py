"""GLB: unlit meshes with linear vertex colours, one for each surface, and the scale of the colours in ``extras``.

The format is Khronos glTF 2.0 with KHR_materials_unlit. COLOR_0 holds radiosity x scale, linear as the standard asks, as 16-bit
fractions that end at 1. ``_RADIOSITY_0`` and so on hold the bands themselves, as 32-bit floats. Each radiating side is single-
sided geometry, so that one can look into closed rooms from outside. Panes are blended, with an alpha of 1 - transmittance. glTF
is y-up: the root node turns scenes that are z-up, and vertices keep the scene's coordinates (metres). Vertices are in single
precision. Those of a surface far from the origin, for its size, are relative to a point near it, to which its node moves them
(JSON holds doubles).
"""

import numpy as np

from .glb import ARRAY, TURN, USHORT, Buffer, save
from .look import Look
from .mesh import ColouredMesh, coloured


def write(solution, path, look: Look) -> None:
    """Write a GLB file.

    Raises:
        OutputError: the file cannot be written, or would pass the 4 GB that GLB can hold.
    """
    save(path, *document(coloured(solution, look)))


def document(mesh: ColouredMesh) -> tuple[dict, list]:
    """Return the JSON document, and the buffer's parts in order."""
    buffer, meshes, nodes = Buffer(), [], []
    for part in mesh.by_surface():
        points = (part.vertices - part.origin).astype("<f4")
        tint = np.full((len(points), 4), 65535, "<u2")
        tint[:, 3] = round((1 - part.transmittance) * 65535)
        tint[:, :3] = np.clip(np.nan_to_num(part.linear), 0, 1) * 65535 + 0.5
        attributes = {"POSITION": buffer.vertices(points, limits=True)}
        attributes["COLOR_0"] = buffer.add(tint, "VEC4", USHORT, ARRAY, normalized=True)
        for band in range(part.values.shape[1]):
            # unknown values are not written: the standard forbids NaN
            attributes[f"_{mesh.key.upper()}_{band}"] = buffer.vertices(np.nan_to_num(part.values[:, band]))
        indices = buffer.indices(part.triangles)
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
        **buffer.entries(),
    }
    return contents, buffer.blocks
