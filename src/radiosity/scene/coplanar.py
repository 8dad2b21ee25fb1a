"""Faces that lie on each other within what single precision holds apart, however they are cut.

Copies are faces with the very same corners in the same order. The first copy stands for all: only it is compared with other
faces, and each copy with it. So a million copies are a million pairs, not half a billion.
"""

import warnings
from weakref import WeakKeyDictionary

import numpy as np

from ..errors import RadiosityWarning
from ..pieces import of_pieces
from .contacts import Contacts
from .equal_keys import follows, mixed, sort
from .flat_pieces import flat_pieces, numbered
from .model import Scene
from .neighbours import Plates, pairs
from .overlap import common, overlapping
from .precision import EPSILON
from .welded import welded

SIZE = 1 << 14  # faces at a time
ONE_PLANE = 4  # ulps: faces nearer than this where they overlap lie in one plane
NEAR = 8  # ulps: distance in front of their face where lines begin (tracing/geometry.py); they miss faces that are nearer
WIDTH = 32  # ulps: the common part of faces is wider than that, and than SLIVER of the smaller one's longest edge
SLIVER = 1e-5
MOST = 1 << 24  # pairs

_known: "WeakKeyDictionary[Scene, Contacts]" = WeakKeyDictionary()


def contacts(scene: Scene) -> Contacts:
    """The pairs of a scene; they are found once."""
    if scene not in _known:
        _known[scene] = _find(scene)
    return _known[scene]


def copied(scene: Scene) -> np.ndarray:
    """Return the first face with the same corners in the same order, or else the face itself, (n_faces,) int64.

    A pane stands for others only where none of them is opaque.
    """
    return _copied(scene, _corners(scene), _places(scene))


def _copied(scene: Scene, corners: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Return what `copied` does, of corners, (n_faces, 4, 3), and their `_places`."""
    if not _repeats(place):
        return np.arange(scene.n_faces)
    rows = corners.reshape(scene.n_faces, 12)
    order = np.argsort(scene.panes, kind="stable")
    _, first, number = np.unique(numbered(rows)[order], return_index=True, return_inverse=True)
    place = np.empty(len(order), np.int64)
    place[order] = number.ravel()
    first = order[first][place]
    return np.where((rows == rows[first]).all(axis=1), first, np.arange(scene.n_faces))


def _repeats(place: np.ndarray) -> bool:
    """Return whether two faces may have the very same corners."""
    bits = max(len(place) - 1, 1).bit_length()
    low, keys = np.uint64((1 << bits) - 1), np.zeros(len(place), np.uint64)
    for column in place.T:
        keys = mixed(keys + column.view(np.uint64))
    keys &= ~low
    sort(keys)
    return bool(follows(keys, bits).any())


def _four(scene: Scene) -> np.ndarray:
    """Return the vertices of faces, (n_faces, 4) int64; triangles repeat the third."""
    return np.where(scene.faces < 0, scene.faces[:, 2:3], scene.faces)


def _corners(scene: Scene) -> np.ndarray:
    """Return the corners about the centre, (n_faces, 4, 3) metres; triangles repeat the third."""
    return (scene.vertices - scene.centre).take(_four(scene), axis=0)


def _places(scene: Scene) -> np.ndarray:
    """Return numbers that are equal where corners about the centre are, and only there, (n_faces, 4) int64."""
    number = welded(scene.vertices - scene.centre)
    return _four(scene) if number is None else number.take(_four(scene))


def _find(scene: Scene) -> Contacts:
    corners, place = _corners(scene), _places(scene)
    first = _copied(scene, corners, place)
    alone = first == np.arange(scene.n_faces)
    parts, two = _compared(scene, corners, place, np.flatnonzero(alone)), np.flatnonzero(~alone)
    if len(two):
        ulp = EPSILON * np.maximum(np.abs(corners[two]).max(axis=(1, 2)), scene.plane_reach[two])
        yes = np.ones(len(two), bool)
        low, high = np.minimum(first[two], two), np.maximum(first[two], two)
        parts.append(Contacts(low, high, np.zeros(len(two)), ulp, np.ones(len(two)), yes, yes))
    return Contacts.joined(parts)


def _compared(scene: Scene, corners: np.ndarray, place: np.ndarray, faces: np.ndarray) -> list[Contacts]:
    """The pairs among some faces, in parts."""
    longest, reach, low, high, middle = _sizes(corners)
    margin = NEAR * EPSILON * np.maximum(reach, scene.plane_reach)
    height = scene.area * np.where(scene.is_quad, 1, 2) / longest
    least = np.maximum(WIDTH * EPSILON * reach, SLIVER * longest)
    tilt = 2 * margin / height
    piece = flat_pieces(place, scene.normal, tilt, faces)
    plates = Plates(low, high, scene.normal, middle, tilt, margin, least, piece)
    parts, found = [], 0
    for small, large in pairs(plates, faces):
        rows = _parallel(plates, corners, small, large)
        parts.append(_measured(scene, corners, least, small[rows], large[rows]))
        found += len(parts[-1].one)
        if found > MOST:
            warnings.warn(
                f"{scene.source}: more than {MOST} pairs of faces lie on each other; which of the others a line meets is left to "
                "chance: remove copies of faces",
                RadiosityWarning,
                stacklevel=3,
            )
            break
    return parts


def _sizes(corners: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return longest edges, the largest coordinates, (n,), and the lowest, highest and mean coordinates of corners, (n, 3)."""
    n = len(corners)
    longest, reach = np.empty(n), np.empty(n)
    low, high, middle = (np.empty((n, 3)) for _ in range(3))

    def measure(part: slice) -> None:
        one, two, three, four = places = [np.ascontiguousarray(corners[part, k].T) for k in range(4)]
        squared = [_squared(places[(k + 1) % 4] - places[k]) for k in range(4)]
        longest[part] = np.sqrt(np.maximum(np.maximum(squared[0], squared[1]), np.maximum(squared[2], squared[3])))
        lowest = np.minimum(np.minimum(one, two), np.minimum(three, four))
        highest = np.maximum(np.maximum(one, two), np.maximum(three, four))
        reach[part] = np.maximum(-lowest, highest).max(axis=0)
        low[part], high[part] = lowest.T, highest.T
        middle[part] = ((one + two + three + four) / 4).T

    of_pieces(measure, n, SIZE)
    return longest, reach, low, high, middle


def _squared(vectors: np.ndarray) -> np.ndarray:
    x, y, z = vectors
    return x * x + y * y + z * z


def _parallel(plates: Plates, corners: np.ndarray, small: np.ndarray, large: np.ndarray) -> np.ndarray:
    """The rows of pairs that are parallel and in one plane, within their uncertainty."""
    normal = plates.normal
    turned = np.linalg.norm(np.cross(normal[small], normal[large]), axis=1)
    rows = np.flatnonzero(turned <= 2 * (plates.tilt[small] + plates.tilt[large]) + EPSILON)
    small, large = small[rows], large[rows]
    height = np.einsum("mki,mi->mk", corners[small] - corners[large][:, :1], normal[large])
    margin = plates.margin[small] + plates.margin[large]
    return rows[(height.min(axis=1) <= margin) & (height.max(axis=1) >= -margin)]


def _measured(scene: Scene, corners: np.ndarray, least: np.ndarray, small: np.ndarray, large: np.ndarray) -> Contacts:
    """The pairs that overlap and are nearer than `NEAR` ulps."""
    normal = scene.normal
    first = corners[large, 1] - corners[large, 0]
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    basis = np.stack([first, np.cross(normal[large], first)], axis=2)
    below, above = (np.einsum("mki,mij->mkj", corners[face] - corners[large][:, :1], basis) for face in (large, small))
    rows = np.flatnonzero(overlapping(below, above, least[small]))
    small, large, basis = small[rows], large[rows], basis[rows]
    shape, area = common(below[rows], above[rows])
    points = corners[large][:, :1] + np.einsum("mkj,mij->mki", shape, basis)
    exact = _height(corners, normal[large], small, points) - _height(corners, normal[large], large, points)
    rounded = corners.astype(np.float32).astype(np.float64)  # as the BVH has them
    told = _height(rounded, normal[large], small, points) - _height(rounded, normal[large], large, points)
    most = np.take_along_axis(exact, np.abs(exact).argmax(axis=1)[:, None], axis=1)[:, 0]
    place = np.maximum(scene.plane_reach[small], scene.plane_reach[large])
    ulp = EPSILON * np.maximum(np.abs(points).max(axis=(1, 2)), place)
    same = np.einsum("ij,ij->i", normal[small], normal[large]) > 0
    turn = small < large  # then the larger one is `two`, and its height is measured along the normal of the smaller
    gap = np.where(turn, np.where(same, -most, most), most)
    share = area / np.minimum(scene.area[small], scene.area[large])
    every = Contacts(
        np.minimum(small, large), np.maximum(small, large), gap, ulp, share, np.abs(told).max(axis=1) <= ONE_PLANE * ulp, same
    )
    return every.take(np.minimum(np.abs(exact), np.abs(told)).max(axis=1) <= NEAR * ulp)


def _height(corners: np.ndarray, along: np.ndarray, face: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the distances from points, along a direction, to the planes of faces, (m, k)."""
    origin, second, third, fourth = corners[face].transpose(1, 0, 2)
    last = np.where((third == fourth).all(axis=1)[:, None], third, fourth)
    normal = np.cross(second - origin, last - origin)
    return np.einsum("mki,mi->mk", origin[:, None] - points, normal) / np.einsum("mi,mi->m", normal, along)[:, None]
