"""The closed forms that referees compare with, against numerical integration of what they are the integral of."""

import numpy as np
import pytest
from scipy.integrate import quad as integral

from validation.closed_forms import enclosures, offset_rectangles, rectangles, round, strings

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)
NODES, WEIGHTS = (NODES + 1) / 2, WEIGHTS / 2


def grid(*spans):
    """Points of the product of spans, one array a coordinate, and their weights."""
    points = np.meshgrid(*(a + (b - a) * NODES for a, b in spans), indexing="ij")
    weights = np.meshgrid(*((b - a) * WEIGHTS for a, b in spans), indexing="ij")
    return [p.ravel() for p in points], np.prod([w.ravel() for w in weights], axis=0)


def kernel(one, normal, other, facing):
    """cos cos' / (pi r²), zero where one is behind the other; arrays (..., 3)."""
    way = other - one
    square = (way**2).sum(axis=-1)
    up, down = np.maximum((way * normal).sum(axis=-1), 0), np.maximum(-(way * facing).sum(axis=-1), 0)
    return up * down / (np.pi * square**2)


def over_rectangles(one, other):
    """A F between (origin, edge, edge) and another, fronts on the side of the edges' cross product, apart."""
    rows = []
    for origin, first, second in (one, other):
        o, a, b = (np.array(x, float) for x in (origin, first, second))
        (u, v), weights = grid((0, 1), (0, 1))
        cross = np.cross(a, b)
        area = np.linalg.norm(cross)
        rows.append((o + u[:, None] * a + v[:, None] * b, cross / area, weights * area))
    (points, normal, weights), (ends, facing, others) = rows
    return float(weights @ kernel(points[:, None], normal, ends[None], facing) @ others)


def test_parallel_rectangles():
    found = over_rectangles(((0, 0, 0), (2, 0, 0), (0, 1, 0)), ((0, 0, 0.7), (0, 1, 0), (2, 0, 0)))
    assert 0.49 * rectangles.parallel(2 / 0.7, 1 / 0.7) == pytest.approx(found, rel=1e-6)
    assert offset_rectangles.parallel((0, 2), (0, 1), (0, 2), (0, 1), 0.7) == pytest.approx(found, rel=1e-6)
    found = over_rectangles(((0, 0, 0), (1, 0, 0), (0, 1, 0)), ((0.6, 0.5, 0.8), (0, 0.8, 0), (1.4, 0, 0)))
    assert offset_rectangles.parallel((0, 1), (0, 1), (0.6, 2.0), (0.5, 1.3), 0.8) == pytest.approx(found, rel=1e-8)


def test_rectangles_at_an_angle():
    found = over_rectangles(((0.2, 0, 0), (0.8, 0, 0), (0, 1, 0)), ((0, 0.3, 0.1), (0, 1.3, 0), (0, 0, 0.8)))
    assert offset_rectangles.perpendicular((0.2, 1.0), (0, 1), (0.1, 0.9), (0.3, 1.6)) == pytest.approx(found, rel=1e-6)
    touching = offset_rectangles.perpendicular((0, 0.8), (0, 1), (0, 1.5), (0, 1))
    assert rectangles.perpendicular(0.8, 1.5) == pytest.approx(touching, rel=1e-12)


@pytest.mark.parametrize(("a", "b", "angle"), [(1.0, 0.8, np.pi / 3), (0.7, 1.2, 3 * np.pi / 4)])
def test_rectangles_with_a_common_edge(a, b, angle):
    """Strips that touch along the edge are left out of the integral, which is then what four formulas with a common edge give."""
    gap = 0.3
    up = np.array([np.cos(angle), 0, np.sin(angle)])
    found = over_rectangles(((gap, 0, 0), (a - gap, 0, 0), (0, 1, 0)), (gap * up, (0, 1, 0), (b - gap) * up))
    f = rectangles.inclined
    parts = f(a, b, angle) - f(gap, b, angle) - f(a, gap, angle) + f(gap, gap, angle)
    assert parts == pytest.approx(found, rel=1e-6)


def rings(first, second, distance):
    """A F between coaxial parallel rings, (inner, outer) each: by radii and the angle between."""
    (a, b, angle), weights = grid(first, second, (0, np.pi))
    square = a * a + b * b - 2 * a * b * np.cos(angle) + distance**2
    return float((weights * 2 * 2 * np.pi * a * b * distance**2 / (np.pi * square**2)).sum())


def test_discs_and_rings():
    assert round.disc_to_disc(1.0, 0.7, 0.9) == pytest.approx(rings((0, 1), (0, 0.7), 0.9) / np.pi, rel=1e-9)
    found = rings((0, 0.8), (0.5, 1.2), 0.6) / (np.pi * 0.64)
    assert round.disc_to_ring(0.8, 0.5, 1.2, 0.6) == pytest.approx(found, rel=1e-8)
    found = rings((0.4, 1.0), (0.6, 1.4), 0.5) / (np.pi * (1 - 0.16))
    assert round.ring_to_ring((0.4, 1.0), (0.6, 1.4), 0.5) == pytest.approx(found, rel=1e-7)


def test_cylinders():
    (a, angle, z), weights = grid((0, 1), (0, np.pi), (0, 1.5))
    # from a point of the base at radius a to the wall
    across = 1 - a * np.cos(angle)
    square = a * a + 1 - 2 * a * np.cos(angle) + z * z
    found = (weights * 2 * 2 * np.pi * a * z * across / (np.pi * square**2)).sum() / np.pi
    assert round.base_to_wall(1.0, 1.5) == pytest.approx(found, rel=5e-3)  # the integrand is singular where they touch
    assert round.wall_to_itself(1.0, 1.5) == pytest.approx(1 - 2 * np.pi * round.base_to_wall(1.0, 1.5) / (2 * np.pi * 1.5))

    inner, outer, height = 0.5, 1.2, 2.0
    limit = np.arccos(inner / outer)  # beyond it the inner cylinder turns away
    (angle, z, w), weights = grid((0, limit), (0, height), (0, height))
    up, down = outer - inner * np.cos(angle), outer * np.cos(angle) - inner
    square = outer**2 + inner**2 - 2 * outer * inner * np.cos(angle) + (z - w) ** 2
    found = (weights * 2 * inner * up * down / (np.pi * square**2)).sum() / height
    assert round.outer_to_inner(inner, outer, height) == pytest.approx(found, rel=1e-6)


def test_long_bodies():
    """In the plane across them: cos cos' / (2 r) over both outlines."""

    def plane_factor(ends):
        """F of a point to what lies between two angles to its normal."""
        return (np.sin(ends[1]) - np.sin(ends[0])) / 2

    def other(angle):
        """From a cylinder of radius one to another, axes 3 apart: the other spans an angle, some of it below the horizon."""
        x, y = 3 - np.cos(angle), -np.sin(angle)
        middle, half = np.arctan2(y, x) - angle, np.arcsin(1 / np.hypot(x, y))
        return plane_factor(np.clip((middle - half, middle + half), -np.pi / 2, np.pi / 2)) / np.pi

    found = integral(other, 0, np.pi, limit=200, epsabs=1e-12)[0]
    assert round.cylinder_to_cylinder(1.0) == pytest.approx(found, rel=1e-8)

    def pipe(x):
        middle, half = np.arctan(-x / 1.5), np.arcsin(0.5 / np.hypot(x, 1.5))
        return plane_factor((middle - half, middle + half))

    assert round.strip_to_cylinder(0.2, 1.7, 1.5, 0.5) == pytest.approx(integral(pipe, 0.2, 1.7)[0] / 1.5, rel=1e-10)

    def strip(x):
        return plane_factor((np.arctan((0.5 - x) / 0.8), np.arctan((1.8 - x) / 0.8)))

    assert strings.crossed(((0, 0), (1, 0)), ((0.5, 0.8), (1.8, 0.8))) == pytest.approx(integral(strip, 0, 1)[0], rel=1e-10)

    def past(x):
        """The whole other strip less what the plate hides."""
        whole = np.sort([np.arctan(0 - x), np.arctan(1 - x)])
        plate = np.clip([np.arctan((0.3 - x) / 0.5), np.arctan((0.7 - x) / 0.5)], *whole)
        return plane_factor(whole) - plane_factor(plate)

    assert strings.past_a_plate(1.0, 1.0, 0.4) == pytest.approx(integral(past, 0, 1, points=[0.4, 0.6])[0], rel=1e-9)
    assert strings.triangle(3, 5, 4) == pytest.approx(strings.crossed(((0, 0), (3, 0)), ((0, 4), (3, 0))), rel=1e-12)


def test_spheres():
    """A small sphere is a point source: the share of its light is the solid angle over 4 pi."""
    found = integral(lambda r: r / (2 * (r * r + 1) ** 1.5), 0, 1.2)[0]
    assert round.sphere_to_disc(1.2, 1.0) == pytest.approx(found, rel=1e-10)
    (x, y), weights = grid((0, 2), (0, 1))
    found = (weights * 0.8 / (4 * np.pi * (x * x + y * y + 0.64) ** 1.5)).sum()
    assert round.sphere_to_rectangle(2.0, 1.0, 0.8) == pytest.approx(found, rel=1e-7)


def test_matrices_of_rooms_are_closed():
    _, factors = enclosures.box_factors((2.0, 1.0, 0.7), rectangles.parallel, rectangles.perpendicular)
    assert factors.sum(axis=1) == pytest.approx(np.ones(6), rel=1e-12)
    areas, factors = enclosures.prism_factors(np.pi / 2, (3.0, 4.0), 6.0, rectangles.inclined)
    assert factors.sum(axis=1) == pytest.approx(np.ones(5), rel=1e-9)
    exchange = areas[:, None] * factors
    assert exchange == pytest.approx(exchange.T, rel=1e-9)
    assert (factors >= 0).all()
    # the two ends, which closure gave: opposite triangles
    corners = np.array([(0, 0), (3, 0), (0, 4)], float)
    (u, v, s, t), weights = grid_of_triangles()
    one = corners[0] + u[:, None] * corners[1] + (v * (1 - u))[:, None] * corners[2]
    other = corners[0] + s[:, None] * corners[1] + (t * (1 - s))[:, None] * corners[2]
    square = ((one - other) ** 2).sum(axis=1) + 36
    found = (weights * 144 * (1 - u) * (1 - s) * 36 / (np.pi * square**2)).sum() / 6
    assert factors[3, 4] == pytest.approx(found, rel=1e-6)


def grid_of_triangles():
    nodes, weights = np.polynomial.legendre.leggauss(10)
    points = np.meshgrid(*[(nodes + 1) / 2] * 4, indexing="ij")
    product = np.prod([w.ravel() for w in np.meshgrid(*[weights / 2] * 4, indexing="ij")], axis=0)
    return [p.ravel() for p in points], product


def test_networks():
    areas = 4 * np.pi * np.array([1.0, 1.8**2])
    factors = np.array([[0, 1], [1 / 1.8**2, 1 - 1 / 1.8**2]])
    net = enclosures.net(areas, factors, (0.6, 0.3), (10.0, 2.0))
    assert net == pytest.approx([w := enclosures.two_spheres(1.0, 1.8, (0.6, 0.3), (10.0, 2.0)), -w], rel=1e-12)
    net = enclosures.net((1, 1), [[0, 1], [1, 0]], (0.6, 0.3), (10.0, 2.0))
    assert net[0] == pytest.approx(enclosures.parallel_plates((0.6, 0.3), (10.0, 2.0)), rel=1e-12)
    # all that is emitted leaves, or is absorbed
    wall, rho = 0.8, 0.6
    radiosity = 1.0 / (1 - rho * wall)
    left = enclosures.spherical_cavity(wall, rho, 1.0)
    assert 4 * np.pi * wall == pytest.approx(left + (1 - rho) * 4 * np.pi * wall * wall * radiosity)
