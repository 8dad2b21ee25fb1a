"""Sample lines of a small scene, for pictures of them; every line is intersected with every face."""

from dataclasses import dataclass

import numpy as np

from ..patches.model import Patches
from ..scene.model import Back, Scene

NEAR = 1e-9  # metres: a hit nearer than this is the point where the line starts


@dataclass(frozen=True, eq=False)
class Spans:
    """Pieces of lines between two points that see each other, both on sides that radiate.

    Attributes:
        line: (n,) index of the line of each piece.
        ends: (n, 2, 3) metres, in the direction of the line.
        face: (n, 2) faces of the ends.
    """

    line: np.ndarray
    ends: np.ndarray
    face: np.ndarray


def crossings(scene: Scene, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Return the multiples of each line's direction at which it crosses each face, (m, n_faces).

    They are infinite where it does not cross the face, or the face lets it pass.
    """
    corner, first, second = scene.frames
    cross = np.cross(first, second)
    slope = directions @ cross.T
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (np.sum(corner * cross, axis=1) - origins @ cross.T) / slope
        apart = origins[:, None] + t[..., None] * directions[:, None] - corner
        square = np.sum(cross**2, axis=1)
        u = np.sum(np.cross(apart, second) * cross, axis=2) / square
        v = np.sum(np.cross(first, apart) * cross, axis=2) / square
        inside = (u >= 0) & (v >= 0) & np.where(scene.is_quad, (u <= 1) & (v <= 1), u + v <= 1)
    passed = (scene.back == Back.PASSES) & (slope > 0)
    return np.where(inside & ~passed & (slope != 0), t, np.inf)


def nearest(scene: Scene, origins: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the first hits of lines of unit direction, (m, 3), and the face, -1 where nothing is hit."""
    t = crossings(scene, origins, directions)
    t = np.where(t > NEAR, t, np.inf)
    face = t.argmin(axis=1)
    t = t[np.arange(len(t)), face]
    hit = np.isfinite(t)
    return origins + np.where(hit, t, 0.0)[:, None] * directions, np.where(hit, face, -1)


def local_lines(patches: Patches, patch: int, count: int, seed: int) -> np.ndarray:
    """Return lines from uniform points of a patch, cosine distributed, to their first hits, (count, 2, 3), in a closed scene."""
    random = _random(seed)
    corners, uv = patches.corners[patch], random.random((count, 2))
    start = corners[0] + uv[:, :1] * (corners[1] - corners[0]) + uv[:, 1:] * (corners[3] - corners[0])
    end, _ = nearest(patches.scene, start, _cosine(random, np.repeat(patches.normal[patch][None], count, axis=0)))
    return np.stack([start, end], axis=1)


def sphere(scene: Scene) -> tuple[np.ndarray, float]:
    """Return centre and radius of the sphere about the scene's bounds."""
    low, high = scene.bounds
    return (low + high) / 2, float(np.linalg.norm(high - low) / 2)


def chords(scene: Scene, count: int, seed: int) -> np.ndarray:
    """Return lines between uniform points of the bounding sphere, (count, 2, 3)."""
    centre, radius = sphere(scene)
    points = _random(seed).standard_normal((count, 2, 3))
    return centre + radius * points / np.linalg.norm(points, axis=2, keepdims=True)


def spans(scene: Scene, lines: np.ndarray) -> Spans:
    """Return the spans of (m, 2, 3) lines: between consecutive faces on a line whose sides towards each other radiate."""
    start, way = lines[:, 0], lines[:, 1] - lines[:, 0]
    t = crossings(scene, start, way)
    t = np.where((t >= 0) & (t <= 1), t, np.inf)
    order = t.argsort(axis=1, kind="stable")
    t = np.take_along_axis(t, order, axis=1)
    forward = np.take_along_axis(way @ scene.normal.T > 0, order, axis=1)  # the line leaves the front and meets the back
    back = (scene.back == Back.RADIATES)[order]
    both = np.isfinite(t[:, 1:]) & (forward | back)[:, :-1] & (~forward | back)[:, 1:]
    line, place = np.nonzero(both)
    at = np.stack([t[line, place], t[line, place + 1]], axis=1)
    ends = start[line, None] + at[..., None] * way[line, None]
    return Spans(line, ends, np.stack([order[line, place], order[line, place + 1]], axis=1))


def walks(scene: Scene, face: int, count: int, seed: int) -> list[np.ndarray]:
    """Return paths of particles from a face's front until they are absorbed, (segments + 1, 3) points each, in a closed scene."""
    random, paths = _random(seed), []
    corner, first, second = (edge[face] for edge in scene.frames)
    for _ in range(count):
        u, v = random.random(2)
        points, normal, alive = [corner + u * first + v * second], scene.normal[face], True
        while alive:
            way = _cosine(random, normal[None])
            end, met = nearest(scene, points[-1][None], way)
            points.append(end[0])
            front = float(way[0] @ scene.normal[met[0]]) < 0
            normal = scene.normal[met[0]] * (1 if front else -1)
            radiates = front or scene.back[met[0]] == Back.RADIATES
            alive = bool(radiates and random.random() < (scene.reflectance if front else scene.back_reflectance)[met[0], 0])
        paths.append(np.array(points))
    return paths


def breadth_first(lengths: list[int]) -> list[tuple[int, int]]:
    """Return (walk, segment) in the order in which they are fired: all first segments, then all second ones."""
    return [
        (walk, segment) for segment in range(max(lengths, default=0)) for walk, length in enumerate(lengths) if segment < length
    ]


def depth_first(lengths: list[int]) -> list[tuple[int, int]]:
    """Return (walk, segment) in the order in which they are fired: each walk until it ends."""
    return [(walk, segment) for walk, length in enumerate(lengths) for segment in range(length)]


def _cosine(random: np.random.Generator, normal: np.ndarray) -> np.ndarray:
    """Return unit directions about (m, 3) normals: the normal plus a uniform point of the unit sphere, normalised."""
    point = random.standard_normal(normal.shape)
    way = normal + point / np.linalg.norm(point, axis=1, keepdims=True)
    return way / np.linalg.norm(way, axis=1, keepdims=True)


def _random(seed: int) -> np.random.Generator:
    return np.random.Generator(np.random.Philox(seed))
