"""Run random commands on small scenes, each in a process of its own; keep those that crash, hang or find a fault of the program.

    python tests/fuzz/commands.py --seed 0 --first 0 --count 100 --keep out/fuzz

A job is a check, or a solve with some choices and perhaps a resume and a picture after it (`jobs`). Right are exit status 0, 2
with a line of ``error:``, 3 where an error was not reached, and of ``check`` 1. Anything else is told with the job's number, and
its folder is kept; job k of a seed is always the same, so ``--first k --count 1`` runs it again.
"""

import argparse
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE)]
from jobs import Job, job  # noqa: E402

SECONDS = 180  # for one command
FAULT = "a fault of the program"  # what `radiosity.cli.app` says of exceptions that are not of `radiosity.errors`


@dataclass
class Outcome:
    """What became of jobs.

    Attributes:
        counts: number of commands by what became of them.
        found: by the number of the job, the command and what is wrong with how it ended.
    """

    counts: Counter = field(default_factory=Counter)
    found: dict[int, str] = field(default_factory=dict)
    seconds: float = 0.0


def judged(command: list[str], status: int | None, output: str) -> tuple[str, str | None]:
    """What became of a command, and what is wrong with that, if anything."""
    if status is None:
        return "hang", f"no end in {SECONDS} s"
    last = (output.strip().splitlines() or [""])[-1]
    if status < 0 or status >= 128:
        return f"signal {-status if status < 0 else status - 128}", f"ended by a signal, status {status}: {last}"
    if "Traceback (most recent call last)" in output or FAULT in output:
        return "fault", last
    if status == 0:
        return "done", None
    if status == 1 and command[0] == "check":
        return "suspicious", None
    if status == 3 and "was not reached" in output:
        return "not reached", None
    if status == 2 and "error:" in output:
        return "refused", None
    return f"status {status}", f"ended with status {status}: {last}"


class Forks:
    """Commands in processes that are forked from one that waits for them (`forks`)."""

    def __init__(self, seconds: float = SECONDS):
        self.process = subprocess.Popen(
            [sys.executable, str(HERE / "forks.py"), str(seconds)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def __call__(self, command: list[str], folder: Path) -> tuple[int | None, str]:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(json.dumps([str(folder), command]), file=self.process.stdin, flush=True)
        status, output = json.loads(self.process.stdout.readline())
        return status, output

    def close(self) -> None:
        self.process.communicate()


def fresh(command: list[str], folder: Path, seconds: float = SECONDS) -> tuple[int | None, str]:
    """The status of a command in a process that was started for it, None if it did not end in time; and its output."""
    try:
        done = subprocess.run(
            [sys.executable, "-m", "radiosity", *command],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=seconds,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return None, ""
    return done.returncode, done.stdout


def run(given: Job, folder: Path, start=fresh):
    """Run a job's commands in a folder: for each the command, what became of it, and what is wrong."""
    for name, text in given.files.items():
        (folder / name).write_text(text)
    for command in given.commands:
        yield command, *judged(command, *start(command, folder))


def fuzz(seed: int, first: int, count: int, keep: Path | None = None, start=fresh) -> Outcome:
    """Run jobs ``first`` to ``first + count`` of a seed."""
    outcome, begun = Outcome(), time.monotonic()
    for number in range(first, first + count):
        with tempfile.TemporaryDirectory() as folder:
            for command, what, wrong in run(job(seed, number), Path(folder), start):
                outcome.counts[what] += 1
                if wrong is None:
                    continue
                outcome.found[number] = f"radiosity {shlex.join(command)}: {wrong}"
                print(f"  {seed} {number}: {outcome.found[number]}", flush=True)
                if keep is not None:
                    shutil.copytree(folder, keep / f"commands-{seed}-{number}", dirs_exist_ok=True)
        if (number + 1 - first) % 25 == 0:
            print(f"{number + 1 - first} jobs, {dict(outcome.counts)}", flush=True)
    outcome.seconds = time.monotonic() - begun
    return outcome


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100, help="jobs")
    parser.add_argument("--fresh", action="store_true", help="start each process anew, which takes four times as long")
    parser.add_argument("--show", action="store_true", help="print the commands and run nothing")
    parser.add_argument("--keep", type=Path, default=Path("out/fuzz"), help="where folders go of jobs that went wrong")
    arguments = parser.parse_args()
    if arguments.show:
        for number in range(arguments.first, arguments.first + arguments.count):
            given = job(arguments.seed, number)
            for name, text in given.files.items():
                print(f"# {number} {name}\n{text}")
            print(*(f"radiosity {shlex.join(command)}" for command in given.commands), sep="\n")
        return 0
    forks = Forks() if hasattr(os, "fork") and not arguments.fresh else None
    outcome = fuzz(arguments.seed, arguments.first, arguments.count, arguments.keep, forks or fresh)
    if forks is not None:
        forks.close()
    total = sum(outcome.counts.values())
    print(f"{total} commands of {arguments.count} jobs in {outcome.seconds:.0f} s, {dict(outcome.counts)}")
    print(f"{len(outcome.found)} jobs went wrong")
    return 1 if outcome.found else 0


if __name__ == "__main__":
    sys.exit(main())
