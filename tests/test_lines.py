"""From patch to line and from hit to patch, in kernels, against the same in numpy."""

import numpy as np
import pytest
from scipy import stats

import radiosity as rd
from radiosity.device.backend import choose, upload
from radiosity.patches import cells
from radiosity.tracing.faces import OFFSET
from radiosity.tracing.first_hits import first_hits
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.hits import first_hit, local_line, patch_of

ALPHA = 1e-4


def scene_of_all_kinds() -> rd.Scene:
    """A closed box of triangles and parallelograms, every side radiating, far from the origin."""
    vertices = np.array([(0, 0, 0), (2, 0, 0), (2, 3, 0), (0, 3, 0), (0, 0, 1), (2, 0, 1), (2, 3, 1), (0, 3, 1)], float)
    vertices += np.array([900.0, -50.0, 7.0])
    faces = [(0, 1, 2, -1), (0, 2, 3, -1), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, -1), (2, 7, 3, -1), (3, 7, 4, 0)]
    return rd.Scene.from_arrays(vertices, faces, 0.5, 1.0, two_sided=True)


def lines(patches, numbers, patch):
    device = choose("cpu")
    geometry = Geometry(patches, device)
    types = device.types
    import drjit as dr

    origin, direction = local_line(
        geometry,
        dr.gather(types.Array2u, geometry.patch_records, upload(types.UInt32, patch.astype(np.uint32))),
        [upload(types.Float, c.astype(np.float32)) for c in numbers.T],
    )
    hit = first_hit(geometry, origin, direction)
    landed = np.array(patch_of(geometry, hit, 2**32 - 2, 2**32 - 1))
    tree = geometry.bvh
    return np.array(origin).T / tree.scale + tree.centre, np.array(direction).T, landed


@pytest.mark.parametrize("k", [1, 3, 8])
def test_lines_begin_in_their_patch_and_land_where_numpy_says(k, random):
    scene = scene_of_all_kinds()
    patches = rd.subdivide(scene, cells=k)
    patch = random.integers(0, len(patches), 20_000)
    origin, direction, landed = lines(patches, random.random((len(patch), 4)), patch)
    front = np.einsum("ij,ij->i", direction, patches.normal[patch])
    assert front.min() > 0
    height = np.einsum("ij,ij->i", origin - patches.centroid[patch], patches.normal[patch])
    assert height.min() > 0
    assert height.max() < 3 * OFFSET * 4
    assert np.abs(np.linalg.norm(direction, axis=1) - 1).max() < 1e-6
    # the origin's own cell
    o, first, second = (edge[patches.face[patch]] for edge in scene.frames)
    basis = np.stack([first, second, np.cross(first, second)], axis=2)
    u, v, _ = np.linalg.solve(basis, (origin - o)[:, :, None])[:, :, 0].T
    face = patches.face[patch]
    cell = cells.number(u, v, patches.columns[face], patches.rows[face], scene.is_quad[face])
    own = patch - patches.first[face] - np.where(patches.is_back[patch], patches.cells_per_face[face], 0)
    assert (cell == own).mean() > 0.9995  # the rest lies on a cell's rim
    # inside, every line lands on the front of a face; outside, it escapes
    outside = patches.is_back[patch]
    assert (landed[outside] == 2**32 - 1).all()
    assert (landed[~outside] < len(patches)).all()
    hits = first_hits(scene, origin[~outside], direction[~outside])
    number = cells.number(hits.u, hits.v, patches.columns[hits.face], patches.rows[hits.face], scene.is_quad[hits.face])
    assert (patches.first[hits.face] + number == landed[~outside]).mean() > 0.999
    assert not patches.is_back[landed[~outside]].any()


def test_points_are_uniform_and_directions_cosine_distributed(random):
    patches = rd.subdivide(scene_of_all_kinds(), cells=1)
    numbers = random.random((40_000, 4))
    for number in (0, 2):  # a triangle, a parallelogram
        origin, direction, _ = lines(patches, numbers, np.full(len(numbers), number))
        cosine = direction @ patches.normal[number]
        assert stats.kstest(cosine**2, "uniform").pvalue > ALPHA
        face = patches.face[number]
        o, first, second = (edge[face] for edge in patches.scene.frames)
        u, v, _ = np.linalg.solve(np.stack([first, second, np.cross(first, second)], axis=1), (origin - o).T)
        if patches.scene.is_quad[face]:
            assert stats.chisquare(np.histogram2d(u, v, bins=8, range=[[0, 1], [0, 1]])[0].ravel()).pvalue > ALPHA
        else:
            eight, triangle = np.full(len(u), 8), np.zeros(len(u), bool)
            counts, wrong = (np.bincount(cells.number(x, v, eight, eight, triangle), minlength=64) for x in (u, np.sqrt(u)))
            assert stats.chisquare(counts).pvalue > ALPHA
            assert stats.chisquare(wrong).pvalue < ALPHA


def stack(back: rd.Back) -> rd.Scene:
    """An emitter below, a sheet seen from behind, and a receiver above, in a column with black walls."""
    from radiosity.scene.shapes import quad

    quads = [quad((0, 0, z), (1, 0, 0), (0, 1, 0)) for z in (0.0, 0.5)] + [quad((-9, -9, 1.0), (0, 20, 0), (20, 0, 0))]
    return rd.Scene.from_arrays(
        np.concatenate(quads),
        np.arange(12).reshape(3, 4),
        [0.0, 0.0 if back is rd.Back.OPEN else 0.5, 0.0],
        [1.0, 0.0, 0.0],
        back=[rd.Back.ABSORBS, back, rd.Back.ABSORBS],
        surface=[0, 1, 2],
        names=["emitter", "sheet", "receiver"],
    )


@pytest.mark.parametrize("order", ["breadth-first", "depth-first"])
def test_backs_absorb_radiate_or_pass(order):
    solved = {back: rd.solve(stack(back), rays=200_000, replicates=2, order=order) for back in rd.Back}
    assert [len(s.patches.scene.names) for s in solved.values()] == [3] * len(rd.Back)
    received = {back: {row["surface"]: row["received"] for row in s.surface_table()} for back, s in solved.items()}
    exact = 0.41525  # parallel unit squares at half their width (Howell C-11)
    absorbed, radiated, passed = (received[b] for b in (rd.Back.ABSORBS, rd.Back.RADIATES, rd.Back.PASSES))
    assert solved[rd.Back.ABSORBS].books[0]["lost"] == pytest.approx(exact, abs=0.005)
    assert absorbed["sheet"] == 0
    assert radiated["sheet"] == pytest.approx(exact, abs=0.005)
    assert solved[rd.Back.RADIATES].books[0]["lost"] == 0
    assert passed["sheet"] == 0
    assert solved[rd.Back.PASSES].books[0]["lost"] == 0
    assert passed["receiver"] == pytest.approx(absorbed["receiver"] + exact, abs=0.01)
    assert received[rd.Back.OPEN] == passed
    for solution in solved.values():
        assert solution.books[0]["closes"]


def test_place_and_size_do_not_matter():
    patches = {}
    for scale, move in ((1.0, 0.0), (1e-4, 3.0e-4), (1e6, -5e5)):
        scene = rd.load_scene("room")
        moved = rd.Scene.from_arrays(
            scene.vertices * scale + move,
            scene.faces,
            scene.reflectance,
            scene.emission,
            back=scene.back,
            back_reflectance=scene.back_reflectance,
            back_emission=scene.back_emission,
            surface=scene.surface,
            names=scene.names,
        )
        patches[scale] = rd.solve(rd.subdivide(moved, cells=3), "random-walk", rays=500_000)
    for solution in patches.values():
        assert solution.escaped[0] == 0
        z = (solution.radiosity - patches[1.0].radiosity)[solution.arrivals > 0]
        error = np.hypot(solution.standard_error, patches[1.0].standard_error)[solution.arrivals > 0]
        known = error > 0
        assert np.abs(z[known] / error[known]).max() < 6
