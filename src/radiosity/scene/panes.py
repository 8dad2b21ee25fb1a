"""Panes: faces that let light through, from either side. Their transmittances are checked here.

A clear share goes straight on. A diffusing share leaves the other side like light that is reflected there, in all directions.
"""

from collections.abc import Sequence

import numpy as np

from ..errors import SceneError
from . import arguments
from .back import Back
from .clear_glass import mean_share

HIGHEST = 4.0  # index of refraction
ROUNDING = 1e-9  # of a transmittance
LEAVE_OUT = "what lets all light through is not there: leave the surface out"


def panes_or_none(transmittance: np.ndarray | None) -> np.ndarray | None:
    """Return transmittances of faces; None where no face is a pane."""
    return None if transmittance is None or not transmittance.any() else transmittance


def transmittances(given, n: int, source: str) -> np.ndarray | None:
    """Return the transmittance of each face, (n,) float64; None where no face is a pane.

    Raises:
        SceneError: another shape.
    """
    return _of_faces(given, n, "transmittance", source)


def indices(given, n: int, source: str) -> np.ndarray | None:
    """Return the index of refraction of each face, (n,) float64, 0 where it has none; None where no face has one.

    Raises:
        SceneError: another shape.
    """
    return _of_faces(given, n, "refractive_index", source)


def _of_faces(given, n: int, name: str, source: str) -> np.ndarray | None:
    if given is None:
        return None
    value = arguments.array(given, np.float64, name, source)
    if value.shape not in ((), (n,)):
        raise SceneError(
            f"{source}: {name} has shape {value.shape}; expected one number or ({n},): one for each face and all bands"
        )
    return panes_or_none(np.broadcast_to(value, (n,)).copy())


def check_glass(index: np.ndarray | None, transmittance: np.ndarray | None, others, surface, names, source) -> None:
    """Refuse indices of refraction out of range, and glass that lets nothing through, or does anything else to light.

    Args:
        index: (n_faces,) or None.
        others: (n_faces, n_bands) each, what must be 0 of glass.
    """
    if index is None:
        return
    through = np.zeros(len(index)) if transmittance is None else transmittance
    for face in np.flatnonzero(index != 0):
        where = f"{source}: refractive index of face {face} (surface '{names[surface[face]]}') is {index[face]:g}"
        if not 1 < index[face] <= HIGHEST:
            raise SceneError(f"{where}; it must lie above 1, up to {HIGHEST:g}, or be 0 for none")
        most = float(mean_share(1.0, float(index[face])))
        if not 0 < through[face] <= most + ROUNDING:
            text = f"glass of this index lets at most {most:.3f} of diffuse light through"
            raise SceneError(f"{where}, and its transmittance {through[face]:g}; {text}, and must let some")
        if any(value[face].any() for value in others):
            text = "clear glass reflects, emits and diffuses nothing here: set these to 0, or leave the index out"
            raise SceneError(f"{where}; {text}")


def diffuse_transmittances(given, n: int, source: str) -> np.ndarray | None:
    """Return the diffuse transmittance of each face, (n, 1) or (n, n_bands) float64; None where no face diffuses light.

    Raises:
        SceneError: another shape.
    """
    return None if given is None else panes_or_none(arguments.per_face(given, n, "diffuse_transmittance", source))


def of_all_faces(scenes, key: str, n_bands: int | None = None) -> np.ndarray | None:
    """Return the transmittances of the faces of several scenes; 0 for faces of scenes without panes. None where no face is one.

    Args:
        key: "transmittance" or "diffuse_transmittance".
        n_bands: None for one value for all bands.
    """
    found = []
    for scene in scenes:
        shape = (scene.n_faces,) if n_bands is None else (scene.n_faces, n_bands)
        value = getattr(scene, key)
        found.append(np.zeros(shape) if value is None else np.broadcast_to(value, shape))
    return panes_or_none(np.concatenate(found))


def check(
    transmittance: np.ndarray | None, back, reflectances: Sequence[np.ndarray], surface, names, source, diffuse=None
) -> None:
    """Refuse transmittances out of range, and sides that would give back more light than they get.

    Args:
        transmittance: (n_faces,) or None.
        reflectances: (n_faces, n_bands) of the fronts, then of the backs.
        diffuse: (n_faces, n_bands) diffuse transmittances, or None.
    """
    if diffuse is not None:
        _check_diffuse(diffuse, transmittance, back, reflectances, surface, names, source)
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


def _check_diffuse(diffuse: np.ndarray, transmittance, back, reflectances, surface, names, source) -> None:
    """Refuse diffuse transmittances out of range, on backs that do not radiate, or too large beside the other shares."""

    def refuse(wrong: np.ndarray, text) -> None:
        if wrong.any():
            face, band = np.argwhere(wrong)[0]
            where = f"face {face} (surface '{names[surface[face]]}', band {band})"
            raise SceneError(f"{source}: diffuse transmittance of {where} is {diffuse[face, band]:g}; {text(face, band)}")

    refuse(~((diffuse >= 0) & (diffuse < 1)), lambda face, band: "it must lie in [0, 1)")
    refuse(
        (diffuse > 0) & (back != Back.RADIATES)[:, None],
        lambda face, band: "what falls on one side leaves the other, so that both must radiate: make the face two-sided",
    )
    clear = np.zeros(len(diffuse)) if transmittance is None else transmittance
    for values, side in zip(reflectances, ("front", "back"), strict=True):
        total = values + diffuse + clear[:, None]
        refuse(
            (diffuse > 0) & ~(total < 1),
            lambda face, band, values=values, total=total, side=side: (
                f"with the reflectance {values[face, band]:g} of its {side} and the clear transmittance {clear[face]:g} the sum "
                f"is {total[face, band]:g}; it must be strictly below 1: the rest is absorbed"
            ),
        )
