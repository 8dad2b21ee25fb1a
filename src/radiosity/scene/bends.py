"""Parallelograms over which texture coordinates are not linear become two triangles, over which they are.

Other programs cut all quadrilaterals so.
"""

from dataclasses import replace

import numpy as np

from .arrays import PARALLEL_TOLERANCE
from .parts import Part


def straightened(part: Part) -> Part:
    """A part whose parallelograms are cut from their first corner to their third where its textures need it.

    They need it where texture coordinates are not linear, or where corner colours that multiply an image are not.
    """
    faces = np.asarray(part.faces)
    if faces.shape[1] == 3 or not (faces[:, 3] >= 0).any():
        return part
    held = [part.uv if part.emission_uv is None else part.emission_uv] if part.emission_texture is not None else []
    held += [part.uv, part.color] if part.texture is not None and part.uv is not None else []
    if not held:
        return part
    quads = faces[:, 3] >= 0
    corners = faces[quads]
    bent = np.zeros(len(corners), bool)
    for values in held:
        if values is not None:
            bent |= ~is_linear(np.moveaxis(np.asarray(values, np.float64)[corners], 1, 0))
    points = np.asarray(part.vertices, np.float64)[corners]
    size = np.linalg.norm(points[:, [1, 3]] - points[:, [0]], axis=2).max(axis=1)
    off = np.linalg.norm(points[:, 0] + points[:, 2] - points[:, 1] - points[:, 3], axis=1)
    bent &= off <= PARALLEL_TOLERANCE * size  # others are cut anyway
    if not bent.any():
        return part
    cut = np.zeros(len(faces), bool)
    cut[quads] = bent
    rows = np.repeat(np.arange(len(faces)), 1 + cut)
    second = np.append(False, rows[1:] == rows[:-1])
    result = faces[rows].copy()
    for halves, order in ((cut[rows] & ~second, [0, 1, 2]), (second, [0, 2, 3])):
        result[halves] = np.column_stack([result[halves][:, order], np.full(halves.sum(), -1)])
    return replace(part, faces=result)


def is_linear(corners: np.ndarray) -> np.ndarray:
    """Return whether values at the four corners of parallelograms, (4, m, k), are those of a linear function, (m,) bool."""
    one, two, three, four = corners
    extent = np.ptp(corners, axis=0).max(axis=1, initial=0)
    largest = np.abs(corners).max(axis=(0, 2), initial=0)
    return ~(np.abs(one - two + three - four).max(axis=1, initial=0) > tolerance(extent, largest))


def tolerance(extent: np.ndarray, largest: np.ndarray) -> np.ndarray:
    """The error that texture coordinates may have: a share of their extent, and the rounding of single precision."""
    return 1e-5 * extent + 5e-7 * largest
