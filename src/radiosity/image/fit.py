"""A camera for a scene that has none: of several places inside and outside, the one that sees most."""

from itertools import product

import numpy as np

from ..patches import Patches
from ..scene import Camera, Scene
from .lookup import Lookup
from .view import directions, up_axis

TRIAL = (40, 30)  # pixels of a trial picture
INSIDE_FOV, OUTSIDE_FOV = 65.0, 40.0  # degrees, vertical
INSETS = (0.04, 0.15)  # from the corners of the bounding box, as a part of its sides
HEIGHTS = (0.5, 0.75)  # of the eye, as a part of the box's height
NEAR = 0.15  # of the box's mean side: a view whose typical distance is below this is blocked


def fitted(patches: Patches, light: np.ndarray, hits, *, width: int = 800, height: int = 600) -> Camera:
    """The candidate that shows most lit surface, of as many surfaces as possible, and not from too near.

    Args:
        patches: of the solution.
        light: (n_patches,) what they radiate; NaN counts as dark.
        hits: ``hits(scene, origins, directions)``, see `radiosity.image.render`.
        width, height: of the picture, pixels.
    """
    look = Lookup(patches, np.nan_to_num(light)[:, None], smooth=False)
    cameras = [*candidates(patches.scene, width / height)]
    scores = [_score(look, camera, hits) for camera in cameras]
    best = cameras[int(np.argmax(scores))]
    return Camera(best.origin, best.target, best.up, best.fov, width, height)


def candidates(scene: Scene, aspect: float) -> list[Camera]:
    """Cameras inside, near the corners of the bounding box, and outside, before its corners."""
    low, high = scene.bounds
    size = np.maximum(high - low, 1e-6 * np.max(high - low))
    axis = "xyz".index(up_axis(scene))
    level = [i for i in range(3) if i != axis]
    up = np.eye(3)[axis]
    centre = (low + high) / 2
    result = []
    for one, two in product((0, 1), repeat=2):
        corner = np.zeros(3)
        corner[level] = one, two
        for inset, eye in product(INSETS, HEIGHTS):
            part = np.where(corner > 0, 1 - inset, inset)
            target = np.where(corner > 0, 0.35, 0.65)
            part[axis], target[axis] = eye, 0.4
            result.append(_camera(low + part * size, low + target * size, up, INSIDE_FOV))
    radius = np.linalg.norm(size) / 2
    narrow = np.arctan(np.tan(np.deg2rad(OUTSIDE_FOV) / 2) * min(1.0, aspect))
    for one, two, rise in product((-1, 1), (-1, 1), (0.6, -0.6)):
        view = np.zeros(3)
        view[level] = one, two * 0.8  # not along the diagonal, where edges would fall onto each other
        view[axis] = rise
        result.append(_camera(centre + view / np.linalg.norm(view) * radius / np.sin(narrow), centre, up, OUTSIDE_FOV))
    return result


def _camera(origin, target, up, fov) -> Camera:
    (x, y, z), (a, b, c), (i, j, k) = (np.asarray(v, np.float64).tolist() for v in (origin, target, up))
    return Camera((x, y, z), (a, b, c), (i, j, k), fov, *TRIAL)


def _score(look: Lookup, camera: Camera, hits) -> float:
    x, y = np.meshgrid(np.arange(TRIAL[0]) + 0.5, np.arange(TRIAL[1]) + 0.5)
    rays = directions(camera, x.ravel(), y.ravel())
    seen = hits(look.patches.scene, np.broadcast_to(camera.origin, rays.shape).copy(), rays)
    values, patch = look(seen)
    lit = (patch >= 0) & (values[:, 0] > 0)
    if not lit.any():
        return 0.0
    counts = np.bincount(look.patches.surface[patch[lit]])
    share = counts[counts > 0] / lit.sum()
    variety = np.exp(-(share * np.log(share)).sum())  # the number of surfaces, were they seen equally well
    side = float(np.mean(np.ptp(look.patches.scene.bounds, axis=0)))
    room = min(1.0, float(np.median(np.asarray(seen.distance)[lit])) / (NEAR * side))
    return float(lit.mean() * np.sqrt(variety) * room)
