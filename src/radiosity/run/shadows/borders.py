"""Borders of shadows: where of two points beside each other one sees the middle of a light and the other does not."""

from dataclasses import dataclass

import numpy as np

from ...scene.model import Scene
from . import edges
from .lights import Light
from .receivers import Receivers, lit_by
from .sight import Sight

PAIRS = 1 << 16  # of such points at most, those with most light
HALVINGS = 9  # of the way between them
LINES = 2048  # edges at most, those that most light ends at


@dataclass(frozen=True, eq=False)
class Borders:
    """Edges that stop light on its way to sides, and the straight lines where their shadows end.

    Attributes:
        side: (m,) int64, numbers of sides of `Receivers`. light: (m,) int64.
        ends: (m, 2, 3) metres, in the planes of the sides: they may leave the faces.
    """

    side: np.ndarray
    light: np.ndarray
    ends: np.ndarray


def borders(scene: Scene, sight: Sight, receivers: Receivers, lights: list[Light]) -> tuple[Borders, np.ndarray]:
    """Return the edges that stop light, those first that most of it ends at, and the light of the points, (n_points,).

    The light is that of the middles of the strongest lights, mean of bands.
    """
    normals = receivers.normals(scene)
    one, two = receivers.neighbours()
    total = np.zeros(len(receivers.side))
    parts = []
    for number, (light, (some, light_of)) in enumerate(zip(lights, lit_by(scene, receivers, lights), strict=True)):
        side = receivers.side[some]
        met = sight.met(receivers.points[some], normals[side], receivers.face[side], light.middle)
        arriving, seen = np.zeros(len(total)), np.zeros(len(total), bool)
        arriving[some], seen[some] = light_of, met < 0
        total += arriving * seen
        differ = np.flatnonzero((arriving[one] > 0) & (arriving[two] > 0) & (seen[one] != seen[two]))
        pair = np.where(seen[one[differ]], (one[differ], two[differ]), (two[differ], one[differ]))
        worth = arriving[pair[0]] * receivers.reflectance[receivers.side[pair[0]]]
        parts.append((*pair, np.full(len(differ), number), worth))
    lit, dark, light, worth = (np.concatenate(column) for column in zip(*parts, strict=True))
    order = np.sort(np.argsort(-worth, kind="stable")[:PAIRS])
    return _edges(scene, sight, receivers, lights, *(column[order] for column in (lit, dark, light, worth))), total


def _edges(scene, sight: Sight, receivers: Receivers, lights: list[Light], lit, dark, light, worth) -> Borders:
    """Return the edges that lie between pairs of points, each with all of its shadow on a side."""
    side, places = receivers.side[lit], np.array([one.middle for one in lights]).reshape(-1, 4)[light]
    normals, face = receivers.normals(scene)[side], receivers.face[side]
    first, second, met = receivers.points[lit], receivers.points[dark], np.full(len(lit), -1)
    for _ in range(HALVINGS):
        middle = (first + second) / 2
        by = sight.met(middle, normals, face, places)
        first, second = np.where((by < 0)[:, None], middle, first), np.where((by < 0)[:, None], second, middle)
        met = np.where(by < 0, met, by)
    corners = scene.vertices[np.where(scene.faces < 0, scene.faces[:, 2:3], scene.faces)]
    edge = np.where(met >= 0, edges.crossed(places, first, second, corners[met]), -1)
    found = np.flatnonzero(edge >= 0)
    side, light, worth, met, edge, places = (x[found] for x in (side, light, worth, met, edge, places))
    keys, at, number = np.unique(np.stack([side, light, met, edge], axis=1), axis=0, return_index=True, return_inverse=True)
    order = np.argsort(-np.bincount(number.ravel(), worth, len(keys)), kind="stable")[:LINES]
    at = at[order]
    ends = np.stack([corners[met[at], edge[at]], corners[met[at], (edge[at] + 1) % 4]], axis=1)
    origin = scene.frames[0][receivers.face[side[at]]]
    ends, there = edges.shadow_of(places[at], ends, origin, receivers.normals(scene)[side[at]])
    return Borders(side[at][there], light[at][there], ends[there])
