"""What lines of sight see where there are panes: each pane, and through it what is behind.

A pane shows its own radiosity, and its transmittance times what is behind it: a sum without noise. Values of other kinds, such as
irradiances, do not add up: a line shows the first face that is no pane, or a pane that lets less than half of the light through.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..scene.clear_glass import of_mean, share_at
from ..scene.model import Scene
from .gathered import Gathered
from .lookup import Lookup

MOST = 64  # panes behind each other
STEP = 2e-6  # of the scene's reach, by which a line begins behind a pane
HALF = 0.5


def through_at(scene: Scene, face: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Return what faces let through of rays of unit length, (m,): of glass by the angle."""
    assert scene.transmittance is not None
    found = scene.transmittance[face]
    if scene.refractive_index is None:
        return found
    index = scene.refractive_index[face]
    for share, one in {(found[i], index[i]) for i in np.flatnonzero(index > 0)}:
        here = np.flatnonzero((index == one) & (found == share))
        cosine = np.abs((rays[here] * scene.normal[face[here]]).sum(axis=1))
        found[here] = share_at(np.maximum(cosine, 1e-6), of_mean(float(share), float(one)), float(one))
    return found


@dataclass(frozen=True, eq=False)
class Sight:
    """Lines of sight in a scene.

    Attributes:
        scene: that is looked at.
        look: finds values from hits.
        hits: as of `radiosity.image.render`.
        adds: values add up through panes.
    """

    scene: Scene
    look: Lookup | Gathered
    hits: Callable[..., Any]
    adds: bool

    @cached_property
    def _opaque(self) -> Scene:
        """The scene with opaque panes."""
        return replace(self.scene, transmittance=None)

    def __call__(self, origins: np.ndarray, rays: np.ndarray, marked: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return values, (m, n), the first patch that is seen, (m,), -1 for none, and whether a marked one is, (m,).

        Args:
            marked: (n_patches,) bool.
        """
        through = self.scene.transmittance
        if through is None:
            values, patch = self.look(self.hits(self.scene, origins, rays))
            return values, patch, (patch >= 0) & marked[patch]
        step = STEP * max(self.scene.reach, float(np.abs(origins - self.scene.centre).max(initial=0.0)))
        rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
        going, share, last = np.arange(len(rays)), np.ones(len(rays)), np.full(len(rays), -1)
        total = np.zeros((len(rays), self.look.columns))
        nearest, own = np.full(len(rays), -1), np.zeros(len(rays), bool)
        for _ in range(MOST):
            met = self.hits(self._opaque, origins, rays[going])
            values, patch = self.look(met)
            face = np.asarray(met.face)
            t = np.where(face >= 0, through_at(self.scene, face, rays[going]), 0.0)
            again = (face >= 0) & (face == last[going])  # the step was too short
            shows = ~again & (patch >= 0) & ((t < HALF) | self.adds)
            here = going[shows]
            total[here] += share[here, None] * values[shows]
            nearest[here] = np.where(nearest[here] < 0, patch[shows], nearest[here])
            own[here] |= marked[patch[shows]]
            on = again | ((t > 0) & ((t >= HALF) | self.adds))
            share[going] *= np.where(again, 1.0, t)
            last[going] = face
            origins = origins[on] + rays[going[on]] * (np.asarray(met.distance)[on] + step)[:, None]
            going = going[on]
            if not self.adds:
                share[going] = 1.0
            if not len(going):
                break
        return total, nearest, own
