"""Mitsuba's BSDFs by their diffuse albedo: what a side reflects."""

from dataclasses import dataclass

from ....errors import SceneError
from .color import Color, Colors, Image, VertexColors
from .node import Node

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
OTHERS = ("blendbsdf", "hair", "measured", "measured_polarized", "null", "twosided")


@dataclass(frozen=True)
class Side:
    """What one side reflects; None where nothing is known."""

    albedo: "Color | Image | VertexColors | None" = None
    diffuse: bool = True


@dataclass(frozen=True)
class Sides:
    """Front and back; no back: it absorbs. ``invisible``: there is no surface at all."""

    front: Side
    back: Side | None = None
    invisible: bool = False


def read_bsdf(node: Node | None, colors: Colors) -> Sides:
    """The sides of a shape that has this BSDF; None: Mitsuba's default, diffuse 0.5, of one side.

    Raises:
        SceneError: Mitsuba has no such BSDF, or a colour of it cannot be read.
    """
    if node is None:
        return Sides(Side())
    if node.plugin == "twosided":
        nested = [_side(child, colors) for child in node.of("BSDF")] or [Side()]
        return Sides(nested[0], nested[-1])
    if node.plugin in WRAPPERS and (inner := node.of("BSDF")):
        sides = read_bsdf(inner[0], colors)
        back = sides.back and Side(sides.back.albedo, False)
        return Sides(Side(sides.front.albedo, False), back, sides.invisible)
    return Sides(_side(node, colors), invisible=node.plugin == "null")


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
    mean = weight.mean[0] if isinstance(weight, Image) else weight[0] if isinstance(weight, tuple) else 0.5
    first, second = (s.albedo.mean if isinstance(s.albedo, Image) else s.albedo for s in nested)
    if not isinstance(first, tuple) or not isinstance(second, tuple):
        return Side(first or second, False)
    width = max(len(first), len(second))
    mixed = tuple((1 - mean) * a + mean * b for a, b in zip(_wide(first, width), _wide(second, width), strict=True))
    return Side(mixed, all(side.diffuse for side in nested) and isinstance(weight, tuple))


def _wide(color: Color, width: int) -> Color:
    return color * width if len(color) == 1 else color
