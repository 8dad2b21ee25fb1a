"""Which sides of two-sided surfaces light reaches, by the lines that met each side of their faces."""

from enum import IntEnum

import numpy as np

from .model import Back, Scene

MANY = 30  # lines on a face, from which on none on its other side says that it is dark
STRAY = 0.01  # of the lines of a surface wound both ways at most meet faces that few lines reached


class Lit(IntEnum):
    """The sides of a surface that are lit. One side alone is so where all lines met it."""

    BOTH = 0  # or it is not known, or the surface has one side
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
