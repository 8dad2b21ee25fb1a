"""glTF 2.0 (.glb, .gltf): a part for every node x primitive.

Reflectance is base colour factor x texture x vertex colour; metallic and alpha are left out, and the reflectance of a material
without any of the three is unknown. Emission is factor x texture x emissive strength, a radiance L, so the exitance is pi L. A
double-sided material radiates to both sides, another one absorbs from behind. Coordinates stay as they are: metres, y up. Units
of light are taken as W/m² (``photometric`` is False): files rarely mean the cd/m² that the specification says, and the factor
is one of names only. Where a file has lights (KHR_lights_punctual), in cd and lux, all is photometric as the specification says.
"""

from pathlib import Path

import numpy as np

from ....device import memory
from ....errors import shown
from ...assemble import Material, Part, ReadOptions, assemble, warn
from ...lights.add import with_lights
from ...model import Scene
from ...sampler import DEFAULT_SAMPLER
from ..beside import warn_of_case
from ..mesh_colors import FULL, are_bytes
from ..room import refuse
from ..textures import warn_of_means, with_means
from .accessor import accessor
from .deform import Skins, morphed
from .extensions import check_required, instances, warn_of_unread
from .file import UNPACK, GltfFile, load
from .lights import PUNCTUAL, PunctualLights
from .material import Finish, Materials, Texture
from .nodes import Node, cameras, walk

LINES, TRIANGLES, STRIP, FAN = (0, 1, 2, 3), 4, 5, 6
FACE = 176  # bytes a face, at the peak of reading (docs/performance.md)
FEW = 2  # times the corners of a primitive are fewer than the vertices that it may name: then those that it uses are taken


def read(path: Path, options: ReadOptions) -> Scene:
    """Read a .glb or .gltf file.

    Raises:
        SceneError: the file or one that it refers to is missing, damaged or not understood.
    """
    file = load(path, options)
    check_required(file)
    nodes = walk(file)
    materials, skins, lights = Materials(file), Skins(file), PunctualLights(file)
    left_out: dict[str, list[str]] = {}
    parts, faces, room = [], 0, memory.room()
    for node in nodes:
        if node.hidden and ({"mesh", "camera"} & set(node.info) or node.extension(file, PUNCTUAL) is not None):
            left_out.setdefault("hidden objects (KHR_node_visibility)", []).append(node.name)
            continue
        lights.add(node)
        if "mesh" not in node.info:
            continue
        mesh = file.item("meshes", node.info["mesh"])
        for number, primitive in enumerate(file.items(mesh, "primitives")):
            primitive = file.dictionary(primitive, f"primitive {number} of '{node.name}'")
            mode = primitive.get("mode", TRIANGLES)
            if mode in LINES:
                left_out.setdefault("points and lines", []).append(node.name)
                continue
            if mode not in (TRIANGLES, STRIP, FAN):
                raise file.fail(f"mode of primitive {number} of '{node.name}' is {mode!r}; expected 0 to 6")
            parts.append(_part(file, node, mesh, primitive, materials, skins))
            faces += len(parts[-1].faces)
            what = f"with '{node.name}', one of {len(nodes)} nodes, there are {faces:,} faces, which take"
            refuse(path, faces * FACE, what, "take fewer copies of its meshes", room)
    for what, names in left_out.items():
        warn(f"{path}: {what} are left out: {shown(dict.fromkeys(names))}")
    materials.report()
    lights.report([part.name for part in parts if any(part.material.emission)])
    warn_of_unread(file)
    warn_of_case(path, file.renamed)
    placed = [with_means(part, part.uv is None, part.emission_uv is None) for part in parts]
    warn_of_means(parts, placed, str(path))
    seen = cameras(file, [node for node in nodes if not node.hidden])
    scene = assemble(placed, str(path), options, photometric=bool(lights.found), cameras=seen)
    return with_lights(scene, lights.found)


def _part(file: GltfFile, node: Node, mesh: dict, primitive: dict, materials: Materials, skins: Skins) -> Part:
    name, what = node.name, f"'{node.name}'"
    attributes = file.dictionary(primitive.get("attributes"), f"attributes of {what}")
    count = _count(file, attributes, primitive, what)
    faces = _triangles(file, primitive, count, what)
    rows = _used(node, primitive, faces, count)
    if rows is not None:
        faces = np.searchsorted(rows, faces)
    vertices = _attribute(file, attributes, "POSITION", (3,), what, count, rows)
    moving = len(vertices)
    vertices = morphed(file, node.info, mesh, primitive, vertices, what)
    vertices, faces = _placed(file, node, attributes, skins, vertices, faces)
    color = None
    if "COLOR_0" in attributes:
        color = _attribute(file, attributes, "COLOR_0", (3, 4), what, count)[:, :3]
        if are_bytes(color):  # of all values: a few may be small
            materials.bytes[node.name] = None
            color = color / FULL
        color = color if rows is None else color[rows]
        if (color == 1).all():
            color = None
    if "material" in primitive:
        finish = materials.of(primitive["material"], "COLOR_0" in attributes)
        name = f"{name}/{finish.name}" if finish.name != name else name
    else:
        finish = Finish("", Material((1.0,) if "COLOR_0" in attributes else None))
    base, emissive = finish.base, finish.emissive
    uv = [_uv(file, attributes, texture, what, count, rows) for texture in (base, emissive)]
    copies = len(vertices) // max(moving, 1)
    uv, (color,) = [_repeated(values, copies) for values in uv], [_repeated(color, copies)]
    return Part(
        name,
        vertices,
        faces,
        finish.material,
        uv[0],
        color,
        base and base.image,
        emissive and emissive.image,
        uv[1],
        sampler=base.sampler if base else DEFAULT_SAMPLER,
        emission_sampler=emissive.sampler if emissive else DEFAULT_SAMPLER,
    )


def _repeated(values: np.ndarray | None, copies: int) -> np.ndarray | None:
    return values if values is None or copies == 1 else np.tile(values, (copies, 1))


def _count(file: GltfFile, attributes: dict, primitive: dict, what: str) -> int:
    """Return the number of vertices that a primitive may name."""
    held = file.dictionary(primitive.get("extensions", {}), f"extensions of {what}")
    if "KHR_draco_mesh_compression" in held and "POSITION" in attributes:
        info = file.item("accessors", attributes["POSITION"])
        if "bufferView" not in info:
            raise file.fail(f"{what} is compressed with 'KHR_draco_mesh_compression', which is not read; {UNPACK}")
    return _held(file, attributes, "POSITION", what)


def _used(node: Node, primitive: dict, faces: np.ndarray, count: int) -> np.ndarray | None:
    """Return the vertices that faces use, in order, where they are few of those that several primitives share; else None.

    Some programs write the vertices of all objects as one accessor, which each of thousands of primitives names.
    """
    if FEW * faces.size >= count or "skin" in node.info or primitive.get("targets"):
        return None
    return np.unique(faces)


def _held(file: GltfFile, attributes: dict, key: str, what: str) -> int:
    if key not in attributes:
        raise file.fail(f"a primitive of {what} has no {key}")
    return file.whole(file.item("accessors", attributes[key]), "count", f"accessor {attributes[key]}")


def _placed(
    file: GltfFile, node: Node, attributes: dict, skins: Skins, vertices: np.ndarray, faces: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Vertices in the world and faces, of all instances; a mirrored instance keeps its front."""
    if "skin" in node.info:
        vertices, mirrored = skins.placed(node.info["skin"], attributes, vertices, f"'{node.name}'")
        return vertices, faces[:, ::-1] if mirrored else faces
    copies = instances(file, node, max(len(faces), len(vertices)))
    matrices = node.matrix[None] if copies is None else node.matrix @ copies
    mirrored = np.linalg.det(matrices[:, :3, :3]) < 0
    place = np.einsum("kij,nj->kni", matrices[:, :3, :3], vertices) + matrices[:, None, :3, 3]
    if len(matrices) == 1:
        return place[0], faces[:, ::-1] if mirrored[0] else faces
    every = np.where(mirrored[:, None, None], faces[:, ::-1], faces) + (np.arange(len(matrices)) * len(vertices))[:, None, None]
    return place.reshape(-1, 3), every.reshape(-1, 3)


def _attribute(
    file: GltfFile, attributes: dict, key: str, widths: tuple, what: str, count: int, rows: np.ndarray | None = None
) -> np.ndarray:
    """Return the values of all vertices of a primitive, or of some rows."""
    held = _held(file, attributes, key, what)
    values = accessor(file, attributes[key], rows if held == count else None).astype(np.float64, copy=False)
    if values.shape[1] not in widths or held != count:
        shape = held, values.shape[1]
        raise file.fail(f"{key} of {what} has shape {shape}; expected ({count or 'n'}, {' or '.join(map(str, widths))})")
    return values


def _uv(file: GltfFile, attributes: dict, texture: Texture | None, what: str, count: int, rows) -> np.ndarray | None:
    key = f"TEXCOORD_{texture.coordinates}" if texture else ""
    if texture is None or key not in attributes:
        return None
    return texture.uv(_attribute(file, attributes, key, (2,), what, count, rows))


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
