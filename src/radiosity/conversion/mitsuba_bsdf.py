"""Mitsuba's BSDFs of surfaces: diffuse, of two sides or one, behind a mask where light goes straight through.

Clear glass is a ``thindielectric``, and a diffusing pane a ``principledthin``, which is not quite diffuse in Mitsuba.
"""

from collections.abc import Iterator

import numpy as np

from ..scene.formats.mitsuba.node import Node
from ..scene.formats.mitsuba.thin_pane import thin_pane
from ..scene.model import Back
from .mitsuba_tags import rgb
from .pieces import Piece
from .told import Told

SAME = 1e-12  # relative difference of shares that rounding makes


def bsdf(piece: Piece, told: Told) -> Iterator[str]:
    """Yield the lines of a BSDF."""
    if piece.back == Back.OPEN:
        yield '<bsdf type="null"/>'
        return
    if piece.back == Back.PASSES:
        told.add("backs that let lines pass become backs that absorb", [piece.name])
    radiates = piece.back == Back.RADIATES
    mirrors = piece.refractive_index and piece.transmittance and not piece.emission.any()
    if mirrors and not (piece.reflectance.any() or piece.back_reflectance.any() or piece.diffuse.any()):
        yield from _glass(piece)
        return
    solid = 1 - piece.transmittance
    if piece.transmittance:
        yield f'<bsdf type="mask"><float name="opacity" value="{solid!r}"/>'
    if piece.diffuse.any():
        yield from _diffusing(piece, solid, told)
    elif radiates:
        same = (piece.reflectance == piece.back_reflectance).all()
        sides = (piece.reflectance,) if same else (piece.reflectance, piece.back_reflectance)
        yield f'<bsdf type="twosided">{"".join(_diffuse(side / solid) for side in sides)}</bsdf>'
    else:
        yield _diffuse(piece.reflectance / solid)
    if piece.transmittance:
        yield "</bsdf>"


def _diffuse(reflectance: np.ndarray) -> str:
    return f'<bsdf type="diffuse">{rgb("reflectance", reflectance)}</bsdf>'


def _glass(piece: Piece) -> Iterator[str]:
    """A pane between whose sides as much is absorbed as brings its mean transmittance to that of the piece."""
    index = {"int_ior": piece.refractive_index, "ext_ior": 1.0}
    share = piece.transmittance / thin_pane(Node("BSDF", "thindielectric", "", "", index))
    yield '<bsdf type="thindielectric">'
    yield from (f'  <float name="{key}" value="{value!r}"/>' for key, value in index.items())
    yield f'  <float name="specular_transmittance" value="{min(share, 1.0)!r}"/></bsdf>'


def _diffusing(piece: Piece, solid: float, told: Told) -> Iterator[str]:
    """A sheet whose colour is that of what it reflects and of what it diffuses together, in one proportion."""
    told.add("diffusing panes are not quite diffuse in Mitsuba itself", [piece.name])
    whole = piece.reflectance + piece.diffuse
    share = float(piece.diffuse.mean() / whole.mean())
    if np.abs(piece.diffuse - share * whole).max() > SAME:
        told.add("diffusing panes reflect and let through the same colour, of both together", [piece.name])
    if (piece.reflectance != piece.back_reflectance).any():
        told.add("backs that reflect or emit otherwise get the values of their fronts", [piece.name])
    yield '<bsdf type="principledthin">'
    yield f"  {rgb('base_color', whole / solid)}"
    yield f'  <float name="diff_trans" value="{2 * share!r}"/></bsdf>'
