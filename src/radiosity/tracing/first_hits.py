"""Lines of any origin, traced for pictures and checks."""

from dataclasses import dataclass

import numpy as np

from ..device.turn import turn
from ..patches import subdivide
from ..scene.model import Scene

CHUNK = 1 << 21


@dataclass(frozen=True, eq=False)
class Hits:
    """First hits of m lines.

    Attributes:
        face: (m,) int64, -1 where nothing is hit.
        u, v: (m,) float64 face coordinates.
        front: (m,) bool.
        distance: (m,) float64 metres, infinite where nothing is hit.
    """

    face: np.ndarray
    u: np.ndarray
    v: np.ndarray
    front: np.ndarray
    distance: np.ndarray


@turn()
def first_hits(scene: Scene, origins: np.ndarray, directions: np.ndarray, device: str = "auto") -> Hits:
    """Return the first hit of each line; lines go on through backs that let them pass.

    Args:
        origins, directions: (m, 3) metres; directions need not be of unit length.

    Raises:
        DeviceError: there is no usable back end.
    """
    from ..device.backend import choose
    from .geometry import Geometry

    return hits_of(Geometry(subdivide(scene, cells=1), choose(device)), origins, directions)


@turn()
def hits_of(geometry, origins: np.ndarray, directions: np.ndarray) -> Hits:
    """Return the same, in a `Geometry` that is used more than once."""
    import drjit as dr

    from ..device.backend import upload
    from .hits import first_hit

    types, bvh = geometry.device.types, geometry.bvh
    origins, directions = (np.asarray(a, np.float64).reshape(-1, 3) for a in (origins, directions))
    length = np.linalg.norm(directions, axis=1, keepdims=True)
    unit = (directions / np.where(length > 0, length, 1)).astype(np.float32)
    start = ((origins - bvh.centre) * bvh.scale).astype(np.float32)
    parts = []
    for at in range(0, len(start), CHUNK):
        rows = slice(at, at + CHUNK)
        rays = [types.Array3f(*(upload(types.Float, a[rows, i]) for i in range(3))) for a in (start, unit)]
        hit = first_hit(geometry, *rays)
        face = dr.gather(types.UInt32, geometry.faces.primitive_faces, hit.primitive, hit.valid)
        outputs = (face, hit.u, hit.v, hit.front, hit.distance, hit.valid)
        dr.eval(outputs)
        face, u, v, front, distance, valid = (np.array(x) for x in outputs)
        u, v = np.where(valid, u, 0), np.where(valid, v, 0)
        parts.append(
            (np.where(valid, face.astype(np.int64), -1), u, v, front & valid, np.where(valid, distance / bvh.scale, np.inf))
        )
    if not parts:
        parts = [tuple(np.zeros(0) for _ in range(5))]
    face, u, v, front, distance = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Hits(face.astype(np.int64), u.astype(np.float64), v.astype(np.float64), front.astype(bool), distance)
