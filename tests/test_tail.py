"""Wavefronts of few lines, and particles, are followed until they end, by lanes that take one walk after the other. Results are
those of whole wavefronts, wherever that begins, in every order, at any number of walks a lane, and where a run ends within it.
"""

import pytest
import states
from states import STAGES, begun, coloured, interrupted, same, whole

import radiosity as rd
from radiosity.algorithms.base import Interrupted
from radiosity.algorithms.firing.orders import breadth_first, depth_first
from radiosity.algorithms.walks import shooting
from radiosity.device.backend import choose
from radiosity.tracing import lanes, refill

ORDERS = ("breadth-first", "well-distributed", "staged", "depth-first")
NEVER, ALWAYS = 0, 1 << 40

pytestmark = pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning")  # of few lines


@pytest.fixture
def walks(monkeypatch):
    """The lanes of depth-first launches so far."""
    begun, walk = [], depth_first.walk

    def counted(counters, launch):
        begun.append(launch.lanes)
        walk(counters, launch)

    monkeypatch.setattr(depth_first, "walk", counted)
    return begun


@pytest.fixture
def short(monkeypatch):
    """Launches of few lines, so that a tail has several."""
    monkeypatch.setattr(lanes, "CHUNK", 1 << 10)
    monkeypatch.setattr(lanes, "CORE_CHUNK", 1)


def grey(order):
    return rd.Method(order=order, numbers="sobol")


def handed_over(monkeypatch, tail: int) -> None:
    monkeypatch.setattr(breadth_first, "TAILS", {"cpu": tail, "cuda": tail})


@pytest.fixture
def wavefronts(monkeypatch, one_band):
    """The state of whole wavefronts alone."""
    with monkeypatch.context() as patched:
        handed_over(patched, NEVER)
        return whole(grey("breadth-first"))


@pytest.fixture
def one_band(monkeypatch):
    """States are of a grey scene: bands need whole wavefronts."""
    monkeypatch.setattr(states, "scene_of", lambda method: states.grey())


@pytest.mark.parametrize("order", ORDERS)
def test_integers_are_equal_wherever_the_tail_begins(order, wavefronts, walks, short, monkeypatch):
    for tail in (1, 40, 1500, 5000, ALWAYS):
        walks.clear()
        handed_over(monkeypatch, tail)
        assert same(whole(grey(order)), wavefronts)
        assert all(lanes <= 1024 for lanes in walks)
        assert bool(walks) == (tail > 1 or order == "depth-first")
        assert len(walks) > 2 * len(STAGES) or tail < ALWAYS  # launches end within tails


@pytest.mark.parametrize("each", [1, 3, 16])
def test_walks_of_a_lane_do_not_matter(each, wavefronts, walks, monkeypatch):
    handed_over(monkeypatch, ALWAYS)
    monkeypatch.setattr(refill, "LEAST", 1)
    monkeypatch.setattr(refill, "MOST", each)
    assert same(whole(grey("breadth-first")), wavefronts)
    assert max(walks) > 16


@pytest.mark.parametrize("order", ORDERS)
def test_a_run_that_ends_within_a_tail_goes_on_to_equal_integers(order, wavefronts, walks, short, monkeypatch):
    handed_over(monkeypatch, 5000)
    monkeypatch.setattr(states, "MOST", 1000)
    state, stops = interrupted(grey(order))
    assert same(state, wavefronts)
    assert stops > len(STAGES)
    assert walks


def test_the_same_counters_go_on_after_an_interruption_within_a_tail(wavefronts, walks, short, monkeypatch):
    """Patches that lines hit in launches before the interruption are not forgotten."""
    handed_over(monkeypatch, ALWAYS)
    algorithm, stopped = begun(grey("breadth-first")), []

    def stop_once(lines):
        if len(stopped) < 3:
            stopped.append(lines)
            raise Interrupted("test")

    for quanta in STAGES:
        for _ in range(4):
            try:
                algorithm.advance(quanta, stop_once)
                break
            except Interrupted:
                continue
    assert len(stopped) == 3
    assert same(algorithm.capture(), wavefronts)


def test_lines_are_told_as_they_are_traced(one_band, short, monkeypatch):
    handed_over(monkeypatch, 5000)
    algorithm, told = begun(grey("breadth-first")), []
    algorithm.advance(STAGES[-1], told.append)
    assert sum(told) == int(algorithm.capture().fired.sum())


def test_bands_keep_whole_wavefronts(walks, monkeypatch):
    handed_over(monkeypatch, ALWAYS)
    _, problem = coloured()
    assert problem.groups.n_groups > 1
    rd.solve(problem.patches, "random-walk", quanta=STAGES[-1], replicates=2)
    assert not walks


@pytest.mark.parametrize(("walks", "lanes"), [(1, 2), (2, 2), (1000, 1000), (100_000, 1031), (1_000_000, 7813)])
def test_lanes_for_walks(walks, lanes, monkeypatch):
    """All walks have a lane, and none more than `MOST`."""
    monkeypatch.setattr(refill, "LEAST", 1024 / refill.dr.thread_count())
    assert refill.lanes_for(choose("cpu").types, walks) == lanes
    assert walks <= lanes * refill.MOST


PARTICLES = (
    rd.Method(equation="continuous"),
    rd.Method(equation="continuous", estimator="absorption"),
    rd.Method(estimator="survival"),
)


@pytest.mark.parametrize("method", PARTICLES, ids=str)
@pytest.mark.parametrize("gray", [True, False])
def test_particles_are_followed_from_any_number_on(method, gray, monkeypatch):
    """Scores and counters are those of particles that are traced segment by segment."""
    if gray:
        monkeypatch.setattr(states, "scene_of", lambda method: states.grey())
    monkeypatch.setattr(shooting, "TAILS", {"cpu": 0})
    followed, found = [], whole(method)
    to_the_end = shooting.Walks._to_the_end

    def counted(self, particles, *arguments):
        followed.append(particles.size)
        return to_the_end(self, particles, *arguments)

    monkeypatch.setattr(shooting.Walks, "_to_the_end", counted)
    for tail, least in ((30, 1), (1 << 20, 1), (1 << 20, 1 << 20)):
        followed.clear()
        monkeypatch.setattr(shooting, "TAILS", {"cpu": tail})
        monkeypatch.setattr(refill, "LEAST", least)
        assert same(whole(method), found)
        assert 0 < max(followed) <= tail
    assert max(followed) > 500
