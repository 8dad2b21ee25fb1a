"""Points on the rims of faces, u or v exactly 0 or 1, and between cells: met on purpose, since lines meet them by chance.

Whatever kernels say of a hit there is compared with `patches.cells`, and that with the cell's own corners.
"""

from dataclasses import replace
from types import SimpleNamespace

import drjit as dr
import numpy as np
import pytest

import radiosity as rd
from radiosity.device.backend import choose, upload
from radiosity.image.lookup import Lookup
from radiosity.patches import cells
from radiosity.tracing.first_hits import first_hits
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.hits import first_hit, patch_of, place_of

SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
RAISED = [(x + 4, y, z) for x, y, z in SQUARE]
FACES = {
    "quads": [[0, 1, 2, 3], [4, 5, 6, 7]],
    "triangles": [[0, 1, 3, -1], [4, 5, 7, -1]],
    "both": [[0, 1, 2, 3], [4, 5, 7, -1]],
}
BACK = 1 << 31
ESCAPED, ABSORBED = 2**32 - 1, 2**32 - 2


def scene(kind: str, **more) -> rd.Scene:
    """Two faces side by side, seen from above; a wrong cell of the first is one of the second."""
    return rd.Scene.from_arrays(SQUARE + RAISED, FACES[kind], 0.5, 1.0, **more)


def rims(quad: bool, k: int) -> np.ndarray:
    """(m, 2) face coordinates: points on the rim and its corners, on the lines between cells and where these meet, and within."""
    at = (np.unique(np.concatenate([np.arange(k + 1), np.arange(k) + 0.25, np.arange(k) + 0.75])) / k).astype(np.float32)
    u, v = (x.ravel() for x in np.meshgrid(at, at))
    if not quad:
        u, v = u[u + v <= 1], v[u + v <= 1]
    return np.column_stack([u, v])


def holds(patches: rd.Patches, patch: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(m,) bool: the patch's polygon holds the point, or nearly (single precision)."""
    corners, normal = patches.corners[patch], patches.normal[patch]
    edges = np.roll(corners, -1, axis=1) - corners
    inward = np.einsum("ijk,ik->ij", np.cross(edges, points[:, None] - corners), normal)
    return (inward >= -1e-6).all(axis=1)


def straight(geometry: Geometry, points: np.ndarray, up: float):
    """Where lines straight up or down from points, metres, land."""
    types, tree = geometry.device.types, geometry.bvh
    origin = ((points - tree.centre) * tree.scale).astype(np.float32)
    zero = dr.zeros(types.Float, len(points))
    return first_hit(geometry, types.Array3f(*(upload(types.Float, x) for x in origin.T)), types.Array3f(zero, zero, zero + up))


@pytest.mark.parametrize("k", [1, 2, 3, 7])
@pytest.mark.parametrize("quad", [True, False])
def test_cells_on_rims_hold_the_point(quad, k):
    patches = rd.subdivide(scene("quads" if quad else "triangles"), cells=k)
    u, v = rims(quad, k).T
    number = cells.number(u, v, *(np.full(len(u), value) for value in (k, k, quad)))
    assert ((number >= 0) & (number < k * k)).all()
    assert set(number) == set(range(k * k))
    assert holds(patches, number, np.column_stack([u, v, 0 * u])).all()
    last = cells.number(*np.array([[1.0, 0, 1], [0, 1, 1]]), *(np.full(3, value) for value in (k, k, quad)))
    assert last[:2].tolist() == ([k - 1, k * k - k] if quad else [2 * k - 2, k * k - 1])
    assert not quad or last[2] == k * k - 1


@pytest.mark.parametrize("back", [rd.Back.ABSORBS, rd.Back.RADIATES, rd.Back.PASSES], ids=str)
@pytest.mark.parametrize("k", [1, 3, 4])
@pytest.mark.parametrize("kind", FACES)
def test_kernels_find_the_cell_of_a_hit_on_a_rim(kind, k, back):
    """A hit in the middle of each face and on either side, put onto its rims."""
    patches = rd.subdivide(scene(kind, back=back), cells=k)
    geometry = Geometry(patches, choose("cpu"))
    geometry.prepare()
    types, quads = geometry.device.types, patches.scene.is_quad
    for face, front in ((0, True), (1, True), (0, False), (1, False)):
        if not front and back == rd.Back.PASSES:
            continue
        u, v = rims(bool(quads[face]), k).T
        height = 1.0 if front else -1.0
        hit = straight(geometry, np.tile([face * 4 + 0.2, 0.3, height], (len(u), 1)), -height)
        hit = replace(hit, u=upload(types.Float, u), v=upload(types.Float, v))
        found = np.array(patch_of(geometry, hit, ABSORBED, ESCAPED))
        on_face, s, t = (np.array(x) for x in place_of(geometry, hit))
        number = cells.number(u, v, *(np.full(len(u), value) for value in (k, k, quads[face])))
        radiates = not front and back == rd.Back.RADIATES
        if front or radiates:
            expected = patches.first[face] + number + (k * k if radiates else 0)
            assert holds(patches, found, np.column_stack([u + 4 * face, v, 0 * u])).all()
            assert (patches.is_back[found] == radiates).all()
            assert k == 3 or found.tolist() == expected.tolist()  # thirds are rounded: to which cell is open
        else:
            assert (found == ABSORBED).all()
        assert (on_face == (face | BACK if radiates else face)).all()
        np.testing.assert_allclose(np.column_stack([s, t]), k * np.column_stack([u, v]), rtol=1e-6)
        if back == rd.Back.ABSORBS:
            over = replace(hit, u=upload(types.Float, u * 1.0001 - 0.00005), v=upload(types.Float, v * 1.0001 - 0.00005))
            outside = np.array(patch_of(geometry, over, ABSORBED, ESCAPED))
            assert not front or ((outside >= patches.first[face]) & (outside < patches.first[face + 1])).all()
            most = np.array(place_of(geometry, over)[1:])
            assert most.min() >= 0
            assert most.max() <= k


@pytest.mark.parametrize("k", [1, 4])
@pytest.mark.parametrize("kind", FACES)
def test_lines_that_meet_rims_land_in_a_cell_that_holds_the_point(kind, k):
    """Straight down onto points of the rims and of the lines between cells, whose numbers single precision holds."""
    patches = rd.subdivide(scene(kind), cells=k)
    geometry = Geometry(patches, choose("cpu"))
    points = []
    for face in (0, 1):
        u, v = rims(bool(patches.scene.is_quad[face]), k).T
        points.append(np.column_stack([u + 4 * face, v, 0 * u]))
    points = np.concatenate(points)
    above = points + np.array([0, 0, 1])
    landed = np.array(patch_of(geometry, straight(geometry, above, -1.0), ABSORBED, ESCAPED))
    met = landed != ESCAPED
    assert met.mean() > 0.5  # a line on the rim itself may miss
    assert (landed[met] < len(patches)).all()
    assert holds(patches, landed[met], points[met]).all()
    inside = (np.abs(points % 4 - 0.5) < 0.5)[:, :2].all(axis=1) & ((points % 4)[:, :2].sum(axis=1) < 1)
    assert met[inside].all()
    hosts = first_hits(patches.scene, above, np.tile([0.0, 0, -1], (len(points), 1)))
    seen = Lookup(patches, np.arange(len(patches))[:, None], smooth=False)(hosts)[1]
    assert holds(patches, seen[seen >= 0], points[seen >= 0]).all()


@pytest.mark.parametrize("front", [True, False])
@pytest.mark.parametrize("kind", FACES)
def test_pictures_of_rims_show_the_corners_values(kind, front):
    """What is seen of a linear field is the field, on rims too."""
    patches = rd.subdivide(scene(kind, two_sided=True), cells=3)
    look = Lookup(patches, np.zeros((len(patches), 1)))
    vars(look)["at_vertices"] = (look.mesh.vertices @ [1.0, -2.0, 0.5] + 7.0)[:, None]
    vars(look.planes)["plane"] = np.full(len(patches), -1)  # values at vertices, not fits to planes of triangles
    for face in (0, 1):
        u, v = rims(bool(patches.scene.is_quad[face]), 3).astype(float).T
        hits = SimpleNamespace(face=np.full(len(u), face), u=u, v=v, front=np.full(len(u), front))
        values, patch = look(hits)
        np.testing.assert_allclose(values[:, 0], 7 + u + 4 * face - 2 * v, rtol=1e-6)
        assert (patches.face[patch] == face).all()
        assert (patches.is_back[patch] != front).all()
