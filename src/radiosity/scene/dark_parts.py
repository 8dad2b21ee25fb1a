"""Dark sides within surfaces that light reaches on both sides, as a room and a table top that are one surface of an STL file.

Parts of a surface that are connected by their corners are looked at first, then each face.
"""

import numpy as np

from .model import Back, Scene
from .reached import MANY, Lit
from .topology import weld

EXPECTED = 12  # a side is dark where it has no hit, and would have this many if it were as dim as its surface's dimmer sides


def dark_parts(scene: Scene, reached: np.ndarray, kind: np.ndarray) -> np.ndarray:
    """Return the dark fronts and backs of two-sided faces on surfaces of `Lit.BOTH`, (n_faces, 2) bool.

    Args:
        reached: (n_faces, 2) lines that hit fronts and backs.
        kind: (n_surfaces,) the `Lit` of each surface.
    """
    dark = np.zeros((scene.n_faces, 2), bool)
    open_question = (scene.back == Back.RADIATES) & (kind[scene.surface] == Lit.BOTH)
    less, more = reached.min(axis=1), reached.max(axis=1)
    if not (open_question & (less == 0) & (more >= MANY)).any() or not (open_question & (less > 0)).any():
        return dark
    faces, n = np.flatnonzero(open_question), len(scene.names)
    surface, area, less, more = scene.surface[faces], scene.area[faces], less[faces], more[faces]
    twice = less > 0
    lit_area = np.bincount(surface, np.where(twice, area, 0), n)
    density = np.bincount(surface, less, n) / np.where(lit_area > 0, lit_area, 1)  # lines by area on the dimmer sides
    for group in (_parts(scene, faces), np.arange(len(faces))):
        size = group.max() + 1
        expected = np.bincount(group, area * density[surface], size)
        found = (np.bincount(group, less, size) == 0) & (np.bincount(group, more, size) >= MANY) & (expected >= EXPECTED)
        here = faces[found[group]]
        back_is_less = reached[here, 0] >= reached[here, 1]
        dark[here, back_is_less.astype(int)] = True
    return dark


def _parts(scene: Scene, faces: np.ndarray) -> np.ndarray:
    """Return the number of each face's set, (k,) int; a set is faces of one surface that are connected by corners."""
    corners = weld(scene)[faces]
    keys = np.where(corners >= 0, scene.surface[faces, None] * (corners.max() + 1) + corners, -1)
    keys = np.where(keys < 0, keys[:, :1], keys)
    corner = np.unique(keys, return_inverse=True)[1].reshape(keys.shape)
    label = np.arange(corner.max() + 1)
    while True:
        before = label
        least = label[corner].min(axis=1)
        label = label.copy()
        np.minimum.at(label, corner, least[:, None])
        label = label[label]
        if (label == before).all():
            return np.unique(label[corner[:, 0]], return_inverse=True)[1]
