"""Local linear density estimation: exact on planes, up to the rim; its display mesh; and that it is worth it."""

import numpy as np
import pytest
from enclosures import cube

import radiosity as rd
from radiosity.image import density_mesh, display_mesh
from radiosity.solution.local_linear import CORNER, Regions, weights


@pytest.fixture(scope="module")
def patches():
    return rd.subdivide(cube(), cells=12)


def test_regions_are_walls(patches):
    regions = Regions.find(patches)
    assert regions.count == 6
    assert regions.area == pytest.approx(1.0)
    assert all(len(set(patches.surface[members])) == 1 for members in regions.members)


def test_a_plane_is_kept_up_to_its_corners(patches):
    regions = Regions.find(patches)
    arrivals = np.full(len(patches), 100)
    fit = weights(regions, arrivals, patches.centroid, regions.of)
    assert np.asarray(fit.sum(axis=1)).ravel() == pytest.approx(1.0)
    linear = patches.centroid @ [1.0, -2.0, 0.5] + 3
    assert fit @ linear == pytest.approx(linear)
    mesh = display_mesh.build(patches)
    corner, of = mesh.vertices[mesh.polygons[:, 0]], regions.of
    assert weights(regions, arrivals, corner, of, least=CORNER) @ linear == pytest.approx(corner @ [1.0, -2.0, 0.5] + 3)


def test_a_kernel_without_the_fit_is_rejected_at_the_rim(patches):
    regions = Regions.find(patches)
    linear = patches.centroid @ [1.0, -2.0, 0.5] + 3
    mean = weights(regions, np.full(len(patches), 100), patches.centroid, regions.of, planes=False)
    assert mean.data.min() >= 0
    assert np.asarray(mean.sum(axis=1)).ravel() == pytest.approx(1.0)
    assert np.abs(mean @ linear - linear).max() > 0.02


def test_a_cell_larger_than_the_kernel_stands_alone():
    patches = rd.subdivide(cube(), cells=1)
    regions = Regions.find(patches)
    fit = weights(regions, np.full(6, 10**6), patches.centroid, regions.of)
    assert np.array_equal(fit.toarray(), np.eye(6))


def test_it_errs_less_than_counting_at_few_lines():
    patches = rd.subdivide(rd.load_scene("room"), cells=24)
    exact = rd.solve(patches, "particle-tracing", rays=4_000_000, seed=3).irradiance[:, 0]

    def rms(method):
        found = rd.solve(patches, method, rays=300_000).irradiance[:, 0]
        return np.sqrt(np.average((found - exact) ** 2, weights=patches.area))

    assert rms("density-estimation") < 0.75 * rms("particle-tracing")


def test_display_mesh_covers_every_surface_with_fewer_polygons():
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=32)
    solution = rd.solve(patches, "density-estimation", rays=2_000_000)
    mesh, values, patch = density_mesh.display(solution, "irradiance")
    corners = mesh.vertices[mesh.polygons]
    area = np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1) / 2
    assert len(patch) < 0.95 * len(patches)
    surface = np.bincount(patches.surface, patches.area)
    assert np.bincount(patches.surface[patch], area) == pytest.approx(surface)
    assert values.shape == (len(mesh.vertices), 3)
    # merged or not, means over surfaces are those of the patches
    mean = np.bincount(patches.surface[patch], area * values[mesh.polygons].mean(axis=1)[:, 0]) / surface
    assert mean == pytest.approx(np.bincount(patches.surface, patches.area * solution.irradiance[:, 0]) / surface, rel=0.03)


@pytest.mark.parametrize("two_sided", [False, True])
def test_blocks_are_merged_where_values_are_even(two_sided):
    square = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]], 0.5, 1.0, two_sided=two_sided)
    patches = rd.subdivide(square, cells=8)
    solution = rd.solve(patches, "random-walk", rays=1000, replicates=1)
    mesh = display_mesh.build(patches)
    flat = np.ones((len(mesh.vertices), 1))
    assert len(density_mesh.merged(solution, mesh, flat)[1]) == 1 + two_sided
    steep = np.where(mesh.vertices[:, :1] > 0.49, 2.0, 1.0)  # a step: cells beside it stay
    coarse, patch = density_mesh.merged(solution, mesh, steep)
    assert 4 < len(patch) < 64 * (1 + two_sided)
    corners = coarse.vertices[coarse.polygons]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0])[:, 2]
    assert np.abs(normal).sum() == pytest.approx(1 + two_sided)
    assert np.array_equal(normal < 0, patches.is_back[patch])
    # each block begins with the cell at its corner next to the face's origin
    low, high = corners.min(axis=1), corners.max(axis=1)
    np.testing.assert_allclose((patches.centroid[patch] - low)[:, :2], 1 / 16)
    assert len(set(patch)) == len(patch)
    assert set(np.round((high - low)[:, 0] * 8)) == {1, 2, 4}


def test_exports_use_its_mesh(tmp_path):
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=16)
    solution = rd.solve(patches, "density-estimation", rays=2_000_000)
    counted = rd.solve(patches, "particle-tracing", rays=2_000_000)
    solution.export(tmp_path / "one.glb")
    counted.export(tmp_path / "other.glb")
    assert (tmp_path / "one.glb").stat().st_size < (tmp_path / "other.glb").stat().st_size
    solution.save(tmp_path / "one.npz")
    again = rd.load_solution(tmp_path / "one.npz")
    again.export(tmp_path / "again.glb")
    assert (tmp_path / "again.glb").read_bytes() == (tmp_path / "one.glb").read_bytes()
