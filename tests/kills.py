"""A run that is killed again and again, and resumed from its checkpoint until it is done.

As a program it is one life of that run: it goes on from the checkpoint if there is one, says so after each sweep, and saves
the result.
"""

import json
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import radiosity as rd
from radiosity.algorithms.global_lines import multipath
from radiosity.run import checkpoint as checkpoints

SPANS = 1 << 16  # of multipath runs between two looks at the clock, so that there are many
PAUSE = 0.03  # seconds at most from a sweep to the kill: longer than it takes to write a checkpoint


@dataclass(frozen=True)
class Case:
    scene: str
    method: str
    quanta: int

    def patches(self) -> rd.Patches:
        return rd.subdivide(rd.load_scene(self.scene), cells=3)

    def solve(self, **options) -> rd.Solution:
        multipath.BATCH = SPANS
        return rd.solve(self.patches(), self.method, quanta=self.quanta, replicates=2, seed=5, **options)


def live(case: Case, folder: Path) -> None:
    """One life, with a checkpoint after every sweep."""
    checkpoints.TIMES = 0
    kept = folder / "run.checkpoint.npz"
    before = rd.load_solution(kept) if kept.exists() else None
    case.solve(resume=before, checkpoint=kept, checkpoint_every=0, progress=lambda state: print(state.message, flush=True)).save(
        folder / "run.npz"
    )


def killed(case: Case, folder: Path, sweeps: int, seed: int, most_kills: int) -> tuple[rd.Solution, int]:
    """Lives, each killed at random after up to so many sweeps, until one ends: its result, and how many were killed.

    Args:
        case: what is solved.
        folder: for the files.
        sweeps: that a life has at most.
        seed: of the moments.
        most_kills: after which a life is left to end.
    """
    random, kills = np.random.Generator(np.random.Philox(seed)), 0
    task = json.dumps([case.scene, case.method, case.quanta, str(folder)])
    while True:
        with subprocess.Popen([sys.executable, __file__, task], stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            left = random.integers(1, sweeps, endpoint=True) if kills < most_kills else -1
            for line in process.stdout:
                left -= line == "tracing\n"
                if left == 0:
                    time.sleep(random.uniform(0, PAUSE))
                    process.kill()
                    break
        if process.returncode == 0:
            return rd.load_solution(folder / "run.npz"), kills
        assert process.returncode == -signal.SIGKILL
        kills += 1


def assert_same(one: rd.Solution, other: rd.Solution) -> None:
    """Bit for bit, all but the time."""
    for name in ("irradiance", "irradiance_standard_error", "arrivals"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    for name in ("rays", "quanta", "replicates", "books", "status", "provenance"):
        assert getattr(one, name) == getattr(other, name), name
    assert one.state.keys() == other.state.keys()
    for name, values in one.state.items():
        np.testing.assert_array_equal(values, other.state[name])


if __name__ == "__main__":
    scene, method, quanta, where = json.loads(sys.argv[1])
    live(Case(scene, method, quanta), Path(where))
