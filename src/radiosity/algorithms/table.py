"""The table of algorithms: the name that `method` gives each, and the class that runs it."""

from importlib import import_module

from ..errors import MethodError, shown
from ..method import Baseline, Method
from ..problem.model import Problem
from ..sampling.streams import Seed
from ..tracing.geometry import Geometry
from .base import AbstractAlgorithm

ALGORITHMS = {
    "firing": "firing.algorithm:Firing",
    "walks": "walks.shooting:Walks",
    "gathering": "walks.gathering:Gathering",
    "gather": "gather.algorithm:Gather",
    "iteration": "iterations.algorithm:Iteration",
    "multipath": "global_lines.multipath:Multipath",
    "pooling": "global_lines.pooling:Pooling",
    "matrix": "matrix.algorithm:Matrix",
    "full-matrix": "full_matrix:FullMatrix",
    "progressive": "progressive.algorithm:Progressive",
    "hierarchical": "hierarchical.algorithm:Hierarchical",
}


LIGHTS = ("firing", "gather")  # algorithms that take lights without area


def make(geometry: Geometry, problem: Problem, method: Method | Baseline, seed: Seed | int, replicates: int) -> AbstractAlgorithm:
    """Return the algorithm that runs a method.

    Raises:
        MethodError: there are lights without area, and the method cannot take them.
    """
    if problem.lights is not None and method.machine not in LIGHTS:
        names = shown([one.name for one in problem.patches.scene.lights.all])
        raise MethodError(
            f"{method} sends light from patches only, and {problem.patches.scene.source} has lights without area: {names}; "
            "take --method gather or --method random-walk"
        )
    geometry.prepare()
    module, cls = ALGORITHMS[method.machine].split(":")
    return getattr(import_module(f".{module}", __package__), cls)(geometry, problem, method, seed, replicates)
