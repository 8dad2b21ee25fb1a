"""glTF 2.0 (.glb, .gltf): a part for every node x primitive.

Reflectance is base colour factor x texture x vertex colour; metallic and alpha are left out. Emission is factor x
texture x emissive strength, a radiance L, so the exitance is pi L. A double-sided material radiates to both sides,
another one absorbs from behind. Coordinates stay as they are: metres, y up. Units of light are taken as W/m²
(``photometric`` is False): files rarely mean the cd/m² that the specification says, and the factor is one of names only.
"""

from pathlib import Path

import numpy as np

from ....errors import shown
from ...assemble import Material, Part, ReadOptions, assemble, warn
from ...model import Scene
from ..textures import warn_of_means, with_means
from .accessor import accessor
from .file import GltfFile, load
from .material import Finish, Materials, Texture
from .nodes import cameras, walk

TRIANGLES, STRIP, FAN = 4, 5, 6


def read(path: Path, options: ReadOptions) -> Scene:
    """Read a .glb or .gltf file.

    Raises:
        SceneError: the file or one that it refers to is missing, damaged or not understood.
    """
    file = load(path, options)
    nodes = walk(file)
    materials = Materials(file)
    left_out: dict[str, list[str]] = {}
    clamped: dict[str, bool] = {}
    parts = []
    for name, info, matrix in nodes:
        if "mesh" not in info:
            continue
        mesh = file.item("meshes", info["mesh"])
        if "skin" in info:
            left_out.setdefault("skins (taken in their bind pose)", []).append(name)
        if any(info.get("weights") or mesh.get("weights") or ()):
            left_out.setdefault("morph targets", []).append(name)
        for number, primitive in enumerate(file.items(mesh, "primitives")):
            primitive = file.dictionary(primitive, f"primitive {number} of '{name}'")
            if primitive.get("mode", TRIANGLES) not in (TRIANGLES, STRIP, FAN):
                left_out.setdefault("points and lines", []).append(name)
                continue
            parts.append(_part(file, name, primitive, matrix, materials, clamped))
    if any("extensions" in info and "KHR_lights_punctual" in info["extensions"] for _, info, _ in nodes):
        left_out["point lights (only surfaces emit: give one an emissive colour)"] = [n for n, i, _ in nodes if "extensions" in i]
    if "EXT_mesh_gpu_instancing" in file.items(file.tree, "extensionsUsed"):
        left_out["instances"] = ["EXT_mesh_gpu_instancing"]
    for what, names in left_out.items():
        warn(f"{path}: {what} are left out: {shown(dict.fromkeys(names))}")
    if clamped:
        warn(f"{path}: textures that end at their rim or are mirrored are repeated instead: {shown(clamped)}")
    materials.report()
    placed = [with_means(part, part.uv is None, part.emission_uv is None) for part in parts]
    warn_of_means(parts, placed, str(path))
    return assemble(placed, str(path), options, cameras=cameras(file, nodes))


def _part(file: GltfFile, name: str, primitive: dict, matrix: np.ndarray, materials: Materials, clamped: dict) -> Part:
    what = f"'{name}'"
    attributes = file.dictionary(primitive.get("attributes"), f"attributes of {what}")
    vertices = _attribute(file, attributes, "POSITION", (3,), what)
    faces = _triangles(file, primitive, len(vertices), what)
    vertices = vertices @ matrix[:3, :3].T + matrix[:3, 3]
    if np.linalg.det(matrix[:3, :3]) < 0:
        faces = faces[:, ::-1]  # a mirrored instance keeps its front
    color = None
    if "COLOR_0" in attributes:
        color = _attribute(file, attributes, "COLOR_0", (3, 4), what, len(vertices))[:, :3]
        if (color == 1).all():
            color = None
    if "material" in primitive:
        finish = materials[primitive["material"]]
        name = f"{name}/{finish.name}" if finish.name != name else name
    else:
        finish = Finish("", Material((1.0,) if "COLOR_0" in attributes else None))
    uv = [_uv(file, attributes, texture, what, len(vertices), clamped) for texture in (finish.base, finish.emissive)]
    return Part(
        name, vertices, faces, finish.material, uv[0], color,
        finish.base and finish.base.image, finish.emissive and finish.emissive.image, uv[1],
    )  # fmt: skip


def _attribute(file: GltfFile, attributes: dict, key: str, widths: tuple, what: str, count: int | None = None) -> np.ndarray:
    if key not in attributes:
        raise file.fail(f"a primitive of {what} has no {key}")
    values = accessor(file, attributes[key]).astype(np.float64)
    if values.shape[1] not in widths or count not in (None, len(values)):
        raise file.fail(f"{key} of {what} has shape {values.shape}; expected ({count or 'n'}, {' or '.join(map(str, widths))})")
    return values


def _uv(file: GltfFile, attributes: dict, texture: Texture | None, what: str, count: int, clamped: dict) -> np.ndarray | None:
    key = f"TEXCOORD_{texture.coordinates}" if texture else ""
    if texture is None or key not in attributes:
        return None
    uv = texture.uv(_attribute(file, attributes, key, (2,), what, count))
    if not texture.repeats and (np.abs(uv - 0.5) > 0.501).any():
        clamped[what.strip("'")] = True
    return uv


def _triangles(file: GltfFile, primitive: dict, n_vertices: int, what: str) -> np.ndarray:
    if "indices" in primitive:
        index = accessor(file, primitive["indices"])
        if index.shape[1] != 1 or index.dtype.kind != "i":
            raise file.fail(f"the indices of {what} are no whole numbers")
        index = index[:, 0]
    else:
        index = np.arange(n_vertices)
    if len(index) and not 0 <= index.min() <= index.max() < n_vertices:
        at = int(np.flatnonzero((index < 0) | (index >= n_vertices))[0])
        raise file.fail(f"index {at} of {what} names vertex {index[at]}; there are {n_vertices} (0 to {n_vertices - 1})")
    mode = primitive.get("mode", TRIANGLES)
    if mode == TRIANGLES:
        if len(index) % 3:
            raise file.fail(f"{what} has {len(index)} indices, which is no multiple of 3")
        return index.reshape(-1, 3)
    if len(index) < 3:
        return np.zeros((0, 3), np.int64)
    if mode == FAN:
        return np.column_stack([np.full(len(index) - 2, index[0]), index[1:-1], index[2:]])
    strip = np.column_stack([index[:-2], index[1:-1], index[2:]])
    strip[1::2] = strip[1::2, ::-1]
    return strip
