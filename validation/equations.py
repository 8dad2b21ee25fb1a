"""Both equations against a path tracer, which solves the continuous one."""

from collections.abc import Iterator

import numpy as np

import radiosity as rd

from . import discretisation
from .comparison import Patchwise, patchwise
from .runs import solved

REPLICATES = 4  # of each run


def both(name: str, patches: rd.Patches, rays: float, theirs: np.ndarray) -> Iterator[Patchwise]:
    """Particle tracing as it is, and random walks with what the size of patches does to them added to the variance."""
    runs = solved(patches, rays, method="particle-tracing", replicates=REPLICATES)
    yield patchwise(f"{name}, particle-tracing", runs, theirs)
    runs = solved(patches, rays, method="random-walk", replicates=REPLICATES)
    change, rows = discretisation.error(runs, rays, "random-walk"), discretisation.resolved(patches)
    note = "" if rows.all() else f" (without {(~rows).sum()} patches that something touches)"
    yield patchwise(f"{name}, random-walk{note}", runs, theirs, discretisation=change, rows=rows)
