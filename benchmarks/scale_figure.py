"""Figure of time and memory against faces and patches, from rows of `scale.py`: ``scale_figure.py PATH [ROWS]``.

Rows are those of `docs/figures/scale.jsonl` unless another file is named.
"""

import json
import sys
from pathlib import Path

from radiosity.lab.figures import COLOURS, MARKS, drawn

GIB = 2**30
ROWS = Path(__file__).parents[1] / "docs" / "figures" / "scale.jsonl"
NAMES = {"faces": "every patch a face", "patches": "at most 10⁴ faces"}


def draw(path: Path, of: Path) -> None:
    """Draw the last row of each series and size."""
    rows = {}
    for line in of.read_text(encoding="utf-8").splitlines():
        row = json.loads(line)
        if "peak" in row:
            rows[row["series"], row["patches"]] = row
    with drawn(path, (9, 3.4), "A box in three colours, 8 replicates") as figure:
        left, right = figure.subplots(1, 2)
        for (series, name), colour, mark in zip(NAMES.items(), COLOURS, MARKS, strict=False):
            some = sorted((row for row in rows.values() if row["series"] == series), key=lambda row: row["patches"])
            patches = [row["patches"] for row in some]
            left.loglog(patches, [row["peak"] / GIB for row in some], color=colour, marker=mark, label=name)
            estimate = [(row["before"] + row["expected"]) / GIB for row in some]
            left.loglog(patches, estimate, color=colour, linestyle=":", label=f"{name}: estimated")
            rate = [1e6 * row["seconds"]["run"] / row["rays"] for row in some]
            right.loglog(patches, rate, color=colour, marker=mark, label=name)
        left.set(xlabel="patches", ylabel="peak of the process, GiB")
        right.set(xlabel="patches", ylabel="CPU seconds a million lines")
        left.legend()


if __name__ == "__main__":
    draw(Path(sys.argv[1]), Path(sys.argv[2]) if len(sys.argv) > 2 else ROWS)
