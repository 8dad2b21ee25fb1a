"""What sides of lamps shine on from near: points of them, the face in front of each, and how much of its patch nothing covers."""

import numpy as np

from ..patches import Patches
from ..patches.contact.lines import NEAR_LAMP, PARALLEL, TOUCHES
from ..scene.box_pairs import box_pairs
from ..scene.model import Back, Scene
from ..scene.precision import ulp

GRID = 4  # points along a side of a patch, which are covered or not
ULPS = 16  # lines begin so far in front of a face


def emitting_sides(patches: Patches, n: int) -> np.ndarray | None:
    """Return emitting sides by power, (n,) int64: the face, and for backs the number of faces more; None: there are none."""
    scene = patches.scene
    power = np.zeros((2, scene.n_faces))
    np.add.at(power, (patches.is_back.astype(int), patches.face), (patches.emission * patches.area[:, None]).sum(axis=1))
    share = np.cumsum(power.ravel())
    if not share[-1] > 0:
        return None
    at = (np.arange(n) + 0.5) / n * share[-1]
    return np.minimum(np.searchsorted(share, at, side="right"), len(share) - 1)


def points_of(scene: Scene, face: np.ndarray) -> np.ndarray:
    """Return a point of each face, (n, 3), evenly spread."""
    a, b = (np.arange(1, len(face) + 1)[:, None] * (0.7548776662466927, 0.5698402909980532) % 1).T
    folded = ~scene.is_quad[face] & (a + b > 1)
    u, v = np.where(folded, 1 - a, a), np.where(folded, 1 - b, b)
    origin, first, second = (part[face] for part in scene.frames)
    return origin + u[:, None] * first + v[:, None] * second


def faced(patches: Patches, points: np.ndarray, ways: np.ndarray):
    """Return the nearest face that each point shines on from near.

    Returns:
        The number of the point, the face, its height over it in metres, face coordinates (m, 2), and the patch's size; None where
        there are no such points, or what they shine on from nearest touches them.
    """
    scene = patches.scene
    corners = scene.vertices[np.where(scene.faces < 0, scene.faces[:, 2:3], scene.faces)]
    sizes = patches.sizes
    emits = np.bincount(patches.face, patches.emission.max(axis=1), scene.n_faces) > 0
    reach = NEAR_LAMP * sizes[:, None]
    boxes = corners.min(axis=1) - reach, corners.max(axis=1) + reach
    parts = []
    for face, row in box_pairs(boxes, (points, points)):
        origin, first, second = (part[face] for part in scene.frames)
        way, normal = points[row] - origin, scene.normal[face]
        height = np.einsum("ij,ij->i", way, normal)
        cross = np.cross(first, second)
        square = np.einsum("ij,ij->i", cross, cross)
        u = np.einsum("ij,ij->i", np.cross(way, second), cross) / square
        v = np.einsum("ij,ij->i", np.cross(first, way), cross) / square
        inside = (u >= 0) & (v >= 0) & np.where(scene.is_quad[face], (u <= 1) & (v <= 1), u + v <= 1)
        # of a face that touches, rounding alone says on which side the point is; the point's own face is one
        touching = np.abs(height) <= TOUCHES * scene.plane_reach[face]
        facing = np.einsum("ij,ij->i", ways[row], normal) * np.where(touching, 1.0, np.sign(height)) < -PARALLEL
        facing &= ~(touching & emits[face])
        radiates = (height > 0) | (scene.back[face] == Back.RADIATES)
        near = np.abs(height) <= NEAR_LAMP * sizes[face]
        keep = inside & near & facing & radiates
        parts.append([a[keep] for a in (row, face, height, np.stack([u, v], axis=1), sizes[face])])
    if not parts:
        return None
    row, face, height, uv, size = (np.concatenate(column) for column in zip(*parts, strict=True))
    order = np.lexsort((np.abs(height), row))
    order = order[np.diff(row[order], prepend=-1) > 0]  # the nearest of each
    order = order[np.abs(height[order]) > TOUCHES * scene.plane_reach[face[order]]]
    return (row[order], face[order], height[order], uv[order], size[order]) if len(order) else None


def open_share(patches: Patches, face: np.ndarray, height: np.ndarray, uv: np.ndarray, device: str) -> np.ndarray:
    """Return the share of the patch about a point that nothing covers, (n,)."""
    from ..tracing.first_hits import first_hits  # the tracer takes a while to start

    scene = patches.scene
    cells = np.stack([patches.columns[face], patches.rows[face]], axis=1)
    cell = np.minimum((uv * cells).astype(np.int64), cells - 1)
    inverted = ~scene.is_quad[face] & ((uv * cells - cell).sum(axis=1) > 1)
    steps = (np.arange(GRID) + 0.5) / GRID
    grid = np.stack([axis.ravel() for axis in np.meshgrid(steps, steps)], axis=1)  # (k, 2)
    within = np.broadcast_to(grid, (len(face), *grid.shape))
    outside = ~scene.is_quad[face][:, None] & (within.sum(axis=2) > 1)
    within = np.where(outside[:, :, None], 1 - within, within)
    within = np.where(inverted[:, None, None], 1 - within, within)
    at = (cell[:, None] + within) / cells[:, None]
    origin, first, second = (part[face][:, None] for part in scene.frames)
    way = np.repeat((scene.normal[face] * np.sign(height)[:, None])[:, None], len(grid), axis=1).reshape(-1, 3)
    start = (origin + at[:, :, :1] * first + at[:, :, 1:] * second).reshape(-1, 3)
    start = start + ULPS * ulp(start, scene.centre, np.repeat(scene.plane_reach[face], len(grid)))[:, None] * way
    hits = first_hits(scene, start, way, device=device)
    covered = hits.distance <= 2 * np.repeat(np.abs(height), len(grid))
    return 1 - covered.reshape(len(face), -1).mean(axis=1)
