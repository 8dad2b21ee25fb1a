"""Scenes for the benchmarks: rooms of any number of faces, and strangers' scenes where a checkout has them beside it."""

from dataclasses import replace
from pathlib import Path

import numpy as np

import radiosity as rd

STRANGERS = Path(__file__).resolve().parents[2] / "shared" / "scenes" / "renderpark"


def room(tiles: int) -> rd.Scene:
    """The built-in room with every face cut into tiles x tiles faces, black and emitting everywhere."""
    scene = rd.load_scene("room")
    corners = rd.subdivide(scene, cells=tiles).corners
    corners = corners[~rd.subdivide(scene, cells=tiles).is_back]
    return rd.Scene.from_arrays(
        corners.reshape(-1, 3), np.arange(4 * len(corners)).reshape(-1, 4), 0.0, 1.0, source=f"room/{tiles}"
    )


def black(scene: rd.Scene) -> rd.Scene:
    """The same geometry, grey: every side emits alike and nothing is reflected, so that a sweep is what is asked for."""
    one, none = np.ones((scene.n_faces, 1)), np.zeros((scene.n_faces, 1))
    return replace(
        scene,
        emission=one,
        back_emission=one,
        reflectance=none,
        back_reflectance=none,
        bands=("grey",),
        reflectance_paint=None,
        emission_paint=None,
    )


def strangers() -> dict[str, Path]:
    """Name to path of the scenes that were found."""
    known = {"soda": STRANGERS / "soda.mgf", "office": STRANGERS / "office3" / "office.mgf"}
    return {name: path for name, path in known.items() if path.exists()}
