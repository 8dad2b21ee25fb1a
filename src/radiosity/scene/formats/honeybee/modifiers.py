"""The modifiers of honeybee objects: their own, or one of their room's set, or honeybee's own defaults."""

from typing import Any

from ....errors import SceneError
from ..glazing import transmissivity_of
from ..radiance.modifiers import Chain
from ..radiance.primitives import Primitive
from .schema import Model, Named

SPECULAR = ("specularity", "roughness")
NUMBERS = {  # of Radiance's material, by the keys of honeybee's
    "Plastic": ("plastic", ("r_reflectance", "g_reflectance", "b_reflectance", *SPECULAR)),
    "Metal": ("metal", ("r_reflectance", "g_reflectance", "b_reflectance", *SPECULAR)),
    "Trans": (
        "trans",
        ("r_reflectance", "g_reflectance", "b_reflectance", *SPECULAR, "transmitted_diff", "transmitted_spec"),
    ),
    "Mirror": ("mirror", ("r_reflectance", "g_reflectance", "b_reflectance")),
    "Glass": ("glass", ("r_transmissivity", "g_transmissivity", "b_transmissivity", "refraction_index")),
    "Light": ("light", ("r_emittance", "g_emittance", "b_emittance")),
    "Glow": ("glow", ("r_emittance", "g_emittance", "b_emittance", "max_radius")),
}
DEFAULTS = {"refraction_index": 1.52}  # of numbers that are missing; others are 0


def _opaque(reflectance: float) -> dict[str, Any]:
    return {"type": "Plastic", **dict.fromkeys(("r_reflectance", "g_reflectance", "b_reflectance"), reflectance)}


def _glass(transmittance: float) -> dict[str, Any]:
    share = transmissivity_of(transmittance)
    return {"type": "Glass", **dict.fromkeys(("r_transmissivity", "g_transmissivity", "b_transmissivity"), share)}


GENERIC = {  # honeybee's defaults; windows by the share that they let through straight on
    ("wall_set", "exterior_modifier"): _opaque(0.5),
    ("wall_set", "interior_modifier"): _opaque(0.5),
    ("floor_set", "exterior_modifier"): _opaque(0.2),
    ("floor_set", "interior_modifier"): _opaque(0.2),
    ("roof_ceiling_set", "exterior_modifier"): _opaque(0.8),
    ("roof_ceiling_set", "interior_modifier"): _opaque(0.8),
    ("aperture_set", "window_modifier"): _glass(0.64),
    ("aperture_set", "skylight_modifier"): _glass(0.64),
    ("aperture_set", "operable_modifier"): _glass(0.64),
    ("aperture_set", "interior_modifier"): _glass(0.88),
    ("door_set", "exterior_modifier"): _opaque(0.5),
    ("door_set", "interior_modifier"): _opaque(0.5),
    ("door_set", "overhead_modifier"): _opaque(0.5),
    ("door_set", "exterior_glass_modifier"): _glass(0.64),
    ("door_set", "interior_glass_modifier"): _glass(0.88),
    ("shade_set", "exterior_modifier"): _opaque(0.35),
    ("shade_set", "interior_modifier"): _opaque(0.5),
    ("", "context_modifier"): _opaque(0.2),
}
Role = tuple[str, str]  # a set, and a key of it


class Modifiers:
    """The modifiers and sets of a model."""

    def __init__(self, model: Model, source: str):
        self._source = source
        light = model.properties.radiance
        own = [] if light is None else light.modifiers
        whole = None if light is None else light.global_modifier_set
        self._modifiers = {str(one.get("identifier")): one for one in [*(whole.modifiers if whole else ()), *own]}
        self._sets = {str(one.get("identifier")): one for one in (light.modifier_sets if light else [])}
        self._whole = whole.model_dump() if whole else None

    def of(self, own: Named, of_room: Named, role: Role) -> Chain:
        """The modifier of an object as Radiance has it.

        Args:
            own: the object's.
            of_room: the set of its room.
            role: what to take from a set.

        Raises:
            SceneError: a set holds something else.
        """
        found = own or self._from(of_room, role) or self._from(self._whole, role) or GENERIC[role]
        if isinstance(found, str):
            if found not in self._modifiers:
                return Chain(undefined=(found,))
            found = self._modifiers[found]
        if not isinstance(found, dict):
            place = f"{self._source}: a set of modifiers has {found!r} as its {role[0]} {role[1]}"
            raise SceneError(f"{place}; give the identifier of a modifier, or the modifier itself")
        return _chain(found)

    def _from(self, given: Named, role: Role) -> Named:
        """What a set has for a role; None where it has nothing."""
        one = self._sets.get(given, {}) if isinstance(given, str) else given or {}
        inner = one.get(role[0]) if role[0] else one
        return inner.get(role[1]) if isinstance(inner, dict) else None


def _chain(modifier: dict[str, Any]) -> Chain:
    kind, name = str(modifier.get("type")), str(modifier.get("identifier", "default"))
    if kind == "Void":
        return Chain()
    if kind not in NUMBERS:
        return Chain(Primitive("void", kind, name, (), (), 0))
    called, keys = NUMBERS[kind]
    numbers = []
    for key in keys:
        value = modifier.get(key)
        numbers.append(float(value) if isinstance(value, int | float) else DEFAULTS.get(key, 0.0))
    if kind == "Metal" and modifier.get("specularity") is None:
        numbers[3] = 0.9
    return Chain(Primitive("void", called, name, (), tuple(numbers), 0))
