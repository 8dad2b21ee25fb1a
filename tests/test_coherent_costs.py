"""The table of costs of coherent firing: which machine fires packets of like lines, and what may go on on another one."""

import warnings
from types import SimpleNamespace

import numpy as np
import pytest

import radiosity as rd
from radiosity.cluster.crew import DaskCrew
from radiosity.cluster.job import facts
from radiosity.device.instructions import instructions, widest
from radiosity.tracing import coherent_costs

ASKED, GATHER = rd.Method(coherent=True), rd.Method(order="gather", coherent=True)


@pytest.fixture
def machine(monkeypatch):
    """Makes the table believe that the processor has other instructions."""
    return lambda name: monkeypatch.setattr(coherent_costs, "instructions", lambda: name)


@pytest.fixture(scope="module")
def room():
    return rd.subdivide(rd.load_scene("room"), cells=1)


@pytest.mark.parametrize(
    ("features", "name"),
    [
        ("+avx,+avx2,+avx512f,+avx512vl", "avx512"),
        ("+avx,+avx2,+avx512f,-avx512vl", "avx2"),  # 16 lanes need both
        ("-avx512vl,-avx2,+avx", "avx"),
        ("+neon,+fp-armv8", "neon"),
        ("", "unknown"),
    ],
)
def test_the_widest_instructions_are_found_in_what_llvm_says(features, name):
    assert widest(features) == name


def test_the_instructions_of_this_machine_are_known():
    assert instructions() in ("avx512", "avx2", "avx", "neon")


@pytest.mark.parametrize(
    ("name", "firing", "gather"), [("avx2", None, None), ("avx512", 2304, None), ("neon", None, None), ("unknown", None, None)]
)
def test_the_table_says_who_fires_packets(machine, name, firing, gather):
    machine(name)
    assert coherent_costs.fewest_lines(ASKED, "cpu") == firing
    assert coherent_costs.fewest_lines(GATHER, "cpu") == gather
    assert coherent_costs.fewest_lines(rd.Method(coherent="always"), "cpu") == 0
    assert coherent_costs.fewest_lines(rd.Method(), "cpu") is None
    assert coherent_costs.fewest_lines(rd.Baseline("progressive"), "cpu") is None
    assert coherent_costs.fewest_lines(ASKED, "cuda") is None  # nobody has measured there


def test_where_packets_lose_a_run_says_so_and_fires_as_without_them(machine, room):
    machine("avx2")
    plain = rd.solve(room, rd.Method(), quanta=1 << 12, replicates=2)
    with pytest.warns(rd.RadiosityWarning, match="no packets are fired, since with AVX2 nobody has measured") as told:
        asked = rd.solve(room, quanta=1 << 12, replicates=2, coherent=True)
    assert len(told) == 1
    assert np.array_equal(asked.radiosity, plain.radiosity)
    assert asked.provenance["packets"] == "none"
    assert "packets" not in plain.provenance
    machine("neon")
    with pytest.warns(rd.RadiosityWarning, match="with NEON nobody has measured"):
        rd.solve(room, quanta=1 << 12, replicates=2, coherent=True)


def test_a_run_goes_on_under_the_rule_that_it_began_with(machine, room):
    machine("avx512")
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nothing to tell where packets pay
        begun = rd.solve(room, quanta=1 << 12, replicates=2, coherent=True)
    assert begun.provenance["packets"] == "from 2304 lines a patch"
    machine("avx2")
    with pytest.raises(rd.MethodError, match=r"packets \(from 2304 lines a patch then, none now\)"):
        rd.solve(room, quanta=1 << 13, replicates=2, coherent=True, resume=begun)
    always = rd.solve(room, quanta=1 << 12, replicates=2, coherent="always")
    machine("avx512")
    rd.solve(room, quanta=1 << 13, replicates=2, coherent="always", resume=always)


@pytest.mark.parametrize(("coherent", "refused"), [(True, True), ("always", False), (False, False)])
def test_a_worker_of_another_processor_is_refused_where_the_table_would_differ(coherent, refused):
    crew = SimpleNamespace(job=SimpleNamespace(method=rd.Method(coherent=coherent)))
    there = facts() | {"instructions": "other"}
    if not refused:
        DaskCrew.check(crew, there, "tcp://a:1")
        return
    with pytest.raises(rd.DeviceError, match=r"tcp://a:1 would give other bits: instructions other there"):
        DaskCrew.check(crew, there, "tcp://a:1")
    DaskCrew.check(crew, facts(), "tcp://a:1")
