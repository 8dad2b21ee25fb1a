"""SIGKILL at random moments loses nothing: the run goes on from its checkpoint to the bits of one that was never killed."""

import signal

import pytest
from kills import Case, assert_same, killed

import radiosity as rd

pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")
CASES = [
    Case(scene, method, quanta)
    for scene in ("room", "cornell-box")  # grey and RGB
    for method, quanta in (
        ("random-walk", 3 << 20),
        ("stochastic-jacobi", 3 << 20),
        ("stochastic-jacobi-incremental", 3 << 20),
        ("global-multipath", 1 << 20),
    )
]
LIVES = 10  # of a run, or more: no life is told to have more sweeps than a tenth of all


def sweeps_of(case: Case) -> tuple[rd.Solution, int]:
    told = []
    whole = case.solve(progress=lambda state: told.append(state.message))
    return whole, told.count("tracing")


def test_three_kills(tmp_path):
    case = Case("cornell-box", "random-walk", 1 << 20)
    whole, sweeps = sweeps_of(case)
    found, kills = killed(case, tmp_path, max(2, sweeps // 4), 1, 3)
    assert kills == 3
    assert_same(found, whole)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.checkpoint.npz", "run.npz"]


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.scene}-{case.method}")
def test_many_kills(case, tmp_path):
    """At least 7 for each of the 8 cases, 56 in all: a life has a few sweeps more until the kill reaches it."""
    whole, sweeps = sweeps_of(case)
    found, kills = killed(case, tmp_path, max(2, sweeps // LIVES), 2, 1000)
    assert kills >= 7
    assert_same(found, whole)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.checkpoint.npz", "run.npz"]
