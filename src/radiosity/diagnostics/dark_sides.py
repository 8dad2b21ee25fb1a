"""Findings about two-sided faces that light reaches on one side alone, such as walls of a room from OBJ, PLY and STL."""

from collections.abc import Iterator

import numpy as np

from ..errors import shown
from ..scene.model import Back, Scene
from ..scene.reached import MANY, Lit, lit_sides
from . import leaks
from .report import NOTE, WARNING, Finding

ADVICE = {
    Lit.FRONT: "write sides = 1 for them in a .toml (docs/scene-toml.md)",
    Lit.BACK: "write flip = true and sides = 1 for them in a .toml (docs/scene-toml.md): their fronts look outward",
    Lit.MIXED: "let all their faces look inward in the modelling program (some look outward now), then write sides = 1 for them "
    "in a .toml",
}


def findings(scene: Scene, fates: leaks.Fates, power: np.ndarray) -> Iterator[Finding]:
    """Yield a note for each kind, or a warning where the dark side emits.

    Args:
        fates: fates of lines that follow the light.
        power: (2, n_faces), emitted by front and back.
    """
    lit, back_is_dark = _lit(scene, fates)
    n = len(scene.names)
    area = np.bincount(scene.surface, scene.area, n)
    radiating = (scene.area * np.where(scene.back == Back.RADIATES, 2, 1)).sum()
    wasted = np.bincount(scene.surface, np.where(back_is_dark, power[1], power[0]), n)
    ranks = np.round(area / area.max(), 6)  # equal areas in the order of surfaces, wherever they lie
    for side, advice in ADVICE.items():
        for shines in (False, True):
            here = np.flatnonzero((lit == side) & ((wasted > 0) == shines))
            if not len(here):
                continue
            names = [scene.names[s] for s in here[np.argsort(-ranks[here], kind="stable")]]
            text = f"the faces of {shown(names, 4)} are two-sided and enclose the scene, or a body in it: no line reaches "
            text += f"their other side ({100 * area[here].sum() / radiating:.3g} % of all area that radiates), "
            if shines:
                text += f"which emits {100 * wasted[here].sum() / power.sum():.3g} % of all power to where nothing receives it"
            else:
                text += "which tables leave out and patches are spent on"
            yield Finding(WARNING if shines else NOTE, "two-sided faces", f"{text}; to make them one-sided, {advice}")


def inside(scene: Scene, fates: leaks.Fates) -> leaks.Fates:
    """The lines that do not begin on dark sides: lines that leave the scene from the outside of a room show no leak."""
    lit, back_is_dark = _lit(scene, fates)
    known = lit[scene.surface[fates.face]] != Lit.BOTH
    dark = known & (scene.back == Back.RADIATES)[fates.face] & (fates.back == back_is_dark[fates.face])
    return fates.of(~dark) if dark.any() and not dark.all() else fates


def _lit(scene: Scene, fates: leaks.Fates) -> tuple[np.ndarray, np.ndarray]:
    """The sides of surfaces that lines met, and whether more of them met the front of a face, (n_faces,) bool."""
    seen, reached = fates.fate == leaks.SEEN, np.zeros((scene.n_faces, 2))
    np.add.at(reached, (fates.hit[seen], (~fates.front[seen]).astype(int)), 1)
    reached[scene.diffusers] = reached[scene.diffusers].sum(axis=1, keepdims=True)  # light that falls on one side leaves both
    return lit_sides(scene, reached, MANY), reached[:, 0] >= reached[:, 1]
