"""View3D's geometry (.vs3): a surface for each side that radiates, with its emissivity. Numbers keep all their digits.

Surfaces of View3D radiate from their fronts alone. A surface of two sides becomes two at the same place. Faces after the first of
a surface are combined with it. View3D wants obstructions behind all surfaces, and no emissivity of 0.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import printable
from ..scene.formats.vs3 import OBSTRUCTION
from ..scene.model import Back, Scene
from ..solution.whole import whole_file
from .names import unique_names, word
from .pieces import Piece, called, pieces, tell_of_rest, turned
from .plain import plain
from .told import Told

HOLDS = frozenset({"names", "reflectance", "backs", "heat"})
BEHIND = "_(back)"  # added to the name of a surface for its back: names have no blanks
LEAST = 1e-3  # emissivity: View3D takes this in place of smaller ones


def write(scene: Scene, path: Path, told: Told) -> None:
    """Write the file.

    Raises:
        OutputError: it cannot be written.
    """
    tell_of_rest(scene, told, HOLDS)
    told.add("backs that let lines pass become backs that absorb", called(scene, scene.back == Back.PASSES))
    if scene.heat is not None:
        given = np.isfinite(scene.heat.temperature) | np.isfinite(scene.heat.flux) | scene.heat.isothermal
        told.add("temperatures and heat flows are left out", [scene.names[i] for i in np.flatnonzero(given)])
        around = scene.heat.surroundings
        told.add("the temperature of the surroundings is left out", [] if around is None else [f"{around:g} K"])
    whole = pieces(plain(scene, of_surfaces=True), told, backs="kept")
    obstructing = [piece for piece in whole if _obstructs(scene, piece, whole)]
    sides = [side for piece in whole if piece not in obstructing for side in _sides(scene, piece, told)]
    names = unique_names([side for side, _ in sides] + obstructing, told, _name)
    places, vertex = np.unique(scene.vertices, axis=0, return_inverse=True)  # faces share corners
    vertex, number = np.append(vertex.reshape(-1) + 1, 0), 0  # no fourth corner, -1, is 0
    with whole_file(path) as file:
        file.write(f"T {printable(' '.join(path.stem.split()))}, written by radiosity\nF 3\n".encode())
        file.write("".join(f"V {i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(places.tolist(), 1)).encode())
        for (side, emissivity), name in zip(sides, names, strict=False):
            first = number + 1
            for corners in vertex[side.corners].tolist():
                number += 1
                combined = 0 if number == first else first
                file.write(f"S {number} {' '.join(map(str, corners))} 0 {combined} {emissivity!r} {name}\n".encode())
        for piece in obstructing:
            for corners in vertex[piece.corners].tolist():
                number += 1
                file.write(f"O {number} {' '.join(map(str, corners))}\n".encode())
        file.write(b"End of data\n")


def _obstructs(scene: Scene, piece: Piece, whole: list[Piece]) -> bool:
    """Return whether a piece is what the reader makes of obstructions: all of a black surface of their name."""
    if piece.name != OBSTRUCTION:
        return False
    black = piece.back == Back.RADIATES and not (piece.reflectance.any() or piece.back_reflectance.any() or piece.diffuse.any())
    known = scene.heat is not None and scene.heat.emissivity[piece.surface] is not None
    alone = sum(one.surface == piece.surface for one in whole) == 1
    return black and not known and not piece.transmittance and alone


def _sides(scene: Scene, piece: Piece, told: Told) -> Iterator[tuple[Piece, float]]:
    """Yield the sides of a piece that are surfaces, each as a front, and their emissivities."""
    yield piece, _emissivity(scene, piece, "front", piece.reflectance, told)
    if piece.back == Back.RADIATES:
        told.add(f"surfaces of two sides become two, the second called NAME{BEHIND}", [piece.name])
        name = piece.name + BEHIND
        while name in scene.names:
            name += BEHIND
        back = replace(piece, name=name, corners=turned(piece.corners))
        yield back, _emissivity(scene, piece, "back", piece.back_reflectance, told)


def _emissivity(scene: Scene, piece: Piece, side: str, reflectance: np.ndarray, told: Told) -> float:
    """Return the emissivity of a side: that of heat, or 1 - reflectance."""
    given = None if scene.heat is None else scene.heat.emissivity[piece.surface]
    given = given.get(side) if isinstance(given, dict) else given
    values = 1 - reflectance if given is None else np.array(given, float)
    if np.ptp(values) > 0:
        told.add("bands become one, of the mean of their emissivities", [piece.name])
    value = float(values[0] if np.ptp(values) == 0 else values.mean())
    if given is not None and not np.allclose(1 - value, reflectance, atol=1e-9):
        told.add("reflectances read back as 1 - emissivity", [piece.name])
    if value < LEAST:
        told.add(f"emissivities below {LEAST:g} become {LEAST:g}, the least that View3D takes", [piece.name])
    return max(value, LEAST)


def _name(name: str) -> str:
    return word(name.replace(",", "_"))
