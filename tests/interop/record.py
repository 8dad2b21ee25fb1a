"""What a reader made of a file, surface by surface, in one form for all readers."""

from dataclasses import dataclass

import numpy as np

import radiosity as rd
from radiosity.scene import Back

QUANTITIES = ("refused", "names", "area", "vector", "volume", "bounds", "sides", "reflectance", "power")


class Refused(Exception):
    """The other program does not read the file; the message is its own."""


@dataclass(frozen=True, eq=False)
class Surface:
    """One surface. None: the reader does not know it, so it is not compared.

    Attributes:
        area: m², of one side.
        vector: (3,) integral of the front's normal over the area, m²; a reversed winding changes its sign.
        volume: a third of the integral of normal times position, m³; it tells the winding of closed surfaces.
        bounds: (2, 3) lowest and highest coordinates.
        sides: 1 or 2, how many reflect or emit.
        reflectance: (3,) mean of the front over the area.
        power: (3,) emitted by all sides, W.
        sampled: reflectance or power are means over points, not exact.
    """

    area: float
    bounds: np.ndarray
    vector: np.ndarray | None = None
    volume: float | None = None
    sides: int | None = None
    reflectance: np.ndarray | None = None
    power: np.ndarray | None = None
    sampled: bool = False


Reading = dict[str, Surface]


def surface(triangles, *, reflectance=None, exitance=None, sides=None, wound=True, sampled=False) -> Surface:
    """The record of triangles.

    Args:
        triangles: (m, 3, 3) corners, counterclockwise from the front.
        reflectance: (3,) or (m, 3) mean of each triangle.
        exitance: (3,) or (m, 3) emitted by all sides of a triangle together, W/m².
        sides: 1 or 2.
        wound: the order of the corners says which side is the front.
    """
    triangles = np.asarray(triangles, float).reshape(-1, 3, 3)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) / 2
    areas = np.linalg.norm(normals, axis=1)
    points = triangles[areas > 0].reshape(-1, 3)

    def total(values):
        return np.broadcast_to(np.asarray(values, float), (len(areas), 3)).T @ areas

    return Surface(
        area=float(areas.sum()),
        bounds=np.stack([points.min(axis=0), points.max(axis=0)]),
        vector=normals.sum(axis=0) if wound else None,
        volume=float((normals * triangles.mean(axis=1)).sum() / 3) if wound else None,
        sides=sides,
        reflectance=None if reflectance is None else total(reflectance) / areas.sum(),
        power=None if exitance is None else total(exitance),
        sampled=sampled,
    )


def ours(scene: rd.Scene) -> Reading:
    """What our reader gives: the values of patches, as a solution would use them."""
    patches = rd.subdivide(scene, cells=1)
    corners = scene.vertices[np.where(scene.faces < 0, scene.faces[:, :1], scene.faces)]
    result = {}
    for number, name in enumerate(scene.names):
        faces, on = scene.surface == number, patches.surface == number
        if not faces.any():
            continue
        halves = np.concatenate([corners[faces][:, [0, 1, 2]], corners[faces & scene.is_quad][:, [0, 2, 3]]])
        front = on & ~patches.is_back
        emitted = (patches.emission[on] * patches.area[on, None]).sum(axis=0)
        base = surface(halves)
        result[name] = Surface(
            area=float(scene.area[faces].sum()),
            bounds=base.bounds,
            vector=base.vector,
            volume=base.volume,
            sides=2 if (scene.back[faces] == Back.RADIATES).any() else 1,
            reflectance=_three(np.average(patches.reflectance[front], axis=0, weights=patches.area[front])),
            power=_three(emitted),
        )
    return result


def merged(reading: Reading, name: str = "all") -> Reading:
    """One surface of all, for readers that know no names."""
    surfaces = list(reading.values())
    areas = np.array([s.area for s in surfaces])

    def total(values, weights=None):
        if any(v is None for v in values):
            return None
        return np.sum([np.asarray(v) * (1 if weights is None else w) for v, w in zip(values, areas, strict=True)], axis=0)

    volume, mean = total([s.volume for s in surfaces]), total([s.reflectance for s in surfaces], areas)
    return {
        name: Surface(
            area=float(areas.sum()),
            bounds=np.stack(
                [
                    np.min([s.bounds[0] for s in surfaces], axis=0),
                    np.max([s.bounds[1] for s in surfaces], axis=0),
                ]
            ),
            vector=total([s.vector for s in surfaces]),
            volume=None if volume is None else float(volume),
            sides=None if any(s.sides is None for s in surfaces) else max(s.sides or 0 for s in surfaces),
            reflectance=None if mean is None else mean / areas.sum(),
            power=total([s.power for s in surfaces]),
            sampled=any(s.sampled for s in surfaces),
        )
    }


def _three(values) -> np.ndarray:
    return np.broadcast_to(np.asarray(values, float), (3,)).copy()
