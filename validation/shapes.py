"""Facets of bodies: lists of (k, 3) corners, counterclockwise seen from their front. Round ones keep their area, or their
perimeter, so that what is left of the difference falls with the square of the facets' size."""

from itertools import combinations

import numpy as np

import radiosity as rd

Facets = list[np.ndarray]


def quad(origin, first, second) -> np.ndarray:
    """(4, 3) corners; the front is on the side of first x second."""
    o, a, b = (np.asarray(x, np.float64) for x in (origin, first, second))
    return np.array([o, o + a, o + a + b, o + b])


def turned(facets: Facets) -> Facets:
    """The other way round."""
    return [facet[::-1] for facet in facets]


def moved(facets: Facets, by) -> Facets:
    return [facet + np.asarray(by) for facet in facets]


def circle(radius: float, height: float, sides: int) -> np.ndarray:
    """(sides, 3) corners of the regular polygon that has the circle's area."""
    step = 2 * np.pi / sides
    angle = np.arange(sides) * step
    reach = radius * np.sqrt(step / np.sin(step))
    return np.column_stack([reach * np.cos(angle), reach * np.sin(angle), np.full(sides, height)])


def disc(radius: float, height: float, sides: int) -> Facets:
    """About the z axis, seen from above."""
    rim = circle(radius, height, sides)
    middle = np.array([0, 0, height])
    return [np.array([middle, a, b]) for a, b in zip(rim, np.roll(rim, -1, axis=0), strict=True)]


def ring(inner: float, outer: float, height: float, sides: int) -> Facets:
    """About the z axis, seen from above."""
    a, b = circle(inner, height, sides), circle(outer, height, sides)
    return [np.array(corners) for corners in zip(a, b, np.roll(b, -1, axis=0), np.roll(a, -1, axis=0), strict=True)]


def tube(radius: float, low: float, high: float, sides: int) -> Facets:
    """A cylinder about the z axis, seen from outside, of the circle's perimeter."""
    chord = np.pi / sides
    a, b = (circle(1.0, z, sides) for z in (low, high))
    for rim in (a, b):
        rim[:, :2] *= radius * chord / np.sin(chord) / np.hypot(rim[:1, 0], rim[:1, 1])
    return [np.array(corners) for corners in zip(a, np.roll(a, -1, axis=0), np.roll(b, -1, axis=0), b, strict=True)]


def ball(radius: float, level: int, centre=(0, 0, 0)) -> Facets:
    """An icosahedron divided ``level`` times, 20 x 4^level triangles, seen from outside, with the sphere's area."""
    triangles = _icosahedron()
    for _ in range(level):
        corners = triangles
        middles = (corners + np.roll(corners, -1, axis=1)) / 2
        (a, b, c), (d, e, f) = np.moveaxis(corners, 1, 0), np.moveaxis(middles, 1, 0)
        triangles = np.concatenate([np.stack(t, axis=1) for t in ((a, d, f), (d, b, e), (f, e, c), (d, e, f))])
        triangles /= np.linalg.norm(triangles, axis=2, keepdims=True)
    area = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1).sum() / 2
    return list(radius * np.sqrt(4 * np.pi / area) * triangles + np.asarray(centre, float))


def _icosahedron() -> np.ndarray:
    """(20, 3, 3) unit corners, seen from outside."""
    golden = (1 + 5**0.5) / 2
    points = np.array([(a, b * golden, 0) for a in (-1, 1) for b in (-1, 1)], float)
    points = np.concatenate([points, points[:, [2, 0, 1]], points[:, [1, 2, 0]]])
    near = np.isclose(np.linalg.norm(points[:, None] - points, axis=2), 2)
    faces = [(a, b, c) for a, b, c in combinations(range(12), 3) if near[a, b] and near[a, c] and near[b, c]]
    corners = points[np.array(faces)] / np.linalg.norm(points[0])
    inward = np.linalg.det(corners) < 0
    corners[inward] = corners[inward][:, [0, 2, 1]]
    return corners


def scene(*parts: tuple[str, float, float, Facets], source: str = "validation") -> rd.Scene:
    """A grey scene from (name, reflectance, emission, facets); backs absorb."""
    rows = [(i, reflectance, emission, facet) for i, (_, reflectance, emission, facets) in enumerate(parts) for facet in facets]
    corners = np.concatenate([facet for *_, facet in rows])
    sizes = np.array([len(facet) for *_, facet in rows])
    first = np.cumsum(sizes) - sizes
    faces = np.where(np.arange(4) < sizes[:, None], first[:, None] + np.arange(4), -1)
    return rd.Scene.from_arrays(
        corners,
        faces,
        np.array([r for _, r, _, _ in rows], float),
        np.array([e for _, _, e, _ in rows], float),
        surface=[i for i, *_ in rows],
        names=[name for name, *_ in parts],
        source=source,
    )
