"""NPZ files of view factors: all fields of `ViewFactors` under their names, and the texts among them as JSON in ``meta``.

``matrix`` and ``standard_error``, (n, n), ``escaped`` and ``lost``, (n,), and their errors are there for other programs, where
there are few enough groups.
"""

import json
from dataclasses import fields
from pathlib import Path

import numpy as np

from ..solution.npz import FACTORS
from ..solution.whole import whole_file
from .restoration import SAMPLED

FORMAT = 1
TEXTS = ("names", "replicates", "method", "reciprocal", "restoration", "rays", "status", "provenance")
DERIVED = ("matrix", "standard_error", "escaped", "escaped_standard_error", "lost", "lost_standard_error")


def save(factors, path) -> None:
    """Write the file; a failed write leaves the old one as it was.

    Args:
        factors: the `ViewFactors` to write.
        path: the file.

    Raises:
        OutputError: the file cannot be written.
    """
    arrays = {field.name: getattr(factors, field.name) for field in fields(factors) if field.name not in TEXTS}
    arrays = {name: value for name, value in arrays.items() if value is not None}
    if len(factors) <= SAMPLED:
        arrays |= {name: getattr(factors, name) for name in DERIVED}
    meta = {"kind": FACTORS, "format": FORMAT, **{name: getattr(factors, name) for name in TEXTS}}
    arrays["meta"] = np.array(json.dumps(meta))
    with whole_file(Path(path)) as file:
        np.savez(file, **arrays)
