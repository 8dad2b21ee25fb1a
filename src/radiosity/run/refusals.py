"""Refusals: which methods solve which scenes, by what the scene has that their lines do not follow."""

import numpy as np

from ..errors import MethodError, shown
from ..method import Auto, Baseline, Method
from ..patches import Patches
from ..problem.model import Problem
from ..scene.model import Back, Scene

SHOOTING = ("firing", "walks")  # algorithms whose lines carry power from the patches where they begin


def refuse_cut(patches: Patches, method: Method | Baseline | Auto) -> None:
    """Raise where patches follow the light and the method makes a mesh of its own."""
    if patches.scene.cut is not None:
        refuse_hierarchical(method)


def refines(method: Method | Baseline | Auto) -> bool:
    """Return whether a method refines patches by itself."""
    return isinstance(method, Baseline) and method.scheme == "hierarchical"


def refuse_hierarchical(method: Method | Baseline | Auto) -> None:
    """Raise where a method refines patches by itself."""
    if refines(method):
        raise MethodError(
            "hierarchical radiosity refines its patches by itself, from whole faces: give it the scene, or patches by size or "
            "cells, and no mesh that follows the light"
        )


def refuse_open(scene: Scene, method: Method | Baseline) -> None:
    """Raise where a scene has open lamps and the method cannot solve it.

    An open lamp is seen together with what is behind it. Only lines that carry power from their patch tell the two apart.
    """
    if method.machine in SHOOTING or not (scene.back == Back.OPEN).any():
        return
    names = shown([scene.names[i] for i in np.unique(scene.surface[scene.back == Back.OPEN])])
    raise MethodError(
        f"lines pass through the lamps {names} (null BSDF), and only walks that begin at the lights follow them: "
        "take --method random-walk, or give the lamps a black diffuse BSDF"
    )


def refuse_panes(scene: Scene, method: Method | Baseline) -> None:
    """Raise where a scene has panes and the method cannot solve it.

    Global lines pair the two sides of what they cross, and do not go on through panes. Some algorithms do not send light on from
    the other side of a face.
    """
    if isinstance(method, Method):
        clear = "" if method.lines == "local" else f"lines '{method.lines}' pair the faces on both sides of a pane"
        one_sided = method.machine in ("multipath", "pooling") or method.absorption == "fractional"
    else:
        clear, one_sided = "", method.scheme == "hierarchical"
    glass = "" if isinstance(method, Method) else "form factors of baselines have one transmittance for all angles"
    diffuse = f"method {method} sends no light on from the other side of a face" if one_sided else ""
    for some, key, reason in (
        (scene.panes, "transmittance", clear),
        (scene.diffusers, "diffuse_transmittance", diffuse),
        (np.zeros(1, bool) if scene.refractive_index is None else scene.refractive_index > 0, "refractive_index", glass),
    ):
        if reason and some.any():
            names = shown([scene.names[i] for i in np.unique(scene.surface[some])])
            raise MethodError(
                f"{scene.source}: {names} let light through ({key}), and {reason}: take local lines, such as --method random-walk"
            )


def refuse_depth_first(problem: Problem, method: Method | Baseline) -> None:
    """Raise where walks are followed one by one, and lines of a wavefront carry unlike powers."""
    bands = problem.groups.n_groups
    if method.order != "depth-first":
        return
    if problem.rows.lines is not None:
        raise MethodError(
            "order 'depth-first' cannot send more lines through openings, each with less power: take breadth-first, or leave "
            "out the openings"
        )
    if bands > 1 and method.machine == "firing":
        raise MethodError(
            f"order 'depth-first' cannot carry {bands} different bands: "
            "band power travels with whole wavefronts; take breadth-first, or solve one band at a time"
        )
