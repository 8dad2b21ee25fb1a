"""The surfaces of a honeybee model, with their materials."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from ....errors import SceneError, shown
from ...assemble import warn
from ...parts import Material, Part
from ..faces import CROSSING, cut, warn_of_crossing
from ..polygon import pierced
from ..radiance.materials import Finisher
from ..radiance.modifiers import Chain
from ..radiance.told import Told
from .modifiers import Modifiers, Role
from .schema import Aperture, Door, Face, Model, Named, Polygon, Shade, Shaded

UNITS = {"Meters": 1.0, "Centimeters": 0.01, "Millimeters": 0.001, "Feet": 0.3048, "Inches": 0.0254}  # metres
KINDS = {"Wall": ("wall", "wall_set"), "Floor": ("floor", "floor_set"), "RoofCeiling": ("ceiling", "roof_ceiling_set")}


class Reader:
    """Collects the surfaces of a model.

    Attributes:
        parts: found so far.
    """

    def __init__(self, source: str, model: Model):
        self.parts: list[Part] = []
        self._source, self._unit = source, UNITS[model.units]
        self._modifiers = Modifiers(model, source)
        self._told = Told()
        self._finisher = Finisher(source, self._told, False, lambda _, what: self._faults.update({what: None}))
        # names, by what is told of them
        self._faults: dict[str, None] = {}
        self._undefined: dict[str, None] = {}
        self._dynamic: dict[str, None] = {}
        self._void: dict[str, None] = {}
        self._reaching: dict[str, None] = {}
        light = model.properties.radiance
        self._luminaires = [str(one.get("identifier")) for one in (light and light.luminaires) or () if isinstance(one, dict)]
        self._crossed: dict[str, list[int]] = {}
        self._number: dict[str, int] = {}  # of the part that a face became
        self._second: dict[str, str] = {}  # the identifier of the first of a pair by that of the second

    def follow(self, model: Model) -> None:
        """Take all objects."""
        for room in model.rooms or ():
            of_room = room.light.modifier_set
            for face in room.faces:
                self._face(face, of_room, inward=True)
            self._shades(room, of_room)
        for face in model.orphaned_faces or ():
            self._face(face, None, inward=False)
        for aperture in model.orphaned_apertures or ():
            self._aperture(aperture, "Wall", None, inward=False)
        for door in model.orphaned_doors or ():
            self._door(door, "Wall", None, inward=False)
        for shade in model.orphaned_shades or ():
            role = ("", "context_modifier") if shade.is_detached else ("shade_set", "exterior_modifier")
            self._add("shade", shade, shade.geometry, None, role)
        for mesh in model.shade_meshes or ():
            role = ("", "context_modifier") if mesh.is_detached else ("shade_set", "exterior_modifier")
            faces = np.array([[*face, -1][:4] for face in mesh.geometry.faces], np.int64).reshape(-1, 4)
            vertices = np.array(mesh.geometry.vertices, float).reshape(-1, 3)
            self._part(mesh.called("shade"), vertices, faces, self._modifiers.of(mesh.light.modifier, None, role))

    def _face(self, face: Face, of_room: Named, *, inward: bool) -> None:
        """Take a face; ``inward``: it is turned, since faces of rooms look outward, and what is in the room matters."""
        self._shades(face, of_room)
        holes = [one.geometry.boundary for one in [*(face.apertures or ()), *(face.doors or ())]]
        if face.face_type in KINDS:
            kind, of = KINDS[face.face_type]
            role = (of, "exterior_modifier" if face.boundary_condition.type == "Outdoors" else "interior_modifier")
            if self._first(face):
                self._number[face.identifier] = len(self.parts)
                self._add(kind, face, face.geometry, of_room, role, holes=holes, inward=inward)
                if self._number[face.identifier] == len(self.parts):  # nothing is left between windows, or it is invisible
                    del self._number[face.identifier]
            else:
                self._other_side(face, self._modifiers.of(face.light.modifier, of_room, role))
        for aperture in face.apertures or ():
            self._aperture(aperture, face.face_type, of_room, inward=inward)
        for door in face.doors or ():
            self._door(door, face.face_type, of_room, inward=inward)

    def _aperture(self, aperture: Aperture, wall: str, of_room: Named, *, inward: bool) -> None:
        self._shades(aperture, of_room)
        if self._first(aperture):
            outside = "operable" if aperture.is_operable else "window" if wall == "Wall" else "skylight"
            which = "interior" if aperture.boundary_condition.type == "Surface" else outside
            self._add("aperture", aperture, aperture.geometry, of_room, ("aperture_set", f"{which}_modifier"), inward=inward)

    def _door(self, door: Door, wall: str, of_room: Named, *, inward: bool) -> None:
        self._shades(door, of_room)
        if self._first(door):
            which = "interior" if door.boundary_condition.type == "Surface" else "exterior"
            which = f"{which}_glass" if door.is_glass else which
            which = "overhead" if which == "exterior" and wall != "Wall" else which
            self._add("door", door, door.geometry, of_room, ("door_set", f"{which}_modifier"), inward=inward)

    def _shades(self, holder: Shaded, of_room: Named) -> None:
        for shades, side in ((holder.indoor_shades, "interior"), (holder.outdoor_shades, "exterior")):
            for shade in shades or ():
                self._add("shade", shade, shade.geometry, of_room, ("shade_set", f"{side}_modifier"))

    def _first(self, one: Face | Aperture | Door) -> bool:
        """Return whether an object is the first of a pair of adjacent ones, or has no other."""
        condition = one.boundary_condition
        if condition.type == "Surface" and condition.boundary_condition_objects:
            if one.identifier in self._second:
                return False
            self._second[condition.boundary_condition_objects[0]] = one.identifier
        return True

    def _other_side(self, face: Face, chain: Chain) -> None:
        """Give the first face of a pair, whose back looks into the room of the second one, the second one's reflectance there."""
        number = self._number.get(self._second[face.identifier])
        material = self._material(f"the other side of {self._second[face.identifier]}", chain)
        if number is not None and material is not None:
            one = self.parts[number].material
            opaque = not any(m.transmittance or m.diffuse_transmittance for m in (material, one))
            if material.reflectance != one.reflectance and opaque:
                both = replace(one, back_reflectance=material.reflectance)
                self.parts[number] = replace(self.parts[number], material=both)

    def _add(
        self,
        kind: str,
        one: Shade | Shaded,
        shape: Polygon,
        of_room: Named,
        role: Role,
        *,
        holes: Iterable = (),
        inward: bool = False,
    ) -> None:
        name = one.called(kind)
        if one.light.dynamic_group_identifier is not None:
            self._dynamic[name] = None
        outline = np.array(shape.boundary, float)[:: -1 if inward else 1]
        inside = [np.array(hole, float) for hole in [*(shape.holes or ()), *holes]]
        if inside:
            vertices, triangles, difference = pierced(outline, inside)
            faces = np.column_stack([triangles, np.full(len(triangles), -1)])
            if difference > CROSSING:
                self._reaching[name] = None
        else:
            vertices, faces = outline, cut(outline, np.array([len(outline)]), self._crossed.setdefault(name, []))
        self._part(name, vertices, faces, self._modifiers.of(one.light.modifier, of_room, role))

    def _material(self, name: str, chain: Chain) -> Material | None:
        if chain.undefined:
            self._undefined |= dict.fromkeys(chain.undefined)
            return Material()
        material = self._finisher.material(chain)
        if material is None:
            self._void[name] = None
        return material

    def _part(self, name: str, vertices: np.ndarray, faces: np.ndarray, chain: Chain) -> None:
        material = self._material(name, chain)
        if material is not None and len(faces):
            self.parts.append(Part(name, vertices * self._unit, faces, material))

    def warn(self, strict: bool) -> None:
        """Give one warning a kind of thing that is left out or taken in another way.

        Raises:
            SceneError: something is left out, and ``strict``.
        """
        kinds = {
            "modifiers that the model does not define": self._undefined,
            "surfaces whose modifier is void are invisible, and left out": self._void,
            "modifiers with numbers that make no sense, taken as if there were none": self._faults,
            "luminaires are left out; name their files as [[luminaire]] in a .toml": self._luminaires,
            "windows and doors overlap or reach out of their wall, which may be cut in another way than meant": self._reaching,
            "objects of dynamic groups keep the modifier of their first state": self._dynamic,
        }
        for text, names in kinds.items():
            if names and strict:
                raise SceneError(f"{self._source}: {text}: {shown(names)}; change that, or read the file without strict")
            if names:
                warn(f"{self._source}: {text}: {shown(names)}")
        self._told.warn(self._source, strict)
        warn_of_crossing(self._source, self._crossed)
