"""View factors with closed forms: the formulas by numerical integration, then `view_factors` in scenes of them.

Forms that were there before are integrated in `test_exact_integrals.py`. 38 comparisons at 5 standard errors (Student with 15
degrees of freedom: p = 2e-4) leave a chance of less than 1 % for a false alarm, and seeds are fixed.
"""

import warnings

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.integrate import quad as integral

import radiosity as rd
from validation.closed_forms import obstructed, strings
from validation.configurations import every


def past(spans: list[tuple[float, float]], low: float, high: float) -> float:
    """Half of what is left of the sines from low to high without the spans: the share of a point's light in the plane."""
    left = high - low
    edge = low
    for begin, end in sorted(spans):
        begin, end = max(begin, edge), min(end, high)
        if end > begin:
            left -= end - begin
            edge = end
    return left / 2


def of_circle(x: float, height: float, radius: float) -> tuple[float, float]:
    """Sines of the angles from the vertical between which a circle is seen that stands at x and ``height`` from a point."""
    middle, half = np.arctan2(x, height), np.arcsin(radius / np.hypot(x, height))
    return np.sin(max(middle - half, -np.pi / 2)), np.sin(min(middle + half, np.pi / 2))


def of_strip(left: float, right: float, height: float) -> tuple[float, float]:
    return left / np.hypot(left, height), right / np.hypot(right, height)


@pytest.mark.parametrize(("width", "distance", "radius"), [(1.0, 1.0, 0.2), (2.0, 0.8, 0.35), (0.3, 1.0, 0.45), (1.0, 3.0, 0.05)])
def test_strips_past_a_cylinder(width, distance, radius):
    def seen(x):
        return past([of_circle(-x, distance / 2, radius)], *of_strip(-width / 2 - x, width / 2 - x, distance))

    found = integral(seen, -width / 2, width / 2, limit=400, epsabs=1e-10)[0] / width
    assert obstructed.past_a_cylinder(width, distance, radius) == pytest.approx(found, abs=1e-8)


@pytest.mark.parametrize(("width", "distance", "slit"), [(1.0, 1.0, 0.3), (2.0, 0.5, 1.9), (0.4, 2.0, 0.1)])
def test_strips_through_a_slit(width, distance, slit):
    def seen(x):
        screen = [(-1.0, of_strip(-slit / 2 - x, 0, distance / 2)[0]), (of_strip(0, slit / 2 - x, distance / 2)[1], 1.0)]
        return past(screen, *of_strip(-width / 2 - x, width / 2 - x, distance))

    found = integral(seen, -width / 2, width / 2, limit=400, epsabs=1e-10)[0] / width
    assert obstructed.through_a_slit(width, distance, slit) == pytest.approx(found, abs=1e-8)


@pytest.mark.parametrize(("pitch", "diameter", "height"), [(1.0, 0.5, 1.0), (2.0, 0.3, 0.4), (1.0, 0.95, 2.0)])
def test_a_plane_to_a_row_of_tubes(pitch, diameter, height):
    def seen(x):
        ends = of_strip(-60 * pitch - x, 60 * pitch - x, height)  # beyond them the tubes hide all that is behind
        return past([of_circle(k * pitch - x, height, diameter / 2) for k in range(-60, 61)], *ends)

    found = 1 - integral(seen, 0, pitch, limit=200, epsabs=1e-7)[0] / pitch
    assert obstructed.plane_to_tubes(pitch, diameter) == pytest.approx(found, abs=1e-6)


@pytest.mark.parametrize(("inner", "outer", "height"), [(0.5, 1.2, 2.0), (1.0, 1.1, 0.3), (0.2, 3.0, 1.0)])
def test_coaxial_cylinders(inner, outer, height):
    reach = 2 * np.arccos(inner / outer)  # two points see each other past the inner cylinder

    def wall(z, turn):
        chord = 2 * outer * np.sin(turn / 2)
        return (height - z) * (chord**2 / (2 * outer)) ** 2 / (np.pi * (chord**2 + z**2) ** 2)

    found = dblquad(wall, 0, reach, 0, height, epsabs=1e-9)[0] * outer * 4 / height
    assert obstructed.outer_to_itself(inner, outer, height) == pytest.approx(found, abs=1e-7)

    assert obstructed.end_to_end(inner, outer, height) == pytest.approx(_ends(inner, outer, height), abs=1e-6)


def _ends(inner: float, outer: float, height: float) -> float:
    """Integrate over both radii and the angle between, up to where the line of sight touches the inner cylinder."""
    nodes, weights = np.polynomial.legendre.leggauss(80)
    nodes, weights = (nodes + 1) / 2, weights / 2
    one, two, turn = np.meshgrid(nodes**2, nodes**2, nodes, indexing="ij")  # squares: the limit has a root at the inner radius
    slope = 4 * nodes[:, None, None] * nodes[None, :, None] * (outer - inner) ** 2
    one, two = (inner + (outer - inner) * x for x in (one, two))
    limit = np.arccos(inner / one) + np.arccos(inner / two)
    square = one**2 + two**2 - 2 * one * two * np.cos(turn * limit) + height**2
    value = 2 * limit * one * two * height**2 / (np.pi * square**2) * 2 * np.pi * slope
    whole = np.einsum("ijk,i,j,k->", value, weights, weights, weights)
    return float(whole / (np.pi * (outer**2 - inner**2)))


def test_a_sphere_in_a_tube_is_a_point():
    """From points of a sphere of half the tube's radius: the share of what leaves it that meets the tube."""
    draw, n = np.random.default_rng(0), 400_000
    normal, way = (x / np.linalg.norm(x, axis=1)[:, None] for x in draw.normal(size=(2, n, 3)))
    way = normal + way  # cosine distribution
    start = 0.5 * normal
    a, b, c = ((x * y)[:, :2].sum(axis=1) for x, y in ((way, way), (start, way), (start, start)))
    z = start[:, 2] + way[:, 2] * (-b + np.sqrt(b * b - a * (c - 1))) / a
    found = (np.abs(z) < 0.75).mean()
    exact = obstructed.sphere_to_tube(1.0, 1.5)
    assert found == pytest.approx(exact, abs=5 * np.sqrt(exact * (1 - exact) / n))


def test_plates_of_two_dimensions():
    """Special cases of crossed strings, in the catalogue's words."""
    assert strings.crossed(((0, 0), (1, 0)), ((0, 0.7), (1, 0.7))) == pytest.approx(np.hypot(1, 0.7) - 0.7)  # C-1
    assert strings.triangle(1.0, 0.6, np.hypot(1, 0.6)) == pytest.approx((1 + 0.6 - np.sqrt(1 + 0.36)) / 2)  # C-3
    assert strings.triangle(1.0, 1.0, 2 * np.sin(0.4)) == pytest.approx(1 - np.sin(0.4))  # C-5, an angle of 0.8


@pytest.mark.parametrize("case", every(), ids=lambda case: case.name)
def test_view_factors_are_those_of_closed_forms(case):
    """Raw rows; of round bodies extrapolated over two meshes, since the error of facets falls with the square of their size."""
    meshes = (
        [0] if case.facets is None else [case.facets, case.facets + 1] if case.facets < 10 else [case.facets, 2 * case.facets]
    )
    found, square = [], []
    for mesh in meshes:
        patches = rd.subdivide(case.build(mesh), cells=1)
        names = patches.scene.names
        first = [names[0]] if patches.area[patches.surface == 0].sum() < 0.25 * patches.area.sum() else None
        rays = 100_000 if len(patches) < 1200 else 500_000
        with warnings.catch_warnings():  # of long tubes, whose own rows are not looked at
            warnings.filterwarnings("ignore", ".*faces are so narrow.*'receiver|.*faces are so narrow.*'cylinder")
            factors = rd.view_factors(patches, rays=rays, method="lines", replicates=16, numbers="random", sources=first)
        row, column = (factors.names.index(names[s]) for s in (0, case.receiver))
        found.append(factors.matrix[row, column])
        square.append(factors.standard_error[row, column] ** 2)
    value, error = found[-1], np.sqrt(square[-1])
    if len(found) > 1:
        value, error = (4 * found[1] - found[0]) / 3, np.sqrt(16 * square[1] + square[0]) / 3
        case_bound = case.bound + 0.1 * abs(found[1] - found[0]) / 3
    else:
        case_bound = case.bound
    assert abs(value - case.exact) < 5 * error + case_bound
    assert error < 0.03
