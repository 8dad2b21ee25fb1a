"""Pieces for formats whose lamps shine from their fronts alone."""

from dataclasses import dataclass, replace

import numpy as np

from ..scene.model import Back, Scene
from .pieces import BEHIND, Piece, pieces, turned
from .told import Told

GAP = 2e-5  # of the largest coordinate, between the two sides of a lamp: what single precision tells apart


@dataclass(frozen=True, eq=False)
class Sheet:
    """A piece that emits from its front alone, with vertices of its own.

    Attributes:
        piece: name and values; what its back does is kept, but for emission.
        vertices: (n, 3) metres.
        faces: (k, 4) int, as `Scene.faces` has them.
        vertex: (n,) int, the numbers of the vertices in the scene.
    """

    piece: Piece
    vertices: np.ndarray
    faces: np.ndarray
    vertex: np.ndarray


def sheets(scene: Scene, told: Told) -> list[Sheet]:
    """Return the pieces of a scene as sheets.

    A lamp that shines to both sides becomes two sheets, a hair apart, so that every program meets the side that it comes to. One
    that shines from its back alone is turned round.
    """
    gap = gap_of(scene)
    result = []
    for piece in pieces(scene, told, backs="kept"):
        if not (piece.back == Back.RADIATES and piece.back_emission.any()):
            result.append(sheet(scene, piece, 0.0))
        elif not piece.emission.any():
            told.add("lamps that shine from their backs alone are turned round", [piece.name])
            result.append(sheet(scene, _behind(piece, piece.name), 0.0))
        elif piece.transmittance or piece.diffuse.any():
            told.add("panes that shine to both sides shine from their fronts alone", [piece.name])
            result.append(sheet(scene, replace(piece, back_emission=0 * piece.emission), 0.0))
        else:
            text = f"lamps that shine to both sides become two surfaces, {gap:.2g} m apart, the second called NAME{BEHIND}"
            told.add(text, [piece.name])
            result.append(sheet(scene, replace(piece, back_emission=0 * piece.emission), 0.0))
            result.append(sheet(scene, _behind(piece, piece.name + BEHIND), gap))
    return result


def gap_of(scene: Scene) -> float:
    """Return the distance, m, between what would lie at the same place."""
    return GAP * float(np.abs(scene.vertices).max())


def _behind(piece: Piece, name: str) -> Piece:
    """A piece turned round: its front is what was its back."""
    return replace(
        piece,
        name=name,
        corners=turned(piece.corners),
        reflectance=piece.back_reflectance,
        emission=piece.back_emission,
        back_reflectance=piece.reflectance,
        back_emission=0 * piece.emission,
    )


def sheet(scene: Scene, piece: Piece, gap: float) -> Sheet:
    """Return a piece with its vertices; those of a back are moved away from the front where ``gap`` is not 0, face by face."""
    used = piece.corners >= 0
    if gap:
        corner, row = piece.corners[used], np.nonzero(used)[0]
        faces = np.full(piece.corners.shape, -1)
        faces[used] = np.arange(len(corner))
        return Sheet(piece, scene.vertices[corner] - gap * scene.normal[piece.rows][row], faces, corner)
    vertex, index = np.unique(piece.corners[used], return_inverse=True)
    faces = np.full(piece.corners.shape, -1)
    faces[used] = index.reshape(-1)
    return Sheet(piece, scene.vertices[vertex], faces, vertex)
