"""Luminaires so near to a face, or in it, that shadow rays from its patches hardly find their light.

A lamp that hangs a millimetre below a ceiling lights a spot of a millimetre there. Shadow rays of gather begin at uniform points
of a patch, so that they meet the spot by chance alone: what is missing is in no error bar. Random walks begin at the lamp. So
it is with the part of a soft luminaire's area that is as near to a face, as where the area goes through a wall.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..errors import shown
from ..patches import Patches
from ..scene.habits import warn
from ..scene.lights.luminaire import Luminaire
from ..scene.model import Back
from ..scene.precision import OFFSET

NEAR = 0.02  # of the size of a patch: luminaires nearer to it than this
LEAST = 0.005  # of all light of luminaires: less in spots is not told
ACROSS, LOOKED_AT = 128, 9  # points along a side of a soft area; and those near a face whose light is followed
GAMMAS, PLANES = 60, 24  # directions that its web is looked up at


@dataclass(frozen=True)
class Spot:
    """A luminaire whose light falls on a face that it nearly touches.

    Attributes:
        luminaire, surface: their names.
        distance, size: m, how near it is, and of a patch.
        share: of its own light.
        light: share of the light of all luminaires.
    """

    luminaire: str
    surface: str
    distance: float
    size: float
    share: float
    light: float


def spots(patches: Patches) -> list[Spot]:
    """Return the luminaires that are too near to a face for shadow rays, the one with most light there first; none where all of
    that light together is little."""
    scene, found = patches.scene, []
    if not scene.lights.luminaires:
        return found
    sizes = patches.sizes
    origin, first, second = scene.frames
    power = sum(float(one.power.sum()) for one in scene.lights.luminaires)
    for one in scene.lights.luminaires:
        way, points = one.position - origin, _points(one)
        half = np.abs((points - one.position) @ scene.normal.T).max(axis=0) if one.soft else 0.0
        height = (way * scene.normal).sum(axis=1)
        reach = NEAR * sizes
        longest = np.linalg.norm(first, axis=1) + np.linalg.norm(second, axis=1) + np.linalg.norm(one.size) / 2
        beside = np.linalg.norm(way, axis=1) <= longest + reach
        for face in np.flatnonzero((np.abs(height) <= reach + half) & beside):
            heights = np.abs((points - origin[face]) @ scene.normal[face])
            near = np.flatnonzero(heights <= reach[face])
            some = near[np.linspace(0, len(near) - 1, min(len(near), LOOKED_AT)).astype(int)]
            shares = [_share(replace(one, position=points[i]), scene, int(face)) for i in some]
            share = float(np.mean(shares)) * len(near) / len(points) if shares else 0.0
            if share > 0:
                name, light = scene.names[scene.surface[face]], share * float(one.power.sum()) / power
                found.append(Spot(one.name, name, float(heights.min()), float(sizes[face]), share, light))
    if sum(spot.light for spot in found) < LEAST:
        return []
    return sorted(found, key=lambda spot: -spot.light)


def _points(one: Luminaire) -> np.ndarray:
    """Return points from which a luminaire's light leaves, (n, 3): its middle, or points all over a soft one's area."""
    if not one.soft:
        return one.position[None]
    steps = (np.arange(ACROSS) + 0.5) / ACROSS - 0.5
    u, v = (axis.ravel() for axis in np.meshgrid(steps, steps))
    kept = np.hypot(u, v) <= 0.5 if one.disc else np.ones(len(u), bool)
    return one.position + np.outer(u[kept] * one.size[0], one.axes[0]) + np.outer(v[kept] * one.size[1], one.axes[1])


def warn_of_spots(patches: Patches) -> None:
    """Warn where gather hardly finds light of luminaires that nearly touch faces."""
    found = spots(patches)
    if not found:
        return
    names = shown(list(dict.fromkeys(f"{one.luminaire} at {one.surface} ({one.distance:.3g} m)" for one in found)), 5)
    most, size = 100 * max(one.share for one in found), max(one.size for one in found)
    warn(
        f"{names}: luminaires that nearly touch a face send up to {most:.0f} % of their light to a spot of it, and patches are "
        f"{size:.2g} m large: the shadow rays of gather hardly find that light, and no error shows it; take --method "
        "random-walk, or move them away from the face"
    )


def _share(one: Luminaire, scene, face: int) -> float:
    """Return the share of a luminaire's light that falls on a face, near where it is, by directions of its web."""
    web = one.web
    gamma = np.linspace(web.gamma[0], web.gamma[-1], 2 * GAMMAS + 1)[1::2]
    planes = (np.arange(PLANES) + 0.5) * 360 / PLANES
    rows = np.stack([np.interp(gamma, web.gamma, row) for row in web.intensity])
    if len(rows) > 1:
        rows = np.stack([np.interp(planes, web.planes, column) for column in rows.T], axis=1)
    weight = np.broadcast_to(rows, (PLANES, GAMMAS)) * np.sin(np.radians(gamma))
    c, g = np.radians(planes)[:, None], np.radians(gamma)[None]
    ways = np.stack([np.cos(c) * np.sin(g), np.sin(c) * np.sin(g), np.cos(g) + 0 * c], axis=-1) @ one.axes
    reach = max(np.abs(one.position - scene.centre).max(), 1e-6 * scene.reach)
    start = one.position + one.axes[2] * OFFSET * reach  # one that is let into a face begins in front of it
    origin, first, second = (part[face] for part in scene.frames)
    normal = scene.normal[face]
    height = (start - origin) @ normal
    if height < 0 and scene.back[face] != Back.RADIATES:
        return 0.0
    down = ways @ normal
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.where(down * height < 0, -height / down, np.inf)
    points = start + np.where(np.isfinite(distance), distance, 0)[..., None] * ways - origin
    cross = np.cross(first, second)
    u = np.cross(points, second) @ cross / (cross @ cross)
    v = np.cross(first, points) @ cross / (cross @ cross)
    inside = (u >= 0) & (v >= 0) & ((u <= 1) & (v <= 1) if scene.is_quad[face] else u + v <= 1)
    return float((weight * (inside & np.isfinite(distance))).sum() / max(weight.sum(), 1e-300))
