"""Variants of the iterations for the tests, and what their solutions are compared with."""

from functools import cache

import numpy as np
from replicates import powers

import radiosity as rd

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


def open_room(*, two_sided: bool = False) -> rd.Scene:
    """The room without its north wall; or all its faces with two radiating sides."""
    scene = rd.load_scene("room")
    scene = scene.take(scene.surface != scene.names.index("north wall"))
    if not two_sided:
        return scene
    return rd.Scene.from_arrays(
        scene.vertices,
        scene.faces,
        scene.reflectance,
        scene.emission,
        two_sided=True,
        back_reflectance=0.4,
        back_emission=np.zeros((1, 1)),
        surface=scene.surface,
        names=scene.names,
    )


@cache
def walked() -> dict[str, tuple[rd.Patches, np.ndarray]]:
    """Patches of three scenes, and the power that their surfaces receive from random walks, (replicates, n_surfaces)."""
    scenes = {"room": rd.load_scene("room"), "open": open_room(), "two-sided": open_room(two_sided=True)}
    cut = {name: rd.subdivide(scene, cells=3) for name, scene in scenes.items()}
    return {name: (p, powers(rd.solve(p, "random-walk", rays=4_000_000, replicates=16))) for name, p in cut.items()}
