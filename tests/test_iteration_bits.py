"""Sums of iterations do not depend on threads, and interrupted runs go on to the bits of one run."""

import os
import signal

import numpy as np
import pytest
from iterations import VARIANTS, open_room

import radiosity as rd


@pytest.fixture(scope="module")
def patches():
    return rd.subdivide(open_room(), cells=3)


def same(one: rd.Solution, other: rd.Solution) -> bool:
    return (
        np.array_equal(one.irradiance, other.irradiance)
        and set(one.state) == set(other.state)
        and all(np.array_equal(one.state[key], other.state[key]) for key in one.state)
    )


def stopped(patches, method, folder, **budget) -> rd.Solution:
    """Stopped again and again in the second stage and later, saved, loaded and resumed."""
    part, stops = None, 0
    while True:
        calls = []

        def listen(progress, calls=calls, first=part is None):
            calls.append(progress)
            if len(calls) >= 3 and (progress.stage >= 1 or not first):
                os.kill(os.getpid(), signal.SIGINT)

        part = rd.solve(patches, method, **budget, progress=listen if stops < 3 else None, resume=part)
        part.save(folder / "part.npz")
        part = rd.load_solution(folder / "part.npz")
        if part.status == "complete":
            assert stops == 3
            return part
        stops += 1


@pytest.mark.parametrize("name", VARIANTS)
def test_threads_do_not_matter(patches, name):
    import drjit as dr

    before, results = dr.thread_count(), []
    try:
        for threads in (1, 2):
            dr.set_thread_count(threads)
            results.append(rd.solve(patches, rd.Method(**VARIANTS[name]), quanta=20_000, replicates=3))
    finally:
        dr.set_thread_count(before)
    assert same(*results)


@pytest.mark.parametrize("name", VARIANTS)
def test_an_interrupted_run_goes_on_to_the_same_bits(patches, name, tmp_path):
    method, budget = rd.Method(**VARIANTS[name]), {"quanta": 1_200_000, "replicates": 2}
    assert same(stopped(patches, method, tmp_path, **budget), rd.solve(patches, method, **budget))


def test_a_warm_up_may_be_interrupted(patches):
    """The first stage of a run gives nothing back when it is interrupted; its state can be restored all the same."""
    from radiosity.engine.device import choose
    from radiosity.engine.geometry import Geometry
    from radiosity.engine.problem import Problem
    from radiosity.engine.process import make
    from radiosity.engine.progress import Interrupted

    geometry, problem = Geometry(patches, choose("cpu")), Problem.of(patches)
    arguments = geometry, problem, rd.Method(**VARIANTS["regular, everything"]), 4, 2

    def stop(after):
        calls = []

        def swept(lines):
            calls.append(lines)
            if len(calls) == after:
                raise Interrupted("test")

        return swept

    whole = make(*arguments)
    whole.advance(30_000, lambda lines: None)
    for after in (1, 2, 4, 12):
        begun, state = make(*arguments), {}
        with pytest.raises(Interrupted):
            begun.advance(30_000, stop(after))
        state = begun.capture()
        assert begun.unfinished(state)
        other = make(*arguments)
        other.restore(state)
        other.advance(other.quanta, lambda lines: None)
        expected, found = whole.capture(), other.capture()
        assert set(expected) == set(found)
        assert all(np.array_equal(expected[key], found[key]) for key in expected)


def test_replicates_do_not_depend_on_their_number(patches):
    for name in ("incremental", "regular, control variate"):
        three, one = (rd.solve(patches, rd.Method(**VARIANTS[name]), quanta=5_000, replicates=r).state for r in (3, 1))
        assert np.array_equal(three["fired"][0], one["fired"][0])
        assert np.array_equal(three["arrivals"][0], one["arrivals"][0])
        assert not np.array_equal(three["arrivals"][0], three["arrivals"][1])


def test_going_on_needs_the_counters(patches):
    from dataclasses import replace

    done = rd.solve(patches, rd.Method(order="regular"), quanta=2**17, replicates=2)
    with pytest.raises(rd.MethodError, match="counters of its iterations"):
        rd.solve(patches, rd.Method(order="regular"), rays=4_000_000, replicates=2, resume=replace(done, state={}))
