"""The named contexts of an MGF description: colours, materials and vertices."""

from dataclasses import dataclass, field, replace
from math import inf, isfinite

from .faults import decode

NEUTRAL = (1 / 3, 1 / 3)


@dataclass(frozen=True)
class MgfMaterial:
    """A material: values and (x, y) colours as the file gives them; the default is a two-sided black absorber."""

    reflectance: float = 0.0
    reflectance_color: tuple[float, float] = NEUTRAL
    emittance: float = 0.0  # lm/m²
    emittance_color: tuple[float, float] = NEUTRAL
    transmittance: float = 0.0  # specular: light goes straight on
    transmittance_color: tuple[float, float] = NEUTRAL
    diffuse_transmittance: float = 0.0
    diffuse_transmittance_color: tuple[float, float] = NEUTRAL
    not_diffuse: bool = False  # rs is not zero
    one_sided: bool = False
    defined: bool = True
    file: str = field(default="", compare=False)  # that sets the reflectance


class NamedContexts:
    """Colours, materials and vertices by name, and which are current; the name None is the unnamed context.

    Handlers take the words of a statement and raise ValueError or KeyError where it makes no sense.

    Attributes:
        points: vertex positions as given, before transformation; a vertex is a number in this list.
        material: the current material.
        file: where the statements come from.
        changed: the current material is another one since this was last set to False.
    """

    def __init__(self):
        self.file = ""
        self.points: list[tuple[float, ...]] = [(0.0, 0.0, 0.0)]
        self.vertices: dict[bytes | None, int] = {None: 0}
        self.changed = True
        self._colors: dict[bytes | None, tuple[float, float]] = {None: NEUTRAL}
        self._materials: dict[bytes | None, MgfMaterial] = {None: MgfMaterial()}
        self._color: bytes | None = None
        self._material: bytes | None = None
        self._vertex: bytes | None = None
        self.handlers = {
            b"p": self._set_point,
            b"v": self._get_vertex,
            b"c": self._get_color,
            b"cxy": self._set_chromaticity,
            b"m": self._get_material,
            b"sides": self._set_sides,
            b"rd": self._set_reflectance,
            b"ed": self._set_emittance,
            b"rs": self._set_not_diffuse,
            b"td": self._set_diffuse_transmittance,
            b"ts": self._set_transmittance,
        }

    @property
    def material(self) -> MgfMaterial:
        return self._materials[self._material]

    @property
    def material_name(self) -> str:
        return "unnamed" if self._material is None else decode(self._material)

    def _get(self, table: dict, words: list[bytes], default) -> bytes | None:
        """The name that becomes current by a statement ``v``, ``c`` or ``m`` with ``[name [= [template]]]``."""
        if len(words) == 1:
            table[None] = default
            return None
        if len(words) == 2:
            table[words[1]]  # must be defined
        elif words[2] != b"=" or len(words) > 4:
            raise ValueError("'name = [template]' expected")
        else:
            table[words[1]] = default if len(words) == 3 else table[words[3]]
        return words[1]

    def _get_vertex(self, words) -> None:
        self._vertex = self._get(self.vertices, words, 0)

    def _set_point(self, words) -> None:
        x, y, z = map(float, words[1:])
        if not isfinite(x + y + z):
            raise ValueError("a coordinate is not finite")
        self.vertices[self._vertex] = len(self.points)
        self.points.append((x, y, z))

    def _get_color(self, words) -> None:
        self._color = self._get(self._colors, words, NEUTRAL)

    def _set_chromaticity(self, words) -> None:
        x, y = map(float, words[1:])
        if not (y > 0 and x >= 0 and x + y <= 1):
            raise ValueError("there is no such chromaticity (y must be positive)")
        self._colors[self._color] = (x, y)

    def _get_material(self, words) -> None:
        self.changed = True
        try:
            self._material = self._get(self._materials, words, MgfMaterial())
        except KeyError:
            self._materials[words[1]] = MgfMaterial(defined=False)
            self._material = words[1]
            raise

    def _set(self, **values) -> None:
        self.changed = True
        self._materials[self._material] = replace(self.material, **values)

    def _set_sides(self, words) -> None:
        if words[1:] not in ([b"1"], [b"2"]):
            raise ValueError("sides must be 1 or 2")
        self._set(one_sided=words[1] == b"1")

    def _set_reflectance(self, words) -> None:
        self._set(reflectance=_value(words, 1.0), reflectance_color=self._colors[self._color], defined=True, file=self.file)

    def _set_emittance(self, words) -> None:
        self._set(emittance=_value(words, inf), emittance_color=self._colors[self._color], defined=True)

    def _set_transmittance(self, words) -> None:
        color = self._colors[self._color]
        self._set(transmittance=_value(words, 1.0), transmittance_color=color, defined=True, file=self.file)

    def _set_diffuse_transmittance(self, words) -> None:
        value, color = _value(words, 1.0), self._colors[self._color]
        self._set(diffuse_transmittance=value, diffuse_transmittance_color=color, defined=True, file=self.file)

    def _set_not_diffuse(self, words) -> None:
        self._set(not_diffuse=_value(words, 1.0) > 0, defined=True)


def _value(words: list[bytes], most: float) -> float:
    if len(words) < 2:
        raise ValueError("a value is missing")
    value = float(words[1])
    if not (0 <= value <= most and isfinite(value)):
        raise ValueError(f"{value:g} is out of range")
    return value
