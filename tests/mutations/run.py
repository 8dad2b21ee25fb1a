"""Are small mistakes noticed? Each of `table.MISTAKES` is put into a copy of this checkout, one at a time, and its tests are run.

    python tests/mutations/run.py              all of them, an hour or so
    python tests/mutations/run.py tone vtp     those whose file or reason holds one of the words

The tests must pass without a mistake first. A mistake whose text is no longer in its file, once, is told and counts as missed:
then the table has to follow the code.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from table import MISTAKES, Mistake

ROOT = Path(__file__).resolve().parents[2]
LEFT_OUT = shutil.ignore_patterns(".git", ".venv", "__pycache__", "*.egg-info", ".*_cache", "build", "dist")
LONGEST = 600  # seconds of a run of tests: a mistake may make it endless, which is noticed too


def passes(copy: Path, tests: tuple[str, ...]) -> bool:
    """Whether the tests pass there."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *(f"tests/{test}" for test in tests)]
    environment = os.environ | {"PYTHONPATH": str(copy / "src"), "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        done = subprocess.run(command, cwd=copy, env=environment, capture_output=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return False
    if done.returncode > 2:  # no failures, nor a module that cannot be imported: pytest found no such tests
        raise SystemExit(f"{' '.join(command)}\n{done.stdout.decode()}{done.stderr.decode()}")
    return done.returncode == 0


def outcome(copy: Path, mistake: Mistake) -> str:
    """What came of a mistake: "noticed", "MISSED", or that its text was not found."""
    path = copy / "src" / "radiosity" / mistake.file
    text = path.read_text() if path.is_file() else ""
    if text.count(mistake.old) != 1:
        return f"NOT FOUND: {text.count(mistake.old)} times in {mistake.file}; write the table anew"
    path.write_text(text.replace(mistake.old, mistake.new))
    try:
        return "MISSED" if passes(copy, mistake.tests) else "noticed"
    finally:
        path.write_text(text)


def main(words: list[str]) -> int:
    """Run and tell; the number of mistakes that were missed."""
    chosen = [m for m in MISTAKES if not words or any(word in f"{m.file} {m.why}" for word in words)]
    with tempfile.TemporaryDirectory(prefix="mutations-") as folder:
        copy = Path(folder) / "checkout"
        shutil.copytree(ROOT, copy, ignore=LEFT_OUT)
        tests = dict.fromkeys(test for mistake in chosen for test in mistake.tests)
        failing = [test for test in tests if not passes(copy, (test,))]
        if failing:
            raise SystemExit(f"without any mistake these fail already: {', '.join(failing)}")
        missed = 0
        for number, mistake in enumerate(chosen, 1):
            started = time.perf_counter()
            found = outcome(copy, mistake)
            missed += found != "noticed"
            seconds = time.perf_counter() - started
            print(f"{number:3d} {found:8} {seconds:5.1f} s  {mistake.file}: {mistake.why}", flush=True)
    print(f"{len(chosen) - missed} of {len(chosen)} noticed")
    return missed


if __name__ == "__main__":
    sys.exit(min(main(sys.argv[1:]), 125))
