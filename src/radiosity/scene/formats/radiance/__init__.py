"""Read Radiance scene descriptions (.rad): surfaces, materials by their diffuse reflectance, lights, suns and skies.

A surface is identifier x material, ``desk/wood``. The material is the first one among its modifiers. Numbers at the end of an
identifier (``desk.1042``), by which generators tell faces apart, are left out. Radiance is taken as W/(m² sr); an emitter of
radiance L has the exitance pi L. Surfaces have two sides that are alike, and emit from the front only.
"""

import re
from pathlib import Path

import numpy as np

from ....errors import SceneError
from ...assemble import assemble
from ...lights.add import with_lights
from ...model import Scene
from ...parts import Material, Part, ReadOptions
from ..encoding import read_text
from ..faces import cut, warn_of_crossing
from ..mgf.faults import Faults
from . import told
from .materials import KINDS, Finisher
from .modifiers import PATTERNS, Defined, Modifiers, chain_of
from .primitives import Primitive, primitives
from .shapes import SHAPES, corners_of, curved, joined
from .sources import Sources
from .told import Told

NUMBERED = re.compile(r"(\.\d+)([.,]\d+)*$")
COMPILED = {"instance": "oct", "mesh": "rtm"}
Found = tuple[str, Defined | str | None]  # what names a surface, and its modifier


def read(path: Path, options: ReadOptions) -> Scene:
    """Read a .rad file.

    Raises:
        SceneError: a line that would run a command, text that is no statement, or no face.
    """
    reader = Reader(str(path), Faults(options.strict))
    for primitive in primitives(read_text(path).text, str(path)):
        reader.take(primitive)
    parts = reader.parts()
    reader.faults.warn()
    reader.told.warn(str(path), options.strict)
    if not parts:
        text = "Radiance reads several files as one, and here they must be one: cat materials.rad room.rad > all.rad"
        raise SceneError(f"{path}: holds no surfaces; {text}")
    return with_lights(assemble(parts, str(path), options), reader.sources.lights())


class Reader:
    """Takes the primitives of a file.

    Attributes:
        faults: primitives that make no sense, by line.
        told: what is taken in another way.
        sources: suns and skies.
    """

    def __init__(self, source: str, faults: Faults):
        self.faults, self.told, self.sources = faults, Told(), Sources()
        self._source = source
        self._modifiers = Modifiers()
        self._polygons: dict[Found, list[np.ndarray]] = {}
        self._materials: dict[Defined | str | None, str] = {}  # what a modifier's material is called
        self._curved: dict[Found, list[tuple[np.ndarray, np.ndarray]]] = {}

    def take(self, primitive: Primitive) -> None:
        """Take one primitive.

        Raises:
            SceneError: it is an octree or a mesh that was compiled.
        """
        kind, name = primitive.kind, primitive.name
        if kind in COMPILED:
            file = next((word for word in primitive.words if word.endswith(f".{COMPILED[kind]}")), "a compiled file")
            raise SceneError(
                f"{self._source}:{primitive.line}: {kind} '{name}' shows {file}, which is compiled and not read; put the .rad "
                "files that it was made of in its place (getinfo tells which), moved by xform"
            )
        if kind == "alias":
            if not self._modifiers.alias(primitive):
                self._fault(primitive, f"alias '{name}' stands for '{primitive.words[0]}', which is not defined")
        elif kind in KINDS or kind in PATTERNS:
            self._modifiers.define(primitive)
        elif kind == "source":
            self._guarded(primitive, self._source_of)
        elif kind in SHAPES:
            self._guarded(primitive, self._shape)
        else:
            self._fault(primitive, f"'{kind}' is no type of Radiance's primitives")
            self._modifiers.define(primitive)

    def _fault(self, primitive: Primitive, what: str) -> None:
        self.faults.add(f"{self._source}:{primitive.line}", what)

    def _guarded(self, primitive: Primitive, take) -> None:
        try:
            take(primitive)
        except ValueError as error:
            if isinstance(error, SceneError):
                raise
            self._fault(primitive, f"{error} ('{primitive.name}')")

    def _source_of(self, primitive: Primitive) -> None:
        self.sources.add(primitive, chain_of(self._modifiers.find(primitive.modifier)), self.told)

    def _shape(self, primitive: Primitive) -> None:
        modifier = self._modifiers.find(primitive.modifier)
        if modifier not in self._materials:
            material = chain_of(modifier).material
            self._materials[modifier] = primitive.modifier if material is None else material.name
        made_of = self._materials[modifier]
        # a surface that is called like its material has no number, even where its name ends in one
        thing = made_of if primitive.name == made_of else NUMBERED.sub("", primitive.name) or primitive.name
        place = thing if thing == made_of else f"{thing}/{made_of}", modifier
        if primitive.kind == "polygon":
            corners = corners_of(primitive)
            self._polygons.setdefault(place, []).append(corners)
        else:
            piece = curved(primitive)
            self._curved.setdefault(place, []).append(piece)

    def parts(self) -> list[Part]:
        """All surfaces, with their materials."""
        lights = self.sources.lights()
        finisher = Finisher(self._source, self.told, bool(lights), self._fault)
        materials: dict[Defined | str | None, Material | None] = {}
        crossed: dict[str, list[int]] = {}
        parts = []
        for place in dict.fromkeys([*self._polygons, *self._curved]):
            name, modifier = place
            if modifier not in materials:
                materials[modifier] = finisher.material(chain_of(modifier))
            material = materials[modifier]
            if material is None:
                self.told.add(told.VOID, name)
                continue
            pieces = list(self._curved.get(place, []))
            if rings := self._polygons.get(place):
                points = np.concatenate(rings)
                pieces.append((points, cut(points, np.array([len(ring) for ring in rings]), crossed.setdefault(name, []))))
            parts.append(Part(name, *joined(pieces), material))
        warn_of_crossing(self._source, crossed)
        return parts
