"""Closed scenes whose solution is known, for the tests."""

import numpy as np

import radiosity as rd
from radiosity.scene.shapes import box, quad


def cube(reflectance=0.5, emission=1.0, n_bands=1) -> rd.Scene:
    """A unit cube seen from inside, one surface a wall."""
    quads = box((0, 0, 0), (1, 1, 1), inward=True)
    values = (np.full((1, n_bands), v, float) if np.ndim(v) == 0 else np.asarray(v, float) for v in (reflectance, emission))
    return rd.Scene.from_arrays(
        np.concatenate(quads), np.arange(24).reshape(6, 4), *values, surface=range(6), names=[f"wall {i}" for i in range(6)]
    )


def cube_irradiance(reflectance: np.ndarray, emission: np.ndarray) -> np.ndarray:
    """(6,) irradiance of the walls of `cube`, each one patch: the equation of the patches, with exact form factors."""
    opposite = parallel_squares()[1]
    factors = np.full((6, 6), (1 - opposite) / 4)
    factors[np.arange(6), np.arange(6)] = 0.0
    factors[np.arange(6), np.arange(6) ^ 1] = opposite
    return factors @ np.linalg.solve(np.eye(6) - reflectance[:, None] * factors, emission)


def sphere(reflectance: float, emission: float, subdivisions: int = 3) -> rd.Scene:
    """An icosphere seen from inside."""
    golden = (1 + 5**0.5) / 2
    points = np.array([[-1, golden, 0], [1, golden, 0], [-1, -golden, 0], [1, -golden, 0]], float)
    points = np.concatenate([points, points[:, [2, 0, 1]], points[:, [1, 2, 0]]])
    from scipy.spatial import ConvexHull

    faces = ConvexHull(points).simplices
    for _ in range(subdivisions):
        corners = points[faces]
        middles = (corners + np.roll(corners, -1, axis=1)) / 2
        a, b, c, d, e, f = (x for x in (*np.moveaxis(corners, 1, 0), *np.moveaxis(middles, 1, 0)))
        triangles = np.concatenate([np.stack(t, 1) for t in ((a, d, f), (d, b, e), (f, e, c), (d, e, f))])
        points, index = np.unique(triangles.reshape(-1, 3).round(12), axis=0, return_inverse=True)
        faces = index.reshape(-1, 3)
    points = points / np.linalg.norm(points, axis=1, keepdims=True)
    corners = points[faces]
    outward = np.einsum("ij,ij->i", np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), corners[:, 0]) > 0
    faces[outward] = faces[outward][:, [0, 2, 1]]
    return rd.Scene.from_arrays(points, faces, reflectance, emission)


def sphere_in_box() -> tuple[rd.Scene, float]:
    """A convex polyhedron, nearly a sphere, inside a cube: all of its light lands on the cube, and the share of the cube's light
    that lands on it is the ratio of areas, by reciprocity: exact for any convex body in another."""
    ball, outer = sphere(0.0, 0.0, 2), cube(0.0, 0.0)
    corners = 0.5 + 0.3 * ball.vertices
    triangles = np.column_stack([ball.faces[:, [0, 2, 1]], np.full(ball.n_faces, -1)])
    scene = rd.Scene.from_arrays(
        np.concatenate([corners, outer.vertices]),
        np.concatenate([triangles, outer.faces + len(corners)]),
        0.0,
        1.0,
        surface=[0] * len(triangles) + [1] * outer.n_faces,
        names=["sphere", "box"],
    )
    area = np.bincount(scene.surface, scene.area)
    return scene, float(area[0] / area[1])


def facing(first: np.ndarray, second: np.ndarray) -> rd.Scene:
    """Two black parallelograms, the first emitting 1 W/m²: the share of its power that lands on the other is F_12."""
    return rd.Scene.from_arrays(
        np.concatenate([first, second]),
        np.arange(8).reshape(2, 4),
        0.0,
        [1.0, 0.0],
        surface=[0, 1],
        names=["emitter", "receiver"],
    )


def parallel_squares() -> tuple[rd.Scene, float]:
    """Unit squares at distance 1; F from Howell's catalogue, C-11."""
    x2 = 2.0
    value = 2 / np.pi * (0.5 * np.log(x2 * x2 / (1 + 2)) + 2 * np.sqrt(x2) * np.arctan(1 / np.sqrt(x2)) - 2 * np.arctan(1.0))
    return facing(quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, 1), (0, 1, 0), (1, 0, 0))), float(value)


def perpendicular_squares() -> tuple[rd.Scene, float]:
    """Unit squares with a common edge; F from Howell's catalogue, C-14 with H = W = 1."""
    h = w = 1.0
    s = h * h + w * w
    a = (1 + w * w) * (1 + h * h) / (1 + s)
    b = (w * w * (1 + s) / ((1 + w * w) * s)) ** (w * w)
    c = (h * h * (1 + s) / ((1 + h * h) * s)) ** (h * h)
    value = (w * np.arctan(1 / w) + h * np.arctan(1 / h) - np.sqrt(s) * np.arctan(1 / np.sqrt(s)) + 0.25 * np.log(a * b * c)) / (
        np.pi * w
    )
    return facing(quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, 0), (0, 1, 0), (0, 0, 1))), float(value)


def coaxial_discs(first: float = 1.0, second: float = 0.7, distance: float = 0.9, sides: int = 96) -> tuple[rd.Scene, float]:
    """Parallel discs as polygons of equal area; F from Howell's catalogue, C-41."""
    vertices, faces = [], []
    for radius, height, up in ((first, 0.0, True), (second, distance, False)):
        step = 2 * np.pi / sides
        outer = radius * np.sqrt(step / np.sin(step))
        ring = [(outer * np.cos(i * step), outer * np.sin(i * step), height) for i in range(sides)]
        base = len(vertices)
        vertices += [(0.0, 0.0, height), *ring]
        for i in range(sides):
            j = (i + 1) % sides
            faces.append((base, base + 1 + i, base + 1 + j) if up else (base, base + 1 + j, base + 1 + i))
    surface = np.repeat([0, 1], sides)
    scene = rd.Scene.from_arrays(vertices, faces, 0.0, 1.0 - surface, surface=surface, names=["emitter", "receiver"])
    r1, r2 = first / distance, second / distance
    x = 1 + (1 + r2 * r2) / (r1 * r1)
    return scene, float((x - np.sqrt(x * x - 4 * (r2 / r1) ** 2)) / 2)


def lamp_lit(reflectance=0.9, *, floor: float | None = None) -> rd.Scene:
    """A unit cube seen from inside, with a lamp of a fifth of its width in the middle of the ceiling, flush with it. Nothing
    escapes: where all surfaces reflect alike, the mean irradiance is E_lamp A_lamp / (A (1 - reflectance)), whatever the patches.

    Args:
        reflectance: of all surfaces, or of the floor if given otherwise.
    """
    edges = (0.0, 0.4, 0.6, 1.0)
    parts = list(zip(("south", "north", "west", "east", "floor"), box((0, 0, 0), (1, 1, 1), inward=True)[:5], strict=True))
    for i, j in np.ndindex(3, 3):
        across, along = edges[i + 1] - edges[i], edges[j + 1] - edges[j]
        parts.append(("lamp" if i == j == 1 else "ceiling", quad((edges[i], edges[j], 1), (0, along, 0), (across, 0, 0))))
    names = list(dict.fromkeys(name for name, _ in parts))
    values = {name: reflectance if floor is None or name != "floor" else floor for name in names}
    return rd.Scene.from_arrays(
        np.concatenate([corners for _, corners in parts]),
        np.arange(4 * len(parts)).reshape(-1, 4),
        [values[name] for name, _ in parts],
        [25.0 if name == "lamp" else 0.0 for name, _ in parts],
        surface=[names.index(name) for name, _ in parts],
        names=names,
    )
