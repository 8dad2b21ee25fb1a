"""Reading of line set files."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from ...factors.counted import CountedPairs
from ...factors.counts import split
from ...method import Method
from ...sampling.streams import Seed
from ...solution.npz import FORMATS_OF_PANES, LINES
from ...solution.reading import read
from ...solution.stored_patches import restored
from ...solution.validate import validate_patches
from ..part import Part
from .model import LineSet
from .problem import some_backs_pass
from .saving import FORMAT

FACTS = {"device": str, "budget": dict, "choices": dict, "versions": dict}  # of a provenance, that a solution needs or is told


def load_lines(path) -> LineSet:
    """Read a line set saved by `LineSet.save`. The file stands alone: it has the scene too.

    Raises:
        SceneError: the file is missing, damaged, or no line set; or its geometry is not the one that its lines were traced in.

    Example:
        >>> patches = rd.subdivide(rd.load_scene("room"), cells=1)
        >>> rd.trace_lines(patches, rays=10_000, sources=["light"]).save("lines.npz")
        >>> rd.load_lines("lines.npz").solve(reflectance=0.3).status
        'complete'
    """
    return read(Path(path), LINES, (FORMAT, *FORMATS_OF_PANES), _restore)


def _restore(arrays: dict[str, Any], meta: dict[str, Any]) -> LineSet:
    patches, keys, counts = restored(arrays, meta), arrays["pairs_keys"], arrays["pairs_counts"]
    n, replicates, quanta, both_ways = (meta[name] for name in ("patches", "replicates", "quanta", "both_ways"))
    for name, value, least in (
        ("patches", n, 1),
        ("replicates", replicates, 1),
        ("quanta", quanta, 0),
        ("rays", meta["rays"], 0),
    ):
        _that(type(value) is int and value >= least, f"{name} {value!r}")
    validate_patches(patches, n)
    provenance = meta["provenance"]
    for name, kind in FACTS.items():
        _that(isinstance(provenance[name], kind), f"the provenance has the {name} {provenance[name]!r}")
    for name, now in (("geometry", patches.scene.geometry_hash), ("cut", patches.cut_hash)):
        _that(provenance[name] == now, f"its {name} is not the one that the lines were traced in")
    _that(
        keys.dtype == np.uint64 and counts.dtype in (np.uint32, np.uint64) and keys.ndim == 1 and keys.shape == counts.shape,
        "other counts",
    )
    _that(bool((keys[1:] > keys[:-1]).all()) and bool((counts > 0).all()), "pairs that are not in order")
    rows, columns = split(keys)
    _that(bool((rows < replicates * n).all()) and bool((columns <= n + 1).all()), "pairs of patches that there are not")
    _that(int(counts.sum(dtype=np.uint64)) == meta["rays"], "other lines than it says")
    parts = tuple(Part(Seed(value, first), many) for value, first, many in meta["parts"])
    whole = all(type(x) is int and x >= 0 for part in meta["parts"] for x in part) and all(part.replicates > 0 for part in parts)
    _that(whole and sum(part.replicates for part in parts) == replicates, "other replicates than its parts have")
    method, directed = Method(**meta["method"]), some_backs_pass(patches)
    _that(method.machine == "matrix", f"a method that counts no lines, {method}")
    _that(type(both_ways) is bool and not (both_ways and (directed or method.lines != "local")), f"both ways {both_ways!r}")
    seconds, status, sources = meta["seconds"], meta["status"], meta["sources"]
    _that(isinstance(seconds, int | float) and math.isfinite(seconds) and seconds >= 0, f"seconds {seconds!r}")
    _that(isinstance(status, str) and all(isinstance(name, str) for name in sources), "a status or sources that are no text")
    pairs = CountedPairs(patches.solid, keys, counts, replicates, both_ways, directed, keeps=True)
    return LineSet(pairs, meta["rays"], quanta, float(seconds), status, method, parts, tuple(sources), provenance)


def _that(holds, otherwise: str) -> None:
    if not holds:
        raise ValueError(otherwise)
