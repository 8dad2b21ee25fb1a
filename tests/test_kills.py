"""SIGKILL at random moments loses nothing: the run goes on from its checkpoint to the bits of one that was never killed."""

import signal
import subprocess
import sys

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
    case = Case("cornell-box", "random-walk", 1 << 19)
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


DYING = """
import io, os, signal, sys
from pathlib import Path
import radiosity as rd
from radiosity.solution import whole
moment, path = sys.argv[1], Path(sys.argv[2])
solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), "random-walk", quanta=2000, replicates=2)

def die(*_, **__):
    os.kill(os.getpid(), signal.SIGKILL)

class Dying(io.FileIO):
    def write(self, data):
        if self.tell() > 5000:
            super().write(bytes(data)[: len(data) // 2])
            die()
        return super().write(data)

if moment == "in the midst":
    whole.os.fdopen = Dying
elif moment == "before it is on the disk":
    whole.os.fsync = die
elif moment == "before it takes its place":
    Path.replace = die
elif moment == "before its name is on the disk":
    whole._settle = die
solution.save(path)
"""


@pytest.mark.parametrize(
    "moment", ["in the midst", "before it is on the disk", "before it takes its place", "before its name is on the disk"]
)
def test_a_kill_while_a_checkpoint_is_written(tmp_path, moment):
    path, cut = tmp_path / "run.npz", rd.subdivide(rd.load_scene("room"), cells=1)
    rd.solve(cut, "random-walk", quanta=1000, replicates=2).save(path)
    done = subprocess.run([sys.executable, "-c", DYING, moment, path], capture_output=True, text=True)
    assert done.returncode == -signal.SIGKILL, done.stderr
    assert rd.load_solution(path).quanta == (2000 if moment == "before its name is on the disk" else 1000)
    rd.load_solution(path).save(path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.npz"]  # a half file is gone with the next one
