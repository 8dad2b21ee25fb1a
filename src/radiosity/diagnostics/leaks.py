"""Leaks: light that leaves the scene or hits absorbing backs, and light sources that face the wrong way."""

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from ..scene.model import Back, Scene
from ..scene.precision import ulp

WALKS = 20_000
BOUNCES = 8
PER_EMITTER = 512  # lines from each side of each emitting surface
ULPS = 64  # origins are this many units in the last place, single precision, in front of their face
NEAR = 0.1  # of the square root of the emitting face's area: a surface nearer than this carries the lamp
SEEN, ESCAPED, LOST = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Fates:
    """The fates of lines: where each began and ended.

    Attributes:
        face: (n_lines,) int64, where each began.
        fate: (n_lines,) int, SEEN (a radiating side), ESCAPED or LOST (an absorbing back).
        hit: (n_lines,) int64, the face met, or -1.
        exit: (n_lines,) int64, the side of the scene's box that a line which meets nothing leaves through: x low, x high, ...
        distance: (n_lines,) float64, metres; infinite for a line that escaped.
        front: (n_lines,) bool, it met the front of the face.
        back: (n_lines,) bool, it began on the back of its face.
    """

    face: np.ndarray
    fate: np.ndarray
    hit: np.ndarray
    exit: np.ndarray
    distance: np.ndarray
    front: np.ndarray
    back: np.ndarray

    def of(self, keep: np.ndarray) -> "Fates":
        """The fates of some lines."""
        return Fates(*(getattr(self, field.name)[keep] for field in fields(Fates)))

    @cached_property
    def escaped(self) -> float:
        """Share of the lines that met nothing."""
        return float((self.fate == ESCAPED).mean())

    @cached_property
    def lost(self) -> float:
        """Share of the lines that met an absorbing back."""
        return float((self.fate == LOST).mean())


def follow(scene: Scene, power: np.ndarray, walks: int = WALKS, *, seed: int = 0, device: str = "auto") -> Fates:
    """Trace cosine lines from where light is emitted, and on from where they hit, so that only lit places are judged.

    Args:
        power: (2, n_faces), emitted by front and back; where all is zero, lines begin anywhere on the radiating sides.
        walks: lines of the first generation. Those that meet a side that is not black go on, up to `BOUNCES` times.
    """
    generator = np.random.Generator(np.random.Philox(seed))
    if not power.any():
        power = np.stack([scene.area, np.where(scene.back == Back.RADIATES, scene.area, 0.0)])
    share = np.cumsum(power.ravel() / power.sum())
    # stratified, so that large shares have small errors
    at = (np.arange(walks) + generator.random(walks)) / walks
    side = np.minimum(np.searchsorted(share, at * share[-1], side="right"), len(share) - 1)
    face, back, place = side % scene.n_faces, side >= scene.n_faces, None
    generations = []
    for _ in range(BOUNCES):
        fates, front, place = _trace(scene, face, back, place or _places(scene, face, generator), generator, device)
        generations.append(fates)
        goes_on = fates.fate == SEEN
        goes_on &= (_reflectance(scene, fates.hit, ~front) > 0).any(axis=1) | scene.diffusers[fates.hit]
        face, back, place = fates.hit[goes_on], ~front[goes_on], (place[0][goes_on], place[1][goes_on])
        back ^= _across(scene, face, back, generator)
        if len(face) == 0:
            break
    return Fates(*(np.concatenate([getattr(g, field.name) for g in generations]) for field in fields(Fates)))


def _reflectance(scene: Scene, face: np.ndarray, back: np.ndarray) -> np.ndarray:
    return np.where(back[:, None], scene.back_reflectance[face], scene.reflectance[face])


def _across(scene: Scene, face: np.ndarray, back: np.ndarray, generator) -> np.ndarray:
    """Return which lines go on from the other side of a diffusing pane."""
    diffuse = scene.diffuse_transmittance
    if diffuse is None:
        return np.zeros(len(face), bool)
    through, rho = diffuse[face].max(axis=1, initial=0), _reflectance(scene, face, back).max(axis=1, initial=0)
    return generator.random(len(face)) * (rho + through) < through


def flipped_emitters(scene: Scene, emits: np.ndarray, *, seed: int = 0, device: str = "auto") -> list[tuple[int, float, float]]:
    """Return emitting surfaces whose front sees next to nothing while their back, which emits nothing, sees the scene.

    Args:
        emits: (n_faces,) bool, faces whose front emits and whose back does not.

    Returns:
        Surface, and the shares of lines from its front and from its back that meet another surface's radiating side farther
        away than the surface that carries the source.
    """
    generator = np.random.Generator(np.random.Philox(seed))
    surfaces = np.unique(scene.surface[emits])
    if len(surfaces) == 0:
        return []
    faces = []
    for surface in surfaces:
        own = np.flatnonzero(emits & (scene.surface == surface))
        faces.append(generator.choice(own, PER_EMITTER, p=scene.area[own] / scene.area[own].sum()))
    face = np.concatenate(faces)
    shares = []
    for back in (False, True):
        fates, *_ = _trace(scene, face, np.full(len(face), back), _places(scene, face, generator), generator, device)
        useful = (fates.fate == SEEN) & (fates.distance > NEAR * np.sqrt(scene.area[face]))
        useful &= scene.surface[fates.hit] != scene.surface[face]
        shares.append(useful.reshape(len(surfaces), -1).mean(axis=1))
    return [(int(s), float(f), float(b)) for s, f, b in zip(surfaces, *shares, strict=True) if f < 0.05 and b > 0.5]


def _places(scene: Scene, face: np.ndarray, generator) -> tuple[np.ndarray, np.ndarray]:
    """Return face coordinates (u, v) of a uniform point on each face."""
    a, b = generator.random((2, len(face)))
    root = np.sqrt(a)
    return np.where(scene.is_quad[face], a, root * (1 - b)), np.where(scene.is_quad[face], b, root * b)


def _trace(scene: Scene, face, back, place, generator, device: str):
    """Return fates of cosine lines, and for each hit whether it is on the front, and its (u, v)."""
    from ..tracing.first_hits import first_hits  # the tracer takes a while to start

    radius, turn = np.sqrt(generator.random(len(face))), 2 * np.pi * generator.random(len(face))
    origin, first, second = (part[face] for part in scene.frames)
    normal = scene.normal[face] * np.where(back, -1.0, 1.0)[:, None]
    tangent = first / np.linalg.norm(first, axis=1, keepdims=True)
    across = np.cross(normal, tangent)
    x, y, z = radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - radius**2)
    direction = x[:, None] * tangent + y[:, None] * across + z[:, None] * normal
    start = origin + place[0][:, None] * first + place[1][:, None] * second
    start += ULPS * ulp(start, scene.centre, scene.plane_reach[face])[:, None] * normal
    hits = first_hits(scene, start, direction, device=device)
    dead_back = ~hits.front & (scene.back[hits.face] != Back.RADIATES)
    fate = np.where(hits.face < 0, ESCAPED, np.where(dead_back, LOST, SEEN))
    exits = _exit(scene, start, direction)
    fates = Fates(face, fate, hits.face, exits, hits.distance, hits.front, np.asarray(back, bool))
    return fates, hits.front, (hits.u, hits.v)


def _exit(scene: Scene, start: np.ndarray, direction: np.ndarray) -> np.ndarray:
    low, high = scene.bounds
    ahead = direction > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = (np.where(ahead, high, low) - start) / direction
    axis = np.argmin(np.where(direction == 0, np.inf, steps), axis=1)
    return 2 * axis + ahead[np.arange(len(axis)), axis]
