"""Runs that are killed, whose disk is full for spells and whose workers die: ``python benchmarks/soak.py [--part 0.1]``.

Four runs, a grey one, one in colours, one of iterations and one on a cluster of two processes, are killed (SIGKILL) at random
times and resumed from what is on the disk until they are done. A row a life tells what the kill cost: the seconds from the
moment at which the lines that the next life begins with were first there, until the kill; the lines that were told since; and of
these seconds those in which the disk was full. At the end the results are compared, bit for bit, with those of runs never
stopped. An hour and a half on two cores; ``--part`` of all lines takes as much less. Where no disk of its own may be mounted
(not root), it is never full.
"""

import argparse
import contextlib
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from soak_disk import Disk

import radiosity as rd

LIFE = (15.0, 150.0)  # seconds, drawn between these two
WORKER = (15.0, 60.0)  # seconds between two workers that are killed
ORPHANS = 60.0  # seconds after a driver's kill by which its workers have ended
COMMON = ("--replicates", "4", "--cells", "8", "--seed", "5")
ROW = "{:<10} {:>4} {:>7} {:>7} {:>14} {:>14} {:>12} {:>7} {:>7} {:>7} {:>7} {:>9} {:>8}  {}"
HEAD = (
    "run", "life", "wall s", "start s", "lines at first", "at the end", "lost lines", "lost s", "full s", "MiB", "most",
    "workers", "orphans", "end",
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A run: its name, scene, method, quanta, and further arguments."""

    name: str
    scene: str
    method: str
    quanta: int
    also: tuple[str, ...] = ()

    def arguments(self, part: float, out: Path) -> list[str]:
        return ["solve", self.scene, "--method", self.method, *COMMON, "--quanta", str(round(self.quanta * part)), "-o", str(out)]


CASES = (
    Case("grey", "room", "random-walk", 200_000_000),
    Case("colours", "cornell-box", "random-walk", 220_000_000),
    Case("iterations", "cornell-box", "stochastic-jacobi", 600_000_000),
    Case("cluster", "room", "random-walk", 200_000_000, ("--cluster", "local:2")),
)


@dataclass(eq=False)
class Life:
    """A process that goes on with a run, what it told, and how it ended."""

    command: list[str]
    errors: Path
    begun: float = field(default_factory=time.time)
    told: list[tuple[float, str, int]] = field(default_factory=list)
    memory: tuple[float, float] = (0.0, 0.0)  # MiB resident, and most
    workers: int = 0
    orphans: float = 0.0
    ended: float = 0.0

    def start(self) -> None:
        with self.errors.open("w") as errors:
            self.process = subprocess.Popen(
                [sys.executable, str(Path(__file__).with_name("soak_life.py")), *self.command],
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
                start_new_session=True,
            )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if line.startswith("@ "):
                _, when, what, lines = line.split()
                self.told.append((float(when), what, int(lines)))

    def live(self, seconds: float, random: np.random.Generator, *, kill_workers: bool) -> int:
        """Wait so long, then kill it; its exit status."""
        end, worker = time.time() + seconds, time.time() + random.uniform(*WORKER)
        while time.time() < end and self.process.poll() is None:
            time.sleep(0.1)
            self._weigh()
            if kill_workers and time.time() > worker:
                worker = time.time() + random.uniform(*WORKER)
                self._kill_a_worker(random)
        self.process.kill()
        self.ended, status = time.time(), self.process.wait()
        self._reader.join(ORPHANS)
        with contextlib.suppress(ProcessLookupError, PermissionError):
            while time.time() < self.ended + ORPHANS:
                os.killpg(self.process.pid, 0)
                time.sleep(0.1)
            os.killpg(self.process.pid, signal.SIGKILL)
        self.orphans = time.time() - self.ended
        return status

    def _weigh(self) -> None:
        with contextlib.suppress(OSError, ValueError):
            status = Path(f"/proc/{self.process.pid}/status").read_text()
            found = dict(re.findall(r"^(VmRSS|VmHWM):\s+(\d+) kB", status, re.MULTILINE))
            if found:
                self.memory = int(found["VmRSS"]) / 1024, int(found["VmHWM"]) / 1024

    def _kill_a_worker(self, random: np.random.Generator) -> None:
        tasks = Path(f"/proc/{self.process.pid}/task")
        with contextlib.suppress(OSError):
            found = {int(one) for task in tasks.iterdir() for one in (task / "children").read_text().split()}
            workers = [one for one in sorted(found) if b"spawn_main" in Path(f"/proc/{one}/cmdline").read_bytes()]
            if workers:
                os.kill(int(random.choice(workers)), signal.SIGKILL)
                self.workers += 1

    @property
    def first(self) -> int:
        """Lines that it began with; -1 where it ended before that was known."""
        return next((lines for _, what, lines in self.told if what == "begin"), -1)

    def had(self, lines: int) -> float:
        """The time at which it first told of so many lines."""
        return min([when for when, _, there in self.told if there >= lines], default=self.begun)


def soak(case: Case, part: float, disk: Disk, folder: Path, random: np.random.Generator) -> tuple[list[float], rd.Solution]:
    """Lives until one is done: lost seconds of those that were killed while the disk had room, and the result."""
    out = disk.folder / f"{case.name}.npz"
    kept, before, lost, number = out.with_suffix(".checkpoint.npz"), None, [], 0
    while True:
        number += 1
        resume = ["--resume", str(kept)] if kept.exists() else []
        life = Life([*case.arguments(part, out), *case.also, *resume], folder / f"{case.name}-{number}.txt")
        life.start()
        status = life.live(random.uniform(*LIFE), random, kill_workers=bool(case.also))
        if before is not None:
            lost += told(case, number - 1, before, life, disk)
        before, errors = (life, status), life.errors.read_text()
        if status == 0:
            told(case, number, before, life, disk)
            return lost, rd.load_solution(out)
        rescued = re.findall(r"kept in (\S+\.npz)", errors) if status > 0 else []
        kept = Path(rescued[-1]) if rescued else kept


def told(case: Case, number: int, before: tuple[Life, int], after: Life, disk: Disk) -> list[float]:
    """Print the row of a life, and return the seconds that its kill has cost, if it was traced, and the disk had room."""
    life, status = before
    traced = [lines for _, what, lines in life.told if what in ("begin", "tracing")]
    most, first = (traced[-1] if traced else life.first), max(life.first, 0)
    kept = most if status == 0 else max(after.first, 0)
    since = life.had(kept)
    lost = 0.0 if status == 0 or not traced else life.ended - since
    full = disk.full(since, life.ended) if lost else 0.0
    start = (life.told[0][0] if life.told else life.ended) - life.begun
    end = {0: "done", -signal.SIGKILL: "killed"}.get(status, f"status {status}")
    said = life.errors.read_text().strip().replace("\n", " | ")
    seconds = [f"{value:.1f}" for value in (life.ended - life.begun, start, lost, full, *life.memory, life.orphans)]
    row = (*seconds[:2], first, most, most - kept, *seconds[2:6], life.workers, seconds[6], f"{end} {said}")
    print(ROW.format(case.name, number, *row), flush=True)
    return [lost] if lost and not full else []


def same(one: rd.Solution, other: rd.Solution) -> bool:
    """Are all numbers equal, bit for bit?"""
    arrays = [(getattr(one, name), getattr(other, name)) for name in ("irradiance", "irradiance_standard_error", "arrivals")]
    arrays += [(one.state[name], other.state[name]) for name in one.state]
    return one.rays == other.rays and all(np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in arrays)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--part", type=float, default=1.0, help="of all lines")
    parser.add_argument("--runs", nargs="+", default=[case.name for case in CASES], choices=[case.name for case in CASES])
    parser.add_argument("--seed", type=int, default=1, help="of the moments of kills and full disks")
    parser.add_argument("--folder", type=Path, help="for the files, which then stay (default: a temporary one)")
    given = parser.parse_args()
    random, begun, faults = np.random.Generator(np.random.Philox(given.seed)), time.time(), 0
    with tempfile.TemporaryDirectory(prefix="soak-") as temporary:
        folder = given.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        os.environ["TMPDIR"] = str(folder)
        whole: dict[tuple[str, str, int], rd.Solution] = {}
        print(ROW.format(*HEAD), flush=True)
        with Disk(folder / "disk", given.seed) as disk:
            ends = [(case, *soak(case, given.part, disk, folder, random)) for case in CASES if case.name in given.runs]
        for case, lost, found in ends:
            key = (case.scene, case.method, case.quanta)
            if key not in whole:
                out = folder / f"{case.name}-whole.npz"
                command = [sys.executable, "-m", "radiosity", *case.arguments(given.part, out)]
                subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
                whole[key] = rd.load_solution(out)
            equal = same(found, whole[key])
            faults += not equal
            bits = "yes" if equal else "NO"
            print(
                f"{case.name}: {found.rays} lines, the bits of a run never stopped: {bits}; lost where the disk had room: "
                f"at most {max(lost, default=0):.1f} s, {np.mean(lost or [0]):.1f} s on average of {len(lost)}",
                flush=True,
            )
    print(f"{time.time() - begun:.0f} s of wall time, disk of its own: {disk.mounted}, full for {len(disk.spells)} spells")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
