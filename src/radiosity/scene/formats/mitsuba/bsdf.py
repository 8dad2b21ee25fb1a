"""Mitsuba's BSDFs by their diffuse albedo: what a side reflects."""

from dataclasses import dataclass, replace

import numpy as np

from ....errors import SceneError, shown
from .color import Color, Colors, Image, VertexColors
from .node import Node
from .thin_pane import thin_pane

ALBEDO = {
    "diffuse": ("reflectance", 0.5),
    "plastic": ("diffuse_reflectance", 0.5),
    "roughplastic": ("diffuse_reflectance", 0.5),
    "pplastic": ("diffuse_reflectance", 0.5),
    "principled": ("base_color", 0.5),
    "principledthin": ("base_color", 0.5),
}  # plugin: its argument, and the default that it has in Mitsuba
BLACK = ("conductor", "roughconductor", "dielectric", "thindielectric", "roughdielectric", "polarizer", "retarder", "circular")
WRAPPERS = ("bumpmap", "normalmap", "mask")
CLEAR = ("null", "mask", "dielectric", "thindielectric", "roughdielectric")  # what Mitsuba does not take within twosided
OTHERS = ("blendbsdf", "hair", "measured", "measured_polarized", "null", "twosided")


@dataclass(frozen=True)
class Side:
    """The reflectance of one side; None where nothing is known."""

    albedo: "Color | Image | VertexColors | None" = None
    diffuse: bool = True


@dataclass(frozen=True)
class Sides:
    """Front and back; no back: it absorbs. ``opacity``: the share of the light that meets a surface; the rest goes through.

    ``through`` is the share of diffuse light that leaves the other side, and is not reflected.
    """

    front: Side
    back: Side | None = None
    opacity: float = 1.0
    through: float = 0.0


def of_shape(shape: Node, emits: bool, colors: Colors) -> Sides:
    """The sides of a shape. Without a BSDF Mitsuba takes a diffuse one of one side: black where the shape emits, else 0.5.

    Raises:
        SceneError: it has several, Mitsuba has no such BSDF, or a colour of it cannot be read.
    """
    found = shape.of("BSDF")
    if len(found) > 1:
        raise SceneError(f"{shape.place}: the '{shape.plugin}' has {len(found)} BSDFs; Mitsuba takes one: leave out the others")
    if not found:
        return Sides(Side((0.0,)) if emits else Side())
    return read_bsdf(found[0], colors)


def read_bsdf(node: Node, colors: Colors) -> Sides:
    """The sides of a shape that has this BSDF.

    Raises:
        SceneError: Mitsuba has no such BSDF, or a colour of it cannot be read.
    """
    inner = node.of("BSDF")
    if node.plugin == "twosided":
        kinds = [child.plugin for child in inner]
        if len(kinds) not in (1, 2) or set(kinds) & {*CLEAR, "twosided"}:
            text = f"{node.place}: a 'twosided' BSDF of {shown(kinds) or 'nothing'}"
            raise SceneError(f"{text}; Mitsuba takes one or two that let no light through (put a mask around the twosided one)")
        nested = [_side(child, colors) for child in inner]
        return Sides(nested[0], nested[-1])
    if node.plugin in WRAPPERS:
        if len(inner) != 1:
            raise SceneError(f"{node.place}: a '{node.plugin}' holds {len(inner)} BSDFs; Mitsuba takes one")
        sides = read_bsdf(inner[0], colors)
        if node.plugin == "mask":
            return replace(sides, opacity=sides.opacity * min(max(_mean(colors.get(node, "opacity", 0.5)), 0.0), 1.0))
        back = sides.back and Side(sides.back.albedo, False)
        return replace(sides, front=Side(sides.front.albedo, False), back=back)
    if node.plugin == "blendbsdf" and len(inner) == 2 and "null" in (kinds := [child.plugin for child in inner]):
        weight = _mean(colors.get(node, "weight", 0.5))
        sides = read_bsdf(inner[kinds.index("null") - 1], colors)
        return replace(sides, opacity=sides.opacity * (weight if kinds[0] == "null" else 1 - weight))
    if node.plugin == "thindielectric":
        return Sides(_side(node, colors), opacity=1 - thin_pane(node) * _mean(colors.get(node, "specular_transmittance", 1.0)))
    if node.plugin == "principledthin":  # a sheet that is alike on both sides; diff_trans is 2 where all is transmitted
        side, through = _side(node, colors), min(max(_mean(colors.get(node, "diff_trans", 0.0)) / 2, 0.0), 1.0)
        return Sides(side, side, through=through)
    return Sides(_side(node, colors), opacity=0.0 if node.plugin == "null" else 1.0)


def _mean(value: "Color | Image | VertexColors") -> float:
    """One number of a weight, an opacity or a texture of them."""
    color = value.mean if isinstance(value, Image) else value
    return float(np.mean(color)) if isinstance(color, tuple) else 0.5


def _side(node: Node, colors: Colors) -> Side:
    if node.plugin not in (*ALBEDO, *BLACK, *WRAPPERS, *OTHERS):
        raise SceneError(f"{node.place}: Mitsuba has no BSDF of type '{node.plugin}'")
    if node.plugin in ALBEDO:
        key, default = ALBEDO[node.plugin]
        return Side(colors.get(node, key, default), node.plugin == "diffuse")
    if node.plugin in BLACK:
        return Side((0.0,), False)
    nested = [_side(child, colors) for child in node.of("BSDF")]
    if node.plugin in WRAPPERS and nested:
        return Side(nested[0].albedo, False)
    if node.plugin == "blendbsdf" and len(nested) == 2:
        return _blend(node, nested, colors)
    return Side(None, False)


def _blend(node: Node, nested: list[Side], colors: Colors) -> Side:
    weight = colors.get(node, "weight", 0.5)
    mean = _mean(weight)
    first, second = (s.albedo.mean if isinstance(s.albedo, Image) else s.albedo for s in nested)
    if not isinstance(first, tuple) or not isinstance(second, tuple):
        return Side(first or second, False)
    width = max(len(first), len(second))
    mixed = tuple((1 - mean) * a + mean * b for a, b in zip(_wide(first, width), _wide(second, width), strict=True))
    return Side(mixed, all(side.diffuse for side in nested) and isinstance(weight, tuple))


def _wide(color: Color, width: int) -> Color:
    return color * width if len(color) == 1 else color
