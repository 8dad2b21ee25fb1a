"""Runs on a cluster of Dask have the bits of runs on one machine, however many workers there are and whatever becomes of them."""

import signal
from types import SimpleNamespace

import numpy as np
import pytest
from iterations import open_room
from some_cases import some
from test_merge import FIRST, INCREMENTAL, PARTS, TOGETHER, assert_same

import radiosity as rd
from radiosity.algorithms.in_parts import InParts, Share
from radiosity.algorithms.matrix.state import MatrixState
from radiosity.algorithms.merging import merge as merge_states
from radiosity.algorithms.splitting import divisible, split
from radiosity.image import render
from radiosity.run import budget
from radiosity.run.solve import prepared
from radiosity.sensors import pixels

distributed = pytest.importorskip("distributed", reason="distributed is not installed")
dask = pytest.importorskip("dask", reason="dask is not installed")
from radiosity.cluster import connect, crew, plugin, sensing, worker  # noqa: E402
from radiosity.cluster.job import Job  # noqa: E402
from radiosity.cluster.plugin import JobPlugin, bring  # noqa: E402

QUANTA = 3 << 12  # stages at 4096 (of 5 replicates), 8192 and 12288
GREY = ["firing", "gathering", "regular", "local matrix"]
MORE_GREY = ["depth-first", "random numbers", "continuous", "fractional", "density", "control variate", "two ends", "first shot"]
COLOURED = ["firing", "fractional"]
MORE_COLOURED = ["continuous", "gathering", "regular", "control variate", "first shot", "global matrix"]
pytestmark = [
    pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning"),  # of few lines
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


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


@some(GREY, MORE_GREY)
def test_parts_on_workers_are_one_run(client, grey, name):
    assert_same(solved(grey, PARTS[name], cluster=client), solved(grey, PARTS[name]))


@some(COLOURED, MORE_COLOURED)
def test_parts_on_workers_are_one_run_in_colour(client, coloured, name):
    assert_same(solved(coloured, PARTS[name], cluster=client), solved(coloured, PARTS[name]))


@some(["incremental"], ["pooled", "warm-up", "coherent", "progressive", "gather"])
def test_methods_whose_replicates_advance_together_run_on_one_worker(client, grey, name):
    method = (TOGETHER | INCREMENTAL | {"gather": rd.PRESETS["gather"].method})[name]
    options = {"replicates": 1} if isinstance(method, rd.Baseline) else {}
    assert_same(solved(grey, method, cluster=client, **options), solved(grey, method, **options))


def test_an_error_target_is_reached_as_on_one_machine(client, grey):
    options = {"quanta": None, "error": 0.05, "replicates": 4}
    assert_same(solved(grey, "random-walk", cluster=client, **options), solved(grey, "random-walk", **options))


def test_a_split_state_merged_is_the_state(grey):
    for name in ("firing", "fractional", "regular", "two ends", "first shot"):
        run = prepared(grey, PARTS[name], quanta=QUANTA, replicates=5)
        run.solve()
        state = run.algorithm.capture()
        assert divisible(type(state))
        one, other = state.arrays(), merge_states(split(state, [2, 1, 2])).arrays()
        assert all(np.array_equal(one[key], other[key]) for key in one | other), name
    assert not divisible(MatrixState)  # of pairs of all replicates


def test_lines_and_view_factors_are_those_of_one_machine(client, grey):
    options = {"rays": 30_000, "replicates": 3, "seed": 4}
    alone, lines = (rd.trace_lines(grey, **options, **more) for more in ({}, {"cluster": client}))
    assert lines.provenance == alone.provenance
    assert lines.rays == alone.rays
    options |= {"method": "lines", "error": None}
    one, other = (rd.view_factors(grey, **options, **more) for more in ({}, {"cluster": client}))
    assert np.array_equal(one.matrix, other.matrix)


@pytest.mark.parametrize("scene", ["room"])
def test_sensors_are_those_of_one_machine(client, scene, monkeypatch):
    monkeypatch.setattr(sensing, "FEWEST", 64)
    room, seen = rd.load_scene(scene), []
    monkeypatch.setattr(sensing, "on_host", lambda sums, kept=sensing.on_host: seen.append(1) or kept(sums))
    plane = rd.Sensors.grid(room, "floor", height=1.0, spacing=1.5) + rd.Sensors.of([[1, 1, 1]], kind="cylindrical")
    patches, options = rd.subdivide(room, cells=2), {"rays": 60_000, "replicates": 3, "seed": 2}
    alone, found = (rd.measure(patches, plane, **options, **more) for more in ({}, {"cluster": client}))
    assert len(seen) > 1
    assert np.array_equal(found.values, alone.values)
    assert found.rays == alone.rays


def test_a_final_gather_is_that_of_one_machine(client, monkeypatch):
    monkeypatch.setattr(sensing, "FEWEST", 64)
    box = rd.solve(rd.subdivide(rd.load_scene("cornell-box"), cells=1), "random-walk", quanta=2000, replicates=2)
    monkeypatch.setattr(pixels, "PIECE", 64)
    setup, brought = JobPlugin.setup, []
    monkeypatch.setattr(JobPlugin, "setup", lambda this, worker: brought.append(type(this.job).__name__) or setup(this, worker))
    given = {"width": 12, "samples": 1, "final_gather": 8}
    alone, found = (render(box, **given, **more) for more in ({}, {"cluster": client}))
    assert alone.any()
    assert np.array_equal(found, alone)
    assert brought.count("SceneJob") == 2  # one for each worker
    assert brought.count("SensorJob") >= 4  # one for each worker and piece


def test_heat_is_that_of_one_machine(client):
    room, given = rd.subdivide(open_room(two_sided=True), cells=1), {"emissivity": 0.7, "surroundings": 280.0, "replicates": 3}
    alone, found = (rd.radiative_exchange(room, {"*": 300}, rays=20_000, **given, **more) for more in ({}, {"cluster": client}))
    assert np.array_equal(found.net, alone.net)
    lines = rd.trace_lines(room, rays=2_000, replicates=2)
    with pytest.raises(rd.MethodError, match="leave rays, error and cluster out"):
        rd.radiative_exchange(lines, {"*": 300}, emissivity=0.7, surroundings=280.0, cluster=client)


# ---- interruptions, and workers that come and go ------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["firing", "regular"])
def test_a_run_that_is_stopped_within_a_stage_goes_on_with_and_without_a_cluster(client, coloured, name, tmp_path):
    whole, sweeps = solved(coloured, PARTS[name]), []

    def stop(moment):
        sweeps.append(moment)
        if moment.stage == 1 and moment.rays > 0 and len([one for one in sweeps if one.stage == 1]) == 4:
            signal.raise_signal(signal.SIGINT)

    stopped = solved(coloured, PARTS[name], cluster=client, progress=stop, checkpoint=tmp_path / "run.npz")
    assert stopped.status == "interrupted"
    assert stopped.quanta < QUANTA
    assert "parts" in stopped.state  # each part is elsewhere in the stage
    with pytest.raises(rd.MethodError, match="within a stage"):
        rd.merge([stopped])
    before = rd.load_solution(tmp_path / "run.npz")
    assert_same(solved(coloured, PARTS[name], resume=before), whole)
    assert_same(solved(coloured, PARTS[name], resume=before, cluster=client), whole)


def test_workers_that_leave_and_come(coloured):
    options = {"n_workers": 2, "threads_per_worker": 1, "processes": False, "dashboard_address": "127.0.0.1:0"}
    seen = set()
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:

        def change(moment):
            there = client.nthreads()
            seen.update(there)
            if moment.rays > 0 and len(seen) == 2:
                cluster.scale(1 if len(there) == 2 else 2)

        found = solved(coloured, PARTS["firing"], cluster=client, progress=change)
    assert len(seen) == 3
    assert_same(found, solved(coloured, PARTS["firing"]))


def test_a_worker_with_other_packages_is_refused(client, grey, monkeypatch):
    monkeypatch.setattr(worker, "facts", lambda: crew.facts() | {"mitsuba": "3.0.0"})
    with pytest.raises(rd.DeviceError, match=r"worker .* would give other bits: mitsuba 3.0.0 there, .* here"):
        solved(grey, PARTS["firing"], cluster=client)


def test_errors_of_workers_are_those_of_one_machine(client, monkeypatch):
    def broken(self, first, count):
        raise rd.MethodError("too much of it")

    monkeypatch.setattr(Job, "algorithm", broken)
    with pytest.raises(rd.MethodError, match="too much of it"):
        solved(rd.subdivide(rd.load_scene("room"), cells=1), "random-walk", cluster=client)


# ---- what is no cluster -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("cluster", "error", "message"),
    [
        ("local:0", rd.MethodError, "a number N of processes"),
        ("local:many", rd.MethodError, "a number N of processes"),
        ("localhost:8786", rd.MethodError, "give the address of a scheduler"),
        (7, rd.MethodError, "cluster is 7"),
        ("tcp://127.0.0.1:1", rd.DeviceError, r"tcp://127\.0\.0\.1:1': no scheduler answers \((.*refused|nothing within .*)\)"),
        ("tls://127.0.0.1:1", rd.DeviceError, "certificates"),
    ],
)
def test_what_is_no_cluster(grey, cluster, error, message, monkeypatch):
    """It leaves Dask as it was: else what other programs of the process compute with it would fail, such as xarray's files."""
    monkeypatch.setattr(connect, "TIMEOUT", 0.2)
    with dask.config.set(scheduler=None):
        with pytest.raises(error, match=message):
            solved(grey, "random-walk", cluster=cluster)
        assert dask.config.get("scheduler") is None


def test_without_the_extra(grey, monkeypatch):
    monkeypatch.setattr(connect, "find_spec", lambda name: None)
    with pytest.raises(rd.DeviceError, match=r"needs 'distributed'.*radiosity\[cluster\]"):
        solved(grey, "random-walk", cluster="local:2")


def test_a_result_whose_worker_died_before_it_came_is_not_waited_for():
    """Dask calls such a task finished, then lost, and would wait for a worker that never comes back."""
    from radiosity.cluster import crew

    class Lost:
        status = "finished"

        def result(self, timeout):
            self.status = "lost"
            raise TimeoutError

    class Slow:
        status, waited = "finished", 0.0

        def result(self, timeout):
            self.waited += timeout
            if self.waited < 10:
                raise TimeoutError
            return "brought"

    assert crew.fetched(Lost()) is None
    assert crew.fetched(Slow()) == "brought"


def test_a_worker_that_dies_while_the_job_is_brought_is_no_error_of_dask(monkeypatch):
    """Dask gives up for all workers where one goes: they are asked once more. What fails for good is told."""
    monkeypatch.setattr(plugin, "PAUSE", 0)
    gone = distributed.comm.CommClosedError("in <TCP (closed)>: Stream is closed")

    def client(*answers, status="running"):
        left, there = list(answers), []

        def register_plugin(what):
            if (error := left.pop(0)) is not None:
                raise error
            there.append(what.name)

        return SimpleNamespace(status=status, register_plugin=register_plugin, there=there)

    job = SimpleNamespace(key="1")
    dying = client(gone, gone, None)
    bring(dying, job)
    assert dying.there == ["radiosity-1"]
    with pytest.raises(rd.DeviceError, match=r"cannot be reached .*Stream is closed"):
        bring(client(*[gone] * 9), job)
    bring(client(gone, status="closed"), job)  # a lost scheduler, which is told where workers are looked for
    with pytest.raises(ValueError, match="of its own"):
        bring(client(ValueError("of its own")), job)


def test_units_last_by_the_quickest_sending_and_tell_their_age(grey, monkeypatch):
    """A busy machine holds some states up: that makes no unit longer. A checkpoint is told how old the oldest state is."""
    monkeypatch.setattr(crew, "SECONDS", 4.0)
    monkeypatch.setattr(crew, "MOST_SECONDS", 60.0)
    monkeypatch.setattr(crew.DaskCrew, "check", lambda *_: None)
    now = [100.0]
    monkeypatch.setattr(crew.time, "monotonic", lambda: now[0])
    whole = prepared(grey, rd.Method(), quanta=1, replicates=1)._spread_out()
    shares, state = [Share(0, 1, None)], whole.capture().arrays()
    team = crew.DaskCrew(None, None, "")
    run = InParts(whole, team)
    assert team.behind() == run.behind() == 0
    lasts = []
    for spent in (0.01, 9.0, 0.5, 7.0, 3.0, 8.0, 2.5):
        lasts.append(team._seconds("tcp://a"))
        one = crew.Active(shares[0], "tcp://a", now[0])
        team._active = {"a": one, "b": crew.Active(shares[0], "tcp://b", now[0] + 2)}
        now[0] += 5.0 + spent
        assert team.behind() == run.behind() == pytest.approx(5.0 + spent)
        team._take(one, worker.Outcome(state, "token", 5, False, 5.0, "", (), "tcp://a", {}), run, shares)
    assert lasts == pytest.approx([4, 4, 4, 4, 4, 15, 15])
    assert team._seconds("tcp://a") == 60
    assert team._seconds("tcp://b") == 4


def test_workers_that_die_in_a_row_end_a_run_and_others_do_not(monkeypatch):
    """A run of days may lose many workers, as long as parts come back in between."""
    brought = SimpleNamespace(lines=5)
    monkeypatch.setattr(crew.DaskCrew, "_outcome", lambda self, future, one: future.brings)
    monkeypatch.setattr(crew.DaskCrew, "_take", lambda *_: None)
    run, one = crew.DaskCrew(None, None, ""), crew.Active(Share(0, 1, None), "tcp://gone", 0.0)

    class Ended:
        status, brings, cancel = "finished", None, staticmethod(lambda: None)

    def ends(brings) -> int:
        future = Ended()
        future.brings = brings
        return run._take_back(None, [one.share], {future: one})

    for _ in range(3):
        assert [ends(None) for _ in range(crew.DEATHS - 1)] == [0] * (crew.DEATHS - 1)
        assert ends(brought) == 5
    for _ in range(crew.DEATHS - 1):
        ends(None)
    with pytest.raises(rd.DeviceError, match=r"8 workers in a row died .* tcp://gone"):
        ends(None)
