"""The scenes of the study, and their reference solutions where no exact one is known."""

import numpy as np

from ..algorithms.table import make
from ..device.backend import choose
from ..method import Method
from ..patches import subdivide
from ..problem.model import Problem
from ..scene import Scene, load_scene
from ..tracing.geometry import Geometry
from .measure import radiosity
from .study import Case, Protocol

MAZES = ("labyrinth-0.1", "labyrinth-0.5", "labyrinth-0.9")
CELLS = {"room": 6}
REFERENCE_SEED = 987654321


def maze(name: str) -> Case:
    """Return a closed maze with the mean reflectance of its name; reflectance differs by patch, emission is 1 - rho, so B = 1."""
    patches = subdivide(load_scene(name), cells=1)
    return Case(name, patches, np.ones(len(patches)))


def ones(case: Case) -> np.ndarray:
    """Return the exact solution of a maze, (n_patches,)."""
    return np.ones(len(case.patches))


def room(cells: int | None = None) -> Case:
    """Return a box with two boxes and a small light."""
    return Case("room", subdivide(load_scene("room"), cells=cells or CELLS["room"]), None)


def plates(cells: int = 4) -> Case:
    """Return an open scene: the room's lit floor, one of its walls and the lamp. Half of the patches see no light.

    They radiate on both sides; backs reflect less.
    """
    scene = load_scene("room")
    keep = np.isin(scene.surface, [scene.names.index(name) for name in ("floor", "west wall", "light")])
    lit = scene.take(keep)
    both = Scene.from_arrays(
        lit.vertices,
        lit.faces,
        lit.reflectance,
        lit.emission,
        two_sided=True,
        back_reflectance=0.3,
        back_emission=np.zeros((1, 1)),
        surface=lit.surface,
        names=lit.names,
    )
    return Case("plates", subdivide(both, cells=cells), None)


def reference(case: Case, equation: str, protocol: Protocol) -> tuple[np.ndarray, float]:
    """Return the reference radiosity, (n_patches,), by ``protocol.reference`` times as many lines, and its relative error.

    It solves the arms' own equation. The error is the area-weighted RMS of its standard error, divided by that of the reflected
    light.
    """
    problem, geometry = Problem.of(case.patches), Geometry(case.patches, choose("cpu"))
    replicates = 8
    algorithm = make(geometry, problem, Method(equation=equation, randomisation="shared"), REFERENCE_SEED, replicates)
    # a quantum takes 1 / (1 - mean reflectance) lines; more lines than asked for do no harm
    lines = protocol.reference * protocol.rungs[-1]
    algorithm.advance(max(1, lines // replicates), lambda lines: None)
    found = radiosity(algorithm, problem, algorithm.capture())
    mean, error = found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(replicates)
    area = case.patches.area
    return mean, float(np.sqrt(area @ error**2) / np.sqrt(area @ (mean - case.patches.emission[:, 0]) ** 2))
