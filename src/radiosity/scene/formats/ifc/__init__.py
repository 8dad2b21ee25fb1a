"""Read IFC models through ifcopenshell, which makes triangles of all shapes, in metres.

A surface is class/name/material: ``IfcWall/W1/paint``, where the material is the name of the surface's style, or of the only IFC
material of the product. Colours of styles are taken as sRGB, and are the reflectance. Closed shells have one side, with the front
outside; other surfaces have two. Openings, spaces and annotations are no surfaces. Glass lets light through.

Proxies of the type `OWN`, which `radiosity convert` writes, are surfaces with their names, sides and colours as they are.
"""

from pathlib import Path

import numpy as np

from ....errors import SceneError, shown
from ...assemble import assemble, warn
from ...model import Back, Scene
from ...parts import Material, Part, ReadOptions
from ..glazing import clear_share
from ..textures import decode_srgb
from .run import Product, products
from .shells import mended

GLASS = (
    "glass",
    "glas",
    "glazing",
    "glaz",
    "verre",
    "vitrage",
    "vidrio",
    "vetro",
    "vidro",
    "lasi",
    "szkło",
    "стекло",
    "ガラス",
    "玻璃",
)
NO_GLASS = ("wool", "fib", "wolle", "faser", "foam", "laine", "lana")  # of names such as glass wool
CLEAR = 0.96  # transmissivity of glass whose transparency is not given
WITH_PANES = ("IfcWindow", "IfcWindowStandardCase", "IfcCurtainWall")
MOST_CLEAR = 0.95
OWN, ONE_SIDED = "radiosity surface", "POSITIVE"  # type of our own proxies, and the side of a style whose backs absorb


def read(path: Path, options: ReadOptions) -> Scene:
    """Read an .ifc file.

    Raises:
        SceneError: ifcopenshell is not installed, or cannot read the file; or the file holds no surfaces.
    """
    found, told = products(path)
    if not found:
        raise SceneError(f"{path}: ifcopenshell finds no shapes; export the model with its geometry (a Body representation)")
    reader = Reader()
    for product in found:
        reader.add(product)
    lost = told["products_with_shape"] - told["left_out"] - len(found)
    kinds = {
        "shells that looked inward, of mirrored items, are turned": reader.turned,
        "transparent surfaces are clear panes, which let all colours through alike": reader.panes,
        "windows without a transparent part are opaque; give their glass a transmittance in a .toml": reader.opaque,
        "a factor of the diffuse colour is left out, and the colour of the surface is the reflectance": reader.factors,
        "ifcopenshell leaves out triangles without area, or too near to others": reader.lost,
    }
    for text, names in kinds.items():
        if names:
            warn(f"{path}: {text}: {shown(names)}")
    for text, number in (
        ("products have no shape that ifcopenshell can make", lost),
        ("light sources are left out", told["lights"]),
    ):
        if number > 0 and options.strict:
            raise SceneError(f"{path}: {number} {text}; read the file without strict")
        if number > 0:
            warn(f"{path}: {number} {text}")
    return assemble(reader.parts, str(path), options)


class Reader:
    """Makes surfaces of products.

    Attributes:
        parts: found so far.
        turned, panes, opaque, factors, lost: names of what is told.
    """

    def __init__(self):
        self.parts: list[Part] = []
        self.turned: dict[str, None] = {}
        self.panes: dict[str, None] = {}
        self.opaque: dict[str, None] = {}
        self.factors: dict[str, None] = {}
        self.lost: dict[str, None] = {}

    def add(self, product: Product) -> None:
        """Take a product: a surface for each of its styles, and for closed and open shells of it."""
        lost = product.listed - len(product.triangles)
        if lost > 0:
            self.lost[f"{product.name} ({lost} of {product.listed})"] = None
        if product.type == OWN:
            self._add_own(product)
            return
        triangles, closed, turned = mended(product.vertices, product.triangles)
        name = f"{product.kind}/{product.name}"
        if turned:
            self.turned[name] = None
        clear = False
        for number in np.unique(product.style):
            style = product.styles[number] if 0 <= number < len(product.styles) else {}
            only = product.materials[0] if len(product.materials) == 1 else None
            label = style.get("name") or only
            if style.get("factor") is not None and style["factor"] != 1:
                self.factors[f"{label} ({style['factor']:g})"] = None
            for solid in (True, False):
                rows = (product.style == number) & (closed == solid)
                if rows.any():
                    material = _material(style, label, solid)
                    part = Part(f"{name}/{label}" if label else name, product.vertices, triangles[rows], material)
                    self.parts.append(part)
                    if material.transmittance > 0:
                        clear = True
                        whole = material.transmittance ** (2 if solid else 1)
                        self.panes[f"{part.name} ({whole:.2f})"] = None
        if product.kind in WITH_PANES and not clear:
            self.opaque[name] = None

    def _add_own(self, product: Product) -> None:
        """Take a surface that `radiosity convert` wrote."""
        for number in np.unique(product.style):
            style = product.styles[number] if 0 <= number < len(product.styles) else {}
            back = Back.ABSORBS if style.get("side") == ONE_SIDED else Back.RADIATES
            color, clear = style.get("color"), style.get("transparency") or 0.0
            material = Material(None if color is None else _reflectance(color), back=back, transmittance=clear)
            self.parts.append(Part(product.name, product.vertices, product.triangles[product.style == number], material))


def _reflectance(color: list[float]) -> tuple[float, ...]:
    """The reflectance that a colour of the screen stands for."""
    linear = decode_srgb(np.array(color))
    return (float(linear[0]),) if np.ptp(linear) == 0 else tuple(map(float, linear))


def _material(style: dict, label: str | None, solid: bool) -> Material:
    """The material of a style; light goes through two faces of a solid pane, each of which lets the root of it through."""
    color, transparency = style.get("color"), style.get("transparency")
    back = Back.ABSORBS if solid else Back.RADIATES
    if transparency or (transparency is None and is_glass(label)):
        whole = min(transparency, MOST_CLEAR) if transparency else float(clear_share(np.array([CLEAR]))[0])
        return Material((0.0,), back=back, transmittance=whole**0.5 if solid else whole)
    if color is None:
        return Material(back=back)
    return Material(_reflectance(color), back=back)


def is_glass(label: str | None) -> bool:
    """Return whether a name of a material says that it is glass."""
    text = (label or "").lower()
    return any(word in text for word in GLASS) and not any(word in text for word in NO_GLASS)
