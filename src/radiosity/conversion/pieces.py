"""Pieces of surfaces: faces of one surface with one material, which scene files hold."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..scene.model import Back, Scene
from ..scene.paint import Paint
from .told import Told

BEHIND = " (back)"  # added to the name of a surface for its backs, where they differ from the fronts


@dataclass(frozen=True, eq=False)
class Piece:
    """Faces of one surface with one material.

    Attributes:
        name: of the surface.
        number: of the piece within the surface, from 0.
        surface: index of the surface.
        rows: (k,) int, the faces.
        corners: (k, 4) int, their vertices as `Scene.faces` has them, turned round for backs.
        reflectance, emission: (n_bands,).
        back: what the back does.
        back_reflectance, back_emission: (n_bands,), where the back radiates.
        transmittance: of a pane.
        refractive_index: of clear glass, whose transmittance is the mean over diffuse light; 0 for none.
        diffuse: (n_bands,) diffuse transmittance.
    """

    name: str
    number: int
    surface: int
    rows: np.ndarray
    corners: np.ndarray
    reflectance: np.ndarray
    emission: np.ndarray
    back: Back
    back_reflectance: np.ndarray
    back_emission: np.ndarray
    transmittance: float
    refractive_index: float
    diffuse: np.ndarray


Backs = Literal["apart", "alike", "kept"]  # what becomes of backs with values of their own


def pieces(scene: Scene, told: Told, *, backs: Backs = "apart") -> list[Piece]:
    """Return the pieces of a scene, surface by surface.

    Args:
        backs: what becomes of backs that radiate with values of their own. "apart", where a format has one-sided faces: fronts
            and backs become two pieces, one-sided, at the same place, since lines meet the side that they come to. "alike": backs
            get the values of their fronts. "kept": pieces have both values.
    """
    radiates = scene.back == Back.RADIATES
    own = radiates & ((scene.back_reflectance != scene.reflectance) | (scene.back_emission != scene.emission)).any(axis=1)
    if backs == "kept":
        behind = np.column_stack([scene.back_reflectance, scene.back_emission]) * radiates[:, None]
        return _grouped(scene, np.arange(scene.n_faces), scene.reflectance, scene.emission, scene.back, behind, "")
    alike = own & (scene.panes | scene.diffusers | (backs == "alike"))  # a pane is one face: light goes through it once
    told.add("backs that reflect or emit otherwise get the values of their fronts", called(scene, alike))
    own &= ~alike
    back = np.where(own, Back.ABSORBS, scene.back)
    found = _grouped(scene, np.arange(scene.n_faces), scene.reflectance, scene.emission, back, None, "")
    rows = np.flatnonzero(own)
    if len(rows):
        told.add(
            f"backs that reflect or emit otherwise than their fronts become surfaces of their own, called NAME{BEHIND}",
            called(scene, own),
        )
        found += _grouped(scene, rows, scene.back_reflectance, scene.back_emission, back, None, BEHIND)
    return sorted(found, key=lambda piece: piece.surface)


def _through(scene: Scene) -> np.ndarray:
    """Return transmittance, index of refraction and diffuse transmittance of each face, (n_faces, 2 + n_bands)."""
    found = np.zeros((scene.n_faces, 2 + scene.n_bands))
    for at, value in ((0, scene.transmittance), (1, scene.refractive_index)):
        found[:, at] = 0 if value is None else value
    found[:, 2:] = 0 if scene.diffuse_transmittance is None else scene.diffuse_transmittance
    return found


def _grouped(scene: Scene, rows: np.ndarray, reflectance, emission, back, behind, tail: str) -> list[Piece]:
    """Return the pieces of some faces.

    Args:
        behind: (n_faces, 2 n_bands) reflectance and emission of backs; None: those of the fronts.
        tail: behind the names of backs that become pieces.
    """
    fronts, through = np.column_stack([reflectance, emission]), _through(scene)
    behind = fronts if behind is None else behind
    keys = np.column_stack([scene.surface, fronts, back, behind, through])[rows]
    _, first, index = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    index = index.reshape(-1)
    count: dict[int, int] = {}
    result = []
    for group in np.argsort(first, kind="stable"):  # in the order of the faces
        own = rows[index == group]
        face, surface = own[0], int(scene.surface[own[0]])
        number = count[surface] = count.get(surface, -1) + 1
        corners = scene.faces[own] if not tail else turned(scene.faces[own])
        name = scene.names[surface] + tail
        while tail and name in scene.names:
            name += tail
        front, rear = np.split(fronts[face], 2), np.split(behind[face], 2)
        kind, clear, refraction = Back(int(back[face])), float(through[face, 0]), float(through[face, 1])
        values = front[0], front[1], kind, rear[0], rear[1], clear, refraction, through[face, 2:]
        result.append(Piece(name, number, surface, own, corners, *values))
    return sorted(result, key=lambda piece: piece.surface)


def turned(faces: np.ndarray) -> np.ndarray:
    """Return faces, (k, 4), that run round the other way; a triangle keeps -1 in the last column."""
    return np.where(faces[:, 3:] >= 0, faces[:, [0, 3, 2, 1]], faces[:, [0, 2, 1, 3]])


def triangles(corners: np.ndarray) -> np.ndarray:
    """Return the triangles of faces as numbers of their corners, (m, 2) int: the row, and 0 to 3 three times, (m, 4)."""
    quad = corners[:, 3] >= 0
    order = np.concatenate([np.flatnonzero(~quad), np.repeat(np.flatnonzero(quad), 2)])
    halves = np.array([[0, 1, 2], [0, 2, 3]])
    which = np.concatenate([np.tile(halves[0], ((~quad).sum(), 1)), np.tile(halves, (quad.sum(), 1))])
    place = np.argsort(order, kind="stable")
    return np.column_stack([order, which])[place]


def painted(paint: Paint | None, rows: np.ndarray) -> bool:
    """Return whether any of the faces has an image or colours."""
    return paint is not None and bool(paint.painted[rows].any())


def tell_of_rest(scene: Scene, told: Told, holds: frozenset[str]) -> None:
    """Note what of a scene a format does not hold.

    Args:
        holds: of "backs", "cameras", "diffusing panes", "emission", "glass", "heat", "lights", "names", "open", "openings",
            "panes", "patch sizes", "reflectance", "sensors", "textures" and "units" what it holds.
    """
    every, lights = np.ones(scene.n_faces, bool), scene.lights
    radiates, lit = scene.back == Back.RADIATES, glowing(scene)
    paints = [paint.painted for paint in (scene.reflectance_paint, scene.emission_paint) if paint is not None]
    openings = [] if lights.openings is None else [f"opening {i}" for i in range(len(lights.openings))]
    shines = (scene.emission > 0).any(axis=1)
    single = shines & (~radiates | (scene.back_emission != scene.emission).any(axis=1))
    rest = (
        ("names", "surfaces become one, without their names", scene.names if len(scene.names) > 1 else ()),
        ("names", "the surface loses its name", scene.names if len(scene.names) == 1 else ()),
        ("reflectance", "reflectances are left out", called(scene, every)),
        ("emission", "emission is left out", lit),
        ("units", "emission in lm/m² reads back as W/m²", lit if scene.photometric else ()),
        ("backs", "one-sided surfaces read back as two-sided", called(scene, ~radiates)),
        (
            "backs",
            "lamps that shine to one side read back as shining alike to both",
            called(scene, single) if "emission" in holds else (),
        ),
        ("open", "lamps that lines pass absorb what comes to them", called(scene, (scene.back == Back.OPEN) & shines)),
        ("panes", "panes become opaque", called(scene, scene.panes)),
        ("diffusing panes", "diffusing panes become opaque", called(scene, scene.diffusers)),
        (
            "glass",
            "glass gets one transmittance for all angles",
            called(scene, scene.refractive_index > 0) if scene.refractive_index is not None and "panes" in holds else (),
        ),
        ("textures", "means take the place of textures and vertex colours", called(scene, np.any([~every, *paints], axis=0))),
        ("lights", "lights without area are left out", [light.name for light in lights.all]),
        ("openings", "openings for the sky are left out", openings),
        ("cameras", "cameras are left out", [f"camera {i}" for i in range(len(scene.cameras))]),
        ("sensors", "sensors are left out", [request.name for request in scene.sensors]),
        ("heat", "temperatures and emissivities are left out", scene.names if scene.heat is not None else ()),
        ("patch sizes", "patch sizes are left out", [scene.names[i] for i in np.flatnonzero(np.isfinite(scene.patch_size))]),
    )
    for what, text, names in rest:
        if what not in holds:
            told.add(text, names)


def glowing(scene: Scene) -> list[str]:
    """Return the names of the surfaces that emit."""
    behind = (scene.back == Back.RADIATES)[:, None] & (scene.back_emission > 0)
    return called(scene, ((scene.emission > 0) | behind).any(axis=1))


def called(scene: Scene, mask: np.ndarray) -> list[str]:
    """Return the names of the surfaces of these faces."""
    return [scene.names[i] for i in np.unique(scene.surface[mask])]
