"""One replicate on two workers of Dask has the bits of a run on one machine: in cut wavefronts and steps, or without barriers."""

from itertools import pairwise

import numpy as np
import pytest
from some_cases import some
from test_merge import FIRST, INCREMENTAL, PARTS, TOGETHER, assert_same

import radiosity as rd
from radiosity.algorithms.firing.orders import breadth_first
from radiosity.run import budget
from radiosity.tracing import lanes

distributed = pytest.importorskip("distributed", reason="distributed is not installed")
from radiosity.cluster import barrier, post, room, steps, wavefronts  # noqa: E402

pytestmark = [
    pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning"),  # of few lines
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


@pytest.fixture(scope="module")
def coloured():
    return rd.subdivide(rd.load_scene("cornell-box"), cells=1)


@pytest.fixture(autouse=True)
def short(monkeypatch):
    """Several stages at few lines."""
    monkeypatch.setattr(budget, "FIRST_STAGE", FIRST)


def solved(patches, method, **options) -> rd.Solution:
    return rd.solve(patches, method, **{"quanta": 20_000, "replicates": 1, "seed": 3} | options)


CUT = {
    "grey": ("room", {}, {}),
    "depth-first": ("room", {"order": "depth-first"}, {}),
    "colours": ("cornell-box", {}, {}),
    "colours in parts": ("cornell-box", {}, {}),
    "random numbers": ("room", {"numbers": "random"}, {}),
}


def cut_small(monkeypatch, rows: int) -> None:
    """Cut wavefronts of few lines; ``rows`` of a worker at least, where there are to be no barriers."""
    for name, value in {"FEWEST": 64, "LEAST": 16, "ROWS": rows}.items():
        monkeypatch.setattr(wavefronts, name, value)
    monkeypatch.setattr(breadth_first, "TAILS", {"cpu": 64})


@some(["grey", "colours", "colours in parts"], ["depth-first", "random numbers"])
def test_one_replicate_on_two_workers(client, name, monkeypatch):
    scene, choices, options = CUT[name]
    cut_small(monkeypatch, rows=10_000)  # each wavefront ends with a barrier
    if name == "colours in parts":
        monkeypatch.setitem(wavefronts.EACH, "cpu", 256)
    patches, units = rd.subdivide(rd.load_scene(scene), cells=2), []
    submit = barrier.Barrier._submit
    monkeypatch.setattr(barrier.Barrier, "_submit", lambda *of: (units.append(of[1]), submit(*of)))
    given = options | choices
    found = solved(patches, "random-walk", cluster=client, **given)
    assert len(units) > 10
    firsts = [one for unit in units for one in unit]
    assert any(np.isin(one.rows, other.rows).any() for one, other in pairwise(firsts))  # lines of one row went to both
    assert_same(found, solved(patches, "random-walk", **given))


@pytest.mark.parametrize("heard", [True, False])
def test_two_workers_without_barriers(client, heard, monkeypatch):
    """Each fires rows of its own and sends hits to the other; what it is never told of is fired afterwards."""
    cut_small(monkeypatch, rows=1)
    tasks, came = [], []
    submit, take = barrier.Barrier._submit, post.WorkerPost.take
    monkeypatch.setattr(barrier.Barrier, "_submit", lambda *of: (tasks.append(of[1]), submit(*of)))
    monkeypatch.setattr(post.WorkerPost, "take", lambda this: came.append(take(this)) or (came[-1] if heard else 0))
    patches = rd.subdivide(rd.load_scene("room"), cells=2)
    found = solved(patches, "random-walk", cluster=client)
    own = [one[0] for one in tasks if isinstance(one, tuple)]
    assert {one.own for one in own} == {0, 1}
    assert sum(map(np.sum, came)) > 1000
    assert_same(found, solved(patches, "random-walk"))


def test_a_worker_that_is_lost_without_barriers_costs_their_lines(client, monkeypatch):
    """Then the others' lines do not count either: some follow from hits that nobody has."""
    cut_small(monkeypatch, rows=1)
    outcome, lost = barrier.Barrier._outcome, []

    def lose(this, future):
        found = outcome(this, future)
        fails = found is not None and found.what[0].fired is not None and not lost
        return lost.append(found) if fails else found

    monkeypatch.setattr(barrier.Barrier, "_outcome", lose)
    patches = rd.subdivide(rd.load_scene("room"), cells=2)
    found = solved(patches, "random-walk", cluster=client)
    assert len(lost) == 1
    assert_same(found, solved(patches, "random-walk"))


def waiting(key: str, addresses: list[str]) -> bool:
    """Wait for hits that never come, on the first of some workers."""
    return post.WorkerPost(distributed.get_worker(), key, 0, addresses).wait(60.0)


def test_a_worker_that_waits_for_others_comes_back_when_it_is_told(client):
    client.run(lambda dask_worker: post.open_for(dask_worker))
    addresses = list(client.nthreads())
    future = client.submit(waiting, "nobody sends", addresses, workers=addresses[:1], pure=False)
    client.run(post.end, "nobody sends", workers=addresses[:1], wait=False)
    assert future.result(timeout=30) is False


STEPS = ["regular", "regular in parts", "incremental", "continuous", "gather"]
MORE_STEPS = ["two ends", "control variate", "warm-up", "gathering", "fractional", "sorted", "density", "incremental, two ends"]
OTHERS = {"gather": rd.PRESETS["gather"].method, "sorted": rd.Method(equation="continuous", order="sorted")}


@some(STEPS, MORE_STEPS)
def test_steps_of_one_replicate_on_two_workers(client, coloured, name, monkeypatch):
    method = (PARTS | TOGETHER | INCREMENTAL | OTHERS)[name.removesuffix(" in parts")]
    if name != name.removesuffix(" in parts"):
        monkeypatch.setitem(wavefronts.EACH, "cpu", 256)
    monkeypatch.setattr(steps, "FEWEST", 64)
    monkeypatch.setattr(lanes, "CHUNK", 512)
    units, submit = [], barrier.Barrier._submit
    monkeypatch.setattr(barrier.Barrier, "_submit", lambda *of: (units.append(of[1]), submit(*of)))
    found = solved(coloured, method, cluster=client)
    assert len(units) >= 8
    assert_same(found, solved(coloured, method))


@pytest.mark.parametrize("replicates", [5, 1])
def test_a_worker_with_too_little_memory_is_told_before_it_begins(client, replicates, monkeypatch):
    monkeypatch.setattr(room, "left", lambda there: 2**20)
    monkeypatch.setattr(wavefronts, "FEWEST", 64)
    monkeypatch.setattr(breadth_first, "TAILS", {"cpu": 64})
    message = r"worker inproc://\S+ has too little memory: .* in \d replicates would take .* 1 MiB there"
    with pytest.raises(rd.MethodError, match=message):
        solved(rd.subdivide(rd.load_scene("room"), cells=1), "random-walk", cluster=client, replicates=replicates, quanta=2000)
