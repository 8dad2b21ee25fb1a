"""Light that is gathered at points of every face, on both sides: what `meshes_bound.py` knows of a scene."""

from dataclasses import dataclass

import numpy as np
from meshes import Places

import radiosity as rd

EACH = 1000  # lines of a point
FEWEST, MOST = 4, 10  # a face has 2 ** 4 to 2 ** 10 points on each side


@dataclass(frozen=True, eq=False)
class Light:
    """Reflected light at points of a face: 2**a x 2**b points, one in each cell of a grid.

    Attributes:
        values: (rows, 2**b, 2**a), W/m², a row for each side and band. noise: the same, their variances.
        area: m² of a side. sides: 1 or 2. quad: it is a parallelogram, otherwise a triangle, over which the square is folded.
    """

    values: np.ndarray
    noise: np.ndarray
    u: np.ndarray
    v: np.ndarray
    area: float
    sides: int
    quad: bool


def gathered(scene: rd.Scene, read: rd.Solution, points: int, seed: int) -> list[Light]:
    """Return the light of each face.

    Args:
        scene: cut or not. read: a solution on a mesh of it, or of the scene that it is a cut of, which points read.
        points: how many there are, about: half by area, half by the square of light.
    """
    patches = rd.subdivide(scene, cells=1)
    owner = read.patches.scene.cut.face[read.patches.face]
    square = ((read.patches.reflectance * read.irradiance) ** 2).sum(axis=1)
    bright = np.bincount(owner, read.patches.area * square, owner.max() + 1)
    whole = scene.cut.face  # of the faces, where they are cut
    bright = bright[whole] * scene.area / np.bincount(whole, scene.area)[whole]
    share = (scene.area / scene.area.sum() + bright / bright.sum()) / 2
    sides = np.where(scene.back == rd.Back.RADIATES, 2, 1)
    level = np.clip(np.round(np.log2(np.maximum(points * share / sides, 1))), FEWEST, MOST).astype(int)
    origin, first, second = scene.frames
    ratio = np.log2(np.linalg.norm(first, axis=1) / np.linalg.norm(second, axis=1))
    a = np.where(scene.is_quad, np.clip(np.round((level + ratio) / 2), 1, level - 1), level // 2).astype(int)
    random = np.random.default_rng(seed)
    grids, where, normals, weights = [], [], [], []
    for face in range(scene.n_faces):
        m, n = 1 << a[face], 1 << (level[face] - a[face])
        u = (np.arange(m)[None, :] + random.random((n, m))) / m
        v = (np.arange(n)[:, None] + random.random((n, m))) / n
        if not scene.is_quad[face]:
            over = u + v > 1
            u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
        grids.append((u, v))
        at = origin[face] + u.reshape(-1, 1) * first[face] + v.reshape(-1, 1) * second[face]
        for side in range(sides[face]):
            where.append(at)
            normals.append(np.tile(scene.normal[face] * (1 - 2 * side), (m * n, 1)))
            weights.append(np.full(m * n, scene.area[face] / (m * n)))
    places = Places(np.concatenate(where), np.concatenate(normals), np.concatenate(weights))
    truth = rd.measure(read, rd.Sensors.of(places.points, places.normals), rays=EACH * len(places.points), seed=seed + 1)
    found, begin = [], 0
    for face in range(scene.n_faces):
        u, v = grids[face]
        rho = patches.reflectance[patches.first[face] + np.arange(sides[face])]
        rows = slice(begin, begin + sides[face] * u.size)
        begin = rows.stop
        value, noise = truth.illuminance[rows], np.nan_to_num(truth.standard_error[rows])
        value, noise = (x.reshape(sides[face], u.size, -1) for x in (value, noise))
        value, noise = value * rho[:, None], (noise * rho[:, None]) ** 2
        value, noise = (x.transpose(0, 2, 1).reshape(-1, *u.shape) for x in (value, noise))
        found.append(Light(value, noise, u, v, float(scene.area[face]), int(sides[face]), bool(scene.is_quad[face])))
    return found
