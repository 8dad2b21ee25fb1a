"""The discretisation error of experiment 3 (section 5), apart from the computational one.

The error of a piecewise constant solution at x is B(x) - B_i. B(x) is taken from a mesh four times finer, with many lines. The
source of the error is the paper's delta (equation 6): the light that arrives at x from constant patches, less its mean over the
patch. A discrete solution propagates it by the transport equation, a continuous one does not.
"""

from dataclasses import dataclass

import numpy as np

from ..method import Method
from ..patches import Patches, cells, subdivide
from ..patches.nesting import parents
from ..scene import Scene, load_scene
from ..tracing.first_hits import first_hits

FINER = 4
LINES = 4_000_000  # in all, to evaluate delta


@dataclass(frozen=True)
class Discretisation:
    """RMS errors over the area of one mesh, divided by the RMS of the reflected light.

    Attributes:
        patches: the number of patches.
        discrete, continuous: of B(x) - B_i for the two kinds of solution.
        delta: of equation 6, evaluated with the discrete solution; its noise, known from halves of the lines, is taken out.
    """

    patches: int
    discrete: float
    continuous: float
    delta: float


def discretisation(count: int, lines: float, seed: int) -> Discretisation:
    """Return the errors of ``room`` with faces cut into count x count cells."""
    from ..run.solve import solve

    scene = load_scene("room")
    coarse, fine = subdivide(scene, cells=count), subdivide(scene, cells=FINER * count)
    parent = parents(fine, coarse)
    smooth = solve(fine, Method(equation="continuous"), rays=lines, seed=seed)
    exact, noise = smooth.radiosity[:, 0], smooth.standard_error[:, 0] ** 2
    scale = np.sqrt(fine.area @ (exact - fine.emission[:, 0]) ** 2)
    errors, rough = {}, {}
    for equation in ("discrete", "continuous"):
        found = solve(coarse, Method(equation=equation), rays=lines, seed=seed + 1)
        rough[equation] = found.radiosity[:, 0]
        # the noise of both runs is known from their replicates, and taken out
        square = (exact - rough[equation][parent]) ** 2 - noise - found.standard_error[parent, 0] ** 2
        errors[equation] = float(np.sqrt(max(fine.area @ square, 0.0)) / scale)
    halves = [delta(scene, fine, coarse, parent, rough["discrete"], np.random.default_rng([seed, half])) for half in (0, 1)]
    # the product of independent halves has no noise in its mean
    square = fine.area @ (halves[0] * halves[1])
    return Discretisation(len(coarse), errors["discrete"], errors["continuous"], float(np.sqrt(max(square, 0.0)) / scale))


def delta(scene: Scene, fine: Patches, coarse: Patches, parent: np.ndarray, radiosity: np.ndarray, random) -> np.ndarray:
    """Return equation 6 on fine patches, (n_fine,): reflectance times (arriving light less its mean over the coarse patch)."""
    column, row, _ = fine.place
    each = max(LINES // len(fine), 1)
    face = np.repeat(fine.face, each)
    origin, first, second = (edge[face] for edge in scene.frames)
    u = (np.repeat(column, each) + random.random(len(face))) / fine.columns[face]
    v = (np.repeat(row, each) + random.random(len(face))) / fine.rows[face]
    normal = np.repeat(fine.normal, each, axis=0)
    tangent = first / np.linalg.norm(first, axis=1, keepdims=True)
    radius, turn = np.sqrt(random.random(len(face))), 2 * np.pi * random.random(len(face))
    height = np.sqrt(1 - radius**2)
    direction = (
        tangent * (radius * np.cos(turn))[:, None]
        + np.cross(normal, tangent) * (radius * np.sin(turn))[:, None]
        + normal * height[:, None]
    )
    point = origin + u[:, None] * first + v[:, None] * second + normal * 1e-5
    hits = first_hits(scene, point, direction)
    met = np.zeros(len(face))
    lit = (hits.face >= 0) & hits.front
    at = hits.face[lit]
    number = cells.number(hits.u[lit], hits.v[lit], coarse.columns[at], coarse.rows[at], scene.is_quad[at])
    met[lit] = radiosity[coarse.first[at] + number]
    arriving = met.reshape(len(fine), each).mean(axis=1)
    mean = np.bincount(parent, arriving * fine.area) / np.bincount(parent, fine.area)
    return fine.reflectance[:, 0] * (arriving - mean[parent])
