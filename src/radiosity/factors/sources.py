"""The sources of form factors of baselines, by name."""

from importlib import import_module

from ..problem.model import Problem
from ..sampling.streams import Seed
from ..tracing.geometry import Geometry
from .rows import AbstractRows

ROWS = {"polygons": "polygon_rows:PolygonRows", "hemicube": "hemicube_rows:HemicubeRows", "lines": "line_rows:LineRows"}


def rows_for(geometry: Geometry, problem: Problem, method, seed: Seed | int, replicates: int) -> AbstractRows:
    """The source of form factors that a `Baseline` names."""
    module, cls = ROWS[method.factors].split(":")
    return getattr(import_module(f".{module}", __package__), cls)(geometry, problem, method, seed, replicates)
