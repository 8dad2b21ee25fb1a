"""Figures of the runs of ``make bench``: one JSON line a run, in a file that git ignores.

``make bench-compare`` prints the ratios of the last two runs. A line holds when and on what it was measured, and ``figures``:
numbers by their names, whose last word is the unit. Rates (M/s) are better where larger, seconds (s) where smaller. Runs on
different machines or versions are compared too, and what differs is told.
"""

import json
import os
import platform
import sys
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

FILE = Path(__file__).with_name("history.jsonl")
PACKAGES = ("radiosity", "drjit", "mitsuba", "numpy")
ROW = "{:<64} {:>10} {:>10} {:>7}"

_figures: dict[str, float] = {}


def note(name: str, value: float, unit: str) -> None:
    """Remember a figure of this run."""
    _figures[f"{name}, {unit}"] = round(float(value), 4)


def machine() -> dict:
    """What figures depend on, besides the code."""
    return {
        "processor": platform.processor() or platform.machine(),
        "processors": os.cpu_count(),
        "python": platform.python_version(),
        **{package: version(package) for package in PACKAGES},
    }


def keep(file: Path = FILE) -> None:
    """Append what was noted as one line, and forget it."""
    line = {"at": datetime.now(UTC).isoformat(timespec="seconds"), "machine": machine(), "figures": dict(_figures)}
    with file.open("a", encoding="utf-8") as opened:
        opened.write(json.dumps(line) + "\n")
    _figures.clear()


def compare(file: Path = FILE) -> str:
    """A table of the last two runs.

    Raises:
        SystemExit: there are no two runs yet.
    """
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    if len(lines) < 2:
        raise SystemExit(f"{file}: holds {len(lines)} run(s); `make bench` adds one, and two are needed")
    before, last = (json.loads(line) for line in lines[-2:])
    rows = [f"{last['at']} over {before['at']}", ROW.format("", "before", "last", "ratio")]
    for name in sorted({**before["machine"], **last["machine"]}):
        one, two = (run["machine"].get(name) for run in (before, last))
        if one != two:
            rows.append(f"not alike: {name} was {one}, is {two}")
    for name, value in last["figures"].items():
        old = before["figures"].get(name)
        known = old is not None
        ratio = f"{value / old:.2f}" if old else "?"
        rows.append(ROW.format(name, f"{old:.2f}" if known else "new", f"{value:.2f}", ratio))
    rows += [
        ROW.format(name, f"{value:.2f}", "gone", "") for name, value in before["figures"].items() if name not in last["figures"]
    ]
    return "\n".join(rows)


if __name__ == "__main__":
    print(compare(Path(sys.argv[1]) if len(sys.argv) > 1 else FILE))
