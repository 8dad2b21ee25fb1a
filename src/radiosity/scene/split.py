"""Scenes whose faces are parts of another scene's faces."""

from dataclasses import replace

import numpy as np

from .cut import Cut
from .model import Scene
from .paint import Paint, between


def split(scene: Scene, face: np.ndarray, corners: np.ndarray, region: np.ndarray | None = None) -> Scene:
    """Return the scene of parts of faces, with the same light at each point.

    Args:
        face: (m,) the face that each part lies in; parts of a face stand together.
        corners: (m, 4, 2) their face coordinates, counterclockwise; a triangle repeats its third. Parts of a face with colours or
            texture coordinates that are not linear over it (`bent`) have edges along those of the face.
        region: (m,) int64 numbers of parts that no contact line holds apart; None: those of the faces that are cut.
    """
    is_triangle = (corners[:, 2] == corners[:, 3]).all(axis=1)
    origin, first, second = (edge[face][:, None] for edge in scene.frames)
    points = origin + corners[:, :, :1] * first + corners[:, :, 1:] * second
    vertices, number = np.unique(points.reshape(-1, 3), axis=0, return_inverse=True)
    faces = number.reshape(-1, 4)
    faces[is_triangle, 3] = -1
    taken, before = scene.take(face), scene.cut
    if region is None:
        region = np.arange(scene.n_faces)[face] if before is None else before.region[face]
    cut = Cut(scene.hash if before is None else before.whole, face if before is None else before.face[face], region)
    paints = {
        name: paint and _painted(paint, scene, face, corners)
        for name in ("reflectance_paint", "emission_paint")
        for paint in [getattr(scene, name)]
    }
    return replace(taken, vertices=vertices, faces=faces.astype(np.int64), cut=cut, **paints)


def bent(scene: Scene) -> np.ndarray:
    """Return faces over which colours or texture coordinates are not linear, (n_faces,) bool: some painted parallelograms."""
    result = np.zeros(scene.n_faces, bool)
    for paint in (scene.reflectance_paint, scene.emission_paint):
        if paint is not None:
            for corner in (paint.uv.astype(np.float64), paint.color):
                twist = np.abs(corner[:, 0] - corner[:, 1] + corner[:, 2] - corner[:, 3]).max(axis=1)
                result |= twist > 1e-6 * np.abs(corner).max(axis=(1, 2))
    return result & scene.is_quad


def _painted(paint: Paint, scene: Scene, face: np.ndarray, corners: np.ndarray) -> Paint:
    """Return the paint of parts: what the face has at their corners."""
    quad = scene.is_quad[face]

    def at(values: np.ndarray) -> np.ndarray:
        parts = [between(values[face].astype(np.float64), quad, corners[:, i, 0], corners[:, i, 1]) for i in range(4)]
        return np.stack(parts, axis=1).astype(values.dtype)

    return replace(paint, image=paint.image[face], uv=at(paint.uv), color=at(paint.color))
