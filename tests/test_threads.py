"""Threads of one process take turns with Dr.Jit (`device.turn`)."""

import os
import signal
import threading

import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.firing.counters import FiringCounters
from radiosity.device import backend as device
from radiosity.device import turn as turns
from radiosity.device.backend import choose
from radiosity.device.turn import aside, turn
from radiosity.diagnostics.leaks import follow
from radiosity.factors.missed import missed
from radiosity.image import render
from radiosity.run.run import Run
from radiosity.tracing import lanes
from radiosity.tracing.first_hits import first_hits
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.global_lines.spans import Spans
from radiosity.tracing.visibility import Polygons, visible_share

LONG = 60  # seconds: nothing waits so long, unless it waits for ever


@pytest.fixture(autouse=True)
def two_threads_of_drjit():
    """What is lost where Python threads do not take turns is lost with two or more."""
    import drjit as dr

    with device.threads(max(dr.thread_count(), 2)):
        yield


@pytest.fixture
def waiting(monkeypatch):
    """Set once a thread waits for its turn."""
    event = threading.Event()

    class Heard(threading.Condition):
        def wait(self, timeout=None):
            event.set()
            return super().wait(timeout)

    monkeypatch.setattr(turns, "_changed", Heard())
    return event


@pytest.fixture
def patches(cube):
    return rd.subdivide(cube, cells=2)


def quick(patches, **more):
    return rd.solve(patches, "random-walk", quanta=1024, replicates=2, **more)


def in_thread(function):
    """A thread that runs the function, and what it gave or raised."""
    found = {}

    def go():
        try:
            found["result"] = function()
        except BaseException as error:
            found["error"] = error

    thread = threading.Thread(target=go, daemon=True)
    thread.start()
    return thread, found


DOORS = {
    "solve": lambda p: quick(p),
    "refine_check": lambda p: rd.refine_check(p, "random-walk", quanta=64, replicates=2),
    "first_hits": lambda p: first_hits(p.scene, np.full((4, 3), 0.5), np.eye(3)[[0, 1, 2, 0]]),
    "render": lambda p: render(quick(p), width=4, height=4),
    "leaks": lambda p: follow(p.scene, np.zeros((2, p.scene.n_faces)), walks=64),
    "visible_share": lambda p: visible_share(Geometry(p, choose()), Polygons.of(p, [0, 1]), Polygons.of(p, [9, 10])),
    "missed": lambda p: missed(Geometry(p, choose()), 4),
    "spans": lambda p: Spans(Geometry(p, choose()), rd.Method(lines="spans", order="matrix"), 0, 1).draw(0, 0, 16),
}


@pytest.mark.parametrize("door", DOORS)
def test_whoever_traces_lines_waits_until_another_thread_is_done(waiting, patches, door):
    with turn():
        thread, found = in_thread(lambda: DOORS[door](patches))
        assert waiting.wait(LONG), found
        assert not found
    thread.join(LONG)
    assert "result" in found, found


def test_two_runs_are_never_under_way_at_once(monkeypatch, patches):
    """Each would meet the other at the barrier, which breaks since only one comes."""
    barrier, stages, inside, most = threading.Barrier(2), Run._stages, [], []

    def watched(self):
        inside.append(self)
        most.append(len(inside))
        try:
            barrier.wait(0.5)
        except threading.BrokenBarrierError:
            barrier.reset()
        try:
            return stages(self)
        finally:
            inside.remove(self)

    monkeypatch.setattr(Run, "_stages", watched)
    two = [in_thread(lambda: quick(patches)) for _ in range(2)]
    for thread, _ in two:
        thread.join(LONG)
    assert most == [1, 1]
    one, other = (found["result"] for _, found in two)
    assert np.array_equal(one.irradiance, other.irradiance)


def test_a_run_may_begin_another_while_it_tells_of_itself(patches):
    """In the same thread, and in another one that it waits for; both end in the bits of a run alone."""
    alone, told = quick(patches).irradiance, []

    def told_once(moment):
        if told:
            return
        told.append(quick(patches).irradiance)
        thread, found = in_thread(lambda: quick(patches).irradiance)
        thread.join(LONG)
        told.append(found.get("result"))

    outer = quick(patches, progress=told_once)
    assert len(told) == 2
    for values in (outer.irradiance, *told):
        assert np.array_equal(values, alone)


def test_aside_others_have_their_turns_and_then_it_is_taken_back(waiting):
    with turn(), turn():
        with aside():
            with aside():  # not ours to give
                pass
            thread, found = in_thread(turn()(lambda: 1))
            thread.join(LONG)
            assert found == {"result": 1}
            assert not waiting.is_set()
        thread, found = in_thread(turn()(lambda: 2))
        assert waiting.wait(LONG)
        assert not found
    thread.join(LONG)
    assert found == {"result": 2}
    assert turns._turns == []


def test_ctrl_c_is_heard_while_waiting(waiting, patches):
    held, done = threading.Event(), threading.Event()

    def hold():
        with turn():
            held.set()
            done.wait(LONG)

    def press():
        waiting.wait(LONG)
        os.kill(os.getpid(), signal.SIGINT)

    holder, _ = in_thread(hold)
    assert held.wait(LONG)
    in_thread(press)
    with pytest.raises(KeyboardInterrupt):
        quick(patches)
    done.set()
    holder.join(LONG)
    assert quick(patches).status == "complete"  # nothing is left behind
    assert turns._turns == []


def test_what_fails_gives_its_turn_back(patches):
    def fail(moment):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        quick(patches, progress=fail)
    assert turns._turns == []
    thread, found = in_thread(lambda: quick(patches))
    thread.join(LONG)
    assert found["result"].status == "complete"


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
def test_a_child_process_does_not_wait_for_threads_it_has_not():
    held, done = threading.Event(), threading.Event()

    def hold():
        with turn(), turns._changed:  # at the worst moment
            held.set()
            done.wait(LONG)

    holder, _ = in_thread(hold)
    assert held.wait(LONG)
    child = os.fork()
    if child == 0:
        signal.alarm(LONG)
        with turn():
            os._exit(7)
    _, status = os.waitpid(child, 0)
    done.set()
    holder.join(LONG)
    assert os.waitstatus_to_exitcode(status) == 7


@pytest.mark.parametrize("which", ["hits", "lines"])
def test_lost_hits_are_an_error(monkeypatch, patches, which):
    """As kernels of others in other threads lose them."""
    counters = FiringCounters.counters

    def one_less(self):
        arrivals, fired, missed = (np.array(x) for x in counters(self))
        (arrivals if which == "hits" else fired)[0, 3] -= 1
        return arrivals, fired, missed

    monkeypatch.setattr(FiringCounters, "counters", one_less)
    with pytest.raises(rd.DeviceError, match="hits were lost while another thread"):
        quick(patches)


@pytest.mark.slow
def test_runs_at_once_give_the_bits_of_runs_alone():
    """540 runs lost hits in 8 of them before threads took turns: 240 would lose none with probability 3 %."""
    scenes = {"room": 6, "labyrinth-0.5": 4}
    patches = [rd.subdivide(rd.load_scene(name), cells=cells) for name, cells in scenes.items()]
    options = {"rays": 400_000, "seed": 3}
    alone = [rd.solve(p, **options).irradiance for p in patches]

    def runs(k):
        return sum(not np.array_equal(rd.solve(patches[k], **options).irradiance, alone[k]) for _ in range(120))

    threads = [in_thread(lambda k=k: runs(k)) for k in (0, 1)]
    for thread, _ in threads:
        thread.join()
    assert [found for _, found in threads] == [{"result": 0}, {"result": 0}]


def test_walks_that_stop_within_a_stage_go_on_with_another_number_of_threads(monkeypatch, tmp_path):
    """A state counts its launches in chunks, and not in launches, whose size depends on the threads."""
    monkeypatch.setattr(lanes, "CHUNK", 1 << 10)
    monkeypatch.setattr(lanes, "CORE_CHUNK", 1 << 8)
    patches, options = rd.subdivide(rd.load_scene("room"), cells=1), {"quanta": 20_000, "replicates": 2, "seed": 3}

    def stop(moment):
        if moment.rays > 0:
            signal.raise_signal(signal.SIGINT)

    whole = rd.solve(patches, "particle-tracing", **options)
    with device.threads(16), pytest.raises(KeyboardInterrupt):  # no stage is complete
        rd.solve(patches, "particle-tracing", **options, progress=stop, checkpoint=tmp_path / "run.npz")
    stopped = rd.load_solution(tmp_path / "run.npz")
    assert stopped.status == "interrupted"
    assert stopped.state["launches"] == 4
    found = rd.solve(patches, "particle-tracing", **options, resume=stopped)
    assert all(np.array_equal(found.state[name], whole.state[name]) for name in whole.state)
