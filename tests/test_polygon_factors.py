"""Form factors between polygons with nothing between them, against closed forms, sums of parts and quadrature."""

import numpy as np
import pytest
from enclosures import coaxial_discs, cube, sphere
from hypothesis import given
from hypothesis import strategies as st

import radiosity as rd
from radiosity.factors.polygons import exchange, from_points
from radiosity.factors.polygons.contour import around
from radiosity.scene.shapes import quad
from validation.closed_forms.rectangles import discs, inclined, parallel, perpendicular


def one_pair(one: np.ndarray, other: np.ndarray) -> float:
    return float(exchange(one[None], other[None])[0])


def triangle(a, b, c) -> np.ndarray:
    return np.array([a, b, c, c], float)


def plates(a: float, b: float, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Widths a and b, with a common edge of length one, that look into the angle between them."""
    return quad((0, 0, 0), (0, 1, 0), (-a, 0, 0)), quad((0, 0, 0), (-b * np.cos(angle), 0, b * np.sin(angle)), (0, 1, 0))


@pytest.mark.parametrize(("a", "b"), [(1, 1), (0.3, 2), (40, 60), (0.05, 0.05)])
def test_opposed_rectangles(a, b):
    found = one_pair(quad((0, 0, 0), (a, 0, 0), (0, b, 0)), quad((0, 0, 1), (0, b, 0), (a, 0, 0)))
    assert found == pytest.approx(parallel(a, b), rel=1e-9)


def test_small_squares_far_apart():
    """The closed form has no digits left there; F A of points is A² / pi, and the first correction is 2 A / 3 of it."""
    found = one_pair(quad((0, 0, 0), (1e-3, 0, 0), (0, 1e-3, 0)), quad((0, 0, 1), (0, 1e-3, 0), (1e-3, 0, 0)))
    assert found == pytest.approx(1e-12 / np.pi * (1 - 2e-6 / 3), rel=1e-10)


@pytest.mark.parametrize(("width", "height"), [(1, 1), (0.02, 3), (10, 7), (0.5, 0.5)])
def test_perpendicular_rectangles(width, height):
    found = one_pair(quad((0, 0, 0), (1, 0, 0), (0, width, 0)), quad((0, 0, 0), (0, 0, height), (1, 0, 0)))
    assert found == pytest.approx(perpendicular(width, height), rel=1e-10)


@pytest.mark.parametrize(("a", "b"), [(1, 1), (0.5, 2), (3, 0.2)])
@pytest.mark.parametrize("degrees", [15, 60, 90, 120, 165])
def test_inclined_rectangles(a, b, degrees):
    angle = np.deg2rad(degrees)
    assert one_pair(*plates(a, b, angle)) == pytest.approx(inclined(a, b, angle), rel=1e-9)


def test_walls_of_a_cube_and_rows_of_closed_boxes():
    corners = rd.subdivide(cube(), cells=1).corners
    i, j = (x.ravel() for x in np.indices((6, 6)))
    factors = exchange(corners[i], corners[j]).reshape(6, 6)
    assert np.unique(factors.round(12)) == pytest.approx([0, parallel(1, 1), perpendicular(1, 1)], abs=1e-12)
    assert factors.sum(axis=1) == pytest.approx(np.ones(6), abs=1e-13)


@pytest.mark.parametrize(("scene", "cells"), [(cube(), 2), (sphere(0.5, 1.0, 1), 1)], ids=["cube", "sphere"])
def test_reciprocity_and_rows_of_convex_enclosures(scene, cells):
    patches = rd.subdivide(scene, cells=cells)
    i, j = (x.ravel() for x in np.indices((len(patches),) * 2))
    factors = exchange(patches.corners[i], patches.corners[j]).reshape(len(patches), -1)
    assert factors == pytest.approx(factors.T, rel=1e-9, abs=1e-13)
    assert factors.sum(axis=1) == pytest.approx(patches.area, rel=1e-10)


def test_discs_of_triangles():
    """Regular polygons of the circles' areas: the difference falls with the fourth power of the number of sides."""
    exact, errors = discs(1.0, 0.7, 0.9), []
    for sides in (24, 48):
        patches = rd.subdivide(coaxial_discs(1.0, 0.7, 0.9, sides)[0], cells=1)
        first, second = (patches.corners[patches.surface == k] for k in (0, 1))
        i, j = (x.ravel() for x in np.indices((len(first), len(second))))
        errors.append(exchange(first[i], second[j]).sum() - exact)
    assert abs(errors[1]) < 1e-5 * exact
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.1)


def test_separate_perpendicular_rectangles_by_view_factor_algebra():
    """Strips of two plates with a common edge that do not touch it, and one moved along the edge."""
    floor, wall = quad((0, 0, 0), (1, 0, 0), (0, 2, 0)), quad((0, 0, 0), (0, 0, 3), (1, 0, 0))
    strip, high = quad((0, 0.5, 0), (1, 0, 0), (0, 1.5, 0)), quad((0, 0, 1), (0, 0, 2), (1, 0, 0))
    algebra = perpendicular(2, 3) - perpendicular(0.5, 3) - perpendicular(2, 1) + perpendicular(0.5, 1)
    assert one_pair(strip, high) == pytest.approx(algebra, rel=1e-10)
    assert one_pair(floor, wall) == pytest.approx(perpendicular(2, 3), rel=1e-10)
    # along an edge of length two, each half of the floor sees both halves of the wall
    beside, both = quad((1, 0, 0), (0, 0, 3), (1, 0, 0)), 2**2 * perpendicular(1, 1.5)
    assert one_pair(floor, beside) == pytest.approx(both / 2 - perpendicular(2, 3), rel=1e-10)


def test_coplanar_and_averted_polygons_exchange_exactly_nothing(random):
    floor = quad((0, 0, 0), (1, 0, 0), (0, 1, 0))
    beside, below, ceiling = (
        floor + np.array([1, 0, 0]),
        quad((0, 0, -1), (1, 0, 0), (0, 1, 0)),
        quad((0, 0, 1), (1, 0, 0), (0, 1, 0)),
    )
    for other in (floor, beside, below, ceiling, floor[::-1], below[::-1]):
        assert one_pair(floor, other) == 0
        for _ in range(20):
            turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
            turn *= np.sign(np.linalg.det(turn))
            place = random.normal(size=3) * 1e3
            assert one_pair(floor @ turn.T + place, other @ turn.T + place) == 0


def test_what_lies_behind_is_cut_away():
    floor, wall = quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, -2), (0, 0, 3), (1, 0, 0))
    assert one_pair(floor, wall) == pytest.approx(perpendicular(1, 1), rel=1e-12)
    assert float(around(floor[None], wall[None])[0]) != pytest.approx(perpendicular(1, 1), rel=0.1)  # the wrong way
    # a corner of a triangle sticks through: the part above, by hand
    pierced = triangle((0.2, 1.5, -1), (0.8, 1.5, 1), (0.2, 1.5, 1))
    above = np.array([(0.2, 1.5, 0), (0.5, 1.5, 0), (0.8, 1.5, 1), (0.2, 1.5, 1)])
    assert one_pair(floor, pierced) == pytest.approx(one_pair(floor, above), rel=1e-10)
    assert one_pair(floor, above) > 0.01
    # both cut each other
    crossed = quad((0, 0.5, -1), (0, 0, 2), (1, 0, 0))
    assert one_pair(floor, crossed) == pytest.approx(perpendicular(0.5, 1), rel=1e-10)


def parts(polygon: np.ndarray) -> list[np.ndarray]:
    """Four triangles of a triangle; of a parallelogram three pieces that meet in a T."""
    a, b, c, d = polygon
    if (c == d).all():
        e, f, g = (a + b) / 2, (b + c) / 2, (c + a) / 2
        return [triangle(*t) for t in ((a, e, g), (e, b, f), (g, f, c), (e, f, g))]
    e, f, g, h = a + 0.3 * (b - a), d + 0.3 * (c - d), b + 0.6 * (c - b), a + 0.3 * (b - a) + 0.6 * (d - a)
    return [np.array(q) for q in ((a, e, f, d), (e, b, g, h), (h, g, c, f))]


TOUCHING = {
    "edge": ((0, 0, 0), (1, 0.2, 0), (0.9, 0.4, 1.1)),
    "corner": ((0, 0, 0), (-0.3, 0.8, 1.2), (0.9, 0.4, 1.1)),
    "corner on an edge": ((0.4, 0.08, 0), (-0.3, 0.8, 1.2), (0.9, 0.4, 1.1)),
    "part of an edge": ((0.3, 0.06, 0), (0.8, 0.16, 0), (0.9, 0.4, 1.1)),
    "corner on the face": ((0.5, 0.3, 0), (-0.3, 0.8, 1.2), (0.9, 0.4, 1.1)),
    "nearly flat": ((0, 0, 0), (1, 0.2, 0), (0.9, -1, 0.02)),
    "gap": ((0.4, 0.08, 1e-5), (-0.3, 0.8, 1.2), (0.9, 0.4, 1.1)),
}


@pytest.mark.parametrize("name", TOUCHING)
@pytest.mark.parametrize("four", [False, True])
def test_the_whole_is_the_sum_of_its_parts(name, four):
    a, b = np.array((1, 0.2, 0)), np.array((-0.2, 1, 0))
    one = quad((0, 0, 0), a, b) if four else triangle((0, 0, 0), a, b)
    other = triangle(*TOUCHING[name])
    if one_pair(one, other) == 0:
        other = other[[0, 2, 1, 1]]
    whole = one_pair(one, other)
    assert whole > 1e-5
    pieces = [(p, q) for p in parts(one) for q in parts(other)]
    assert exchange(*(np.array(x) for x in zip(*pieces, strict=True))).sum() == pytest.approx(whole, rel=1e-7)
    assert exchange(np.array(parts(one)), np.array([other] * (3 if four else 4))).sum() == pytest.approx(whole, rel=1e-7)


@pytest.mark.parametrize(("scale", "move"), [(1e-4, 0), (1e6, 0), (1e-4, 10.0), (1.0, 1e5), (1e6, 1e10)])
def test_place_and_size_do_not_matter(random, scale, move):
    corners = random.normal(size=(2, 300, 3, 3))[:, :, [0, 1, 2, 2]]
    here = exchange(*corners)
    there = exchange(*(corners * scale + move)) / scale**2
    known = here > 1e-3
    assert known.sum() > 50
    assert there[known] == pytest.approx(here[known], rel=1e-9 + 1e4 * np.finfo(float).eps * move / scale)


def by_points(one: np.ndarray, other: np.ndarray, order: int = 32) -> float:
    """Lambert's factor of the other polygon, integrated over the triangles of the first."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    u, v = (x.ravel() for x in np.meshgrid((nodes + 1) / 2, (nodes + 1) / 2, indexing="ij"))
    weight = np.outer(weights, weights).ravel() / 4 * u
    total = 0.0
    for a, b, c in (one[[0, 1, 2]], one[[0, 2, 3]]):
        cross = np.cross(b - a, c - a)
        area = np.linalg.norm(cross)
        if area > 0:
            points = a + u[:, None] * (b - a) + (u * v)[:, None] * (c - b)
            factors = from_points(points, np.tile(cross / area, (len(u), 1)), np.tile(other, (len(u), 1, 1)))
            total += area * float(factors @ weight)
    return total


coordinates = st.lists(st.floats(-1, 1), min_size=18, max_size=18)


@given(coordinates, st.sampled_from([2.5, 6.0, 40.0, 900.0]), st.booleans())
def test_any_pair_of_separate_polygons_agrees_with_quadrature(values, distance, four):
    one, other = np.array(values).reshape(2, 3, 3)
    if min(np.linalg.norm(np.cross(t[1] - t[0], t[2] - t[0])) for t in (one, other)) < 1e-2:
        return
    one = quad(one[0], one[1] - one[0], one[2] - one[0]) if four else triangle(*one)
    middle, normal = one.mean(axis=0), np.cross(one[1] - one[0], one[2] - one[0])
    other = triangle(*(other - other.mean(axis=0) + middle + distance * normal / np.linalg.norm(normal)))
    if exchange(one[None], other[None])[0] == 0:
        other = other[[0, 2, 1, 1]]
    found = one_pair(one, other)
    largest = parallel(1, 1) / distance**2
    # the other is in front of the first, so no point of it comes to lie in a plane where the factor has a kink
    assert found == pytest.approx(by_points(other, one), rel=1e-6, abs=1e-6 * largest)
    assert found == pytest.approx(one_pair(other, one), rel=1e-9, abs=1e-12 * largest)


def test_points_over_a_rectangle_and_at_its_horizon():
    """Differential areas: over the corner of a parallel rectangle (B-4), at the foot of a perpendicular one (B-5)."""
    a, b = 0.7, 1.3
    x, y = np.sqrt(1 + a * a), np.sqrt(1 + b * b)
    over = (a / x * np.arctan(b / x) + b / y * np.arctan(a / y)) / (2 * np.pi)
    ceiling = quad((0, 0, 1), (0, b, 0), (a, 0, 0))
    assert from_points(np.zeros((1, 3)), np.array([[0, 0, 1.0]]), ceiling[None])[0] == pytest.approx(over, rel=1e-12)
    # distance 1 from a wall of width a and height b, from the foot of its corner; the half below the floor counts nothing
    foot = (np.arctan(a) - np.arctan(a / y) / y) / (2 * np.pi)
    wall = quad((0, 1, -b), (a, 0, 0), (0, 0, 2 * b))
    assert from_points(np.zeros((1, 3)), np.array([[0, 0, 1.0]]), wall[None])[0] == pytest.approx(foot, rel=1e-12)
    assert from_points(np.zeros((1, 3)), np.array([[0, 0, 1.0]]), wall[None, ::-1])[0] == 0
    assert from_points(np.zeros((1, 3)), np.array([[0, 0, -1.0]]), ceiling[None])[0] == 0


def test_points_see_all_of_a_box(random):
    walls = rd.subdivide(cube(), cells=3).corners
    points = np.column_stack([random.random((200, 2)), np.zeros(200)])
    factors = from_points(np.repeat(points, 54, axis=0), np.tile([0, 0, 1.0], (200 * 54, 1)), np.tile(walls, (200, 1, 1)))
    assert factors.reshape(200, 54).sum(axis=1) == pytest.approx(np.ones(200), abs=1e-12)


def test_far_points_join_near_ones():
    wall = quad((-0.5, 0, -0.5), (1, 0, 0), (0, 0, 1))
    for distance in (6e3, 8e3):  # one point stands for the wall beyond 7071
        point, normal = np.array([[0, -distance, 0]]), np.array([[0.6, 0.8, 0]])
        assert from_points(point, normal, wall[None])[0] == pytest.approx(0.8 / (np.pi * distance**2), rel=2e-8)
