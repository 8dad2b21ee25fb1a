"""Findings of `check` and `solve` about faces that lie on each other, or are too near or too small to be told apart."""

import warnings
from collections.abc import Iterator

import numpy as np

from ..errors import RadiosityWarning, shown
from ..scene.contacts import Contacts
from ..scene.coplanar import NEAR, contacts
from ..scene.model import Back, Scene
from ..scene.precision import ulp
from ..scene.topology import coincident
from .report import NOTE, WARNING, Finding

LITTLE = 1e-3  # of the smaller face: a smaller common part comes from the rounding of rims
SMALL = 32  # ulps: where the longest edge of a face is shorter, lines begin a quarter of it away, or more
DUPLICATES, TOO_NEAR, TOO_SMALL = "duplicates", "too near", "too small"


def findings(scene: Scene) -> Iterator[Finding]:
    """The findings about faces that lie on each other, one for each kind."""
    found = contacts(scene)
    found = found.take(found.share > LITTLE)
    doubled = found.doubled(scene)
    one, two = _with_copies(scene, found.take(doubled))
    if len(one):
        yield Finding(WARNING, DUPLICATES, _doubled(scene, one, two))
    behind = found.take(found.coplanar & ~doubled)
    if len(behind.one):
        text = "lie back to back on another face, as the two sides of a thin wall"
        yield Finding(NOTE, DUPLICATES, f"{_faces(behind.two)} {text} ({_names(scene, behind.one, behind.two)})")
    for kind, text in _held_apart(scene, found):
        yield Finding(WARNING, kind, text)


def tell(scene: Scene, *, any_light: bool = False) -> None:
    """Warn, before a run, of what makes its results wrong: lamps that lie on other faces, and faces too near or too small.

    Args:
        any_light: the lines are for any light, or for heat: every face that lies on another one may emit.
    """
    found = contacts(scene)
    found = found.take(found.share > LITTLE)
    emits = np.any([(scene.emission > 0).any(axis=1), (scene.back_emission > 0).any(axis=1)], axis=0)
    lamps = found.take(found.doubled(scene) & (any_light | emits[found.one] | emits[found.two]))
    said = [text for _, text in _held_apart(scene, found)]
    if len(lamps.one):
        said.insert(0, _doubled(scene, lamps.one, lamps.two))
    for text in said:
        warnings.warn(f"{scene.source}: {text}", RadiosityWarning, stacklevel=4)


def _doubled(scene: Scene, one: np.ndarray, two: np.ndarray) -> str:
    text = "lie on another face and radiate to the same side; where two overlap, lines meet the smaller one alone, and both emit"
    return f"{_faces(two)} {text}: remove copies, or cut away what is covered ({_names(scene, one, two)})"


def _held_apart(scene: Scene, found: Contacts) -> Iterator[tuple[str, str]]:
    near = found.take(found.unseen(scene))
    if len(near.one):
        yield TOO_NEAR, _near(scene, near)
    small, held = _small(scene)
    if len(small):
        yield TOO_SMALL, _tiny(scene, small, held)


def _near(scene: Scene, near: Contacts) -> str:
    first, count = int(np.argmax(near.ulp)), len(near.one)
    a, b = (scene.names[scene.surface[face[first]]] for face in (near.one, near.two))
    apart, offset = abs(near.gap[first]), NEAR * near.ulp[first]
    return (
        f"{count} pair{'s' if count > 1 else ''} of faces do not see each other as they should: they are nearer than single "
        f"precision holds apart where they lie ('{a}' and '{b}' are {apart:.3g} m apart, and lines begin {offset:.3g} m in front "
        "of a face there); move them apart, make one face of them, or give what lies far away its own scene "
        f"({_names(scene, near.one, near.two)})"
    )


def _small(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return faces hardly larger than the distance by which lines begin in front of them, the worst first, and an ulp at each."""
    _, first, second = scene.frames
    longest = np.max([np.linalg.norm(edge, axis=1) for edge in (first, second, second - first)], axis=0)
    held = ulp(scene.vertices[scene.faces[:, 0]], scene.centre, scene.plane_reach)
    small = np.flatnonzero(longest < SMALL * held)
    small = small[np.argsort(-held[small], kind="stable")]
    return small, held[small]


def _tiny(scene: Scene, small: np.ndarray, held: np.ndarray) -> str:
    count, names = len(small), _names(scene, small)
    return (
        f"{count} face{'s' if count > 1 else ''} (of {names}) {'are' if count > 1 else 'is'} hardly larger than what single "
        f"precision holds apart so far from the scene's centre (lines begin {NEAR * held[0]:.3g} m in front of "
        f"'{scene.names[scene.surface[small[0]]]}'): values there are inexact; give what lies far away its own scene"
    )


def _with_copies(scene: Scene, found: Contacts) -> tuple[np.ndarray, np.ndarray]:
    """The pairs, and pairs of copies a little further apart that look the same way or radiate to both sides."""
    one, two, same_way = coincident(scene)
    radiates = np.asarray(scene.back) == Back.RADIATES
    copies = same_way | radiates[one] | radiates[two]
    every = np.unique(np.concatenate([np.column_stack([found.one, found.two]), np.column_stack([one, two])[copies]]), axis=0)
    return every[:, 0], every[:, 1]


def _faces(faces: np.ndarray) -> str:
    return f"{len(np.unique(faces))} faces (first: face {int(faces.min())})"


def _names(scene: Scene, *faces: np.ndarray) -> str:
    return shown(sorted({scene.names[s] for s in scene.surface[np.concatenate(faces)]}))
