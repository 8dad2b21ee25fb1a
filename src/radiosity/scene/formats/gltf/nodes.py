"""The tree of a glTF scene: instances with their names and transforms, and the cameras."""

from dataclasses import dataclass

import numpy as np

from ....errors import shown
from ...assemble import warn
from ...model import Camera
from ..names import numbered
from .file import GltfFile

HEIGHT = 600  # pixels of a picture; glTF gives only the ratio


@dataclass(frozen=True, eq=False)
class Node:
    """A node of the scene: its unique name, its JSON, its (4, 4) transform to the world, and whether it or one above it is hidden
    (KHR_node_visibility)."""

    name: str
    info: dict
    matrix: np.ndarray
    hidden: bool

    def extension(self, file: GltfFile, name: str) -> dict | None:
        return extension(file, self.info, name, f"node '{self.name}'")


def extension(file: GltfFile, holder: dict, name: str, what: str) -> dict | None:
    """An extension's object, or None where the JSON has none of that name."""
    found = file.dictionary(holder.get("extensions", {}), f"extensions of {what}")
    return file.dictionary(found[name], f"{name} of {what}") if name in found else None


def walk(file: GltfFile) -> list[Node]:
    """Every node of the scene, in depth-first order. One warning names objects that have the same name.

    Raises:
        SceneError: a node is missing, or has two parents or itself as ancestor.
    """
    stack = [(index, np.eye(4), False) for index in reversed(_roots(file))]
    seen: set[int] = set()
    taken: dict[str, int] = {}
    alike: dict[str, int] = {}
    result = []
    while stack:
        index, parent, hidden = stack.pop()
        info = file.item("nodes", index)
        if index in seen:
            raise file.fail(f"node {index} has two parents or is its own ancestor; nodes must form a tree")
        seen.add(index)
        matrix = parent @ local_matrix(file, info, f"node {index}")
        seeing = extension(file, info, "KHR_node_visibility", f"node {index}")
        hidden = hidden or (seeing is not None and seeing.get("visible", True) is False)
        name = _name(file, info, index)
        result.append(Node(numbered(name, taken), info, matrix, hidden))
        if "mesh" in info:
            alike[name] = alike.get(name, 0) + 1
        stack += [(child, matrix, hidden) for child in reversed(file.items(info, "children"))]
    nodes = file.items(file.tree, "nodes")
    rest = [(index, file.dictionary(nodes[index], f"node {index}")) for index in range(len(nodes)) if index not in seen]
    if result and (outside := [_name(file, info, index) for index, info in rest if "mesh" in info]):
        warn(f"{file.path}: objects outside the scene that the file shows are left out: {shown(outside)}")
    if several := [f"{name} ({count})" for name, count in alike.items() if count > 1]:
        warn(f"{file.path}: objects of the same name get numbers (name#2, ...) in the order of the file: {shown(several)}")
    return result


def cameras(file: GltfFile, nodes) -> tuple[Camera, ...]:
    """Perspective cameras; a camera looks along its -z, up is its y."""
    result = []
    for node in nodes:
        name, info, matrix = node.name, node.info, node.matrix
        if "camera" not in info:
            continue
        lens = file.item("cameras", info["camera"])
        if lens.get("type") != "perspective":
            warn(f"{file.path}: camera '{name}' is {lens.get('type')}, not perspective; left out")
            continue
        lens = file.dictionary(lens.get("perspective"), f"perspective of camera '{name}'")
        (fov,) = file.numbers({"yfov": [lens.get("yfov")]}, "yfov", (0.0,), f"camera '{name}'")
        (ratio,) = file.numbers({"v": [lens.get("aspectRatio", 4 / 3)]}, "v", (0.0,), f"aspectRatio of camera '{name}'")
        origin, forward, up = matrix[:3, 3], -matrix[:3, 2], matrix[:3, 1]
        lengths = np.linalg.norm([forward, up], axis=1)
        if not (0 < fov < np.pi and 0.01 < ratio < 100 and np.isfinite(matrix).all() and (lengths > 0).all()):
            warn(f"{file.path}: camera '{name}' (yfov {fov:g}, aspect ratio {ratio:g}) makes no sense; left out")
            continue
        forward, up = forward / lengths[0], up / lengths[1]
        result.append(
            Camera(
                _three(origin),
                _three(origin + forward),
                _three(up),
                float(np.rad2deg(fov)),
                max(1, round(HEIGHT * ratio)),
                HEIGHT,
            )
        )
    return tuple(result)


def _three(values) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _roots(file: GltfFile) -> list:
    if file.items(file.tree, "scenes"):
        return file.items(file.item("scenes", file.tree.get("scene", 0)), "nodes")
    nodes = file.items(file.tree, "nodes")
    children = [c for node in nodes if isinstance(node, dict) for c in file.items(node, "children")]
    return [index for index in range(len(nodes)) if index not in children]


def _name(file: GltfFile, info: dict, index: int) -> str:
    name = info.get("name")
    if not name and "mesh" in info:
        name = file.item("meshes", info["mesh"]).get("name")
    return str(name or f"node {index}")


def local_matrix(file: GltfFile, info: dict, what: str) -> np.ndarray:
    """Return the transform of a node to the coordinates of its parent, (4, 4)."""
    if "matrix" in info:
        matrix = np.array(file.numbers(info, "matrix", tuple(np.eye(4).ravel()), what)).reshape(4, 4).T
        if not np.allclose(matrix[3], (0, 0, 0, 1), atol=1e-6):
            text = "glTF writes matrices by columns, so that the fourth, eighth and twelfth numbers are 0 and the last is 1"
            raise file.fail(f"matrix of {what} has the last row {matrix[3].tolist()}; expected (0, 0, 0, 1): {text}")
        return matrix
    rotation = np.array(file.numbers(info, "rotation", (0.0, 0.0, 0.0, 1.0), what))
    if not rotation.any():
        raise file.fail(f"rotation of {what} is zero; expected a unit quaternion")
    scale = np.array(file.numbers(info, "scale", (1.0, 1.0, 1.0), what))
    return composed(np.array(file.numbers(info, "translation", (0.0, 0.0, 0.0), what)), rotation, scale)


def composed(translation: np.ndarray, rotation: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Return matrices, (..., 4, 4), of translations (..., 3), quaternions x y z w (..., 4) of any length, and scales (..., 3)."""
    x, y, z, w = np.moveaxis(rotation, -1, 0)
    s = 2 / (rotation**2).sum(axis=-1)
    matrix = np.zeros((*rotation.shape[:-1], 4, 4))
    rows = [
        [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
        [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)],
        [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)],
    ]
    matrix[..., :3, :3] = np.moveaxis(np.array(rows), (0, 1), (-2, -1)) * scale[..., None, :]
    matrix[..., :3, 3], matrix[..., 3, 3] = translation, 1.0
    return matrix
