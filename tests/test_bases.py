"""Polynomials on patches: the functions of the bases, and what iterations make of them, against closed forms and quadrature.

Alpha: Student with 15 degrees of freedom, 6.5 standard errors for some 200 coefficients: 200 * 1e-5; seeds are fixed.
"""

import os
import signal
from dataclasses import replace

import drjit as dr
import numpy as np
import pytest
from enclosures import cube
from iterations import VARIANTS, open_room
from replicates import process_of

import radiosity as rd
from radiosity.algorithms.iterations.exchange import LINE, Exchange
from radiosity.device.backend import choose, upload
from radiosity.factors.polygons import from_points
from radiosity.patches.bases import BASES
from radiosity.patches.nesting import halved, parents
from radiosity.patches.polynomials import Polynomials
from radiosity.problem.model import Problem
from radiosity.tracing.geometry import Geometry

SIGMAS = 6.5
SEVERAL = ("linear", "quadratic")
SOME = ("incremental", "incremental, control variate", "regular, warm-up", "regular, everything")


def gauss(n: int = 6) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points and weights of a rule on the unit square, exact to degree 2n - 1 in each coordinate."""
    x, w = np.polynomial.legendre.leggauss(n)
    x, w = (x + 1) / 2, w / 2
    return np.repeat(x, n), np.tile(x, n), np.outer(w, w).ravel()


@pytest.mark.parametrize("name", SEVERAL)
def test_functions_are_orthonormal(name):
    """On the square, and on the triangle by Duffy's map."""
    basis, (a, b, w) = BASES[name], gauss()
    square, half = basis.at(a, b, True), basis.at(a * (1 - b), b, False)
    assert (square.T * w) @ square == pytest.approx(np.eye(basis.size), abs=1e-12)
    assert (half.T * (2 * w * (1 - b))) @ half == pytest.approx(np.eye(basis.size), abs=1e-12)
    assert np.array_equal(square[:, 0], np.ones(len(a)))


@pytest.mark.parametrize("name", SEVERAL)
def test_polynomials_of_the_degree_are_reproduced(name):
    """A polynomial of the place in the scene has on each patch, whatever its cell, the values that it has there."""
    basis, patches = BASES[name], rd.subdivide(kite(), cells=3)

    def field(points):
        x, y = points[..., 0], points[..., 1]
        return 2 + x - 3 * y + (0 if basis.degree == 1 else x * x - 2 * x * y + 0.5 * y * y)

    a, b, w = gauss()
    quad, n = patches.scene.is_quad[patches.face], len(patches)
    coefficients = np.zeros((n, basis.size))
    for row in range(n):
        s, t, weight = (a, b, w) if quad[row] else (a * (1 - b), b, 2 * w * (1 - b))
        coefficients[row] = (field(points_of(patches, row, s, t)) * weight) @ basis.at(s, t, bool(quad[row]))
    found = Polynomials(patches, basis, coefficients[:, :1], coefficients[:, None, 1:])
    face, (column, row, inverted) = patches.face, patches.place
    inside = np.where(quad, 0.3, np.where(inverted, 0.6, 0.3))
    u, v = (column + inside) / patches.columns[face], (row + inside + 0.05) / patches.rows[face]
    origin, first, second = (x[face] for x in patches.scene.frames)
    values = found.at(np.arange(n), u, v)[:, 0]
    assert values == pytest.approx(field(origin + u[:, None] * first + v[:, None] * second), rel=1e-12)


def kite() -> rd.Scene:
    """A parallelogram and a triangle in the plane z = 0, with two radiating sides."""
    corners = [[0, 0, 0], [2, 0.2, 0], [2.5, 1.2, 0], [0.5, 1, 0], [3, 0, 0], [4, 0.3, 0], [3.2, 1.5, 0]]
    return rd.Scene.from_arrays(np.array(corners, float), [[0, 1, 2, 3], [4, 5, 6, -1]], 0.5, 1.0, two_sided=True)


def points_of(patches: rd.Patches, row: int, a, b) -> np.ndarray:
    """Points of a patch with coordinates a and b in it."""
    column, line, inverted = (x[row] for x in patches.place)
    face = patches.face[row]
    a, b = (1 - a, 1 - b) if inverted else (a, b)
    origin, first, second = (x[face] for x in patches.scene.frames)
    u, v = (column + a) / patches.columns[face], (line + b) / patches.rows[face]
    return origin + u[:, None] * first + v[:, None] * second


def lit_by_a_wall(rho: float = 0.0) -> rd.Scene:
    """A cube one of whose walls emits."""
    return cube(rho, [[1.0]] + [[0.0]] * 5)


DIRECT = {name: VARIANTS[name] for name in ("incremental", "incremental, control variate", "regular, everything")}
DIRECT |= {"particles": {"equation": "continuous"}, "gather": {"order": "gather"}}


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow) if "," in name else name for name in DIRECT])
def test_moments_are_those_of_the_direct_light(name):
    """The light of one wall on black ones: a closed form at points, integrated with the functions by quadrature."""
    patches, basis = rd.subdivide(lit_by_a_wall(), cells=2), BASES["quadratic"]
    solution = rd.solve(patches, rd.Method(**DIRECT[name], basis="quadratic"), rays=400_000, replicates=16, seed=2)
    a, b, w = gauss(12)
    functions = basis.at(a, b, True)
    rows = np.flatnonzero(patches.face > 0)
    points = np.array([points_of(patches, row, a, b) for row in rows])
    exact = falling(patches.scene, points.reshape(-1, 3), np.repeat(patches.normal[rows], len(a), axis=0))
    exact = (exact.reshape(len(rows), -1) * w) @ functions
    found = np.column_stack([solution.irradiance[rows, 0], solution.irradiance_coefficients[rows, 0]])
    error = np.column_stack(
        [solution.irradiance_standard_error[rows, 0], solution.irradiance_coefficients_standard_error[rows, 0]]
    )
    z = (found - exact) / error
    assert np.abs(z).max() < SIGMAS
    assert 0.7 < np.sqrt(np.mean(z**2)) < 1.4


@pytest.mark.parametrize("estimator", ["collision", "bidirectional"])
def test_lines_carry_the_polynomial_of_where_they_begin(estimator):
    """Floor and ceiling of a cube, one sends a polynomial of mean zero: against quadrature of the kernel at both ends."""
    method = rd.Method(order="incremental", basis="linear", numbers="random", estimator=estimator)
    patches, replicates = rd.subdivide(cube(0.5, 1.0), cells=1), 64
    exchange = Exchange(Geometry(patches, choose("cpu")), Problem.of(patches), method, 1, replicates)
    power = np.zeros((replicates, 6, 3))
    power[:, 0] = [0.0, 0.8, -0.6]
    power = upload(exchange.types.Float64, power.ravel() * LINE * 1000)
    expected = exchange.types.UInt64(exchange.largest(power)) + dr.opaque(exchange.types.UInt64, 500 * LINE)
    exchange.send(power, expected, 1.0)
    got = np.array(exchange.patches(exchange.shooter.scores.received)).reshape(replicates, 6, 3) / LINE / 1000
    a, b, w = gauss(8)
    basis, (one, other) = BASES["linear"], (points_of(patches, row, a, b) for row in (0, 1))
    way = other[None] - one[:, None]
    distance = np.linalg.norm(way, axis=2)
    kernel = (way @ patches.normal[0]) * -(way @ patches.normal[1]) / (np.pi * distance**4)
    sent = basis.at(a, b, True) @ [0.0, 0.8, -0.6] * w
    exact = (sent @ kernel * w) @ basis.at(a, b, True)
    assert np.abs(exact[1:]).max() > 0.01
    z = (got[:, 1].mean(axis=0) - exact) / (got[:, 1].std(axis=0, ddof=1) / np.sqrt(replicates))
    assert np.abs(z).max() < 4.0  # three values, Student with 63 degrees of freedom: 5e-4


@pytest.mark.parametrize("name", [*SOME, "gather"])
def test_a_furnace_is_flat(name):
    """In a furnace B = 1 everywhere: all coefficients but the mean are zero within their errors."""
    patches = rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1)
    choices = {"order": "gather"} if name == "gather" else VARIANTS[name]
    solution = rd.solve(patches, rd.Method(**choices, basis="quadratic"), rays=300_000, replicates=16)
    if "control" in name or "everything" in name:
        assert np.abs(solution.radiosity - 1).max() < 0.01
        assert np.abs(solution.irradiance_coefficients).max() < 0.01
        return
    assert np.abs((solution.radiosity - 1) / solution.standard_error).max() < SIGMAS
    z = solution.irradiance_coefficients / solution.irradiance_coefficients_standard_error
    assert np.abs(z).max() < 7.5  # of 350
    assert 0.75 < np.sqrt(np.mean(z**2)) < 1.4


@pytest.fixture(scope="module")
def two_sided():
    patches = rd.subdivide(open_room(two_sided=True), cells=1)
    return patches, rd.solve(patches, rd.Method(**VARIANTS["regular, warm-up"], basis="linear"), rays=4_000_000, replicates=16)


@pytest.mark.parametrize("name", [name for name in VARIANTS if name != "regular, warm-up"])
def test_all_iterations_agree(two_sided, name):
    """In an open scene whose backs radiate, where a control variate must know the moments of what escapes."""
    patches, expected = two_sided
    solution = rd.solve(patches, rd.Method(**VARIANTS[name], basis="linear"), rays=400_000, replicates=16, seed=3)
    for field in ("irradiance", "irradiance_coefficients"):
        error = np.hypot(*(getattr(one, f"{field}_standard_error") for one in (solution, expected)))
        known = error > 0
        z = (getattr(solution, field) - getattr(expected, field))[known] / error[known]
        assert np.abs(z).max() < SIGMAS
    assert abs(solution.books[0]["rounding"]) < 0.02 * solution.books[0]["emitted"]


def test_short_runs_are_right_in_the_mean(two_sided):
    """With few quanta most of the light is sent in steps of extra lines, and what is dropped or doubled at the end counts."""
    patches, expected = two_sided
    method = rd.Method(order="incremental", basis="linear", numbers="random")
    solution = rd.solve(patches, method, quanta=30, replicates=768, seed=1)
    error = np.hypot(solution.irradiance_standard_error, expected.irradiance_standard_error)
    z = ((solution.irradiance - expected.irradiance) / np.where(error > 0, error, 1)).ravel()
    assert np.abs(z).max() < 4.5  # of 19: 1e-4
    assert solution.irradiance_standard_error.max() < 0.2 * solution.irradiance.max()


def test_linear_light_needs_a_quarter_of_the_patches():
    """On black walls lit by one: half the error at most, though a quarter of the patches; quadratic less again."""
    scene = lit_by_a_wall()
    coarse = rd.subdivide(scene, cells=4)
    fine = halved(halved(halved(coarse)))
    rows, (u, v) = np.flatnonzero(fine.face > 0), middles(fine)
    exact = falling(scene, fine.centroid[rows], fine.normal[rows])
    method = rd.Method(**VARIANTS["regular, warm-up"])
    constant = rd.solve(halved(coarse), method, rays=1_000_000, seed=1)
    errors = [np.sqrt(np.mean((constant.irradiance[parents(fine, constant.patches)[rows], 0] - exact) ** 2))]
    for name in SEVERAL:
        found = rd.solve(coarse, replace(method, basis=name), rays=1_000_000, seed=1)
        light = Polynomials(coarse, found.basis, found.irradiance, found.irradiance_coefficients)
        errors.append(np.sqrt(np.mean((light.at(parents(fine, coarse)[rows], u[rows], v[rows])[:, 0] - exact) ** 2)))
    assert errors[1] < 0.5 * errors[0]
    assert errors[2] < 0.7 * errors[1]


def test_the_rule_of_a_quarter_where_noise_does_not_matter():
    """Gathers of the same light, whose own errors are below a quarter of all: half the error of constants at most."""
    scene = lit_by_a_wall()
    coarse = rd.subdivide(scene, cells=3)
    fine = halved(halved(coarse))
    rows, (u, v) = np.flatnonzero(fine.face > 0), middles(fine)
    exact = falling(scene, fine.centroid[rows], fine.normal[rows])
    errors = []
    for patches, name in ((halved(coarse), "constant"), (coarse, "linear")):
        found = rd.solve(patches, "gather", basis=name, rays=800_000, seed=1)
        at, noise = parents(fine, patches)[rows], found.irradiance_standard_error[:, 0] ** 2
        light, noise = found.irradiance[at, 0], noise[at]
        if name == "linear":
            shape = Polynomials(coarse, found.basis, found.irradiance, found.irradiance_coefficients)
            light = shape.at(at, u[rows], v[rows])[:, 0]
            noise = noise + (found.irradiance_coefficients_standard_error[at, 0] ** 2).sum(axis=1)  # functions have mean square 1
        errors.append(np.sqrt(np.mean((light - exact) ** 2)))
        assert np.sqrt(noise.mean()) < 0.25 * errors[-1]
    assert errors[1] < 0.5 * errors[0]


def falling(scene: rd.Scene, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """The irradiance of points by the first face, which emits 1, in closed form."""
    return from_points(points, normals, np.tile(scene.vertices[scene.faces[0]], (len(points), 1, 1)))


@pytest.mark.parametrize(("bands", "choices"), [(1, {}), (2, {"estimator": "survival", "order": "depth-first"})])
def test_particles_count_moments_beside_their_hits(bands, choices, tmp_path):
    """Means have the bits that they have without a basis; coefficients are those of iterations, whose patches are small."""
    scene = cube([[0.5] * bands] * 6, [[1.0, 0.2][:bands]] + [[0.0, 0.1][:bands]] * 5)
    patches, budget = rd.subdivide(scene, cells=2), {"rays": 100_000, "replicates": 16}
    method = rd.Method(equation="continuous", basis="linear", **choices)
    found = rd.solve(patches, method, **budget)
    assert np.array_equal(found.irradiance, rd.solve(patches, replace(method, basis="constant"), **budget).irradiance)
    other = rd.solve(patches, "stochastic-jacobi", basis="linear", **budget, seed=2)
    error = np.hypot(found.irradiance_coefficients_standard_error, other.irradiance_coefficients_standard_error)
    z = (found.irradiance_coefficients - other.irradiance_coefficients) / error
    assert np.sqrt(np.mean(z**2)) < 1.4
    if bands == 1:
        part = rd.solve(patches, method, quanta=2**12, replicates=2)
        part.save(tmp_path / "x.npz")
        on = rd.solve(patches, method, quanta=2**13, replicates=2, resume=rd.load_solution(tmp_path / "x.npz"))
        whole = rd.solve(patches, method, quanta=2**13, replicates=2)
        assert np.array_equal(on.irradiance_coefficients, whole.irradiance_coefficients)


@pytest.mark.parametrize(
    "name", [pytest.param("constant", marks=pytest.mark.slow), "linear", pytest.param("quadratic", marks=pytest.mark.slow)]
)
def test_a_refine_check_knows_what_polynomials_leave_out(name):
    """On black walls lit by one: what is left out within patches is that of a closed form, for each degree."""
    rho = 1e-3  # so that there is a radiosity, and hardly more light than the lamp's
    scene = lit_by_a_wall(rho)
    coarse = rd.subdivide(scene, cells=2)
    fine = halved(halved(halved(coarse)))
    rows, (u, v), parent = np.flatnonzero(fine.face > 0), middles(fine), parents(fine, coarse)
    exact = falling(scene, fine.centroid[rows], fine.normal[rows])
    check = rd.refine_check(coarse, "stochastic-jacobi", basis=name, rays=300_000, replicates=4)
    solution = check.coarse
    light = solution.irradiance[parent[rows], 0]
    if solution.basis.size > 1:
        polynomials = Polynomials(coarse, solution.basis, solution.irradiance, solution.irradiance_coefficients)
        light = polynomials.at(parent[rows], u[rows], v[rows])[:, 0]
    left_out = np.sum((light - exact) ** 2) * fine.area[-1]
    stated = coarse.area @ check.square_within[:, 0] / rho**2
    assert stated == pytest.approx(left_out, rel=0.35)


def middles(patches: rd.Patches) -> tuple[np.ndarray, np.ndarray]:
    """Face coordinates of the middles of parallelograms."""
    column, row, _ = patches.place
    return (column + 0.5) / patches.columns[patches.face], (row + 0.5) / patches.rows[patches.face]


@pytest.mark.parametrize("name", ["incremental", "regular, everything"])
def test_an_interrupted_run_goes_on_to_the_same_bits(name, tmp_path):
    patches = rd.subdivide(open_room(), cells=2)
    method, budget = rd.Method(**VARIANTS[name], basis="quadratic"), {"quanta": 300_000, "replicates": 2}
    calls = []

    def stop(progress):
        calls.append(progress)
        if len(calls) == 6:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        rd.solve(patches, method, **budget, progress=stop, checkpoint=tmp_path / "part.npz")
    part = rd.load_solution(tmp_path / "part.npz")
    assert part.status == "interrupted"
    whole = rd.solve(patches, method, **budget)
    done = rd.solve(patches, method, **budget, resume=part)
    assert np.array_equal(done.irradiance_coefficients, whole.irradiance_coefficients)
    assert all(np.array_equal(done.state[key], whole.state[key]) for key in whole.state)


def test_coefficients_are_kept_in_files(tmp_path):
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=1)
    solution = rd.solve(patches, "stochastic-jacobi", rays=100_000, replicates=2, basis="linear")
    assert solution.irradiance_coefficients.shape == (len(patches), 3, 2)
    assert solution.basis.name == "linear"
    solution.save(tmp_path / "x.npz")
    back = rd.load_solution(tmp_path / "x.npz")
    for field in ("irradiance_coefficients", "irradiance_coefficients_standard_error", "radiosity_coefficients"):
        assert np.array_equal(getattr(back, field), getattr(solution, field))
    arrays = dict(np.load(tmp_path / "x.npz"))
    for change in ({"irradiance_coefficients": arrays["irradiance_coefficients"][:, :, :1]}, {"irradiance_coefficients": None}):
        changed = {key: value for key, value in (arrays | change).items() if value is not None}
        np.savez(tmp_path / "y.npz", **changed)
        with pytest.raises(rd.SceneError, match="coefficients"):
            rd.load_solution(tmp_path / "y.npz")


def test_states_have_a_column_for_each_function():
    patches = rd.subdivide(rd.load_scene("room"), cells=1)
    solution = rd.solve(patches, "stochastic-jacobi", rays=50_000, replicates=2, basis="linear")
    process = process_of(solution, Problem.of(patches))
    assert process.read(solution.state, process.sizes).quanta == solution.quanta
    assert solution.state["received"].size == 2 * (len(patches) + 2) * 3


@pytest.mark.parametrize(
    "choices",
    [{}, {"order": "gather", "reconstruction": "smooth"}, {"order": "matrix"}, {"lines": "global", "order": "regular"}],
)
def test_other_methods_refuse_a_basis(choices):
    with pytest.raises(rd.MethodError, match="basis 'linear' is for iterations of local lines"):
        rd.Method(basis="linear", **choices)
