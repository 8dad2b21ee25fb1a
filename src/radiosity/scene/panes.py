"""Panes: faces that let a share of the light go straight on, from either side. Their transmittances are checked here."""

from collections.abc import Iterable

import numpy as np

from ..errors import SceneError
from . import arguments
from .back import Back

LEAVE_OUT = "what lets all light through is not there: leave the surface out"


def panes_or_none(transmittance: np.ndarray | None) -> np.ndarray | None:
    """Return transmittances of faces; None where no face is a pane."""
    return None if transmittance is None or not transmittance.any() else transmittance


def transmittances(given, n: int, source: str) -> np.ndarray | None:
    """Return the transmittance of each face, (n,) float64; None where no face is a pane.

    Raises:
        SceneError: another shape.
    """
    if given is None:
        return None
    value = arguments.array(given, np.float64, "transmittance", source)
    if value.shape not in ((), (n,)):
        raise SceneError(
            f"{source}: transmittance has shape {value.shape}; expected one number or ({n},): one for each face and all bands"
        )
    return panes_or_none(np.broadcast_to(value, (n,)).copy())


def check(transmittance: np.ndarray | None, back, reflectances: Iterable[np.ndarray], surface, names, source) -> None:
    """Refuse transmittances out of range, and sides that would give back more light than they get.

    Args:
        transmittance: (n_faces,) or None.
        reflectances: (n_faces, n_bands) of the fronts, then of the backs.
    """
    if transmittance is None:
        return

    def refuse(wrong: np.ndarray, text) -> None:
        if wrong.any():
            face = int(np.argmax(wrong))
            where = f"face {face} (surface '{names[surface[face]]}')"
            raise SceneError(f"{source}: transmittance of {where} is {transmittance[face]:g}; {text(face)}")

    refuse(transmittance == 1, lambda face: f"it must lie in [0, 1): {LEAVE_OUT}")
    refuse(~((transmittance >= 0) & (transmittance < 1)), lambda face: "it must lie in [0, 1)")
    refuse(
        (transmittance > 0) & (back == Back.OPEN),
        lambda face: "its back is open, so that all lines pass already; leave the transmittance out, or choose another back",
    )
    for values, side, there in zip(reflectances, ("front", "back"), (True, back == Back.RADIATES), strict=True):
        highest = values.max(axis=1)
        refuse(
            (transmittance > 0) & there & (highest + transmittance >= 1),
            lambda face, values=highest, side=side: (
                f"with the reflectance {values[face]:g} of its {side} the sum is {values[face] + transmittance[face]:g}; it must "
                "be strictly below 1: the rest is absorbed"
            ),
        )
