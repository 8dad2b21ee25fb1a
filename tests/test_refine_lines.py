"""Lines that refine the pair of elements which they carry power between (`algorithms.iterations.refinement`).

Elements are compared with `Hierarchy`, decisions with the formula in double precision, results with closed forms and with lines
that end on patches. Seeds are fixed; bounds are stated where they are.
"""

from dataclasses import replace

import drjit as dr
import numpy as np
import pytest
from enclosures import cube
from iterations import open_room
from replicates import difference, powers
from test_hierarchy import hierarchy

import radiosity as rd
from radiosity.algorithms.base import Interrupted
from radiosity.algorithms.iterations.clearance import clearance, largest_clear
from radiosity.algorithms.iterations.elements import Elements
from radiosity.algorithms.iterations.refined_tally import RefinedTally
from radiosity.algorithms.iterations.refinement import End, Refinement
from radiosity.algorithms.table import make
from radiosity.device.backend import choose, upload
from radiosity.patches import elements as geometry_of
from radiosity.problem.model import Problem
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.line_tracer import LineTracer

REPLICATES = 2
EVERYTHING: dict = {"order": "regular", "estimator": "bidirectional", "control_variate": True, "warm_up": True}
VARIANTS: dict[str, dict] = {"incremental": {"order": "incremental"}, "warm-up": {"order": "regular", "warm_up": True}, "everything": EVERYTHING}


def elements_of(patches: rd.Patches) -> Elements:
    geometry = Geometry(patches, choose("cpu"))
    geometry.prepare()
    return Elements(LineTracer.of(geometry, "random", "by-patch", 0, REPLICATES))


@pytest.fixture(scope="module")
def mixed() -> Elements:
    """Parallelograms and triangles with two sides, cut in both directions and in one."""
    return elements_of(hierarchy().patches)


@pytest.fixture(scope="module")
def room() -> rd.Patches:
    return rd.subdivide(open_room(), cells=8)


@pytest.fixture(scope="module")
def small() -> rd.Patches:
    return rd.subdivide(open_room(), cells=4)


@pytest.fixture(scope="module")
def known(room) -> rd.Solution:
    return rd.solve(room, "random-walk", rays=3_000_000, replicates=4, seed=9)


def above(elements: Elements) -> np.ndarray:
    """The element of each level that holds each patch, (levels, n_patches), or -1 below the patches, by `Hierarchy`."""
    tree = elements.tree
    leaf = tree.leaf(np.arange(len(tree.patches)))
    found = np.full((int(tree.deepest.max()) + 1, len(leaf)), -1)
    element, of = leaf, np.arange(len(leaf))
    while len(of):
        found[tree.level(element), of] = element
        inner = tree.level(element) > 0
        of, element = of[inner], tree.parent(element[inner])
    return found


def slots_of(elements: Elements, element: np.ndarray) -> np.ndarray:
    """The slots of elements of the first replicate: patches themselves, then those that are no patches, in the order of sides."""
    tree = elements.tree
    inner = np.diff(tree.first) - tree.patches.cells_per_face[tree.side_face]
    side = tree.side(element)
    number = elements.tracer.slots + (np.cumsum(inner) - inner)[side] + element - tree.first[side]
    leaf = tree.is_leaf(element)
    return np.where(leaf, tree.patch(np.where(leaf, element, tree.leaf(np.zeros(1, int)))), number)


def test_elements_are_those_of_the_hierarchy(mixed):
    holders, n = above(mixed), len(mixed.tree.patches)
    number = upload(mixed.types.UInt32, np.arange(n, dtype=np.uint32))
    for level, holder in enumerate(holders):
        found = np.array(mixed.slot(number, mixed.place(number), mixed.types.UInt32(level)))
        deep = holder < 0
        assert np.array_equal(found[~deep], slots_of(mixed, holder[~deep]))
        assert np.array_equal(found[deep], np.flatnonzero(deep))
    assert mixed.size == mixed.tracer.slots + REPLICATES * (len(mixed.tree) - n)


def test_ends_have_the_geometry_of_elements(mixed):
    """To single precision, and to the margin along edges where no line begins."""
    tree, n = mixed.tree, len(mixed.tree.patches)
    faces = mixed.tracer.geometry.faces
    scale = np.linalg.norm(faces.frames[1], axis=1)[0] / np.linalg.norm(tree.patches.scene.frames[1][0])
    origin = faces.frames[0][0] / scale - tree.patches.scene.frames[0][0]
    number = upload(mixed.types.UInt32, np.arange(n, dtype=np.uint32))
    place = mixed.place(number)
    for level, holder in enumerate(above(mixed)):
        end, there = End.of(place, mixed.frame(place), mixed.types.UInt32(level)), holder >= 0
        element = holder[there]
        centroid = np.array(end.centroid).T[there] / scale - origin
        assert centroid == pytest.approx(geometry_of.centroid(tree, element), abs=1e-3)
        assert np.array(end.area)[there] / scale**2 == pytest.approx(geometry_of.area(tree, element), rel=1e-3)
        assert np.array(end.normal).T[there] == pytest.approx(geometry_of.normal(tree, element), abs=1e-5)


def test_what_elements_received_is_shared_out_without_loss(mixed):
    """Every unit, of either sign, arrives; and each patch has its share to one unit a level."""
    tree, columns, random = mixed.tree, 2, np.random.Generator(np.random.Philox(0))
    received = random.integers(-(2**40), 2**40, (mixed.size, columns))
    pushed = np.array(mixed.pushed(upload(mixed.types.Int64, received.ravel()), columns)).reshape(-1, columns)
    slots, n = mixed.tracer.slots, len(tree.patches)
    assert np.array_equal(pushed[mixed.tracer.total :], received[mixed.tracer.total : slots])
    assert np.array_equal(pushed.sum(axis=0), received.sum(axis=0))
    expected = received[:n].astype(float)
    for holder in above(mixed):
        inner = (holder >= 0) & (holder != tree.leaf(np.arange(n)))
        of = np.flatnonzero(inner)
        number, where, count = np.unique(holder[inner], return_inverse=True, return_counts=True)
        expected[of] += (received[slots_of(mixed, number)] / count[:, None])[where]
    assert np.abs(pushed[:n] - expected).max() < len(above(mixed))


def test_what_elements_send_is_that_of_their_patches(mixed):
    random, n = np.random.Generator(np.random.Philox(1)), len(mixed.tree.patches)
    sent = random.random(mixed.tracer.total) ** 4
    pulled = np.array(mixed.pulled(upload(mixed.types.Float64, sent)))
    for holder in above(mixed):
        of = np.flatnonzero(holder >= 0)
        number, where = np.unique(holder[of], return_inverse=True)
        assert pulled[slots_of(mixed, number)] == pytest.approx(np.bincount(where, sent[:n][of]), rel=1e-6)


def decided(patches: rd.Patches, epsilon: float, *, seed: int = 0) -> tuple[np.ndarray, Elements, np.ndarray]:
    """The slot that receives from each patch what goes to each, (n, n), for a random power; and that power."""
    elements = elements_of(patches)
    lines, n = Refinement(elements, epsilon), len(patches)
    sent = np.random.Generator(np.random.Philox(seed)).random(elements.tracer.total) ** 8 / n
    lines.begin(upload(elements.types.Float64, sent))
    source, patch = (upload(elements.types.UInt32, x.ravel().astype(np.uint32)) for x in np.indices((n, n)))
    return np.array(lines.receiver(source, patch)).reshape(n, n), elements, sent[:n]


def leaves_of(elements: Elements) -> dict[int, np.ndarray]:
    """The patches of each slot of the first replicate."""
    n = len(elements.tree.patches)
    found = {patch: np.array([patch]) for patch in range(n)}
    for holder in above(elements):
        for element in np.unique(holder[holder >= 0]):
            found[int(slots_of(elements, np.array([element]))[0])] = np.flatnonzero(holder == element)
    return found


def covers(receivers: np.ndarray, elements: Elements) -> bool:
    """From each patch, each element that receives gets what goes to any of its patches."""
    leaves = leaves_of(elements)
    return all((row[leaves[slot]] == slot).all() for row in receivers for slot in np.unique(row))


def test_each_pair_of_patches_goes_through_one_pair_of_elements(small, monkeypatch):
    receivers, elements, _ = decided(small, 1e-3)
    n = len(small)
    assert 0.05 < (receivers != np.arange(n)).mean() < 0.95
    assert covers(receivers, elements)
    of = End.of

    def of_the_line(place, frame, level):  # decides by where the line ends, not by the elements
        return replace(of(place, frame, level), centroid=of(place, frame, place.deepest).centroid)

    monkeypatch.setattr(End, "of", staticmethod(of_the_line))
    assert not covers(*decided(small, 1e-3)[:2])


def expected_receiver(elements: Elements, sent: np.ndarray, epsilon: float, source: int, patch: int, holders, clear) -> int:
    """The formula of the module's docstring in double precision."""
    tree = elements.tree
    s, r = 0, int(clear[patch])

    def end(level, of):
        element = holders[level, of : of + 1]
        low, first, second = geometry_of.corners(tree, element)[0][[0, 1, -1]]
        half = (np.sum((first - low) ** 2) + np.sum((second - low) ** 2)) / 4
        place = (geometry_of.centroid, geometry_of.normal, geometry_of.area)
        return element[0], *(x(tree, element)[0] for x in place), half

    deepest = [int(tree.level(tree.leaf(np.array([of])))[0]) for of in (source, patch)]
    while r < deepest[1]:
        (e_s, x_s, n_s, a_s, h_s), (_, x_r, n_r, a_r, h_r) = end(s, source), end(r, patch)
        power = sent[holders[s] == e_s].sum()
        way = x_r - x_s
        far = np.sqrt(way @ way + h_s + h_r)
        c_s = min(max(way @ n_s / far, 0) + h_r**0.5 / far, 1)
        c_r = min(max(-way @ n_r / far, 0) + h_s**0.5 / far, 1)
        if power * a_r / (np.pi * far**2) * (2 * c_r * c_s + c_r + c_s) * h_r**0.5 / far <= epsilon:
            break
        if s == deepest[0] or a_r >= 0.99 * a_s:
            r += 1
        else:
            s += 1
    return int(slots_of(elements, holders[r, patch : patch + 1])[0])


def test_pairs_are_refined_as_the_formula_says(small):
    """500 pairs; single precision may decide one otherwise."""
    receivers, elements, sent = decided(small, 1e-3)
    holders, clear = above(elements), largest_clear(elements.tree, elements.tracer.geometry)
    random = np.random.Generator(np.random.Philox(3))
    pairs = random.integers(0, len(small), (500, 2))
    wrong = sum(receivers[s, r] != expected_receiver(elements, sent, 1e-3, s, r, holders, clear) for s, r in pairs)
    assert wrong <= 1


def test_the_clearance_of_a_square_under_another():
    """One centimetre apart: the harmonic mean of the lengths is near it, and no element of many patches is clear."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    scene = rd.Scene.from_arrays(
        np.concatenate([square, square[::-1] + np.array([0, 0, 0.01])]), np.arange(8).reshape(2, 4), 0.5, 1.0, surface=[0, 1]
    )
    near, alone = (Geometry(rd.subdivide(x, cells=4), choose("cpu")) for x in (scene, scene.take(np.array([0]))))
    lengths = clearance(near) / near.faces.frames[1][0].max()
    assert (lengths > 0.01).all()
    assert (lengths < 0.03).all()  # 1 / r is cos / 0.01, whose mean is 2 / 3 of it
    assert np.isinf(clearance(alone)).all()
    for geometry, level in ((near, 2), (alone, 0)):
        assert (largest_clear(elements_of(geometry.patches).tree, geometry) == level).all()


@pytest.mark.parametrize("name", VARIANTS)
def test_lines_refined_to_patches_are_plain_lines(room, name):
    method, budget = rd.Method(**VARIANTS[name]), {"quanta": 20_000, "replicates": 2}
    plain, refined = (rd.solve(room, replace(method, refine_lines=epsilon), **budget) for epsilon in (0.0, 1e-300))
    assert np.array_equal(plain.irradiance, refined.irradiance)
    assert not refined.state["blurred"].any()
    assert all(np.array_equal(plain.state[key], refined.state[key]) for key in plain.state)


SLOW = [name if name == "incremental" else pytest.param(name, marks=pytest.mark.slow) for name in VARIANTS]


@pytest.mark.parametrize("name", SLOW)
def test_a_furnace_is_one_everywhere(name):
    """Walls as a whole to noise, patches to what is stated: 96 of them, 6.5 standard errors (p = 1e-3, with 15 degrees)."""
    patches = rd.subdivide(cube(0.5, 0.5), cells=4)
    method = rd.Method(**VARIANTS[name], refine_lines=1e-3)
    solution = rd.solve(patches, method, rays=100_000, replicates=16)
    if "everything" in name:
        assert np.abs(solution.irradiance - 1).max() < 1e-3
        return
    walls = powers(solution)
    assert np.abs(walls.mean(axis=0) - 1).max() < 6 * (walls.std(axis=0, ddof=1) / 4).max()
    assert np.abs((solution.irradiance - 1) / solution.irradiance_standard_error).max() < 6.5
    book = solution.books[0]
    assert book["closes"] is (True if name == "incremental" else None)
    assert abs(book["rounding"]) < 1e-3 * book["emitted"]


def test_what_elements_blur_is_in_the_bars(room, known, monkeypatch):
    """The error of the scene is stated to a fifth, where it is noise and where it is nearly all blur; without the bias not."""
    method = rd.Method(order="incremental", refine_lines=1e-3)

    def stated_over_true(rays):
        solution = rd.solve(room, method, rays=rays, replicates=8)
        area = room.area[:, None]
        wrong, light = solution.radiosity - known.radiosity, known.radiosity - room.emission
        return solution.error / np.sqrt((area * wrong**2).sum() / (area * light**2).sum())

    ratios = [stated_over_true(rays) for rays in (30_000, 1_000_000)]
    assert np.abs(np.array(ratios) - 1).max() < 0.2
    monkeypatch.setattr(RefinedTally, "bias", RefinedTally.bias_of_sums)
    assert stated_over_true(1_000_000) < 0.5


def test_surfaces_receive_what_plain_lines_bring(room):
    """16 replicates, about 15 surfaces, 6 standard errors, as `test_iteration`; the blur of a face stays within it."""
    one, other = (
        powers(rd.solve(room, rd.Method(order="incremental", refine_lines=epsilon), rays=rays, replicates=16, seed=seed))
        for epsilon, rays, seed in ((1e-4, 200_000, 1), (0.0, 500_000, 2))
    )
    assert np.abs(difference(one, other)).max() < 6


def test_few_lines_tell_more(room, known):
    def error(epsilon):
        found = rd.solve(room, rd.Method(order="incremental", refine_lines=epsilon), rays=30_000, replicates=2).irradiance
        return np.sqrt(np.mean((found - known.irradiance) ** 2))

    assert error(1e-3) < 0.8 * error(0.0)


@pytest.mark.parametrize("name", VARIANTS)
def test_an_interrupted_run_goes_on_to_the_same_bits_on_any_number_of_threads(room, name):
    method = rd.Method(**VARIANTS[name], refine_lines=1e-3)
    geometry, problem = Geometry(room, choose("cpu")), Problem.of(room)

    def run(stops: bool):
        algorithm = make(geometry, problem, method, 4, 2)
        for quanta in (2_000, 20_000):
            while True:
                try:
                    algorithm.advance(quanta, _stop if stops else lambda lines: None)
                    break
                except Interrupted:
                    state = algorithm.read(algorithm.capture().arrays(), algorithm.sizes)
                    algorithm = make(geometry, problem, method, 4, 2)
                    algorithm.restore(state)
        return algorithm.capture().arrays()

    threads, states = dr.thread_count(), []
    try:
        for count, stops in ((1, False), (2, True)):
            dr.set_thread_count(count)
            states.append(run(stops))
    finally:
        dr.set_thread_count(threads)
    assert states[0]["blurred"].any()
    assert states[0].keys() == states[1].keys()
    assert all(np.array_equal(states[0][key], states[1][key]) for key in states[0])


def _stop(lines):
    raise Interrupted("test")


def test_what_it_does_not_go_with_is_refused():
    with pytest.raises(rd.SceneError, match="3 x 3 cells; a hierarchy needs powers of two"):
        rd.solve(rd.subdivide(cube(), cells=3), rd.Method(order="incremental", refine_lines=1e-3), rays=1000)
    for wrong in ({}, {"order": "matrix"}, {"order": "regular", "lines": "global"}, {"order": "incremental", "basis": "linear"}):
        with pytest.raises(rd.MethodError, match="refine_lines"):
            rd.Method(refine_lines=1e-3, **wrong)
    solution = rd.solve(cube(), rd.Method(order="incremental", refine_lines=1e-3), rays=200_000, replicates=2)
    assert (solution.patches.columns & (solution.patches.columns - 1) == 0).all()
