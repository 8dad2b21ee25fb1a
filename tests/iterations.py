"""Variants of the iterations, for the tests."""

import numpy as np

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
