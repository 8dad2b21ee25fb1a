"""The paper's image error: RMS of a tone-mapped picture less the reference picture."""

from dataclasses import dataclass

import numpy as np

from ..image import tone
from ..image.view import directions
from ..patches import Patches, cells
from ..tracing.first_hits import first_hits

WIDTH = 160  # pixels; each has one line of sight, and each patch one value


@dataclass(frozen=True, eq=False)
class Sight:
    """The patches that a camera sees.

    Attributes:
        patch: (pixels,) int64, the patch in each pixel; pixels that see none are left out.
    """

    patch: np.ndarray

    @staticmethod
    def of(patches: Patches) -> "Sight | None":
        """Return what the scene's first camera sees; None where it has none."""
        scene = patches.scene
        if not scene.cameras:
            return None
        camera = scene.cameras[0]
        step = camera.width / WIDTH
        x, y = np.meshgrid((np.arange(WIDTH) + 0.5) * step, np.arange(0.5 * step, camera.height, step))
        aims = directions(camera, x.ravel(), y.ravel())
        hits = first_hits(scene, np.broadcast_to(np.asarray(camera.origin, float), aims.shape), aims)
        seen = (hits.face >= 0) & hits.front
        face = hits.face[seen]
        cell = cells.number(hits.u[seen], hits.v[seen], patches.columns[face], patches.rows[face], scene.is_quad[face])
        return Sight(patches.first[face] + cell)

    def error(self, found: np.ndarray, truth: np.ndarray) -> np.ndarray:
        """Return the RMS over pixels of the difference of display values in [0, 1], (replicates,), at the true picture's scale.

        Args:
            found: (replicates, n_patches) radiosity. truth: (n_patches,).
        """
        scale = tone.automatic_scale(truth[self.patch][:, None])
        pictures = tone.srgb(found[:, self.patch] * scale)
        return np.sqrt(((pictures - tone.srgb(truth[self.patch] * scale)) ** 2).mean(axis=1))
