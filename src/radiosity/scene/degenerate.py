"""Faces without area are found and left out."""

import warnings

import numpy as np

from ..errors import RadiosityWarning, SceneError, shown
from .measures import heights
from .precision import EPSILON

RESOLUTION = 4 * EPSILON  # share of the distance from the scene's centre that the BVH can tell apart

# Least value of twice a face's area over the square of the scene's reach. The BVH's scene reaches to 2^20 (tracing/bvh.py);
# there Embree divides by numbers so close to zero for smaller faces that the places of hits would be wrong.
SMALLEST = 4e-27

WIDER = 1 + 1e-6  # than the box: no rounding of the centre matters


def leave_out(scene):
    """The `Scene` of the faces of ``scene`` that have an area; see `Scene.without_degenerate_faces`."""
    if scene.n_faces == 0:
        raise SceneError(f"{scene.source}: the scene has no faces; add geometry")
    bad = without_area(scene)
    if not bad.any():
        return scene
    counts = np.bincount(scene.surface[bad], minlength=len(scene.names))
    where = shown([scene.names[s] for s in np.flatnonzero(counts)])
    total = int(bad.sum())
    if bad.all():
        raise SceneError(
            f"{scene.source}: no face is left: all {total} have no area (surfaces {where}); check the unit and the file"
        )
    lights = int((scene.emission[bad] > 0).any(axis=1).sum())
    warnings.warn(
        f"{scene.source}: {total} face{'s' if total > 1 else ''} without area left out (first: face "
        f"{int(np.flatnonzero(bad)[0])}; surfaces {where}{f'; {lights} of them should emit light' if lights else ''})",
        RadiosityWarning,
        stacklevel=3,
    )
    return scene.take(~bad)


def without_area(scene) -> np.ndarray:
    """Return which faces of a `Scene` count as faces without area, (n_faces,) bool.

    Their height over their longest edge is below the resolution where they lie, or their area is below what lines can tell apart
    beside the size of the scene.
    """
    measures = scene.measures
    farthest = WIDER * float(np.ptp(measures.bounds, axis=0).max())  # the reach from any centre is less
    if measures.least_doubled > SMALLEST * farthest**2 and measures.least_height > RESOLUTION * farthest:
        return np.zeros(scene.n_faces, bool)
    reach, height = scene.reach, heights(scene.vertices, scene.faces)
    doubled = measures.area * np.where(scene.is_quad, 1, 2)
    bad = doubled <= SMALLEST * reach**2
    thin = np.flatnonzero(height <= RESOLUTION * reach)
    near = np.abs(scene.vertices[scene.faces[thin, :3]] - scene.centre).max(axis=(1, 2), initial=0)
    bad[thin] |= height[thin] <= RESOLUTION * near
    return bad
