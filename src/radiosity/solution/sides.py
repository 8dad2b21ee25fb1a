"""Sides of surfaces: which of them light reached, and their rows in tables.

Faces of OBJ, PLY and STL files have two radiating sides. In a closed room one of them is the outside, which no line reaches: it
is *dark*. A mean over both sides would be half of what the room receives, so means of surfaces leave dark sides out.
"""

from dataclasses import dataclass

import numpy as np

from ..scene.dark_parts import dark_parts
from ..scene.model import Back
from ..scene.reached import Lit, lit_sides
from .intervals import FEW

FRONT, BACK, LIT = "front", "back", "lit"  # lit: fronts of some faces and backs of others, where a surface is wound both ways
ALL = "both"  # the sides of a surface that no line reached
_NAMES = {Lit.FRONT: FRONT, Lit.BACK: BACK, Lit.MIXED: LIT}


@dataclass(frozen=True, eq=False)
class Sides:
    """The sides of all surfaces, and the rows of tables: one for each surface, or two where both sides count.

    Attributes:
        dark: (n_patches,) bool, on a side of a face that no line reached, though lines reached its other side.
        left_out: (n_patches,) bool, in no row: on the dark side of a surface, or of parts of it, which emits nothing.
        surface: (n_rows,) int, index of the surface.
        side: (n_rows,) "front", "back" or "lit", and "both" where no line reached the surface.
        row: (n_patches,) int, the row of each patch; -1 where it is left out.
        dark_area: (n_rows,) m² that are left out: the other side, or where there are two rows the dark part of this side.
        whole: (n_rows,) bool, True where this row holds all that the surface receives.
    """

    dark: np.ndarray
    left_out: np.ndarray
    surface: np.ndarray
    side: tuple[str, ...]
    row: np.ndarray
    dark_area: np.ndarray
    whole: np.ndarray


def sides_of(solution) -> Sides:
    """The sides that lines reached (for methods that count no lines, the sides that received power)."""
    patches = solution.patches
    scene, n = patches.scene, len(patches.scene.names)
    two, surface, place = scene.back == Back.RADIATES, scene.surface, (patches.face, patches.is_back.astype(int))
    received = (np.nan_to_num(solution.irradiance) > 0).any(axis=1)
    # baselines count no lines, and their `few` is False everywhere: there every patch that receives power is reached for certain
    hits = np.where(received, solution.arrivals, 0) if solution.by_own_lines else solution.arrivals
    counts = np.where(solution.few | ~received, hits, np.maximum(hits, FEW))
    reached = np.zeros((scene.n_faces, 2))
    np.add.at(reached, place, counts)
    reached[scene.diffusers] = reached[scene.diffusers].sum(axis=1, keepdims=True)  # light that falls on one side leaves both
    kind = lit_sides(scene, reached, FEW)
    back_is_less = reached[:, 0] >= reached[:, 1]
    of_face, outside = kind[surface], np.zeros((scene.n_faces, 2), bool)
    outside[:, 0] = two & ((of_face == Lit.BACK) | (of_face == Lit.MIXED) & ~back_is_less)
    outside[:, 1] = two & ((of_face == Lit.FRONT) | (of_face == Lit.MIXED) & back_is_less)
    outside |= dark_parts(scene, reached, kind)
    dark = outside | (two[:, None] & (reached == 0) & (reached[:, ::-1] >= FEW))
    left_out = outside[place]
    shines = np.bincount(patches.surface[left_out & patches.emission.any(axis=1)], minlength=n) > 0
    kind[shines] = Lit.BOTH
    left_out &= ~shines[patches.surface]
    met = np.bincount(surface, reached.sum(axis=1), n) > 0
    double = (kind == Lit.BOTH) & (np.bincount(surface[two], minlength=n) > 0) & (met | shines)
    first = np.concatenate([[0], np.cumsum(np.where(double, 2, 1))])
    row = first[patches.surface] + np.where(double[patches.surface], patches.is_back, 0)  # also for patches that are left out
    rows = np.repeat(np.arange(n), np.diff(first))
    is_second = np.arange(first[-1]) > first[rows]
    unmet = ~double & (kind == Lit.BOTH) & (np.bincount(surface[two], minlength=n) > 0)
    names = tuple(
        BACK if second else ALL if unmet[s] else _NAMES.get(kind[s], FRONT) for s, second in zip(rows, is_second, strict=True)
    )
    area = np.bincount(row[left_out], patches.area[left_out], len(rows))
    return Sides(dark[place], left_out, rows, names, np.where(left_out, -1, row), area, ~double[rows])
