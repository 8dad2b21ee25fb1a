"""Radiance's materials of surfaces.

- ``plastic`` without gloss reflects alike on both sides.
- ``BRTDfunc`` of constants has a reflectance for each side, and lets light through straight on and diffusely, band by band.
- ``trans`` does so where the shares are those of all bands, and ``glass`` is clear glass of an index of refraction.
- ``light`` shines and reflects nothing. A lamp that reflects or lets light through is an ``illum``: light that comes to it meets
  the alternate material, and without one it passes. Radiance itself leaves out diffuse light that comes to an illum's front.
"""

import numpy as np

from ..scene.clear_glass import of_mean
from ..scene.model import Back
from .pieces import Piece
from .told import Told

SAME = 1e-12  # relative difference of shares that rounding makes


def material(name: str, piece: Piece, watts: float, told: Told) -> str:
    """Return the statements that define the material of a piece.

    Args:
        watts: what emission is multiplied with.
    """
    if not piece.emission.any():
        if piece.back in (Back.ABSORBS, Back.PASSES):
            told.add("one-sided surfaces read back as two-sided", [piece.name])
            return _statement("plastic", name, [*_three(piece.reflectance), 0, 0])
        return _reflecting(name, piece, piece.back_reflectance)
    light = [value * watts / np.pi for value in _three(piece.emission)]
    if piece.back == Back.OPEN:
        return _statement("illum", name, light, ("void",))
    behind = piece.back_reflectance if piece.back == Back.RADIATES else 0 * piece.reflectance
    if piece.back == Back.PASSES:
        told.add("backs that let lines pass become backs that absorb", [piece.name])
    through = piece.transmittance or piece.diffuse.any()
    if not (through or piece.reflectance.any() or behind.any()):
        return _statement("light", name, light)
    if piece.refractive_index:
        told.add("glass that shines gets one transmittance for all angles", [piece.name])
    told.add(
        "lamps that reflect or let light through do so when they are read here, and not to all light in Radiance", [piece.name]
    )
    other = f"{name}/unlit"
    return _reflecting(other, piece, behind, glass=False) + _statement("illum", name, light, (other,))


def _reflecting(name: str, piece: Piece, behind: np.ndarray, *, glass: bool = True) -> str:
    """What a piece reflects and lets through; its back reflects ``behind``."""
    front, diffuse, clear = piece.reflectance, piece.diffuse, piece.transmittance
    if glass and clear and piece.refractive_index and not (front.any() or behind.any() or diffuse.any()):
        kept = of_mean(clear, piece.refractive_index)
        return _statement("glass", name, [kept, kept, kept, piece.refractive_index])
    alike = (front == behind).all()
    if alike and not clear and not diffuse.any():
        return _statement("plastic", name, [*_three(front), 0, 0])
    kept, passed = front + diffuse + clear, diffuse + clear
    share, straight = passed / np.where(kept > 0, kept, 1), clear / np.where(passed > 0, passed, 1)
    if alike and np.ptp(share) <= SAME and np.ptp(straight) <= SAME:
        return _statement("trans", name, [*_three(kept), 0, 0, float(share[0]), float(straight[0])])
    words = ["0"] * 3 + [repr(clear)] * 3 + ["0"] * 3 + ["."]
    return _statement("BRTDfunc", name, [*_three(front), *_three(behind), *_three(diffuse)], words)


def _statement(kind: str, name: str, numbers, words=()) -> str:
    """A modifier of nothing: its words, no whole numbers, and its numbers."""
    text = " ".join([str(len(words)), *words])
    return f"\nvoid {kind} {name}\n{text}\n0\n{len(numbers)} {' '.join(f'{float(value)!r}' for value in numbers)}\n"


def _three(values: np.ndarray) -> list[float]:
    return np.broadcast_to(values, (3,)).tolist()
