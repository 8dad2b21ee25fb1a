"""A skin of two joints for the first mesh of a glTF file."""

import numpy as np

from .draw import Draw, rotation
from .gltf_buffer import Buffer


def add_weights(draw: Draw, buffer: Buffer, primitive: dict) -> None:
    """Gives each vertex of a primitive a part of both joints."""
    count = buffer.tree["accessors"][primitive["attributes"]["POSITION"]]["count"]
    share = draw.random(count).astype(np.float32)
    weights = np.column_stack([share, 1 - share, np.zeros((count, 2))])
    primitive["attributes"]["WEIGHTS_0"] = buffer.accessor(weights, "f4")
    primitive["attributes"]["JOINTS_0"] = buffer.accessor(np.tile([0, 1, 0, 0], (count, 1)), draw.one("u1", "u2"))


def add_skin(draw: Draw, tree: dict, buffer: Buffer) -> list[int]:
    """Adds an armature of two joints, one below the other; the root of its nodes."""
    first = len(tree["nodes"])
    for name, children in (("armature", [first + 1]), ("hip", [first + 2]), ("knee", [])):
        node: dict = {"name": name, "translation": draw.uniform(-1, 1, 3).tolist(), "rotation": draw.quaternion()}
        tree["nodes"].append(node | ({"children": children} if children else {}))
    binds = []
    for _ in range(2):
        bind = np.eye(4)
        bind[:3, :3], bind[:3, 3] = rotation(draw.quaternion()), draw.uniform(-1, 1, 3)
        binds.append(bind.T.ravel())
    inverse = buffer.accessor(np.array(binds), "f4")
    tree["skins"] = [{"joints": [first + 1, first + 2], "inverseBindMatrices": inverse, "skeleton": first}]
    return [first]
