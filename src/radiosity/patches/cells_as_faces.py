"""Scenes whose faces are the cells of patches, so that each cell can be cut by itself."""

import numpy as np

from ..scene.model import Scene
from ..scene.split import split
from .model import Patches


def cells_as_faces(patches: Patches) -> Scene:
    """Return the scene whose faces are the cells of patches (both sides of a cell are one face), in the order of their faces.

    In a triangle, two cells that share an inner edge across its first corner are one parallelogram. Parallelograms can be cut
    across the direction in which light varies.
    """
    column, row, inverted = patches.place
    cells = np.flatnonzero(~patches.is_back & ~inverted)
    face, column, row = patches.face[cells], column[cells], row[cells]
    columns, rows = patches.columns[face], patches.rows[face]
    pair = patches.scene.is_quad[face] | (column + row + 1 < columns)
    x = column[:, None] + np.where(pair[:, None], [0, 1, 1, 0], [0, 1, 0, 0])
    y = row[:, None] + np.where(pair[:, None], [0, 0, 1, 1], [0, 0, 1, 1])
    return split(patches.scene, face, np.stack([x / columns[:, None], y / rows[:, None]], axis=2))


def turned(scene: Scene) -> Scene:
    """Return the scene whose triangles begin at the corner that is nearest to a right angle, as sides of their cells."""
    edges = scene.vertices[scene.faces[:, [1, 2, 0]]] - scene.vertices[scene.faces[:, :3]]
    back = -np.roll(edges, 1, axis=1)
    cosine = np.einsum("mki,mki->mk", edges, back) / np.linalg.norm(edges, axis=2) / np.linalg.norm(back, axis=2)
    first = np.where(scene.is_quad, 0, np.abs(cosine).argmin(axis=1))
    triangle = np.array([[0.0, 0], [1, 0], [0, 1]])
    corners = np.stack([np.roll(triangle, -k, axis=0)[[0, 1, 2, 2]] for k in range(3)])[first]
    corners[scene.is_quad] = [[0, 0], [1, 0], [1, 1], [0, 1]]
    return split(scene, np.arange(scene.n_faces), corners)
