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
PLAIN = {"order": "incremental", "estimator": "collision", "control_variate": False, "basis": "constant", "refine_lines": 0.0}


def takes_lights(method: Method | Baseline) -> bool:
    """Return whether a method takes lights without area: of iterations those with the choices `PLAIN` do."""
    if method.machine == "iteration":
        return all(getattr(method, name) == value for name, value in PLAIN.items())
    return method.machine in LIGHTS


def make(geometry: Geometry, problem: Problem, method: Method | Baseline, seed: Seed | int, replicates: int) -> AbstractAlgorithm:
    """Return the algorithm that runs a method.

    Raises:
        MethodError: there are lights without area, and the method cannot take them.
    """
    if problem.lights is not None and not takes_lights(method):
        names = shown([one.name for one in problem.patches.scene.lights.all])
        raise MethodError(
            f"{method} sends light from patches only, and {problem.patches.scene.source} has lights without area: {names}; "
            "take --method gather or --method random-walk"
        )
    geometry.prepare()
    module, cls = ALGORITHMS[method.machine].split(":")
    return getattr(import_module(f".{module}", __package__), cls)(geometry, problem, method, seed, replicates)
