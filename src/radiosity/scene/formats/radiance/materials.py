"""The materials of Radiance by their diffuse reflectance, what they let through, and what they emit."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ....errors import SceneError
from ...back import Back
from ...parts import Material
from ..color import luminance_weights
from ..glazing import INDEX, clear_share
from . import told
from .modifiers import Chain
from .primitives import Primitive
from .told import Told

UNKNOWN = ("BSDF", "aBSDF", "WGMDfunc", "mixfunc", "mixdata", "mixpict", "mixtext")
BENDING = ("dielectric", "interface", "prism1", "prism2", "direct1", "direct2")
TRANSMITTED = {"trans": 5, "trans2": 6, "transfunc": 4, "transdata": 4}  # where the share that is let through stands
LIGHTS = ("light", "glow", "spotlight", "illum")


@dataclass
class Finisher:
    """Makes materials of chains of modifiers.

    Attributes:
        source: the file, for messages.
        told: what is taken in another way.
        has_sky: the file has a sky or a sun, whose light shines through windows.
        fault: takes the line and the fault of a material.
    """

    source: str
    told: Told
    has_sky: bool
    fault: Callable[[Primitive, str], None]

    def material(self, chain: Chain) -> Material | None:
        """The material of surfaces with these modifiers; None: they are invisible.

        Raises:
            SceneError: antimatter.
        """
        for pattern in chain.patterns:
            self.told.add(told.PATTERNS, f"{pattern.name} ({pattern.kind})")
        for undefined in chain.undefined:
            self.told.add(told.UNDEFINED, undefined)
        for conflicting in chain.conflicting:
            self.told.add(told.CONFLICT, conflicting.name)
        if chain.material is None:
            return Material() if chain.undefined else None
        one = chain.material
        if one.kind == "antimatter":
            text = "cuts holes into other surfaces (antimatter), which is not read; cut the surfaces themselves"
            raise SceneError(f"{self.source}:{one.line}: '{one.name}' {text}")
        if one.kind == "mist":
            self.told.add(told.MIST, one.name)
            return None
        if one.kind in UNKNOWN or one.kind not in READERS:
            self.told.add(told.UNKNOWN, f"{one.name} ({one.kind})")
            return Material()
        counts, reader = READERS[one.kind]
        if len(one.numbers) not in counts:
            self.fault(one, f"{one.kind} '{one.name}' has {len(one.numbers)} numbers; {' or '.join(map(str, counts))} expected")
            return Material()
        return reader(self, one, np.array(one.numbers), chain)

    def _opaque(self, one: Primitive, numbers, chain: Chain) -> Material:
        return Material(_color(numbers[:3] * (1 - numbers[3])), diffuse=numbers[3] == 0)

    def _mirror(self, one: Primitive, numbers, chain: Chain) -> Material:
        return Material((0.0,), diffuse=False)

    def _bending(self, one: Primitive, numbers, chain: Chain) -> Material:
        self.told.add(told.BLACK, f"{one.name} ({one.kind})")
        return Material((0.0,))

    def _ashik(self, one: Primitive, numbers, chain: Chain) -> Material:
        return Material(_color(numbers[:3]), diffuse=False)

    def _glass(self, one: Primitive, numbers, chain: Chain) -> Material:
        index = numbers[3] if len(numbers) == 4 else INDEX
        if not (index > 1 and (numbers[:3] >= 0).all() and (numbers[:3] <= 1).all()):
            self.fault(one, f"glass '{one.name}' needs transmissivities from 0 to 1, and an index of refraction above 1")
            return Material()
        pane = self._pane(one, clear_share(numbers[:3], index), np.zeros(3))
        return replace(pane, diffuse=False, refractive_index=float(index) if pane.transmittance > 0 else 0.0)

    def _trans(self, one: Primitive, numbers, chain: Chain) -> Material:
        """Trans: what is not mirrored is reflected diffusely, or goes through: a share straight on, the rest diffusely."""
        at = TRANSMITTED[one.kind]
        kept, (share, straight) = numbers[:3] * (1 - numbers[3]), numbers[at:][:2]
        rough = one.kind in ("trans", "trans2") and numbers[4:at].any()
        if share > 0 and straight > 0 and (rough or one.kind in ("transfunc", "transdata")):
            self.told.add(told.ROUGH, one.name)
        pane = self._pane(one, kept * share * straight, kept * (1 - share))
        return replace(pane, diffuse_transmittance=_through(kept * share * (1 - straight)), diffuse=numbers[3] == 0)

    def _directional(self, one: Primitive, numbers, chain: Chain) -> Material:
        """BRTDfunc: diffuse reflectances of both sides and a diffuse transmittance; what goes straight on if it is constant."""
        front, back, through = numbers[:3], numbers[3:6], numbers[6:9]
        constant = _constants(one.words[:9])
        pane = self._pane(one, np.zeros(3) if constant is None else constant[3:6], front)
        pane = replace(pane, back_reflectance=_color(back), diffuse_transmittance=_through(through))
        return replace(pane, diffuse=constant is not None and not constant[[0, 1, 2, 6, 7, 8]].any())

    def _pane(self, one: Primitive, through: np.ndarray, reflected: np.ndarray) -> Material:
        if np.ptp(through) > 1e-6 * through.max(initial=0):
            self.told.add(told.COLOURED, one.name)
        return Material(_color(reflected), transmittance=float(luminance_weights() @ through))

    def _light(self, one: Primitive, numbers, chain: Chain) -> Material:
        if chain.patterns:
            self.told.add(told.DARK, one.name)
            return Material((0.0,), back=Back.ABSORBS)
        share = 1.0
        if one.kind == "glow" and numbers[3] < 0:
            self.told.add(told.NEVER, one.name)
            share = 0.0
        if one.kind == "spotlight":
            self.told.add(told.SPOT, one.name)
            share = float(np.sin(np.radians(min(abs(numbers[3]), 180)) / 2) ** 2)
        return Material((0.0,), _color(np.pi * share * numbers[:3]), Back.ABSORBS)

    def _illum(self, one: Primitive, numbers, chain: Chain) -> Material | None:
        light = self._light(one, numbers, chain)
        other = self.material(chain.alternate) if chain.alternate is not None else None
        if other is not None and (other.transmittance > 0 or other.diffuse_transmittance) and self.has_sky:
            self.told.add(told.WINDOWS, one.name)
            return other
        if any(light.emission):
            self.told.add(told.ILLUMS, one.name)
        if other is None:
            return replace(light, back=Back.OPEN) if any(light.emission) else None
        return replace(other, emission=light.emission, back_emission=(0.0,), refractive_index=0.0)


def _constants(words: tuple[str, ...]) -> np.ndarray | None:
    """The nine functions of a BRTDfunc, where all of them are numbers; else None."""
    try:
        values = np.array([float(word) for word in words])
    except ValueError:
        return None
    return values if len(values) == 9 and np.isfinite(values).all() else None


def _through(values: np.ndarray) -> tuple[float, ...] | None:
    return _color(values) if values.any() else None


def _color(values: np.ndarray) -> tuple[float, ...]:
    """The bands of a colour; grey has one."""
    return (float(values[0]),) if np.ptp(values) == 0 else tuple(float(value) for value in values)


READERS = {  # how many numbers a material has, and what reads it
    **dict.fromkeys(("plastic", "metal"), ((5,), Finisher._opaque)),
    **dict.fromkeys(("plastic2", "metal2"), ((6,), Finisher._opaque)),
    **dict.fromkeys(("plasfunc", "metfunc", "plasdata", "metdata"), (range(4, 100), Finisher._opaque)),
    "trans": ((7,), Finisher._trans),
    "trans2": ((8,), Finisher._trans),
    **dict.fromkeys(("transfunc", "transdata"), (range(6, 100), Finisher._trans)),
    "ashik2": ((8,), Finisher._ashik),
    "BRTDfunc": (range(9, 100), Finisher._directional),
    "glass": ((3, 4), Finisher._glass),
    "mirror": ((3,), Finisher._mirror),
    **dict.fromkeys(BENDING, (range(100), Finisher._bending)),
    "light": ((3,), Finisher._light),
    "glow": ((4,), Finisher._light),
    "spotlight": ((7,), Finisher._light),
    "illum": ((3,), Finisher._illum),
}
KINDS = {*READERS, *UNKNOWN, "mist", "antimatter"}
