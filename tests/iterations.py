"""Variants of the iterations, and how their replicates are compared, for the tests."""

import numpy as np

import radiosity as rd
from radiosity.engine.problem import Problem
from radiosity.engine.process import AbstractTally

VARIANTS = {
    "incremental": {"order": "incremental"},
    "incremental, both ends": {"order": "incremental", "estimator": "bidirectional"},
    "incremental, control variate": {"order": "incremental", "control_variate": True},
    "regular": {"order": "regular"},
    "regular, warm-up": {"order": "regular", "warm_up": True},
    "regular, both ends": {"order": "regular", "estimator": "bidirectional"},
    "regular, control variate": {"order": "regular", "control_variate": True},
    "regular, everything": {"order": "regular", "estimator": "bidirectional", "control_variate": True, "warm_up": True},
}


def replicate_power(solution: rd.Solution, tally: AbstractTally | None = None, group: int = 0) -> np.ndarray:
    """(replicates, n_surfaces) power that arrives on each surface, W."""
    from radiosity.engine.process import make

    problem = Problem.of(solution.patches)
    if tally is None:
        from radiosity.engine.device import choose
        from radiosity.engine.geometry import Geometry

        method = rd.Method(**solution.provenance["choices"])
        tally = make(Geometry(solution.patches, choose("cpu")), problem, method, 0, 1).tally
    values, unit = tally.irradiance(problem, solution.state, group)
    surface = solution.patches.surface
    return np.stack([values[:, surface == s].sum(axis=1) for s in np.unique(surface)], axis=1) * unit


def difference(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Of the means of (replicates, k) values, in combined standard errors, of 1e-6 of the value at least."""
    errors = [np.maximum(x.std(axis=0, ddof=1) / len(x) ** 0.5, 1e-6 * np.abs(x.mean(axis=0))) for x in (one, other)]
    return (one.mean(axis=0) - other.mean(axis=0)) / np.maximum(np.hypot(*errors), 1e-300)


def open_room(*, two_sided: bool = False) -> rd.Scene:
    """The room without its north wall; or all its faces with two radiating sides."""
    scene = rd.load_scene("room")
    scene = scene.take(scene.surface != scene.names.index("north wall"))
    if not two_sided:
        return scene
    return rd.Scene.from_arrays(
        scene.vertices, scene.faces, scene.reflectance, scene.emission, two_sided=True, back_reflectance=0.4,
        back_emission=np.zeros((1, 1)), surface=scene.surface, names=scene.names,
    )  # fmt: skip
