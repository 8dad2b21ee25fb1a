"""The BVH over the faces of a scene.

It holds whole faces (a parallelogram as two triangles). Coordinates are moved to the scene's centre, a median, in double
precision and scaled by a power of two before they become single. So a scene's place and size, and what lies far away, do not
matter.
"""

from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from ..device.backend import Device, entered, upload
from ..scene.model import Scene

# Scenes reach from -2^REACH to 2^REACH in the BVH. Embree divides by twice a triangle's area seen along a line, and takes no
# divisor below 1e-18: in a scene of size 1, hits of faces a billionth as long had wrong coordinates.
REACH = 20

_built: "WeakKeyDictionary[Scene, dict[str, Bvh]]" = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class Bvh:
    """The BVH of Embree (or OptiX) over the faces of a scene.

    Attributes:
        scene: the Mitsuba scene, which finds first hits.
        centre, scale: a point x in metres is (x - centre) * scale in the BVH.
        vertices: (n_vertices, 3) float32, in the BVH's coordinates.
    """

    scene: Any
    centre: np.ndarray
    scale: float
    vertices: np.ndarray

    def place(self, points: np.ndarray) -> np.ndarray:
        """Convert points in metres, (..., 3), to the BVH's coordinates, float32."""
        return ((points - self.centre) * self.scale).astype(np.float32)


def bvh(scene: Scene, device: Device) -> Bvh:
    """Return the scene's BVH on a device; it is built once."""
    known = _built.setdefault(scene, {})
    if device.name not in known:
        known[device.name] = _build(scene, device)
    return known[device.name]


def _build(scene: Scene, device: Device) -> Bvh:
    centre = scene.centre
    scale = 2.0 ** (REACH - np.ceil(np.log2(max(scene.reach, 1e-300))))
    vertices = ((scene.vertices - centre) * scale).astype(np.float32)
    triangles, _ = primitives(scene)
    with entered(device) as mi:
        mesh = mi.Mesh("scene", len(vertices), len(triangles))
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = upload(device.types.Float, vertices)
        parameters["faces"] = upload(device.types.UInt32, triangles.astype(np.uint32))
        parameters.update()
        mitsuba_scene = mi.load_dict({"type": "scene", "embree_use_robust_intersections": True, "mesh": mesh})
    return Bvh(mitsuba_scene, centre, scale, vertices)


def primitives(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return the triangles of the BVH, (n, 3), and the face of each.

    A parallelogram a b c d gives a b d and c d b, so that coordinates (u, v) in the second half are (1 - u, 1 - v) in the face.
    """
    quad = scene.is_quad
    face = np.repeat(np.arange(scene.n_faces), 1 + quad)
    second = np.concatenate([[False], face[1:] == face[:-1]])
    corners = scene.faces[face]
    triangle = corners[:, :3].copy()
    triangle[quad[face]] = corners[quad[face]][:, [0, 1, 3]]
    triangle[second] = corners[second][:, [2, 3, 1]]
    return triangle, face
