"""Contract of a kind of lines: what every member of `LINES` must keep, in every process that takes it (`members.plainest`).

Shares of power are compared with closed forms by Student's t, over 16 replicates or 6 runs, at ALPHA for all comparisons of a
test together (Bonferroni); seeds are fixed. That a line is a function of seed and number, whatever the stages, threads and
interruptions, and another one with another seed, is held by the suite of the orders, which runs every kind of lines.
"""

from dataclasses import replace

import numpy as np
import pytest
from enclosures import coaxial_discs, cube, parallel_squares, perpendicular_squares
from members import accepted, each, plainest
from replicates import powers
from scipy import stats

import radiosity as rd
from radiosity.algorithms.gather.pilot import LINES as LINES_OF_PILOT
from radiosity.method.lines import LINES
from radiosity.sampling import global_lines
from radiosity.tracing import ray_generation

ALPHA, RAYS, REPLICATES, RUNS = 1e-4, 30_000, 16, 6
EDGE = 1e-4  # of all power: lines within single precision of an edge
SETTLED = 1e-6  # of pooled iterations, whose warm-up ends when that of all replicates has settled


def received(scene: rd.Scene, method: rd.Method, cells: int) -> np.ndarray:
    """(replicates, 1): the share of what one surface emits that the other, which is black as the first, receives."""
    patches = rd.subdivide(scene, cells=cells)
    solution = rd.solve(patches, method, rays=8 * RAYS, replicates=REPLICATES)
    lit = patches.emission[:, 0] > 0
    return powers(solution, key=lit)[:, :1] / patches.area[lit].sum()


def off(found: np.ndarray, exact: float) -> float:
    """The largest difference of means of (n, k) values, over the bound that they exceed with probability ALPHA."""
    error = found.std(axis=0, ddof=1) / len(found) ** 0.5
    assert (error < 0.01).all()
    bound = stats.t.ppf(1 - ALPHA / 2 / found.shape[1], len(found) - 1)
    return float((np.abs(found.mean(axis=0) - exact) / (bound * error)).max())


def turned(scene: rd.Scene) -> rd.Scene:
    """The other surface emits."""
    return replace(scene, emission=1.0 - scene.emission)


@pytest.mark.parametrize("lines", LINES)
def test_some_process_takes_it(lines):
    assert plainest("lines", lines)
    assert LINES[lines]


@each(plainest, "lines")
class TestContract:
    def test_exact_form_factors(self, method):
        """Of walls with a common edge; those of opposite ones are held by the test of quarters of walls."""
        scene, exact = perpendicular_squares()
        assert off(received(scene, method, 2), exact) < 1

    def test_both_ways_are_reciprocal(self, method):
        """Discs of unlike area: A_1 F_12 = A_2 F_21."""
        scene, exact = coaxial_discs(sides=24)
        area = np.bincount(scene.surface, scene.area)
        assert off(received(scene, method, 1), exact) < 1
        assert off(received(turned(scene), method, 1), exact * area[0] / area[1]) < 1

    def test_what_misses_all_patches_escapes(self, method):
        scene, exact = parallel_squares()
        patches = rd.subdivide(scene, cells=2)
        runs = [rd.solve(patches, method, rays=RAYS, replicates=1, seed=seed) for seed in range(RUNS)]
        assert off(np.array([run.escaped for run in runs]), 1 - exact) < 1

    def test_nothing_escapes_a_closed_scene_and_each_line_counts_where_it_lands(self, method):
        """A local line, which lands once, counts 1; a span of a global line, which has two ends, 2. Lines that send the residue
        of whole lines on count, too, and are not among the arrivals."""
        patches = rd.subdivide(cube(0.5, [[1.0], *[[0.0]] * 5]), cells=3)
        solution = rd.solve(patches, method, rays=RAYS, replicates=2)
        firing = method.machine == "firing"
        lines = int(solution.state["fired"].sum(dtype=np.uint64)) if firing else solution.rays
        if method.machine == "gather":  # lines of the pilot measure no patch
            lines -= LINES_OF_PILOT * len(patches)
        assert lines == pytest.approx(solution.arrivals.sum(), rel=EDGE)
        if method.machine != "gather":
            assert lines <= solution.rays <= (1.1 if firing else 1) * lines
        for name in ("escaped", "lost"):
            assert solution.books[0][name] <= EDGE * solution.books[0]["emitted"]

    def test_places_of_walls_are_alike(self, method):
        """Quarters of black walls as far from the one that emits receive the same, and they add up to what factors say."""
        patches = rd.subdivide(cube(0.0, [[1.0], *[[0.0]] * 5]), cells=2)
        power = powers(rd.solve(patches, method, rays=8 * RAYS, replicates=REPLICATES), key=np.arange(len(patches)))
        lit = patches.surface == 0
        depth = (patches.centroid - patches.centroid[lit][0]) @ patches.normal[lit][0]
        opposite = parallel_squares()[1]
        for near, exact in ((0.25, None), (0.75, None), (1.0, opposite)):
            alike = power[:, ~lit & np.isclose(depth, near)]
            assert alike.shape[1] == (4 if near == 1.0 else 8)
            assert off(alike - alike.mean(axis=1, keepdims=True), 0.0) < 1
            assert exact is None or off(alike.sum(axis=1, keepdims=True), exact) < 1

    def test_replicates_do_not_depend_on_their_number(self, method):
        patches = rd.subdivide(cube(0.5, [[1.0], *[[0.0]] * 5]), cells=2)
        quanta = rd.solve(patches, method, rays=RAYS, replicates=1).quanta
        read = sums if method.order == "gather" else powers
        three, one = (read(rd.solve(patches, method, quanta=quanta, replicates=r)) for r in (3, 1))
        assert three[0] == pytest.approx(one[0], rel=SETTLED)
        assert three[1] != pytest.approx(one[0], rel=SETTLED)


def sums(solution: rd.Solution) -> np.ndarray:
    """(replicates, n): what the lines of a gather brought. What is read of it is balanced by the spread of all replicates."""
    return np.concatenate([solution.state[name][..., 0].astype(float) for name in ("brought", "met")], axis=1)


def uniform_hemisphere(first, second):
    """Directions that are uniform over the hemisphere, not cosine distributed."""
    import drjit as dr

    sine = dr.sqrt(1 - second * second)
    y, x = dr.sincos(first * (2 * np.pi))
    return x * sine, y * sine, second


def drawn_to_the_equator(first, second):
    """Points that are not uniform on the sphere."""
    import drjit as dr

    z = (1 - 2 * first) ** 3
    radius = dr.sqrt(1 - z * z)
    y, x = dr.sincos(second * (2 * np.pi))
    return x * radius, y * radius, z


@each(lambda axis, value: plainest(axis, value)[:1], "lines")
def test_wrong_directions_are_rejected(method, monkeypatch):
    monkeypatch.setattr(ray_generation, "hemisphere", uniform_hemisphere)
    monkeypatch.setattr(global_lines, "on_sphere", drawn_to_the_equator)
    scene, exact = parallel_squares()
    assert off(received(scene, method, 2), exact) > 2


def test_every_method_has_one_kind():
    assert {method.lines for method in accepted()} == set(LINES)
