"""Gathers of polynomials: coefficients are moments of what lines bring where they leave, against closed forms and quadrature.

Direct light and furnaces are among the cases of `test_bases`. Alpha: Student with 15 degrees of freedom, 6.5 standard errors for
some 300 coefficients: 300 * 1e-5; seeds are fixed.
"""

from dataclasses import replace

import drjit as dr
import numpy as np
import pytest
from enclosures import cube
from kills import assert_same
from test_bases import gauss, points_of
from test_diffusers import furnace
from test_gather_lights import lamp, lit, room

import radiosity as rd
from radiosity.algorithms.gather import algorithm as gather
from radiosity.algorithms.gather import moments
from radiosity.algorithms.gather.chances import Chances
from radiosity.algorithms.gather.fit import Fit
from radiosity.algorithms.gather.lines import Lines
from radiosity.algorithms.gather.packets import Packets
from radiosity.algorithms.gather.rows import Rows
from radiosity.algorithms.gather.stored_lines import StoredLines
from radiosity.device.backend import choose, upload
from radiosity.patches.bases import BASES
from radiosity.problem.model import Problem
from radiosity.sampling.streams import Purpose
from radiosity.scene.shapes import box
from radiosity.tracing.geometry import Geometry

SIGMAS = 6.5
GATHER = rd.Method(order="gather", basis="linear")


def coefficients(solution: rd.Solution) -> tuple[np.ndarray, np.ndarray]:
    """Means and the other coefficients, and their errors, (n_patches, n_bands, K) each."""
    one, other = (
        np.concatenate([mean[..., None], others], axis=2)
        for mean, others in (
            (solution.irradiance, solution.irradiance_coefficients),
            (solution.irradiance_standard_error, solution.irradiance_coefficients_standard_error),
        )
    )
    return one, other


def apart(one: rd.Solution, other: rd.Solution) -> np.ndarray:
    """Differences of the coefficients after the mean of two solutions, in standard errors."""
    (first, error), (second, its_error) = coefficients(one), coefficients(other)
    error = np.hypot(error, its_error)
    return ((first - second) / np.where(error > 0, error, 1.0))[..., 1:]


def in_triangles(scene: rd.Scene) -> rd.Scene:
    """The scene with each parallelogram as two triangles."""
    faces = np.concatenate([scene.faces[:, [0, 1, 2]], scene.faces[:, [0, 2, 3]]])
    twice = lambda values: np.concatenate([values, values])  # noqa: E731
    reflectance, emission, surface = map(twice, (scene.reflectance, scene.emission, scene.surface))
    faces = np.column_stack([faces, np.full(len(faces), -1)])
    return rd.Scene.from_arrays(scene.vertices, faces, reflectance, emission, surface=surface, names=scene.names)


@pytest.mark.parametrize("triangles", [False, True])
def test_a_gather_and_iterations_agree(triangles):
    """Between bright walls of two bands, which most light meets several times; both solve the Galerkin equation."""
    scene = cube([[0.7, 0.3]] * 6, [[1.0, 0.1]] + [[0.0, 0.2]] * 5)
    scene = in_triangles(scene) if triangles else scene
    patches, budget = rd.subdivide(scene, cells=1 if triangles else 2), {"rays": 400_000, "replicates": 16}
    one = rd.solve(patches, GATHER, **budget, seed=1)
    other = rd.solve(patches, "stochastic-jacobi", basis="linear", **budget, seed=2)
    z = apart(one, other)
    assert np.abs(z).max() < SIGMAS
    assert 0.6 < np.sqrt(np.mean(z**2)) < 1.4
    (first, error), (second, its_error) = coefficients(one), coefficients(other)
    assert (np.abs(first - second)[..., 0] < SIGMAS * np.hypot(error, its_error)[..., 0]).all()
    turned = np.abs(first[..., [0, 2, 1]] - second)[..., 1:] / np.hypot(error, its_error)[..., 1:]
    assert turned.max() > 3 * SIGMAS  # each other's coefficients would be noticed


def test_the_light_of_a_point():
    """Moments of shadow rays: the inverse square and the cosine, by quadrature."""
    position = np.array([0.3, 0.45, 0.6])
    patches, (a, b, w) = lit(room(0.0), lamp(position, power=40.0), cells=4), gauss(12)
    found = rd.solve(patches, "gather", basis="quadratic", quanta=150_000, replicates=16)
    points = np.array([points_of(patches, row, a, b) for row in range(len(patches))])
    way = position - points
    light = 40 / (4 * np.pi) * (way * patches.normal[:, None]).sum(axis=2) / (way**2).sum(axis=2) ** 1.5
    exact = (light * w) @ BASES["quadratic"].at(a, b, True)
    value, error = (one[:, 0] for one in coefficients(found))
    z = (value - exact) / np.hypot(error, 2e-4 * exact[:, :1])
    assert np.abs(z).max() < 8
    assert np.sqrt(np.mean(z**2)) < 1.4
    assert np.abs(exact[:, 1:]).max() > 3


def test_lines_and_stored_rows_read_polynomials_and_return_their_moments():
    """The floor of a cube sends a linear field: moments by lines and by rows, and of the ceiling by quadrature of the kernel."""
    patches, basis, (a, b, w) = rd.subdivide(cube(0.5, 1.0), cells=1), BASES["linear"], gauss(12)
    geometry, problem, field = Geometry(patches, choose("cpu")), Problem.of(patches), np.array([0.3, 0.15, -0.1])
    geometry.prepare_hits()
    packets = Packets(geometry, 64)
    chances = Chances.of(geometry, problem)
    purposes = (Purpose.NUMBERS, Purpose.SHADOW_RAYS)
    lines = Lines.of(packets, chances, problem, rd.Method(order="gather"), 1, purposes, basis)
    read = np.zeros((64, 6, 3))
    read[:, 0] = field
    read = [upload(packets.types.Float, packets.lane_values(column).astype(np.float32)) for column in np.moveaxis(read, 2, 0)]
    some = np.full(packets.count, 600)
    kept = StoredLines(packets, basis, 600)
    (sums, _), (emitted, _) = (lines.cosine(np.zeros_like(some), some, one, kept) for one in (read, None))
    columns = [packets.patch_values(np.array(one - other, np.float64)) for one, other in zip(sums, emitted, strict=True)]
    by_lines = np.stack(columns, axis=-1) / (np.array(moments.units(basis)) * lines.unit * 600)
    rows = Rows(packets, kept, dr.full(packets.types.UInt32, 600, packets.lanes), None)
    by_rows = np.stack([packets.patch_values(np.array(one)) for one in rows.means(read)], axis=-1)
    middles = Fit.of(kept, rows.stored * 0, rows.stored).means
    by_rows[..., 1:] += by_rows[..., :1] * np.stack([packets.patch_values(np.array(one)) for one in middles], axis=-1)
    assert by_rows == pytest.approx(by_lines, abs=2e-5)
    floor, ceiling, functions = points_of(patches, 0, a, b), points_of(patches, 1, a, b), basis.at(a, b, True)
    way = ceiling[None] - floor[:, None]
    kernel = (way @ patches.normal[0]) * -(way @ patches.normal[1]) / (np.pi * (way**2).sum(axis=2) ** 2)
    exact = ((functions @ field * w) @ kernel * w) @ functions
    z = (by_lines[:, 1].mean(axis=0) - exact) / (by_lines[:, 1].std(axis=0, ddof=1) / 8)
    assert np.abs(z).max() < 4.0  # three values, Student with 63 degrees of freedom: 5e-4
    assert np.abs(exact[1:]).max() > 0.005


def test_light_through_a_sheet_has_the_shape_that_it_had():
    """A diffusing pane between two boxes, lit from the wall beside it: the other side sends on its polynomial."""
    scene = furnace(2.0, 1.0)
    emission = np.zeros_like(scene.emission)
    emission[0] = 3.0
    patches = rd.subdivide(replace(scene, emission=emission, back_emission=0 * emission), cells=1)
    budget = {"rays": 400_000, "replicates": 16, "basis": "linear"}
    one, other = rd.solve(patches, "gather", **budget), rd.solve(patches, "stochastic-jacobi", **budget, seed=2)
    z = apart(one, other)
    assert np.abs(z).max() < SIGMAS
    assert np.sqrt(np.mean(z**2)) < 1.4
    sheet = patches.surface == 2
    slopes, (_, error) = one.radiosity_coefficients[sheet], coefficients(one)
    assert (np.abs(slopes).max(axis=2) > 10 * error[sheet, :, 1:].max(axis=2)).all()


@pytest.mark.parametrize("name", ["linear", "quadratic"])
def test_a_narrow_gap_is_solved_along_few_lines(name):
    """Bright plates 1 cm apart are a furnace: all noise of a plate comes back to it, and must not grow."""
    corners = np.concatenate(box((0, 0, 0), (1, 1, 0.01), inward=True))
    scene = rd.Scene.from_arrays(corners, np.arange(24).reshape(6, 4), 0.95, 0.05)
    patches = rd.subdivide(scene, cells=3)
    solution = rd.solve(patches, "gather", basis=name, quanta=30 * len(patches), replicates=16, seed=3)
    wide = patches.area > 0.01
    assert np.abs(solution.radiosity - 1).max() < 0.2
    assert np.abs(solution.irradiance_coefficients[wide]).max() < 0.3
    z = solution.irradiance_coefficients / solution.irradiance_coefficients_standard_error
    assert np.sqrt(np.mean(z**2)) < 1.4


@pytest.mark.parametrize("quanta", [20, 120])
def test_bits_do_not_depend_on_stages_or_parts(quanta, monkeypatch):
    """While lines are stored, and after two corrections: slices, a run that goes on, and two parts."""
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=2)
    options = {"basis": "linear", "quanta": quanta * len(patches), "seed": 2}
    whole = rd.solve(patches, "gather", replicates=3, **options)
    monkeypatch.setattr(gather, "SLICE", 3 * options["quanta"] // 5)
    assert_same(rd.solve(patches, "gather", replicates=3, **options), whole)
    few = rd.solve(patches, "gather", replicates=3, **(options | {"quanta": quanta * len(patches) // 3}))
    on = rd.solve(patches, "gather", replicates=3, resume=few, **options)
    assert_same(on, whole)
    parts = [rd.solve(patches, "gather", first_replicate=at, replicates=n, **options) for at, n in ((0, 2), (2, 1))]
    merged = rd.merge(parts)
    assert np.array_equal(merged.irradiance_coefficients, whole.irradiance_coefficients)
    assert np.array_equal(merged.irradiance_coefficients_standard_error, whole.irradiance_coefficients_standard_error)


def test_a_basis_does_not_go_with_smoothing():
    with pytest.raises(rd.MethodError, match="without smoothing"):
        rd.Method(order="gather", basis="linear", reconstruction="smooth")


class Misses:
    """A scene of Mitsuba that leaves NaN where lines hit nothing; Embree leaves what was in memory there."""

    def __init__(self, scene):
        self.scene = scene

    def ray_intersect_preliminary(self, ray, **options):
        found = self.scene.ray_intersect_preliminary(ray, **options)
        found.prim_uv = dr.select(found.is_valid(), found.prim_uv, np.nan)
        return found


def test_lines_that_hit_nothing_bring_nothing(monkeypatch):
    """Report 14 of trimesh/embreex: places of hits that there are not. NaN times nothing made whole numbers of -2^63."""
    scene = cube(0.5, 1.0)
    patches = rd.subdivide(scene.take(np.arange(6) != 5), cells=1)
    options = {"basis": "linear", "rays": 20_000, "replicates": 2}
    plain = rd.solve(patches, "gather", **options)
    built = Geometry(patches, choose("cpu")).bvh
    monkeypatch.setattr(Geometry, "bvh", replace(built, scene=Misses(built.scene)))
    other = rd.solve(patches, "gather", **options)
    assert np.array_equal(plain.irradiance, other.irradiance)
    assert np.array_equal(plain.irradiance_coefficients, other.irradiance_coefficients)
