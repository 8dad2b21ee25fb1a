"""Polygons are cut without gain or loss of area, whatever plane they lie in."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radiosity.scene.formats.polygon import triangulate, vector_area

pytest.importorskip("mapbox_earcut")


def areas(points, triangles):
    one, two, three = (points[triangles[:, i]] for i in range(3))
    return np.cross(two - one, three - one) / 2


def turned(flat, seed):
    """Points of a plane, moved to another plane of space."""
    axes = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return np.column_stack([flat, np.zeros(len(flat))]) @ axes.T + axes[0] * 100


@given(st.lists(st.floats(0.1, 10.0), min_size=3, max_size=40), st.integers(0, 1000), st.booleans())
def test_star_shaped_polygons_keep_their_area_and_side(radii, seed, clockwise):
    angle = np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    flat = np.array(radii)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    points = turned(flat[::-1] if clockwise else flat, seed)
    triangles, difference = triangulate(points)
    assert difference < 1e-9
    expected = vector_area(points)
    np.testing.assert_allclose(areas(points, triangles).sum(axis=0), expected, atol=1e-9 * np.abs(expected).max() + 1e-12)
    assert (areas(points, triangles) @ expected >= -1e-9 * (expected @ expected)).all()


def test_a_hole_joined_by_a_seam():
    flat = np.array([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)], float)
    points = turned(flat, 3)
    triangles, difference = triangulate(points)
    assert difference < 1e-12
    assert np.linalg.norm(areas(points, triangles), axis=1).sum() == pytest.approx(12.0)
    centres = flat[triangles].mean(axis=1)
    assert not ((centres > 1) & (centres < 3)).all(axis=1).any()


def test_seams_that_run_across_their_own_holes():
    outline, far, near = [(0, 0), (8, 0), (8, 4), (0, 4)], [(5, 1), (5, 3), (7, 3), (7, 1)], [(1, 1), (1, 3), (3, 3), (3, 1)]
    flat = np.array([*outline, far[3], *far, outline[3], near[3], *near, outline[3]], float)  # as mgfilt makes them of holes
    triangles, difference = triangulate(turned(flat, 4))
    assert difference < 1e-12
    centres = flat[triangles].mean(axis=1)
    for hole in (far, near):
        assert not ((centres > np.min(hole, axis=0)) & (centres < np.max(hole, axis=0))).all(axis=1).any()


def test_a_polygon_that_crosses_itself_says_so():
    star = turned(np.array([(0, 3), (2, -3), (-3, 1), (3, 1), (-2, -3)], float), 1)
    assert triangulate(star)[1] > 0.01


def test_no_area_no_triangles():
    line = turned(np.column_stack([np.arange(5.0), np.zeros(5)]), 2)
    assert len(triangulate(line)[0]) == 0
    assert len(triangulate(np.ones((6, 3)))[0]) == 0


def test_a_bent_polygon_keeps_its_corners():
    points = np.array([(0, 0, 0), (1, 0, 0.1), (2, 0, 0), (2, 1, 0), (0, 1, 0.05)])
    triangles, _ = triangulate(points)
    assert set(triangles.ravel()) == set(range(5))
    np.testing.assert_allclose(areas(points, triangles).sum(axis=0), vector_area(points))
