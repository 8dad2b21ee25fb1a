"""Hemicubes: their pixels, rows against exact form factors, backs, and what low resolution and alignment do."""

import numpy as np
import pytest
from enclosures import cube

import radiosity as rd
from radiosity.device.backend import choose
from radiosity.errors import MethodError
from radiosity.factors.hemicube import Hemicube, deltas, directions
from radiosity.factors.polygons import exchange, from_points
from radiosity.patches import Patches
from radiosity.scene.shapes import quad
from radiosity.tracing.geometry import Geometry


def geometry_of(patches: Patches) -> Geometry:
    return Geometry(patches, choose("cpu"))


@pytest.mark.parametrize("resolution", [2, 8, 64, 1000])
def test_form_factors_of_pixels_sum_to_one(resolution):
    assert deltas(resolution).shape == (3 * resolution**2,)
    assert deltas(resolution).min() > 0
    assert abs(deltas(resolution).sum() - 1) < 1e-14


def test_form_factors_at_middles_of_pixels_do_not():
    """The wrong variant: cosines over distance squared, at the middle of a pixel, times its area."""
    ways = directions(64)
    across = np.abs(ways).max(axis=1)  # cosine on the face of the cube; the distance is 1 over it
    middles = ways[:, 2] * across**3 / np.pi * 4 / 64**2
    assert middles == pytest.approx(deltas(64), rel=1e-3)
    assert abs(middles.sum() - 1) > 1e-4


def test_pixels_are_rectangles_about_their_directions():
    """Lambert's form factor of each pixel, made from its direction, by another formula."""
    n, ways = 6, directions(6)
    axis = np.abs(ways).argmax(axis=1)
    points = ways / np.abs(ways).max(axis=1)[:, None]
    corners = []
    for point, a in zip(points, axis, strict=True):
        sides = [np.eye(3)[(a + k) % 3] / n for k in (1, 2)]
        rim = np.array([point + s * sides[0] + t * sides[1] for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
        corners.append(rim[::-1] if point[a] > 0 else rim)
    found = from_points(np.zeros((len(ways), 3)), np.tile([0, 0, 1.0], (len(ways), 1)), np.array(corners))
    assert deltas(n) == pytest.approx(found, rel=1e-10)
    assert len(np.unique(points.round(9), axis=0)) == 3 * n * n


def test_rows_converge_to_the_form_factors_of_centre_points():
    """In a box of 216 patches: the RMS error falls at least as 1 / resolution, and with random angles is smaller."""
    patches = rd.subdivide(cube(), cells=6)
    geometry, n = geometry_of(patches), len(patches)
    i, j = (x.ravel() for x in np.indices((n, n)))
    truth = from_points(patches.centroid[i], patches.normal[i], patches.corners[j]).reshape(n, n)
    errors = {}
    for turned in (False, True):
        for resolution in (16, 64):
            factors = Hemicube(resolution, turned).rows(geometry, np.arange(n))
            assert factors.dense().sum(axis=1) == pytest.approx(np.ones(n), abs=1e-13)
            assert not factors.escaped.any()
            assert not factors.lost.any()
            errors[turned, resolution] = np.sqrt(np.mean((factors.dense() - truth) ** 2))
    assert errors[False, 64] < errors[False, 16] / 3.5
    assert errors[True, 64] < errors[True, 16] / 4
    assert errors[True, 64] < 0.02 * np.sqrt(np.mean(truth**2))
    assert errors[True, 64] < errors[False, 64]


def test_one_point_is_not_a_patch():
    """More pixels do not bring a centre point's factor nearer to that of the patch: the near-field error of the method."""
    patches = rd.subdivide(cube(), cells=1)
    factors = Hemicube(512).rows(geometry_of(patches), np.arange(6)).dense()
    exact = exchange(patches.corners[[0]], patches.corners[[1]])[0]
    point = from_points(patches.centroid[[0]], patches.normal[[0]], patches.corners[[1]])[0]
    assert factors[0, 1] == pytest.approx(point, rel=1e-3)
    assert point > 1.19 * exact


def test_a_row_is_a_function_of_seed_replicate_and_patch():
    patches = rd.subdivide(rd.load_scene("room"), size=0.5)
    geometry, n = geometry_of(patches), len(patches)
    all_rows = Hemicube(32, seed=3, replicate=1).rows(geometry, np.arange(n))
    dense = all_rows.dense()
    some = np.array([n - 1, 5, 17])
    few = Hemicube(32, seed=3, replicate=1).rows(geometry, some)
    found = np.zeros((3, n))
    found[few.rows, few.columns] = few.values
    assert (found == dense[some]).all()
    assert (few.escaped == all_rows.escaped[some]).all()
    assert (few.lost == all_rows.lost[some]).all()
    assert (np.diff(all_rows.rows * n + all_rows.columns) > 0).all()
    for other in (Hemicube(32, seed=4, replicate=1), Hemicube(32, seed=3, replicate=2)):
        assert (other.rows(geometry, np.arange(n)).dense() != dense).any()
    assert len(Hemicube(32).rows(geometry, np.zeros(0, int)).values) == 0


@pytest.mark.parametrize("back", [rd.Back.ABSORBS, rd.Back.RADIATES, rd.Back.PASSES])  # OPEN is refused
def test_backs_absorb_radiate_or_pass(back):
    """A sheet seen from behind, half way to a receiver (as in test_lines.py)."""
    quads = [quad((0, 0, z), (1, 0, 0), (0, 1, 0)) for z in (0.0, 0.5)] + [quad((-9, -9, 1.0), (0, 20, 0), (20, 0, 0))]
    scene = rd.Scene.from_arrays(
        np.concatenate(quads), np.arange(12).reshape(3, 4), 0.0, 1.0, back=[rd.Back.ABSORBS, back, rd.Back.ABSORBS]
    )
    patches = rd.subdivide(scene, cells=1)
    factors = Hemicube(256).rows(geometry_of(patches), [0])
    found = dict(zip(factors.columns.tolist(), factors.values.tolist(), strict=True))
    point, normal = patches.centroid[[0]], patches.normal[[0]]
    sheet = from_points(point, normal, quads[1][None, ::-1])[0]
    receiver = from_points(point, normal, quads[2][None])[0]
    absorbs, radiates, passes = (back == kind for kind in (rd.Back.ABSORBS, rd.Back.RADIATES, rd.Back.PASSES))
    last = len(patches) - 1
    assert factors.lost[0] == pytest.approx(sheet if absorbs else 0, abs=2e-3)
    assert found.get(2 if radiates else 1, 0) == pytest.approx(sheet if radiates else 0, abs=2e-3)
    assert found[last] == pytest.approx(receiver if passes else receiver - sheet, abs=2e-3)
    assert factors.escaped[0] == pytest.approx(1 - receiver, abs=2e-3)


def test_what_aligned_cubes_get_wrong_no_average_repairs():
    """A lamp of a tenth of a metre, a metre over 1600 patches: relative RMS errors of the numbers in docs/baselines.md."""
    floor, lamp = quad((0, 0, 0), (2, 0, 0), (0, 2, 0)), quad((0.95, 0.95, 1), (0, 0.1, 0), (0.1, 0, 0))
    scene = rd.Scene.from_arrays(np.concatenate([floor, lamp]), np.arange(8).reshape(2, 4), 0.0, [0.0, 1.0])
    patches = Patches(scene, np.array([40, 1], np.int32), np.array([40, 1], np.int32))
    geometry, count, some = geometry_of(patches), 1600, np.arange(0, 1600, 3)  # every third patch, of all rows and columns
    truth = from_points(patches.centroid[some], patches.normal[some], np.tile(patches.corners[-1], (len(some), 1, 1)))

    def seen(resolution: int, turned: bool, replicate: int) -> np.ndarray:
        factors = Hemicube(resolution, turned, 0, replicate).rows(geometry, some)
        light = factors.columns == count
        return np.bincount(factors.rows[light], weights=factors.values[light], minlength=len(some))

    def error(found: np.ndarray) -> float:
        return float(np.sqrt(np.mean((found - truth) ** 2) / np.mean(truth**2)))

    aligned = {resolution: error(seen(resolution, False, 0)) for resolution in (8, 32, 64)}
    turned = np.array([seen(32, True, replicate) for replicate in range(8)])
    assert aligned[8] > 1.5  # five sixths of the floor do not see the lamp, the rest gets several times its share
    assert (seen(32, False, 1) == seen(32, False, 0)).all()  # replicates say nothing of it
    assert error(turned[0]) < 0.8 * aligned[32]
    assert error(turned.mean(axis=0)) < error(turned[0]) / 2
    assert 0 < aligned[64] < aligned[32] / 2 < aligned[8] / 8


@pytest.mark.parametrize("resolution", [0, 3, -2, 4096])
def test_resolutions_that_cannot_be(resolution):
    with pytest.raises(MethodError, match="resolution"):
        Hemicube(resolution)
