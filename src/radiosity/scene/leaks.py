"""Where lines go: light that leaves the scene or lands on absorbing backs, and light sources that face the wrong way."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .model import Back, Scene

LINES = 100_000
PER_EMITTER = 512  # lines from each side of each emitting surface
ULPS = 64  # origins stand off their face by so many units in the last place of the largest coordinate, single precision
NEAR = 0.1  # of the square root of the emitting face's area: closer than this is the surface that carries the lamp
SEEN, ESCAPED, LOST = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Fates:
    """What became of lines.

    Attributes:
        face: (n_lines,) int64, where each began.
        fate: (n_lines,) int, SEEN (a radiating side), ESCAPED or LOST (an absorbing back).
        hit: (n_lines,) int64, the face met, or -1.
        exit: (n_lines,) int64, for a line that escaped the side of the scene's box that it left through: x low, x high, y low, ...
        distance: (n_lines,) float64, metres; infinite for a line that escaped.
    """

    face: np.ndarray
    fate: np.ndarray
    hit: np.ndarray
    exit: np.ndarray
    distance: np.ndarray

    @cached_property
    def escaped(self) -> float:
        """Share of the lines that met nothing."""
        return float((self.fate == ESCAPED).mean())

    @cached_property
    def lost(self) -> float:
        """Share of the lines that met an absorbing back."""
        return float((self.fate == LOST).mean())


def follow(scene: Scene, lines: int = LINES, *, seed: int = 0, device: str = "auto") -> Fates:
    """Trace cosine lines from points that are uniform over the radiating sides of the scene."""
    generator = np.random.Generator(np.random.Philox(seed))
    weight = np.concatenate([scene.area, np.where(scene.back == Back.RADIATES, scene.area, 0.0)])
    # stratified in area, so that large faces get their share exactly
    at = (np.arange(lines) + generator.random(lines)) / lines * weight.sum()
    side = np.minimum(np.searchsorted(np.cumsum(weight), at, side="right"), len(weight) - 1)
    return _trace(scene, side % scene.n_faces, side >= scene.n_faces, generator, device)


def flipped_emitters(scene: Scene, emits: np.ndarray, *, seed: int = 0, device: str = "auto") -> list[tuple[int, float, float]]:
    """Emitting surfaces whose front sees next to nothing while their back, which emits nothing, sees the scene.

    Args:
        emits: (n_faces,) bool, faces whose front emits.

    Returns:
        Surface, and the shares of lines from its front and from its back that meet another surface's radiating side
        farther away than what the source is mounted on.
    """
    generator = np.random.Generator(np.random.Philox(seed))
    emits = emits & (scene.back != Back.RADIATES)
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
        fates = _trace(scene, face, np.full(len(face), back), generator, device)
        useful = (fates.fate == SEEN) & (fates.distance > NEAR * np.sqrt(scene.area[face]))
        useful &= scene.surface[fates.hit] != scene.surface[face]
        shares.append(useful.reshape(len(surfaces), -1).mean(axis=1))
    return [(int(s), float(f), float(b)) for s, f, b in zip(surfaces, *shares, strict=True) if f < 0.05 and b > 0.5]


def _trace(scene: Scene, face: np.ndarray, back: np.ndarray, generator, device: str) -> Fates:
    from ..engine.caster import first_hits  # the tracer stands later in the walk, and takes seconds to start

    n = len(face)
    u, v, radius, turn = np.sqrt(generator.random(n)), generator.random(n), np.sqrt(generator.random(n)), generator.random(n)
    quad = scene.is_quad[face]
    s, t = np.where(quad, u * u, u * (1 - v)), np.where(quad, v, u * v)
    origin, first, second = (part[face] for part in scene.frames)
    normal = scene.normal[face] * np.where(back, -1.0, 1.0)[:, None]
    tangent = first / np.linalg.norm(first, axis=1, keepdims=True)
    bitangent = np.cross(normal, tangent)
    x, y = radius * np.cos(2 * np.pi * turn), radius * np.sin(2 * np.pi * turn)
    direction = x[:, None] * tangent + y[:, None] * bitangent + np.sqrt(1 - radius**2)[:, None] * normal
    centre = scene.bounds.mean(axis=0)
    offset = ULPS * np.finfo(np.float32).eps * float(np.abs(scene.bounds - centre).max())
    start = origin + s[:, None] * first + t[:, None] * second + offset * normal
    hits = first_hits(scene, start, direction, device=device)
    hit = np.asarray(hits.face)
    landed_on_back = ~np.asarray(hits.front) & (scene.back[hit] != Back.RADIATES)
    fate = np.where(hit < 0, ESCAPED, np.where(landed_on_back, LOST, SEEN))
    return Fates(face, fate, hit, _exit(scene, start, direction), np.where(hit < 0, np.inf, hits.distance))


def _exit(scene: Scene, start: np.ndarray, direction: np.ndarray) -> np.ndarray:
    low, high = scene.bounds
    ahead = direction > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = (np.where(ahead, high, low) - start) / direction
    axis = np.argmin(np.where(direction == 0, np.inf, steps), axis=1)
    return 2 * axis + ahead[np.arange(len(axis)), axis]
