"""Polynomials on patches where they are seen: by lines of a final gather, in pictures, and in files."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from enclosures import cube
from iterations import VARIANTS
from test_bases import gauss, kite, points_of
from test_export_vtp import arrays

import radiosity as rd
from radiosity.image.look import Look
from radiosity.image.lookup import Lookup
from radiosity.image.mesh import coloured
from radiosity.image.quantity import choose
from radiosity.patches.bases import BASES
from radiosity.patches.polynomials import Polynomials
from radiosity.sensors.pixels import Gather
from radiosity.tracing.first_hits import Hits


def having(solution: rd.Solution, coefficients: np.ndarray) -> rd.Solution:
    """A solution whose irradiance has other coefficients after the means."""
    errors = np.zeros_like(coefficients)
    return replace(solution, irradiance_coefficients=coefficients, irradiance_coefficients_standard_error=errors)


def test_lines_of_a_final_gather_read_the_polynomial():
    """What a coefficient of the floor adds at a point of the ceiling: against quadrature over the floor."""
    patches, basis = rd.subdivide(cube([[0.5]] * 6, [[1.0]] * 6), cells=1), BASES["quadratic"]
    solution = rd.solve(patches, "stochastic-jacobi", basis="quadratic", rays=20_000, replicates=2)
    flat = np.zeros((6, 1, 5))
    found, exact = np.zeros(5), np.zeros(5)
    a, b, w = gauss(16)
    points, there = points_of(patches, 0, a, b), points_of(patches, 1, np.array([0.3]), np.array([0.6]))
    way = points - there
    distance = np.linalg.norm(way, axis=1)
    kernel = (way @ patches.normal[1]) * -(way @ patches.normal[0]) / (np.pi * distance**4)

    def seen(coefficients):
        gather = Gather.of(having(solution, coefficients), 1 << 14, 1)
        return gather.irradiance(np.array([1]), np.array([0.3]), np.array([0.6]))[0, 0]

    base = seen(flat)
    for k in range(5):
        one = flat.copy()
        one[0, 0, k] = 1.0
        found[k] = seen(one) - base
        exact[k] = 0.5 * (w * kernel) @ basis.at(a, b, True)[:, k + 1]
    assert np.abs(exact).max() > 0.01
    assert found == pytest.approx(exact, abs=1e-3)  # the same 16 384 lines each time


def test_sensors_read_the_polynomials_of_each_replicate():
    """In a cube that one wall lights, sensors that look at another one, by 6 patches and by 294: less than half the error."""
    scene = cube(0.7, [[1.0]] + [[0.0]] * 5)
    places = [[0.1, 0.5, z] for z in (0.15, 0.5, 0.85)]
    sensors = rd.Sensors.of(places, normals=[[-1.0, 0.0, 0.0]] * 3)

    def light(cells, **choices):
        solution = rd.solve(rd.subdivide(scene, cells=cells), "stochastic-jacobi", rays=200_000, replicates=4, **choices)
        return rd.measure(solution, sensors, rays=20_000).irradiance[:, 0]

    exact, constant, quadratic = light(7), light(1), light(1, basis="quadratic")
    assert np.abs(quadratic - exact).max() < 0.5 * np.abs(constant - exact).max()


@pytest.fixture(scope="module")
def kites() -> tuple[rd.Patches, rd.Solution]:
    """Parallelograms and triangles, fronts and backs, whose light is linear in the place."""
    patches = rd.subdivide(kite(), cells=3)
    solution = rd.solve(patches, "stochastic-jacobi", basis="linear", rays=20_000, replicates=2)
    a, b, w = gauss()
    quad, coefficients = patches.scene.is_quad[patches.face], np.zeros((len(patches), 3))
    for row in range(len(patches)):
        s, t, weight = (a, b, w) if quad[row] else (a * (1 - b), b, 2 * w * (1 - b))
        coefficients[row] = (field(points_of(patches, row, s, t)) * weight) @ BASES["linear"].at(s, t, bool(quad[row]))
    return patches, having(replace(solution, irradiance=coefficients[:, :1]), coefficients[:, None, 1:])


def field(points: np.ndarray) -> np.ndarray:
    return 5 + points[..., 0] - 2 * points[..., 1]


def test_corners_have_the_values_of_their_places(kites):
    patches, solution = kites
    light = Polynomials(patches, solution.basis, solution.irradiance, solution.irradiance_coefficients)
    assert light.at_corners()[..., 0] == pytest.approx(field(patches.corners), rel=1e-12)


@pytest.mark.parametrize("smooth", [True, False])
def test_pictures_show_the_polynomial_at_each_point(kites, smooth, random):
    """Also smoothed: of a linear field, polynomials of neighbours meet, and stay as they are."""
    patches, solution = kites
    face, u = np.repeat([0, 1], 200), random.random((400, 2))
    u = np.where((face == 1)[:, None] & (u.sum(axis=1) > 1)[:, None], 1 - u, u)
    shown = choose(solution, "irradiance")
    look = Lookup(patches, shown.values, smooth, shown.light)
    values, _ = look(Hits(face, u[:, 0], u[:, 1], random.random(400) < 0.5, np.zeros(400)))
    origin, first, second = (x[face] for x in patches.scene.frames)
    assert values[:, 0] == pytest.approx(field(origin + u[:, :1] * first + u[:, 1:] * second), rel=1e-9)


@pytest.mark.parametrize("smooth", [True, False])
def test_files_have_the_polynomial_at_vertices(kites, smooth, tmp_path):
    """GLB and PLY hold the values of this mesh; VTP has point data of its own."""
    _, solution = kites
    mesh = coloured(solution, Look("irradiance", smooth=smooth))
    assert mesh.values[:, 0] == pytest.approx(field(mesh.vertices), rel=1e-9)
    solution.export(tmp_path / "x.vtp", smooth=smooth)
    piece = ElementTree.parse(tmp_path / "x.vtp").getroot().find("PolyData").find("Piece")
    points, radiosity = (arrays(piece.find(name)) for name in ("Points", "PointData"))
    assert radiosity["radiosity"].ravel() == pytest.approx(1 + 0.5 * field(points["Points"].reshape(-1, 3)), rel=1e-9)


def test_light_is_never_shown_negative(kites):
    patches, solution = kites
    steep = having(solution, solution.irradiance_coefficients * 30)
    shown = choose(steep, "irradiance")
    assert shown.light.at_corners().min() < 0
    hits = Hits(np.zeros(50, int), np.linspace(0, 1, 50), np.full(50, 0.5), np.ones(50, bool), np.zeros(50))
    for smooth in (True, False):
        assert Lookup(patches, shown.values, smooth, shown.light)(hits)[0].min() == 0


def test_smoothing_has_no_steps_where_light_is_smooth():
    """Just beside the edges between patches, linear light that was smoothed is equal; as it is, it has steps."""
    patches = rd.subdivide(cube(0.5, [[1.0]] + [[0.0]] * 5), cells=4)
    solution = rd.solve(patches, rd.Method(**VARIANTS["regular, everything"], basis="linear"), rays=2_000_000)
    shown, v = choose(solution, "irradiance"), np.linspace(0.3, 0.7, 21)
    steps = []
    for smooth in (True, False):
        look = Lookup(patches, shown.values, smooth, shown.light)
        sides = [look(Hits(np.full(21, 1), np.full(21, 0.5 + d), v, np.ones(21, bool), np.zeros(21)))[0] for d in (-1e-6, 1e-6)]
        steps.append(np.abs(sides[0] - sides[1]).max() / shown.values[patches.face == 1].mean())
    assert steps[0] < 1e-4
    assert steps[1] > 20 * steps[0]


def test_tables_hold_the_coefficients(kites):
    table = pytest.importorskip("pandas") and kites[1].to_dataframe()
    assert np.array_equal(table["irradiance coefficient 2 [W/m²]"], kites[1].irradiance_coefficients[:, 0, 1])
