"""The form factor of a point and a polygon against closed forms, sums over closed boxes, and quadrature below the horizon."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.factors.polygons import from_points
from radiosity.scene.shapes import box, quad

SQUARE = quad((0, 0, 1), (0, 1, 0), (1, 0, 0))  # looks down


def one(point, normal, corners) -> float:
    return float(from_points(np.array([point], float), np.array([normal], float), np.asarray(corners, float)[None])[0])


def test_a_corner_below_a_square():
    """Howell's catalogue B-4: a point under a corner, parallel."""
    x = 1 / np.sqrt(2)
    assert one((0, 0, 0), (0, 0, 1), SQUARE) == pytest.approx(2 * x * np.arctan(x) / (2 * np.pi), rel=1e-14)


@pytest.mark.parametrize("height", [0.1, 1.0, 3.0])
def test_a_square_at_right_angles(height):
    """Howell's catalogue B-3: a point at the foot's corner, the square standing on its plane."""
    wall = quad((1, 0, 0), (0, 0, height), (0, 1, 0)) if height else None
    expected = (np.arctan(1) - np.arctan(1 / np.hypot(1, height)) / np.hypot(1, height)) / (2 * np.pi)
    assert one((0, 0, 0), (0, 0, 1), wall) == pytest.approx(expected, rel=1e-12)


def test_no_light_from_behind_or_below():
    assert one((0, 0, 0), (0, 0, 1), SQUARE[::-1]) == 0
    assert one((0, 0, 0), (0, 0, -1), SQUARE) == 0
    assert one((0, 0, 2), (0, 0, -1), SQUARE) == 0
    assert one((3, 0, 1), (1, 0, 0), SQUARE) == 0  # in the square's plane


def test_all_directions_of_a_closed_box_add_up_to_one(random):
    """Whatever way a point's surface is turned, what its horizon cuts off included."""
    walls = np.array(box((0, 0, 0), (2, 1, 3), inward=True))
    points, normals = random.uniform(0.01, 0.99, (300, 3)) * (2, 1, 3), random.normal(size=(300, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    total = sum(from_points(points, normals, np.broadcast_to(wall, (300, 4, 3))) for wall in walls)
    np.testing.assert_allclose(total, 1, rtol=1e-13)


def test_halves_of_a_square_add_up_whichever_corner_is_repeated(random):
    a, b, c, d = SQUARE
    points, normals = random.uniform(-1, 1, (200, 3)) * (1, 1, 0.5), random.normal(size=(200, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    whole, *halves = (
        from_points(points, normals, np.broadcast_to(np.array(x), (200, 4, 3))) for x in (SQUARE, (a, b, c, c), (a, a, c, d))
    )
    np.testing.assert_allclose(sum(halves), whole, atol=1e-15)
    assert (whole > 0).sum() > 50


def test_against_quadrature_where_the_horizon_cuts(random):
    scene = rd.Scene.from_arrays(SQUARE, [(0, 1, 2, 3)], 0.5, 1.0)
    places = rd.subdivide(scene, cells=200)
    for _ in range(5):
        point, normal = random.uniform(-1, 1, 3) * (1, 1, 0.5), random.normal(size=3)
        normal /= np.linalg.norm(normal)
        way = places.centroid - point
        square = (way**2).sum(axis=1)
        kernel = np.maximum(way @ normal, 0) * np.maximum(way[:, 2], 0) / (np.pi * square**2)
        # a line of cells that the horizon crosses has errors of its kernel's size: 1 % of all
        assert one(point, normal, SQUARE) == pytest.approx((kernel * places.area).sum(), rel=0.01, abs=1e-5)
