"""Contract of an order: what every member of `ORDERS` must keep, with each kind of lines, estimator, option and preset that goes
with it (`members.varied`). States are compared whole, to the bit (`states.py`): no statistics, no tolerance but that of sums in
doubles. Orders that break it are rejected.
"""

from dataclasses import replace

import numpy as np
import pytest
from enclosures import cube
from members import accepted, each, plainest, varied
from states import MOST, ODD, STAGES, SUMS, begun, interrupted, once, same, scene_of, whole

import radiosity as rd
from radiosity.algorithms.firing.due import due
from radiosity.algorithms.firing.fire import fire
from radiosity.algorithms.firing.orders import breadth_first
from radiosity.algorithms.global_lines import mixing, multipath, pooling
from radiosity.algorithms.matrix import algorithm as matrix
from radiosity.algorithms.walks.launches import AbstractWalks
from radiosity.device.backend import threads
from radiosity.method.order import ORDERS
from radiosity.tracing import lanes

pytestmark = pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning")  # of few lines


BY_LAUNCH = ("sorted", "multipath")  # orders in which lines meet their numbers by the launch that they are in


@pytest.fixture
def short(monkeypatch):
    """Launches of few lines, so that stages have many of them."""
    for module, name, value in (
        (lanes, "CHUNK", 1 << 12),
        (lanes, "CORE_CHUNK", 1),
        (matrix, "LAUNCH", 3_000),
        (mixing, "VISITS", 8),
        (multipath, "BATCH", 1),
        (pooling, "BATCH", 1),
        (breadth_first, "TAILS", {"cpu": 1 << 10, "cuda": 1 << 10}),
    ):
        monkeypatch.setattr(module, name, value)


@pytest.mark.parametrize("order", ORDERS)
def test_some_process_takes_it(order):
    assert plainest("order", order)
    assert ORDERS[order]


@each(varied, "order")
class TestContract:
    def test_bits_repeat_on_any_number_of_threads_and_change_with_the_seed(self, method):
        with threads(2):
            assert same(once(method), whole(method))
        assert not same(once(method), whole(method, seed=5))

    def test_an_interrupted_run_goes_on_to_the_same_bits(self, method, short):
        state, stops = interrupted(method)
        assert len(STAGES) < stops < MOST  # within a stage, too, not at its end alone
        assert same(state, whole(method) if method.order in BY_LAUNCH else once(method))
        assert not state.unfinished

    def test_stages_do_not_matter_where_it_says_so(self, method):
        if begun(method).stage_independent:
            assert same(whole(method, STAGES[-1:]), whole(method, ODD), SUMS)

    def test_lines_only_grow(self, method):
        algorithm, (_, problem) = begun(method), scene_of(method)
        lines = [0]
        times = 16 if method.order == "gather" and method.basis != "constant" else 1  # it stores lines, however small N is
        for quanta in times * np.array((500, *STAGES)):
            algorithm.advance(int(quanta), lambda lines: None)
            assert algorithm.quanta == quanta
            lines.append(algorithm.tally.lines(problem, algorithm.capture()))
        assert (np.diff(lines) > 0).all()

    def test_an_empty_state_is_refused(self, method):
        with pytest.raises(rd.MethodError):
            begun(method).read({}, begun(method).sizes)

    def test_books_balance_and_say_whether_they_close(self, method):
        patches = scene_of(method)[1].patches
        books = rd.solve(patches, method, quanta=STAGES[-1], replicates=2).books
        for book in books:
            assert book["closes"] in (True, None)
            left = book["emitted"] + book["rounding"]
            assert left == pytest.approx(book["absorbed"] + book["escaped"] + book["lost"], rel=1e-9)

    def test_black_walls_end_the_walk(self, method):
        solution = rd.solve(rd.subdivide(cube(0.0, 1.0), cells=2), method, quanta=STAGES[-1], replicates=2)
        assert solution.status == "complete"
        assert np.array_equal(solution.radiosity, solution.patches.emission)
        assert solution.irradiance.mean() == pytest.approx(1, abs=0.02)

    def test_one_face_and_few_lines(self, method):
        """Arrays of one entry, and runs that hit nothing at all; everything escapes."""
        square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
        one, two = (
            rd.subdivide(rd.Scene.from_arrays(square[:corners], [list(range(corners))], 0.5, 1.0), cells=1) for corners in (3, 4)
        )
        budgets = ({"rays": 1}, {"rays": 1000}, {"quanta": 1}, {"quanta": 3, "replicates": 1})
        for patches, budget in zip((one, two, two, one), budgets, strict=True):
            if method.reconstruction == "smooth":  # it compares replicates
                budget = budget | {"replicates": 2}
            solution = rd.solve(patches, method, **budget)
            assert solution.irradiance == 0
            assert solution.radiosity == 1


def test_an_order_with_a_memory_of_its_own_is_rejected(monkeypatch, short):
    """It leaves sweeps out by numbers of its own, which no state holds; what they were to carry is missed when a run goes on."""
    drawn = np.random.default_rng(0)

    def run(self, counters, swept):
        wavefront, largest = due(counters)
        while wavefront is not None and drawn.random() < 0.8:
            fire(counters, wavefront, largest)
            swept(wavefront.total)
            wavefront, largest = due(counters)

    monkeypatch.setattr(breadth_first.BreadthFirst, "run", run)
    method = rd.Method(order="breadth-first")
    assert not same(whole(method), whole(method))
    with pytest.raises(rd.MethodError, match="do not carry what patches have sent"):
        interrupted(method)
    assert not same(whole(method, STAGES[-1:]), whole(method, ODD), SUMS)


def test_a_state_that_leaves_out_where_it_was_is_rejected(monkeypatch, short):
    restore = AbstractWalks.restore
    monkeypatch.setattr(AbstractWalks, "restore", lambda self, state: restore(self, replace(state, launches=0)))
    method = rd.Method(equation="continuous")
    assert not same(interrupted(method)[0], whole(method))


def test_every_method_has_one_order():
    assert {method.order for method in accepted()} == set(ORDERS)
