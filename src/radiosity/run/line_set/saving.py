"""Writing of line set files."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from ...solution.npz import LINES
from ...solution.stored_patches import stored
from ...solution.whole import whole_file

FORMAT = 1  # of line sets
SCALARS = ("rays", "quanta", "seconds", "status", "provenance", "both_ways", "replicates")


def save_lines(lines: Any, path: Path) -> None:
    """Write a `LineSet`; a failed write leaves the old file as it was.

    Raises:
        OutputError: the file cannot be written.
    """
    arrays, facts = stored(lines.patches)
    arrays |= {"pairs_keys": lines.pairs.keys, "pairs_counts": lines.pairs.counts}
    parts = [[part.seed.value, part.first, part.replicates] for part in lines.parts]
    meta = {name: getattr(lines, name) for name in SCALARS} | {"format": FORMAT, "kind": LINES, "parts": parts, **facts}
    meta |= {"method": lines.method.choices, "sources": list(lines.sources), "patches": len(lines.patches)}
    arrays["meta"] = np.array(json.dumps(meta))
    with whole_file(path) as file:
        np.savez(file, **arrays)
