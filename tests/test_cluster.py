"""Runs on a cluster of Dask have the bits of runs on one machine, however many workers there are and whatever becomes of them."""

import numpy as np
import pytest
from iterations import open_room
from test_merge import FIRST, INCREMENTAL, PARTS, TOGETHER, assert_same

import radiosity as rd
from radiosity.algorithms.matrix.state import MatrixState
from radiosity.algorithms.merging import merge as merge_states
from radiosity.algorithms.splitting import divisible, split
from radiosity.run import budget
from radiosity.run.solve import prepared

distributed = pytest.importorskip("distributed", reason="distributed is not installed")
from radiosity.cluster import crew  # noqa: E402

QUANTA = 3 << 12  # stages at 4096 (of 5 replicates), 8192 and 12288
METHODS = ["firing", "depth-first", "fractional", "gathering", "regular", "two ends", "first shot", "local matrix"]
pytestmark = [
    pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning"),  # of few lines
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


@pytest.fixture(scope="module")
def client():
    """Two workers that are threads of this process."""
    options = {"n_workers": 2, "threads_per_worker": 1, "processes": False, "dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
        yield client


@pytest.fixture(scope="module")
def grey():
    return rd.subdivide(open_room(two_sided=True), cells=1)


@pytest.fixture(scope="module")
def coloured():
    return rd.subdivide(rd.load_scene("cornell-box"), cells=1)


@pytest.fixture(autouse=True)
def short(monkeypatch):
    """Several stages at few lines, and units of a wavefront each."""
    monkeypatch.setattr(budget, "FIRST_STAGE", FIRST)
    monkeypatch.setattr(crew, "SECONDS", 0.0)
    monkeypatch.setattr(crew, "MOST_SECONDS", 0.0)


def solved(patches, method, **options) -> rd.Solution:
    return rd.solve(patches, method, **{"quanta": QUANTA, "replicates": 5, "seed": 3} | options)


@pytest.mark.parametrize("name", METHODS)
def test_parts_on_workers_are_one_run(client, grey, name):
    assert_same(solved(grey, PARTS[name], cluster=client), solved(grey, PARTS[name]))


@pytest.mark.parametrize("name", ["firing", "continuous", "gathering", "control variate"])
def test_parts_on_workers_are_one_run_in_colour(client, coloured, name):
    assert_same(solved(coloured, PARTS[name], cluster=client), solved(coloured, PARTS[name]))


@pytest.mark.parametrize("name", ["pooled", "warm-up", "coherent", "incremental", "progressive"])
def test_methods_whose_replicates_advance_together_run_on_one_worker(client, grey, name):
    method = (TOGETHER | INCREMENTAL)[name]
    options = {"replicates": 1} if isinstance(method, rd.Baseline) else {}
    assert_same(solved(grey, method, cluster=client, **options), solved(grey, method, **options))


def test_a_split_state_merged_is_the_state(grey):
    for name in ("firing", "fractional", "regular", "two ends", "first shot"):
        run = prepared(grey, PARTS[name], quanta=QUANTA, replicates=5)
        run.solve()
        state = run.algorithm.capture()
        assert divisible(type(state))
        one, other = state.arrays(), merge_states(split(state, [2, 1, 2])).arrays()
        assert all(np.array_equal(one[key], other[key]) for key in one | other), name
    assert not divisible(MatrixState)  # of pairs of all replicates
