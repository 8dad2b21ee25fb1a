"""GLB files of lightmaps: unlit meshes, one for each surface, with the lightmap as the texture of their colour.

Viewers show a texture of KHR_materials_unlit as it is. The places are both TEXCOORD_0, which the texture takes, and TEXCOORD_1,
where game engines look for lightmaps. Sides are single-sided geometry, as in other GLB files of ours. Panes are blended. Backs
lie a hundred-thousandth of the scene's extent behind their fronts, for renderers that show both sides of everything.
"""

from io import BytesIO

import numpy as np

from ..image.glb import TURN, Buffer, save
from ..image.mesh import origin_of, transmittances
from ..scene.up import up_axis

APART = 1e-5  # of the scene's extent, from fronts to backs
LINEAR, CLAMP = 9729, 33071  # no mipmaps: in these, charts would bleed into each other


def write(lightmap, path, pixels: np.ndarray, facts: dict[str, str]) -> None:
    """Write a file.

    Args:
        pixels: (height, width, 3) uint8.
        facts: what a reader needs to turn colours back into physical values.

    Raises:
        OutputError: the file cannot be written.
    """
    atlas, scene = lightmap.atlas, lightmap.atlas.triangles.scene
    through, vertices = transmittances(scene), _apart(atlas)
    alphas = np.unique(1 - through)[::-1]
    buffer, meshes, nodes = Buffer(), [], []
    surface = scene.surface[atlas.triangles.face]
    for number in np.unique(surface):
        used, local = np.unique(atlas.corners[surface == number], return_inverse=True)
        origin = origin_of(vertices[used])
        points = (vertices[used] - origin).astype("<f4")
        places = buffer.vertices(atlas.uv[used] / [atlas.width, atlas.height])
        attributes = {
            "POSITION": buffer.vertices(points, limits=True),
            "TEXCOORD_0": places,
            "TEXCOORD_1": places,
        }
        primitive = {
            "attributes": attributes,
            "indices": buffer.indices(local),
            "material": int(np.searchsorted(-alphas, through[number] - 1)),
        }
        nodes.append(
            {"name": scene.names[number], "mesh": len(meshes), **({"translation": origin.tolist()} if origin.any() else {})}
        )
        meshes.append({"name": scene.names[number], "primitives": [primitive]})
    turned = {"rotation": TURN} if up_axis(scene) == "z" else {}
    contents = {
        "asset": {"version": "2.0", "generator": "radiosity", "extras": facts},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "scene", "children": list(range(1, len(meshes) + 1)), **turned}, *nodes],
        "meshes": meshes,
        "materials": [_material(lightmap.quantity, float(alpha)) for alpha in alphas],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"magFilter": LINEAR, "minFilter": LINEAR, "wrapS": CLAMP, "wrapT": CLAMP}],
        "images": [{"mimeType": "image/png", "bufferView": buffer.view(_png(pixels)), "name": "lightmap"}],
        **buffer.entries(),
    }
    save(path, contents, buffer.blocks)


def _apart(atlas) -> np.ndarray:
    """Return vertices, (n, 3), with those of backs behind the fronts."""
    triangles, scene = atlas.triangles, atlas.triangles.scene
    corners, normal = atlas.corners[triangles.back], -scene.normal[triangles.face[triangles.back]]
    total = np.zeros(atlas.vertices.shape)
    np.add.at(total, corners.ravel(), np.repeat(normal, 3, axis=0))
    length = np.linalg.norm(total, axis=1, keepdims=True)
    step = APART * float(np.ptp(scene.bounds, axis=0).max())
    return atlas.vertices + step * np.divide(total, length, out=np.zeros_like(total), where=length > 0)


def _material(name: str, alpha: float) -> dict:
    return {
        "name": name if alpha == 1 else f"{name}, panes of {1 - alpha:.4g}",
        "doubleSided": False,
        "extensions": {"KHR_materials_unlit": {}},
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0},
            "baseColorFactor": [1, 1, 1, alpha],
            "metallicFactor": 0,
            "roughnessFactor": 1,
        },
        **({} if alpha == 1 else {"alphaMode": "BLEND"}),
    }


def _png(pixels: np.ndarray) -> np.ndarray:
    """Return the bytes of a PNG file, (n,) uint8."""
    from PIL import Image

    file = BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(file, format="PNG")
    return np.frombuffer(file.getvalue(), np.uint8)
