"""Edges and their shadows: geometry of a light's place, an edge that stops its light, and the plane on which the shadow falls.

The light of a point that passes an edge lies on one side of the plane through both. So the shadow of the edge on a flat face is
straight. Of an extended lamp these are the events of an edge and a vertex (P. S. Heckbert, "Discontinuity meshing for radiosity",
3rd Eurographics Workshop on Rendering, 1992; D. Lischinski, F. Tampieri, D. P. Greenberg, "Discontinuity meshing for accurate
radiosity", IEEE Computer Graphics and Applications 12(6), 1992), with the lamp's middle in the place of its vertices: the line in
the middle of the penumbra. Places of lights are as in `lights`.
"""

import numpy as np

ENDS = 1e-3  # of an edge's length: so far beyond its ends it is taken for the edge
LOW = 1e-3  # of the height of a light over a plane: an edge that is nearer to the light's own height casts its shadow far away


def crossed(place: np.ndarray, lit: np.ndarray, dark: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return which edge of a face hides the light from the dark point, and not from the lit one: (m,) int64, -1 where none does.

    Args:
        place: (m, 4), of lights. lit, dark: (m, 3) points near each other.
        corners: (m, 4, 3) of the faces that lines from the dark points met. A triangle repeats its last corner.
    """
    start, edge = corners, np.roll(corners, -1, axis=1) - corners
    way = (place[:, :3] - place[:, 3:] * lit)[:, None]
    normal = np.cross(edge, place[:, None, :3] - place[:, None, 3:] * start)
    before, after = (np.einsum("kei,kei->ke", normal, point[:, None] - start) for point in (lit, dark))
    across = before * after < 0
    share = np.divide(before, before - after, out=np.zeros_like(before), where=across)
    from_start = lit[:, None] + share[:, :, None] * (dark - lit)[:, None] - start
    turn = np.cross(edge, way)
    square = np.maximum((turn**2).sum(axis=2), 1e-300)
    along = np.einsum("kei,kei->ke", np.cross(from_start, way), turn) / square
    ahead = np.einsum("kei,kei->ke", np.cross(from_start, edge), turn) / square
    found = across & (along >= -ENDS) & (along <= 1 + ENDS) & (ahead > 0)
    return np.where(found.any(axis=1), found.argmax(axis=1), -1)


def shadow_of(place: np.ndarray, ends: np.ndarray, origin: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the ends of the shadows of edges on planes, (m, 2, 3), and whether there are any, (m,) bool.

    Only what is above the plane and below the light casts a shadow.

    Args:
        place: (m, 4), of lights. ends: (m, 2, 3), of edges. origin, normal: (m, 3) of the planes; normals look at the lights.
    """
    height = np.einsum("mei,mi->me", ends - origin[:, None], normal)  # above the plane
    whole = np.einsum("mi,mi->m", place[:, :3] - place[:, 3:] * origin, normal)
    below = whole[:, None] - place[:, 3:] * height  # of the light
    least = LOW * np.abs(whole)
    low, high = np.zeros(len(ends)), np.ones(len(ends))
    for value, bound in ((height, np.zeros(len(ends))), (below, least)):
        slope = value[:, 1] - value[:, 0]
        at = np.divide(bound - value[:, 0], slope, out=np.zeros(len(ends)), where=slope != 0)
        low = np.where((value[:, 0] < bound) & (slope > 0), np.maximum(low, at), low)
        high = np.where((value[:, 1] < bound) & (slope < 0), np.minimum(high, at), high)
        high = np.where((value < bound[:, None]).all(axis=1), -1.0, high)
    there = (low < high) & (whole > 0)
    at = np.stack([low, np.where(there, high, 1.0)], axis=1)[:, :, None]
    points = ends[:, :1] + at * (ends[:, 1:] - ends[:, :1])
    height = np.einsum("mei,mi->me", points - origin[:, None], normal)
    way = place[:, None, :3] - place[:, None, 3:] * points
    down = np.einsum("mei,mi->me", way, normal)
    down = np.where(there[:, None], down, 1.0)
    return points - way * (height / down)[:, :, None], there
