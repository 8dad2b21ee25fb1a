"""The modifiers of honeybee-radiance: ``Plastic``, ``Trans`` and ``Glass`` without gloss, and ``Light``."""

import numpy as np

from ..scene.clear_glass import of_mean
from ..scene.formats.color import luminance_weights
from .honeybee_layers import Layer
from .names import Identifiers
from .pieces import Piece
from .told import Told

SAME = 1e-12  # difference of shares that rounding makes
COLORS = ("r", "g", "b")


def modifier(layer: Layer, identifiers: Identifiers, watts: float, told: Told) -> dict:
    """Return the modifier of a layer.

    Args:
        watts: what emission is multiplied with.
    """
    piece = layer.piece
    if layer.is_lamp:
        kind, values = "Light", _colour("emittance", piece.emission * watts / np.pi)
    elif not layer.is_pane:
        kind, values = "Plastic", _colour("reflectance", piece.reflectance) | _flat()
    elif piece.refractive_index and not (piece.reflectance.any() or piece.diffuse.any()):
        kept = np.full(3, of_mean(piece.transmittance, piece.refractive_index))
        kind, values = "Glass", _colour("transmissivity", kept) | {"refraction_index": piece.refractive_index}
    else:
        kind, values = "Trans", _trans(piece, told)
    return {"type": kind, "identifier": identifiers.of(f"{piece.name} {kind.lower()}"), **values}


def _trans(piece: Piece, told: Told) -> dict:
    """What is not absorbed, by band, the share of it that goes through, and the share of that which goes straight on.

    Where shares differ from band to band, those of the luminance hold.
    """
    passed = piece.diffuse + piece.transmittance
    kept = piece.reflectance + passed
    weights = luminance_weights() if len(kept) == 3 else np.ones(1)
    share, straight = float(weights @ passed / (weights @ kept)), float(piece.transmittance / (weights @ passed))
    if np.abs(kept * share - passed).max() > SAME or np.abs(passed * straight - piece.transmittance).max() > SAME:
        told.add("panes reflect, diffuse and let through one colour, that of all three together", [piece.name])
    return _colour("reflectance", kept) | _flat() | {"transmitted_diff": min(share, 1.0), "transmitted_spec": min(straight, 1.0)}


def _flat() -> dict:
    return {"specularity": 0.0, "roughness": 0.0}


def _colour(what: str, values: np.ndarray) -> dict:
    return {f"{letter}_{what}": value for letter, value in zip(COLORS, np.broadcast_to(values, (3,)).tolist(), strict=True)}
