"""A camera for a scene that has none: the one of several places, inside and outside, that sees most."""

from itertools import product

import numpy as np

from ..patches import Patches
from ..scene import Camera, Scene
from ..scene.up import up_axis
from . import tone
from .lookup import Lookup
from .view import directions

SMALL = (40, 30)  # pixels of the picture by which a candidate is judged
INSIDE_FOV, OUTSIDE_FOV = 65.0, 40.0  # degrees, vertical
CORNERS, EYES = (0.04, 0.15), (0.5, 0.75)  # distance from the bounding box's corners, and height, as a part of its sides
GRID, EYE = (0.1, 0.3, 0.5, 0.7, 0.9), 0.6  # places all over the box, for buildings of several rooms, and their height
FALL = 0.15  # slope by which the views from there look down
FAR = 0.6  # of the box's mean side: typical distances below this make a view worse
DIM = 0.02  # of a well-lit patch's radiosity: patches below it count as dark


def fitted(patches: Patches, light: np.ndarray, hits, *, width: int = 800, height: int = 600) -> Camera:
    """Return the candidate that shows most lit surface, of as many surfaces as possible, and not from too near.

    Args:
        patches: of the solution.
        light: (n_patches,) radiosity; NaN counts as dark.
        hits: ``hits(scene, origins, directions)``, see `radiosity.image.render`.
        width, height: of the picture, pixels.
    """
    scene, level = patches.scene, np.nan_to_num(light)
    well_lit = tone.LEVEL / tone.automatic_scale(level[:, None], patches.area)
    cameras = candidates(scene, width / height)
    x, y = (points.ravel() + 0.5 for points in np.meshgrid(np.arange(SMALL[0]), np.arange(SMALL[1])))
    rays = np.concatenate([directions(camera, x, y) for camera in cameras])
    seen = hits(scene, np.repeat([camera.origin for camera in cameras], len(x), axis=0), rays)
    patch = Lookup(patches, level[:, None], smooth=False).patch(seen).reshape(len(cameras), -1)
    lit = (patch >= 0) & (level[patch] > DIM * well_lit)
    distance = np.asarray(seen.distance).reshape(patch.shape) / np.mean(np.ptp(scene.bounds, axis=0))
    scores = [_score(patches.surface[p[on]], d[on], on.mean()) for p, d, on in zip(patch, distance, lit, strict=True)]
    best = cameras[int(np.argmax(scores))]
    return Camera(best.origin, best.target, best.up, best.fov, width, height)


def candidates(scene: Scene, aspect: float) -> list[Camera]:
    """Return cameras inside, near the corners of the bounding box, all over it, and outside, in front of its corners."""
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
        away = np.where(corner > 0, 0.35, 0.65)
        away[axis] = 0.4
        places = []
        for inset, eye in product(CORNERS, EYES):
            place = np.where(corner > 0, 1 - inset, inset)
            place[axis] = eye
            places.append((place, away))
        result += [_camera(low + place * size, low + target * size, up, INSIDE_FOV) for place, target in places]
        along = np.where(corner > 0, -1, 1) * size * (1 - up)
        along -= FALL * np.linalg.norm(along) * up
        for place in product(GRID, repeat=2):
            middle = np.full(3, EYE)
            middle[level] = place
            result.append(_camera(low + middle * size, low + middle * size + along, up, INSIDE_FOV))
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
    return Camera((x, y, z), (a, b, c), (i, j, k), fov, *SMALL)


def _score(surface: np.ndarray, distance: np.ndarray, lit: float) -> float:
    """Return the score of a view whose lit pixels show these surfaces at these distances (in mean sides of the box)."""
    if lit == 0:
        return 0.0
    counts = np.bincount(surface)
    share = counts[counts > 0] / len(surface)
    variety = np.exp(-(share * np.log(share)).sum())  # the number of surfaces, if they were seen equally well
    return float(lit * np.sqrt(variety * min(1.0, float(np.median(distance)) / FAR)))
