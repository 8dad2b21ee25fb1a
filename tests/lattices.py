"""Scenes of a flat wall for tests of lattices, and fields over them."""

import numpy as np

import radiosity as rd

WIDE, HIGH = 3.0, 2.0


def wall(columns: int, rows: int, *, triangles: bool = False, turned: int = 0, without=(), surface=None, **more) -> rd.Scene:
    """A wall of columns x rows equal faces, each beginning at another corner if ``turned``.

    Args:
        triangles: two triangles in place of each parallelogram.
        without: the numbers of parallelograms to leave out.
        surface: (columns * rows,) int, the surface of each parallelogram.
    """
    x, y = np.meshgrid(np.linspace(0, WIDE, columns + 1), np.linspace(0, HIGH, rows + 1))
    vertices = np.stack([x, y, 0 * x], axis=2).reshape(-1, 3)
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    faces = corner[:, None] + np.array([0, 1, columns + 2, columns + 1])
    faces = np.delete(faces, list(without), axis=0)
    surface = np.zeros(len(faces), int) if surface is None else np.asarray(surface)
    if triangles:
        faces = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
        surface = np.tile(surface, 2)
    corners = faces.shape[1]
    turns = turned * np.arange(len(faces)) % corners
    faces = np.take_along_axis(faces, (np.arange(corners) + turns[:, None]) % corners, axis=1)
    names = [f"part {number}" for number in range(surface.max() + 1)]
    return rd.Scene.from_arrays(vertices, faces, 0.5, 1.0, surface=surface, names=names, **more)


def fields(patches) -> dict[str, np.ndarray]:
    """Fields over a wall, (n_patches,) each: smooth ones, a kink, the edge of a shadow, and a highlight."""
    x, y = patches.centroid[:, 0] / WIDE, patches.centroid[:, 1] / HIGH
    away = (x - 0.4) ** 2 + (y - 0.55) ** 2
    return {
        "linear": 1 + 0.5 * x - 0.3 * y,
        "smooth": 1 + 0.6 * np.cos(2 * x) * np.cos(1.5 * y),
        "lamp": 1 / (1 + 4 * away) ** 2,
        "kink": 1 + np.maximum(0, x + 0.5 * y - 0.8),
        "step": np.where(x + 0.3 * y > 0.63, 1.0, 0.3),
        "highlight": 0.5 + 2 * np.exp(-away / 2 / 0.04**2),
    }


def near_the_step(patches) -> np.ndarray:
    """Patches within about three cells of the edge of the shadow in a wall of 34 x 34, (n_patches,) bool."""
    x, y = patches.centroid[:, 0] / WIDE, patches.centroid[:, 1] / HIGH
    return np.abs(x + 0.3 * y - 0.63) < 0.1
