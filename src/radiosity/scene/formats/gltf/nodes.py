"""The tree of a glTF scene: instances with their names and transforms, and the cameras."""

import numpy as np

from ...assemble import warn
from ...model import Camera
from .file import GltfFile

HEIGHT = 600  # pixels of a picture; glTF gives only the ratio


def walk(file: GltfFile) -> list[tuple[str, dict, np.ndarray]]:
    """(unique name, node, (4, 4) transform to the world) of every node of the scene, in depth-first order.

    Raises:
        SceneError: a node is missing, or has two parents or itself as ancestor.
    """
    stack = [(index, np.eye(4)) for index in reversed(_roots(file))]
    seen: set[int] = set()
    taken: dict[str, int] = {}
    result = []
    while stack:
        index, parent = stack.pop()
        info = file.item("nodes", index)
        if index in seen:
            raise file.fail(f"node {index} has two parents or is its own ancestor; nodes must form a tree")
        seen.add(index)
        matrix = parent @ _matrix(file, info, f"node {index}")
        result.append((_unique(_name(file, info, index), taken), info, matrix))
        stack += [(child, matrix) for child in reversed(file.items(info, "children"))]
    return result


def cameras(file: GltfFile, nodes) -> tuple[Camera, ...]:
    """Perspective cameras; a camera looks along its -z, up is its y."""
    result = []
    for name, info, matrix in nodes:
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


def _unique(name: str, taken: dict[str, int]) -> str:
    """The name, with a number where another object has it."""
    taken[name] = taken.get(name, 0) + 1
    if taken[name] == 1:
        return name
    return _unique(f"{name}#{taken[name]}", taken)


def _matrix(file: GltfFile, info: dict, what: str) -> np.ndarray:
    if "matrix" in info:
        return np.array(file.numbers(info, "matrix", tuple(np.eye(4).ravel()), what)).reshape(4, 4).T
    x, y, z, w = np.array(file.numbers(info, "rotation", (0.0, 0.0, 0.0, 1.0), what))
    length = x * x + y * y + z * z + w * w
    if not length > 0:
        raise file.fail(f"rotation of {what} is zero; expected a unit quaternion")
    s = 2 / length
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
        [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)],
        [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)],
    ]
    matrix[:3, :3] *= np.array(file.numbers(info, "scale", (1.0, 1.0, 1.0), what))
    matrix[:3, 3] = file.numbers(info, "translation", (0.0, 0.0, 0.0), what)
    return matrix
