"""The sides of two-sided surfaces that light reaches, found from the lines that hit each side of their faces."""

from enum import IntEnum

import numpy as np

from .model import Back, Scene

MANY = 30  # from this number of lines on one side of a face, its other side is dark where it has none
STRAY = 0.01  # largest share of the lines of a surface wound both ways that hit faces which few lines reached


class Lit(IntEnum):
    """The sides of a surface that are lit. It is one side alone where all lines hit that side."""

    BOTH = 0  # also where it is unknown, or the surface has one side
    FRONT = 1
    BACK = 2
    MIXED = 3  # one side of each face, fronts and backs: its faces are wound both ways


def lit_sides(scene: Scene, reached: np.ndarray, least: int) -> np.ndarray:
    """Return the `Lit` of each surface, (n_surfaces,).

    Args:
        reached: (n_faces, 2) lines that hit fronts and backs.
        least: from this number of lines on one side of a surface, the other side is dark where it has none.
    """
    two, n = scene.back == Back.RADIATES, len(scene.names)
    surface, here = scene.surface[two], reached[two]
    front, back = (np.bincount(surface, side, n) for side in here.T)
    twice = np.bincount(surface, here.min(axis=1), n)  # lines on faces that were reached on both sides
    stray = np.bincount(surface, np.where(here.max(axis=1) < MANY, here.sum(axis=1), 0), n)
    mixed = (front > 0) & (back > 0) & (twice == 0) & (stray <= STRAY * (front + back))
    return np.select(
        [(back == 0) & (front >= least), (front == 0) & (back >= least), mixed], [Lit.FRONT, Lit.BACK, Lit.MIXED], Lit.BOTH
    )
