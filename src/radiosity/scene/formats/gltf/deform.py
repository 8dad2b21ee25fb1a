"""The places of the vertices of a glTF mesh: morph targets first, then the joints of a skin, or else the transform of the node.

A vertex of a skin is the weighted mean of where its joints take it; the transform of its node is ignored (glTF 2.0, 3.7.3.3).
"""

from dataclasses import dataclass, field

import numpy as np

from .accessor import accessor
from .file import GltfFile
from .nodes import local_matrix


def morphed(file: GltfFile, node: dict, mesh: dict, primitive: dict, vertices: np.ndarray, what: str) -> np.ndarray:
    """Return vertices moved by the weights of the node, or else of the mesh, (n, 3)."""
    targets = file.items(primitive, "targets")
    holder = node if "weights" in node else mesh
    weights = file.items(holder, "weights")
    if not targets or not weights:
        return vertices
    values = file.numbers({"weights": weights}, "weights", (0.0,) * len(targets), what)
    for number, (target, weight) in enumerate(zip(targets, values, strict=True)):
        target = file.dictionary(target, f"morph target {number} of {what}")
        if weight == 0 or "POSITION" not in target:
            continue
        moved = accessor(file, target["POSITION"])
        if moved.shape != vertices.shape:
            raise file.fail(f"morph target {number} of {what} has shape {moved.shape}; expected {vertices.shape}")
        vertices = vertices + weight * moved
    return vertices


@dataclass(eq=False)
class Skins:
    """The joint matrices of a file's skins, made when first asked for."""

    file: GltfFile
    made: dict[int, np.ndarray] = field(default_factory=dict)

    def placed(self, index, attributes: dict, vertices: np.ndarray, what: str) -> tuple[np.ndarray, bool]:
        """Return vertices in the world, (n, 3), and whether the joints mirror them."""
        file, matrices = self.file, self._matrices(index)
        total, weights_of_all, number = np.zeros((len(vertices), 4, 4)), np.zeros(len(vertices)), 0
        while number == 0 or f"JOINTS_{number}" in attributes:
            joints, weights = (self._attribute(attributes, f"{k}_{number}", len(vertices), what) for k in ("JOINTS", "WEIGHTS"))
            if joints.size and not 0 <= joints.min() <= joints.max() < len(matrices):
                raise file.fail(f"JOINTS_{number} of {what} names joint {int(joints.max())}; its skin has {len(matrices)}")
            for column in range(4):
                total += weights[:, column, None, None] * matrices[joints[:, column].astype(np.int64)]
            weights_of_all += weights.sum(axis=1)
            number += 1
        if not (weights_of_all > 0).all():
            vertex = int(np.flatnonzero(~(weights_of_all > 0))[0])
            raise file.fail(f"the weights of vertex {vertex} of {what} sum to {weights_of_all[vertex]:g}; no joint places it")
        total /= weights_of_all[:, None, None]
        moved = np.einsum("nij,nj->ni", total[:, :3, :3], vertices) + total[:, :3, 3]
        return moved, len(total) > 0 and float(np.linalg.det(total[:, :3, :3]).mean()) < 0

    def _attribute(self, attributes: dict, key: str, count: int, what: str) -> np.ndarray:
        if key not in attributes:
            raise self.file.fail(f"{what} has a skin but no {key}; export it again, or apply its armature")
        values = accessor(self.file, attributes[key])
        if values.shape != (count, 4):
            raise self.file.fail(f"{key} of {what} has shape {values.shape}; expected ({count}, 4)")
        return values

    def _matrices(self, index) -> np.ndarray:
        """Return matrices from the mesh's own coordinates to the world, (n_joints, 4, 4)."""
        file, skin = self.file, self.file.item("skins", index)
        if index not in self.made:
            joints = file.items(skin, "joints")
            if not joints:
                raise file.fail(f"skin {index} has no joints")
            world = np.stack([self._world(joint) for joint in joints])
            if "inverseBindMatrices" in skin:
                bind = accessor(file, skin["inverseBindMatrices"])
                if bind.shape[1] != 16 or len(bind) < len(joints):
                    text = f"the inverseBindMatrices of skin {index} have shape {bind.shape}"
                    raise file.fail(f"{text}; expected ({len(joints)}, 16)")
                world = world @ bind[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
            self.made[index] = world
        return self.made[index]

    def _world(self, joint) -> np.ndarray:
        """Return the matrix of a joint to the world, through all nodes above it, (4, 4)."""
        matrix, above, seen = np.eye(4), self._parents(), set()
        while joint is not None:
            info = self.file.item("nodes", joint)
            if joint in seen:
                raise self.file.fail(f"node {joint} is its own ancestor; nodes must form a tree")
            seen.add(joint)
            matrix, joint = local_matrix(self.file, info, f"node {joint}") @ matrix, above.get(joint)
        return matrix

    def _parents(self) -> dict[int, int]:
        nodes = self.file.items(self.file.tree, "nodes")
        return {
            child: index
            for index, node in enumerate(nodes)
            if isinstance(node, dict)
            for child in self.file.items(node, "children")
            if isinstance(child, int)
        }
