"""What rays from cameras and sensors see: the share of each patch."""

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...patches.model import Patches
from ...tracing.geometry import Geometry
from ...tracing.hits import first_hit, patch_of


def shares_seen(geometry: Geometry, patches: Patches, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Return the share of rays that hit each patch first, (n_patches,) float64.

    Args:
        origins, directions: (m, 3) metres, and unit vectors.
    """
    geometry.prepare()
    types, bvh, n = geometry.device.types, geometry.bvh, len(patches)
    start = ((origins - bvh.centre) * bvh.scale).astype(np.float32)
    rays = [types.Array3f(*(upload(types.Float, a[:, i]) for i in range(3))) for a in (start, directions.astype(np.float32))]
    met = patch_of(geometry, first_hit(geometry, *rays), n, n)
    dr.eval(met)
    return np.bincount(np.array(met), minlength=n + 1)[:n] / len(origins)
