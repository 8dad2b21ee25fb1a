"""What the tests of pictures and files share: solutions with made-up values, and a plain ray caster."""

from types import SimpleNamespace

import numpy as np

import radiosity as rd


def solution(patches, radiosity=None, *, unit="W/m²"):
    """Made-up values for patches: radiosity as given, or a smooth function of the place."""
    n, bands = len(patches), patches.scene.bands
    if radiosity is None:
        x, y, z = patches.centroid.T
        radiosity = np.stack([1 + x + 2 * y + 3 * z + k for k in range(len(bands))], axis=1)
    radiosity = np.asarray(radiosity, np.float64).reshape(n, len(bands))
    table = [
        {"surface": name, "area": 2.0, **{f"emitted [{band}]": 0.5 for band in bands}, "error": np.nan}
        for name in patches.scene.names
    ]
    return SimpleNamespace(
        patches=patches,
        radiosity=radiosity,
        irradiance=2 * radiosity,
        standard_error=0.1 * radiosity,
        irradiance_standard_error=0.2 * radiosity,
        arrivals=np.arange(n),
        bands=bands,
        unit=unit,
        irradiance_unit=unit,
        by_own_lines=False,
        surface_table=lambda: table,
        quanta=1,
        few=np.arange(n) < 30,
        interval=lambda level, quantity, rows=slice(None): (1.5 * radiosity[rows], 2.5 * radiosity[rows]),
    )


def quad_scene(names=("floor",), **more):
    """A square of two metres in the plane z = 0, seen from above."""
    return rd.Scene.from_arrays([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], [[0, 1, 2, 3]], 0.5, 0.0, names=names, **more)


def plain_hits(scene, origins, directions):
    """First hits by solving for every face: for small scenes, and independent of the ray caster."""
    origin, first, second = scene.frames
    best = SimpleNamespace(
        face=np.full(len(origins), -1),
        u=np.zeros(len(origins)),
        v=np.zeros(len(origins)),
        front=np.zeros(len(origins), bool),
        distance=np.full(len(origins), np.inf),
    )
    for face in range(scene.n_faces):
        across = np.cross(directions, second[face])
        scale = across @ first[face]
        safe = np.where(np.abs(scale) > 1e-12, scale, np.nan)
        offset = origins - origin[face]
        u = np.einsum("ij,ij->i", offset, across) / safe
        turned = np.cross(offset, first[face])
        v, t = np.einsum("ij,ij->i", directions, turned) / safe, turned @ second[face] / safe
        front = directions @ scene.normal[face] < 0
        inside = (u >= 0) & (v >= 0) & ((np.maximum(u, v) <= 1) if scene.is_quad[face] else (u + v <= 1))
        nearer = inside & (t > 1e-9) & (t < best.distance) & (front | (scene.back[face] != rd.Back.PASSES))
        for name, value in (("face", face), ("u", u), ("v", v), ("front", front), ("distance", t)):
            array = getattr(best, name)
            array[nearer] = np.broadcast_to(value, len(origins))[nearer]
    return best


UTM = (500000.137, 5400000.211, 100.05)  # metres: single precision has half a metre there


def far_room(corner=UTM):
    """The built-in room with a corner at a far place."""
    from dataclasses import replace

    scene = rd.load_scene("room")
    return replace(scene, vertices=scene.vertices - scene.bounds[0] + np.array(corner))
