"""A closed box of any number of faces in three colours, for `scale.py`."""

import numpy as np

from radiosity import Scene

SIZE = (4.0, 3.0, 2.5)  # metres


def box(about: int) -> Scene:
    """Return a box of about so many rectangles, whose ceiling has a lamp in the middle."""
    k = max(1, round((about / 6) ** 0.5))
    step = np.linspace(0.0, 1.0, k + 1)
    u, v = (axis.ravel() for axis in np.meshgrid(step, step, indexing="ij"))
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(k), np.arange(k), indexing="ij"))
    corner = i * (k + 1) + j
    inwards = np.stack([corner, corner + k + 1, corner + k + 2, corner + 1], axis=1)
    vertices, faces = [], []
    for axis in range(3):
        for side in (0, 1):
            place = np.empty((len(u), 3))
            place[:, axis], place[:, (axis + 1) % 3], place[:, (axis + 2) % 3] = side, u, v
            faces.append((inwards if side == 0 else inwards[:, ::-1]) + len(u) * len(faces))
            vertices.append(place * SIZE)
    surface = np.repeat(np.arange(6), k * k)
    reflectance = np.array(
        [[0.7, 0.3, 0.2], [0.2, 0.3, 0.7], [0.5, 0.6, 0.5], [0.6, 0.6, 0.5], [0.3, 0.25, 0.2], [0.8, 0.8, 0.8]]
    )
    emission = np.zeros((len(surface), 3))
    middle = (np.abs(i + 0.5 - k / 2) <= max(k / 8, 0.5)) & (np.abs(j + 0.5 - k / 2) <= max(k / 8, 0.5))
    emission[surface == 5] = np.where(middle[:, None], [30.0, 28.0, 25.0], 0.0)
    names = ("west", "east", "south", "north", "floor", "ceiling")
    return Scene.from_arrays(
        np.concatenate(vertices), np.concatenate(faces), reflectance[surface], emission, surface=surface, names=names
    )
