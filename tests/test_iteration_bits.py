"""Interrupted runs by iterations go on to the bits of one run, from one file to the next."""

import os
import signal

import numpy as np
import pytest
from iterations import VARIANTS, open_room
from some_cases import some

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


QUICK = ("incremental, both ends", "regular, everything")  # states of all of them are compared in test_axis_order.py


@some(QUICK, [name for name in VARIANTS if name not in QUICK])
def test_an_interrupted_run_goes_on_to_the_same_bits(patches, name, tmp_path):
    method, budget = rd.Method(**VARIANTS[name]), {"quanta": 1_200_000, "replicates": 2}
    assert same(stopped(patches, method, tmp_path, **budget), rd.solve(patches, method, **budget))


def test_going_on_needs_the_counters(patches):
    from dataclasses import replace

    done = rd.solve(patches, rd.Method(order="regular"), quanta=2**17, replicates=2)
    with pytest.raises(rd.MethodError, match="counters of its iterations"):
        rd.solve(patches, rd.Method(order="regular"), rays=4_000_000, replicates=2, resume=replace(done, state={}))
