"""The sources of glare that an observer sees: luminaires, and surfaces that emit."""

from dataclasses import dataclass

import numpy as np

from ..errors import MethodError, shown
from ..patches.model import Patches
from ..scene.model import Scene
from ..scene.photopic import PHOTOPIC, RGB
from ..tracing.first_hits import first_hits

SIDE = 4  # points along each side of a luminous area, to see how much of it is hidden
TOUCHES = 1e-4  # of a distance: what a line hits so near to its end hides nothing


@dataclass(frozen=True, eq=False)
class Seen:
    """Sources as an observer sees them: luminance, cd/m²; visible solid angle, sr; way to the middle, (n, 3) m; and names."""

    luminance: np.ndarray
    solid_angle: np.ndarray
    way: np.ndarray
    names: tuple[str, ...]

    @staticmethod
    def of(patches: Patches, point: np.ndarray, device: str) -> "Seen":
        """Find those of a scene that a point sees."""
        one, other = _luminaires(patches.scene, point, device), _surfaces(patches, point, device)
        return Seen(
            np.concatenate([one.luminance, other.luminance]),
            np.concatenate([one.solid_angle, other.solid_angle]),
            np.concatenate([one.way, other.way]),
            one.names + other.names,
        )


def refuse(scene: Scene) -> None:
    """Raise where a scene has no rating of glare.

    Raises:
        MethodError: it is not photometric, has sunlight or a sky, has bands that are not red, green and blue, a luminaire
            without a luminous size, or panes that diffuse light.
    """
    if not scene.photometric:
        raise MethodError(f"{scene.source}: glare is of luminances in cd/m², and the scene is in W; set photometric = true")
    if len(scene.bands) > 1 and tuple(scene.bands) != RGB:
        raise MethodError(f"{scene.source}: glare needs one band, or red, green and blue, not {', '.join(scene.bands)}")
    if scene.lights.suns or scene.lights.sky is not None:
        raise MethodError(f"{scene.source}: UGR is of electric light; leave the sun and the sky out")
    if scene.diffusers.any():
        names = shown([scene.names[i] for i in np.unique(scene.surface[scene.diffusers])])
        raise MethodError(
            f"{scene.source}: {names} diffuse light from behind (diffuse_transmittance), as a luminaire's cover does; UGR takes "
            "only what surfaces emit for sources: give them the exitance that they have, as an emission"
        )
    points = [one.name for one in scene.lights.luminaires if not one.size.any()]
    if points:
        raise MethodError(
            f"{scene.source}: {shown(points)} have no luminous size, so that their luminance is infinite; UGR needs files of "
            "luminaires that say it (IES, EULUMDAT), or surfaces that emit"
        )


def photopic_of(values: np.ndarray) -> np.ndarray:
    """Return one value for all bands, (...), of (..., n_bands)."""
    return values @ PHOTOPIC if values.shape[-1] == len(PHOTOPIC) else values[..., 0]


def _luminaires(scene: Scene, point: np.ndarray, device: str) -> Seen:
    """Return the luminaires: luminance is intensity over the luminous area as it is seen."""
    found = []
    for one in scene.lights.luminaires:
        way = one.position - point
        distance = np.linalg.norm(way)
        direction = -way / distance
        area = one.projected(direction)
        power = np.broadcast_to(one.towards(direction), scene.n_bands)
        intensity = float(photopic_of(power))
        if intensity > 0 and area > 0:
            share = _visible(scene, point, _points_of(one), device)
            found.append((intensity / area, area / distance**2 * share, way, one.name))
    return _seen(found)


def _points_of(one) -> np.ndarray:
    """Return points of the luminous area, (m, 3)."""
    steps = (np.arange(SIDE) + 0.5) / SIDE - 0.5
    u, v = (axis.ravel() for axis in np.meshgrid(steps, steps))
    kept = np.hypot(u, v) <= 0.5 if one.disc else np.ones(len(u), bool)
    return one.position + np.outer(u[kept] * one.size[0], one.axes[0]) + np.outer(v[kept] * one.size[1], one.axes[1])


def _visible(scene: Scene, point: np.ndarray, ends: np.ndarray, device: str) -> float:
    """Return the share of points that are seen."""
    return float(_free(scene, point, ends, device)[0].mean())


def _free(scene: Scene, point: np.ndarray, ends: np.ndarray, device: str) -> tuple[np.ndarray, np.ndarray]:
    """Return which points are seen, (m,) bool, and the face that lines to them meet, (m,) int. Panes hide nothing."""
    solid, way = np.flatnonzero(~scene.panes), ends - point
    if not len(solid):
        return np.ones(len(ends), bool), np.full(len(ends), -1)
    seen = scene if len(solid) == scene.n_faces else scene.take(solid)
    hits = first_hits(seen, np.broadcast_to(point, way.shape), way, device)
    free = hits.distance >= np.linalg.norm(way, axis=1) * (1 - TOUCHES)
    return free, np.where(hits.face >= 0, solid[hits.face], -1)


def _surfaces(patches: Patches, point: np.ndarray, device: str) -> Seen:
    """Return the patches that emit, whose middle is seen; what they reflect is background."""
    lit = np.flatnonzero(photopic_of(patches.emission) > 0)
    way = patches.centroid[lit] - point
    lit = lit[(way * patches.normal[lit]).sum(axis=1) < 0]
    way = patches.centroid[lit] - point
    if not len(lit):
        return _seen([])
    free, face = _free(patches.scene, point, patches.centroid[lit], device)
    free |= face == patches.face[lit]
    lit, way = lit[free], way[free]
    luminance = photopic_of(patches.emission[lit]) / np.pi
    names = [patches.scene.names[i] for i in patches.surface[lit]]
    angles = solid_angle(patches.corners[lit] - point)
    return Seen(luminance, angles, way, tuple(names))


def _seen(rows: list) -> Seen:
    luminance, angle = (np.array([row[i] for row in rows], float) for i in (0, 1))
    return Seen(luminance, angle, np.array([row[2] for row in rows], float).reshape(-1, 3), tuple(row[3] for row in rows))


def solid_angle(corners: np.ndarray) -> np.ndarray:
    """Return the solid angles of polygons seen from the origin, (n,) sr, from corners, (n, 4, 3); triangles repeat their last.

    A. van Oosterom, J. Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed. Eng. 30 (1983).
    """
    unit = corners / np.linalg.norm(corners, axis=2, keepdims=True)
    total = np.zeros(len(corners))
    for second, third in ((1, 2), (2, 3)):
        a, b, c = unit[:, 0], unit[:, second], unit[:, third]
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        cosines = 1 + sum(np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a)))
        total += np.abs(2 * np.arctan2(volume, cosines))
    return total
