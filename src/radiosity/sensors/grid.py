"""Grids of sensors on a plane in front of a surface."""

from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from ..errors import SceneError, shown
from ..scene.model import Back, Scene
from ..scene.up import up_vector
from .limits import LARGEST

FLAT = 1e-3  # cosine less than one: faces whose normals differ by more lie in another plane
MOST = 1_000_000  # sensors of a grid
LONG = 2.0  # ratio of sides from which on the shorter one counts (EN 12464-1, 4.4)
ALIKE = 0.99  # of the largest plane's area: planes that are as large
INSIDE = 1e-9
BINS = 900  # of a right angle, in which edges are sorted


def spacing_of(longer: float, shorter: float) -> float:
    """Return how far apart points of a grid may lie at most, m: p = 0.2 * 5^(log10 d), and 10 m at most (EN 12464-1, 4.4).

    Here d is the longer side of the area, or the shorter one where the longer is twice as long or more.
    """
    d = longer if longer < LONG * shorter else shorter
    return min(0.2 * 5 ** np.log10(d), 10.0)


@dataclass(frozen=True, eq=False)
class Grid:
    """Points of a grid: (n, 3) m; the plane's normal, (3,); row and column of each point, (n, 2); and how far apart they are."""

    points: np.ndarray
    normal: np.ndarray
    cells: np.ndarray
    steps: np.ndarray


def grid(scene: Scene, surface: str, height: float, spacing: float | None, margin: float) -> Grid:
    """Make a grid of points on a plane in front of a surface, see `Sensors.grid`."""
    chosen = [number for number, one in enumerate(scene.names) if one == surface]
    chosen = chosen or [number for number, one in enumerate(scene.names) if fnmatchcase(one, surface)]
    faces = np.flatnonzero(np.isin(scene.surface, chosen))
    if not len(faces):
        raise SceneError(f"{scene.source}: no surface is called '{surface}'; there are {shown(scene.names, 20)}")
    for what, value, least in (("height", height, -LARGEST), ("margin", margin, 0.0)):
        if not least <= value < LARGEST:
            raise SceneError(f"grid of '{surface}': {what} is {value:g} m; it must be a number from {least:g} to {LARGEST:g}")
    if spacing is not None and not 0 < spacing < LARGEST:
        raise SceneError(f"grid of '{surface}': spacing is {spacing:g} m; it must be positive")
    normals = scene.normal[faces].copy()
    both = scene.back[faces] == Back.RADIATES
    up = np.array(up_vector(scene))
    normals[both & (normals @ up < -INSIDE)] *= -1
    faces, normal = _largest_plane(scene, faces, normals, up)
    polygons = _polygons(scene, faces)
    first, second = _axes(polygons, normal)
    flat = np.stack([polygons @ first, polygons @ second], axis=-1)
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    size = high - low - 2 * margin
    if not (size > 0).all():
        raise SceneError(f"grid of '{surface}': a margin of {margin:g} m leaves nothing of {np.round(high - low, 3).tolist()} m")
    apart = spacing_of(float(size.max()), float(size.min())) if spacing is None else float(spacing)
    counts = np.maximum(np.ceil(size / apart - 1e-9), 1)
    if counts.prod() > MOST:
        raise SceneError(
            f"grid of '{surface}': a spacing of {apart:g} m makes {counts.prod():.3g} sensors; the most are {MOST:,}"
        )
    steps = size / counts
    row, column = (axis.ravel() for axis in np.indices(counts[::-1].astype(int)))
    places = low + margin + (np.column_stack([column, row]) + 0.5) * steps
    inside = _inside(places, flat)
    if margin:
        for angle in np.arange(16) * (np.pi / 8):
            inside &= _inside(places + margin * (1 - INSIDE) * np.array([np.cos(angle), np.sin(angle)]), flat)
    if not inside.any():
        raise SceneError(f"grid of '{surface}': no point of it lies within the surface; take a smaller spacing than {apart:g} m")
    places, cells = places[inside], np.column_stack([row, column])[inside]
    plane = float((polygons @ normal).mean()) + height
    points = places[:, :1] * first + places[:, 1:] * second + plane * normal
    return Grid(points, normal, cells, steps)


def _largest_plane(scene: Scene, faces: np.ndarray, normals: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the faces in the plane with the largest area, and its normal. Of planes that are as large, such as the two of a
    slab, it is the one that looks up most, then the highest."""
    origin = scene.vertices[scene.faces[faces, 0]]
    height = (origin * normals).sum(axis=1)
    left, planes, largest = np.arange(len(faces)), [], 0.0
    near = 1e-6 * max(float(np.abs(height).max()), float(np.sqrt(scene.area[faces].max())))
    while len(left):
        one = left[np.argmax(scene.area[faces[left]])]
        same = (normals[left] @ normals[one] > 1 - FLAT) & (np.abs(origin[left] @ normals[one] - height[one]) <= near)
        rows, left = left[same], left[~same]
        area = float(scene.area[faces[rows]].sum())
        planes.append((area, normals[one], origin[one], faces[rows]))
        largest = max(largest, area)
        if scene.area[faces[left]].sum() < largest * ALIKE:
            break
    alike = [plane for plane in planes if plane[0] >= largest * ALIKE]
    _, normal, _, chosen = max(alike, key=lambda plane: (plane[1] @ up, plane[2] @ up))
    return chosen, normal


def _polygons(scene: Scene, faces: np.ndarray) -> np.ndarray:
    """Return corners around faces, (m, 4, 3); a triangle repeats its last one."""
    corners = scene.faces[faces]
    return scene.vertices[np.where(corners < 0, corners[:, 2:3], corners)]


def _axes(polygons: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return two axes of the plane; the first is along its longest edges (edges within the surface count once less)."""
    edges = (np.roll(polygons, -1, axis=1) - polygons).reshape(-1, 3)
    length = np.linalg.norm(edges, axis=1)
    edges = edges[length > 0] / length[length > 0, None]
    turned = np.where((edges @ [1.0, 1e-3, 1e-6] < 0)[:, None], -edges, edges)
    helper = np.eye(3)[np.argmin(np.abs(normal))]
    along = np.cross(normal, helper)
    along /= np.linalg.norm(along)
    across = np.cross(normal, along)
    quarter = np.pi / 2  # outlines are mostly at right angles
    angle = np.arctan2(turned @ across, turned @ along) % quarter
    bins = np.round(angle / quarter * BINS).astype(int) % BINS
    best = int(np.argmax(np.bincount(bins, length[length > 0], BINS)))
    beside = (angle[bins == best] - best / BINS * quarter + quarter / 2) % quarter - quarter / 2
    turn = best / BINS * quarter + float(np.median(beside))
    first = np.cos(turn) * along + np.sin(turn) * across
    options = [first, np.cross(normal, first)]
    first = max(options, key=lambda axis: abs(axis @ [1.0, 1e-3, 1e-6]))
    first = first * (1 if first @ [1.0, 1e-3, 1e-6] > 0 else -1)
    return first, np.cross(normal, first)


def _inside(places: np.ndarray, polygons: np.ndarray) -> np.ndarray:
    """Return which points, (n, 2), lie within any of some convex polygons, (m, 4, 2)."""
    found = np.zeros(len(places), bool)
    for corners in polygons:
        edges = np.roll(corners, -1, axis=0) - corners
        kept = np.linalg.norm(edges, axis=1) > 0
        start, edges = corners[kept], edges[kept]
        area = sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(start, np.roll(start, -1, axis=0), strict=True))
        box = (places >= corners.min(axis=0) - INSIDE).all(axis=1) & (places <= corners.max(axis=0) + INSIDE).all(axis=1)
        rows = np.flatnonzero(box & ~found)
        way = places[rows, None] - start
        side = (edges[:, 0] * way[..., 1] - edges[:, 1] * way[..., 0]) * np.sign(area)
        found[rows] = (side >= -INSIDE * np.abs(area)).all(axis=1)
    return found
