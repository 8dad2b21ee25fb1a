"""Level surfaces seen from above: values on a grid of points, found by lines that look down on them."""

from dataclasses import dataclass

import numpy as np

from ..errors import MethodError
from ..image.lookup import Lookup
from ..image.quantity import choose
from ..patches.polynomials import Polynomials
from ..scene import Back, Scene
from ..scene.named import surfaces_called
from ..scene.up import up_axis, up_vector
from ..solution.model import Solution
from ..tracing.first_hits import first_hits
from .words import single

LEVEL = 0.999  # cosine of the steepest level surface
USUAL, LEAST = 3, 0.02  # plans, and the light on the least as a share of that on the first, where none is asked for
PIXELS = 220  # along the longer side
NEAR = 1e-4  # of the scene's reach: from so far above a surface lines look down on it


@dataclass(frozen=True, eq=False)
class Plan:
    """A level surface seen from above.

    Attributes:
        name: of the surface.
        height: m.
        values: (rows, columns), one number for all bands; NaN beside the surface, under what stands on it, and where it is
            unknown. Row 0 is the lowest of the second axis.
        unknown: (rows, columns) bool, where the value would be the 0 of a patch that no line met.
        extent: left, right, bottom and top, m.
        axes: names of the axes to the right and up.
        area: m², of the surface at this height.
    """

    name: str
    height: float
    values: np.ndarray
    unknown: np.ndarray
    extent: tuple[float, float, float, float]
    axes: tuple[str, str]
    area: float

    @property
    def seen(self) -> np.ndarray:
        """Return which places are of the surface, (rows, columns) bool."""
        return np.isfinite(self.values) | self.unknown

    @property
    def mean(self) -> float:
        """Return the mean over the surface, in which what no line met counts as 0: without it the mean would be too large."""
        return float(np.nan_to_num(self.values).mean(where=self.seen))


def plans(solution: Solution, wanted: tuple[str, ...]) -> list[Plan]:
    """Return plans of surfaces that are named, or of those that look up and receive most light.

    Raises:
        MethodError: no surface is called so, or it is nowhere level.
    """
    patches = solution.patches
    scene = patches.scene
    up = np.array(up_vector(scene))
    flat = (patches.normal @ up > LEVEL) & ~solution.sides.left_out
    height = np.round(patches.centroid @ up, 3)
    surfaces = list(dict.fromkeys(i for name in wanted for i in surfaces_called(scene.names, name)))
    if not surfaces:
        dark = flat & ~(patches.emission > 0).any(axis=1)  # lamps are no planes to work on
        usual = dark if dark.any() else flat
        light = np.maximum(single(scene, solution.irradiance[usual]), 0) * patches.area[usual]
        received = np.bincount(patches.surface[usual], light, len(scene.names))
        order = np.argsort(-received, kind="stable")[:USUAL]
        surfaces = [int(i) for i in order if received[i] > LEAST * received[order[0]]]
    found = []
    for surface in surfaces:
        own = flat & (patches.surface == surface)
        if not own.any():
            raise MethodError(f"no part of '{scene.names[surface]}' is level and looks up: there is no plan of it")
        levels, index = np.unique(height[own], return_inverse=True)
        areas = np.bincount(index, patches.area[own])
        found.append(_plan(solution, surface, float(levels[np.argmax(areas)]), own, float(areas.max())))
    return found


def _plan(solution: Solution, surface: int, level: float, own: np.ndarray, area: float) -> Plan:
    patches, scene = solution.patches, solution.patches.scene
    up, kind = np.array(up_vector(scene)), up_axis(scene)
    right, ahead = (np.eye(3)[0], np.eye(3)[1]) if kind == "z" else (np.eye(3)[0], -np.eye(3)[2])
    here = own & (np.abs(patches.centroid @ up - level) < 2e-3)
    corners = patches.corners[here].reshape(-1, 3)
    (left, end), (bottom, top) = [(float((corners @ axis).min()), float((corners @ axis).max())) for axis in (right, ahead)]
    step = max(end - left, top - bottom) / PIXELS
    columns, rows = (max(2, round(length / step)) for length in (end - left, top - bottom))
    x = left + (np.arange(columns) + 0.5) * (end - left) / columns
    y = bottom + (np.arange(rows) + 0.5) * (top - bottom) / rows
    points = (x[None, :, None] * right + y[:, None, None] * ahead + (level + NEAR * scene.reach) * up).reshape(-1, 3)
    hits = first_hits(scene, points, np.broadcast_to(-up, points.shape))
    values, others = single(scene, solution.irradiance)[:, None], solution.irradiance_coefficients
    light = None
    if others is not None:
        light = Polynomials(patches, solution.basis, values, single(scene, np.moveaxis(others, 1, 2))[:, None])
    seen, patch = Lookup(patches, values, light=light)(hits)
    on = (patch >= 0) & (patches.surface[patch] == surface) & (np.asarray(hits.distance) < 3 * NEAR * scene.reach + 2e-3)
    on &= ~((seen[:, 0] <= 0) & _covered(scene, points, up))
    unmet = choose(solution, "irradiance", single=True).unmet
    unknown = np.zeros(len(on), bool) if unmet is None else on & (seen[:, 0] <= 0) & unmet[patch]
    shown = np.where(on & ~unknown, np.maximum(seen[:, 0], 0), np.nan).reshape(rows, columns)
    axes, extent = ("x", "y" if kind == "z" else "-z"), (left, end, bottom, top)
    return Plan(scene.names[surface], level, shown, unknown.reshape(rows, columns), extent, axes, area)


def _covered(scene: Scene, points: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Return which points have a back that absorbs above them, (m,) bool: those inside of boxes are among them."""
    hits = first_hits(scene, points, np.broadcast_to(up, points.shape))
    face = np.asarray(hits.face, np.int64)
    return (face >= 0) & ~np.asarray(hits.front, bool) & (scene.back[face] == Back.ABSORBS)
