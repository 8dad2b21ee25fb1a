"""Scenes whose faces are the cells of patches, so that each cell can be cut by itself."""

import numpy as np

from ..scene.model import Scene
from ..scene.split import split
from . import cells
from .model import Patches


def cells_as_faces(patches: Patches) -> Scene:
    """Return the scene whose faces are the cells of patches, in their order (both sides of a cell are one face)."""
    front = np.flatnonzero(~patches.is_back)
    face = patches.face[front]
    column, row, inverted = (values[front] for values in patches.place)
    quad = patches.scene.is_quad[face]
    corners = cells.corners(column, row, inverted, patches.columns[face], patches.rows[face], quad)
    return split(patches.scene, face, corners)
