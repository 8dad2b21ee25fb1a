"""The light of polynomials as it is shown.

Polynomials of neighbours do not meet at their common edge. Where values are smoothed, each polynomial is moved at the corners of
its patch to the mean of those that meet there, and between the corners by what these moves interpolate to. So linear light has no
steps along edges. Where polynomials that meet are too unlike, at the edge of a shadow or of a box, they stay as they are.

Noise and the edges of shadows can make a polynomial negative; what is shown is cut at 0, which is never farther from the true
light.
"""

import numpy as np

from ..patches import Patches
from ..patches.polynomials import Polynomials
from . import plane_fit
from .display_mesh import DisplayMesh
from .quantity import Quantity

UNLIKE = (0.02, 0.1)  # mean difference at a vertex, of the value: below the first polynomials are moved, above the second not

NOISE = 2.0  # standard errors by which polynomials that meet may differ besides


def vertex_values(patches: Patches, mesh: DisplayMesh, shown: Quantity) -> np.ndarray:
    """Return smoothed values of a quantity at the vertices of a mesh, (n_vertices, n)."""
    return plane_fit.at_vertices(patches, mesh, shown.values) if shown.light is None else at_vertices(shown.light, mesh)


def own_values(mesh: DisplayMesh, owner: np.ndarray, shown: Quantity) -> np.ndarray:
    """Return values of a quantity at the vertices of a mesh whose patches have vertices of their own, (n_vertices, n).

    Args:
        mesh: the mesh before `DisplayMesh.flat`.
        owner: the patch of each vertex.
    """
    return shown.values[owner] if shown.light is None else corners(shown.light)[mesh.own_corners]


def at_vertices(light: Polynomials, mesh: DisplayMesh) -> np.ndarray:
    """Return the means of polynomials that meet at the vertices of a mesh, (n_vertices, n)."""
    return mesh.smoothed_corners(corners(light))


def corners(light: Polynomials) -> np.ndarray:
    """Return values at the corners of the polygons of a display mesh, (n_patches, 4, n), as they are shown."""
    return np.maximum(_at_corners(light), 0)


def _at_corners(light: Polynomials) -> np.ndarray:
    found = light.at_corners()
    triangles = ~light.patches.scene.is_quad[light.patches.face]
    found[triangles, 3] = found[triangles, 2]  # polygons of a display mesh repeat their third corner
    return found


def moves(light: Polynomials, mesh: DisplayMesh) -> np.ndarray:
    """Return by how much each polynomial is moved at the corners of its patch, (n_patches, 4, n)."""
    own = _at_corners(light)
    apart = mesh.smoothed_corners(own)[mesh.polygons] - own
    size = mesh.smoothed_corners(np.abs(own))
    error = light.error_at_corners()
    noise = 0.0 if error is None else NOISE * mesh.smoothed_corners(error)
    unlike = np.maximum(mesh.smoothed_corners(np.abs(apart)) - noise, 0) / np.maximum(size, 1e-300)  # at each vertex
    share = np.clip((UNLIKE[1] - unlike.max(axis=1)) / (UNLIKE[1] - UNLIKE[0]), 0, 1)
    return apart * share[mesh.polygons][:, :, None]


def moved(light: Polynomials, way: np.ndarray, patch: np.ndarray, weights: np.ndarray, u, v) -> np.ndarray:
    """Return values at points of patches, (m, n), moved to what polynomials that meet at corners have there in the mean.

    Args:
        way: what `moves` returned.
        patch, u, v: (m,) patches and face coordinates.
        weights: (m, 4) shares of the corners of each patch's polygon.
    """
    shifts = np.where(np.expand_dims(weights > 0, -1), way[patch], 0.0)
    return np.maximum(light.at(patch, u, v) + np.einsum("mc,mcn->mn", weights, shifts), 0)
