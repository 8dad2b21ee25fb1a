"""Layers of pieces for honeybee, whose surfaces have two equal sides, and whose lamps shine from one side and are black."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..scene.model import Back, Scene
from .pieces import BEHIND, Piece, pieces, turned
from .told import Told


@dataclass(frozen=True, eq=False)
class Layer:
    """A piece that looks alike from both sides, or one that shines from its front and is black otherwise.

    Attributes:
        piece: name, faces and values; those of its back do not count.
        is_lamp: it shines.
        is_back: it lies a little behind the front.
    """

    piece: Piece
    is_lamp: bool = False
    is_back: bool = False

    @property
    def is_pane(self) -> bool:
        """Return whether it lets light through."""
        return not self.is_lamp and bool(self.piece.transmittance or self.piece.diffuse.any())


def layers(scene: Scene, gap: float, told: Told) -> Iterator[Layer]:
    """Yield the layers of a scene.

    Args:
        gap: metres between the two layers of a piece, for what is told.
    """
    for piece in pieces(scene, told, backs="kept"):
        radiates = piece.back == Back.RADIATES
        if piece.emission.any() or (radiates and piece.back_emission.any()):
            yield from _lamp(scene, piece, gap, told)
        elif not radiates:
            told.add("one-sided surfaces read back as two-sided", [piece.name])
            yield Layer(piece)
        elif (piece.reflectance == piece.back_reflectance).all():
            yield Layer(piece)
        elif piece.transmittance or piece.diffuse.any():
            told.add("backs that reflect or emit otherwise get the values of their fronts", [piece.name])
            yield Layer(piece)
        else:
            yield Layer(piece)
            yield _behind(scene, piece, gap, told)


def _lamp(scene: Scene, piece: Piece, gap: float, told: Told) -> Iterator[Layer]:
    """Yield a lamp, and what is on its other side."""
    radiates = piece.back == Back.RADIATES
    behind = radiates and bool(piece.back_emission.any())
    sides = ((piece.emission, piece.reflectance), (piece.back_emission * radiates, piece.back_reflectance))
    if any(light.any() and reflected.any() for light, reflected in sides):
        told.add("lamps become black, since honeybee's reflect nothing", [piece.name])
    if piece.transmittance or piece.diffuse.any():
        told.add("panes that shine become opaque", [piece.name])
    if piece.back == Back.PASSES:
        told.add("backs that let lines pass become backs that absorb", [piece.name])
    opaque = replace(piece, transmittance=0.0, refractive_index=0.0, diffuse=0 * piece.diffuse)
    if not piece.emission.any() and not piece.reflectance.any():
        told.add("lamps that shine from their backs alone are turned round", [piece.name])
        yield Layer(_turned(opaque, piece.name), is_lamp=True)
        return
    yield Layer(opaque, is_lamp=bool(piece.emission.any()))
    if behind or (radiates and piece.back_reflectance.any()):
        yield _behind(scene, opaque, gap, told)


def _behind(scene: Scene, piece: Piece, gap: float, told: Told) -> Layer:
    """The back of a piece as a surface of its own."""
    told.add(f"sides that differ become two surfaces, {gap:.2g} m apart, the second called NAME{BEHIND}", [piece.name])
    name = piece.name + BEHIND
    while name in scene.names:
        name += BEHIND
    return Layer(_turned(piece, name), is_lamp=bool(piece.back_emission.any()), is_back=True)


def _turned(piece: Piece, name: str) -> Piece:
    """A piece that looks the other way, with the values of its back."""
    return replace(
        piece,
        name=name,
        corners=turned(piece.corners),
        reflectance=np.array(piece.back_reflectance),
        emission=np.array(piece.back_emission),
    )
