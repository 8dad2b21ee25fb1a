"""Are small mistakes noticed? Each of `table.MISTAKES` is put into a copy of this checkout, one at a time, and its tests are run.

    python tests/mutations/run.py              all of them, an hour or so
    python tests/mutations/run.py tone vtp     those whose file or reason holds one of the words

What notices a mistake must pass without it. A mistake whose text does not stand once in its file is told and counts as missed:
then the table has to follow the code.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from table import MISTAKES, Mistake

ROOT = Path(__file__).resolve().parents[2]
LEFT_OUT = shutil.ignore_patterns(".git", ".venv", "__pycache__", "*.egg-info", ".*_cache", "build", "dist")
LONGEST = 900  # seconds of a run of tests: a mistake may make it endless, which is noticed too


def failing(copy: Path, tests: tuple[str, ...]) -> tuple[str, ...]:
    """The first test, or file, of some that fails there; none where all pass."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
    environment = os.environ | {"PYTHONPATH": str(copy / "src"), "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        done = subprocess.run(command, cwd=copy, env=environment, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return ("endless",)
    if done.returncode == 0:
        return ()
    if done.returncode > 2:  # neither failures nor a module that cannot be imported: pytest found no such tests
        raise SystemExit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    return tuple(re.findall(r"^(?:FAILED|ERROR) (tests/.+?)(?: - .*)?$", done.stdout, re.MULTILINE)) or ("a signal",)


def outcome(copy: Path, mistake: Mistake) -> str:
    """What came of a mistake; it begins with "noticed" or "MISSED"."""
    path = copy / "src" / "radiosity" / mistake.file
    text = path.read_text() if path.is_file() else ""
    if text.count(mistake.old) != 1:
        return f"MISSED: its text is there {text.count(mistake.old)} times, write the table anew"
    path.write_text(text.replace(mistake.old, mistake.new))
    try:
        found = failing(copy, tuple(f"tests/{test}" for test in mistake.tests))
    finally:
        path.write_text(text)
    if found and found[0].startswith("tests/") and failing(copy, found):
        return f"MISSED: {found[0]} fails without it, too"
    return f"noticed by {found[0]}" if found else "MISSED"


def main(words: list[str]) -> int:
    """Run and tell; the number of mistakes that were missed."""
    chosen = [m for m in MISTAKES if not words or any(word in f"{m.file} {m.why}" for word in words)]
    with tempfile.TemporaryDirectory(prefix="mutations-") as folder:
        copy, missed = Path(folder) / "checkout", 0
        shutil.copytree(ROOT, copy, ignore=LEFT_OUT)
        for number, mistake in enumerate(chosen, 1):
            started = time.perf_counter()
            found = outcome(copy, mistake)
            missed += found.startswith("MISSED")
            seconds = time.perf_counter() - started
            print(f"{number:3d} {seconds:5.1f} s  {mistake.file}: {mistake.why}\n       {found}", flush=True)
    print(f"{len(chosen) - missed} of {len(chosen)} noticed")
    return missed


if __name__ == "__main__":
    sys.exit(min(main(sys.argv[1:]), 125))
