"""One shape of a Mitsuba scene as a part: what its sides reflect, what its front emits, where textures lie."""

from dataclasses import replace

import numpy as np

from ...model import Back
from ...parts import Material, Part
from ...sampler import DEFAULT_SAMPLER
from .attributes import mean_color, with_colors
from .bsdf import Side, Sides
from .color import Color, Colors, Image, VertexColors, collapse, equal_energy_rgb
from .node import Node, Spectrum
from .shapes import Geometry


def make_part(name: str, geometry: Geometry, sides: Sides, emitter: Node | None, colors: Colors) -> tuple[Part, bool]:
    """The part, and whether textures were averaged because its two sides differ (a part has one texture)."""
    front, back = (sides.front, sides.back) if sides.opacity > 0 else (Side((0.0,)), None)
    averaged = back is not None and back != front and any(not isinstance(s.albedo, tuple | None) for s in (front, back))
    if back is not None and averaged:
        front, back = (_mean(side, geometry, name) for side in (front, back))
    diffused = _mean(front, geometry, name).albedo if sides.through > 0 and sides.opacity > 0 else None
    diffused = diffused if isinstance(diffused, tuple) else None
    image = front.albedo if isinstance(front.albedo, Image) else None
    emission, glow = _emission(emitter, colors)
    held = [value if isinstance(value, VertexColors) else None for value in (front.albedo, glow)]
    geometry, (color, emission_color) = with_colors(geometry, held, name)
    glow = glow if isinstance(glow, Image) else None
    uv = geometry.uv
    material = Material(
        reflectance=_seen(front, sides.opacity * (1 - sides.through)),
        emission=emission,
        back=Back.OPEN if sides.opacity == 0 else Back.ABSORBS if back is None else Back.RADIATES,
        back_reflectance=None if back is None or back == front else _seen(back, sides.opacity),
        transmittance=1 - sides.opacity if 0 < sides.opacity < 1 else 0.0,
        diffuse_transmittance=None if diffused is None else tuple(value * sides.opacity * sides.through for value in diffused),
        back_emission=(0.0,),
        diffuse=front.diffuse and (back is None or back.diffuse),
    )
    part = Part(
        name,
        geometry.vertices,
        geometry.faces,
        material,
        uv=None if image is None or uv is None else image.coordinates(uv),
        color=color,
        emission_color=emission_color,
        texture=image and image.pixels,
        emission_texture=glow and glow.pixels,
        emission_uv=None if glow is None or uv is None else glow.coordinates(uv),
        sampler=image.sampler if image else DEFAULT_SAMPLER,
        emission_sampler=glow.sampler if glow else DEFAULT_SAMPLER,
    )
    return part, averaged or (diffused is not None and not isinstance(front.albedo, tuple))


def is_equal_energy(emitter: Node | None) -> bool:
    """Return whether the radiance is a spectrum that is constant over all wavelengths: grey here, reddish in sRGB."""
    radiance = emitter and emitter.values.get("radiance")
    return isinstance(radiance, Spectrum) and not radiance.wavelengths


def as_srgb(part: Part) -> Part:
    """A part whose emission is of equal energy, in the colours that Mitsuba gives it."""
    emission = tuple(float(v) for v in part.material.emission[0] * equal_energy_rgb())
    return replace(part, material=replace(part.material, emission=emission))


def _emission(emitter: Node | None, colors: Colors) -> tuple[Color, Image | VertexColors | None]:
    """Exitance of the front, and what multiplies it."""
    if emitter is None:
        return (0.0,), None
    radiance = colors.get(emitter, "radiance", 1.0, emission=True)
    if isinstance(radiance, Image | VertexColors):
        return (np.pi,), radiance
    return tuple(np.pi * v for v in radiance), None


def _mean(side: Side, geometry: Geometry, name: str) -> Side:
    if isinstance(side.albedo, VertexColors):
        return replace(side, albedo=collapse(mean_color(geometry, side.albedo, name)))
    return replace(side, albedo=side.albedo.mean) if isinstance(side.albedo, Image) else side


def _base(side: Side) -> Color | None:
    """The base that textures and vertex colours multiply, or the reflectance itself."""
    return (1.0,) if isinstance(side.albedo, Image | VertexColors) else side.albedo


def _seen(side: Side, opacity: float) -> Color | None:
    """The base of what light meets; the rest goes through."""
    base = _base(side)
    return base if base is None or opacity == 1 else tuple(value * opacity for value in base)
