"""A program of its own that writes the triangles of an IFC file to an NPZ file: a crash of the geometry library ends it alone.

It imports nothing of this package: ``python convert.py FILE OUTPUT``.
"""

import json
import sys
from importlib import import_module

import numpy as np

LEFT_OUT = (
    "IfcFeatureElementSubtraction",
    "IfcSpatialElement",
    "IfcSpatialStructureElement",
    "IfcVirtualElement",
    "IfcAnnotation",
)
KEPT = ("IfcSite",)  # of those: its shape is the ground
LIGHTS = "IfcLightSource"


def convert(source: str, target: str) -> None:
    """Write vertices (m), triangles, the material of each triangle, and what is told of products and materials as JSON."""
    ifc = import_module("ifcopenshell")
    file = ifc.open(source)
    _number_points(file)
    shapes = list(_shapes(file, _instances(file, LEFT_OUT, KEPT)))
    told = {
        "products": [told for told, *_ in shapes],
        "lights": len(_instances(file, (LIGHTS,), ())),
        "version": str(ifc.version),
        "products_with_shape": sum(1 for one in file.by_type("IfcProduct") if getattr(one, "Representation", None)),
        "left_out": len([one for one in _instances(file, LEFT_OUT, KEPT) if getattr(one, "Representation", None)]),
    }
    arrays = {"told": np.frombuffer(json.dumps(told).encode(), np.uint8)}
    for number, (_, *found) in enumerate(shapes):
        arrays |= {f"{key}{number}": array for key, array in zip("vtm", found, strict=True)}
    with open(target, "wb") as output:
        np.savez(output, allow_pickle=False, **arrays)


def _number_points(file) -> None:
    """Write the numbers of points in the place of numbers of a list of them (PnIndex), which ifcopenshell 0.8 does not follow."""
    for one in _instances(file, ("IfcTriangulatedFaceSet", "IfcPolygonalFaceSet"), ()):
        numbers = one.PnIndex
        if not numbers:
            continue
        one.PnIndex = None
        if one.is_a("IfcTriangulatedFaceSet"):
            one.CoordIndex = [[numbers[i - 1] for i in corners] for corners in one.CoordIndex]
            continue
        faces = []
        for face in one.Faces:
            copy = file.create_entity(face.is_a(), [numbers[i - 1] for i in face.CoordIndex])
            if holes := getattr(face, "InnerCoordIndices", None):
                copy.InnerCoordIndices = [[numbers[i - 1] for i in hole] for hole in holes]
            faces.append(copy)
        one.Faces = faces


def _instances(file, names, but) -> list:
    found = {}
    for name in names:
        try:
            found |= {one.id(): one for one in file.by_type(name)}
        except RuntimeError:  # another version of IFC has no such class
            continue
    return [one for one in found.values() if not any(one.is_a(name) for name in but)]


def _shapes(file, excluded):
    """What is told of each product, its vertices, triangles, and the number of each triangle's material."""
    geometry, element = import_module("ifcopenshell.geom"), import_module("ifcopenshell.util.element")
    settings = geometry.settings()
    settings.set("use-world-coords", True)
    more = {"exclude": excluded} if excluded else {}
    iterator = geometry.iterator(settings, file, 1, **more)
    if not iterator.initialize():
        return
    while True:
        shape = iterator.get()
        mesh = shape.geometry
        vertices, triangles = np.array(mesh.verts, float).reshape(-1, 3), np.array(mesh.faces, np.int64).reshape(-1, 3)
        product = file.by_id(shape.id)
        told = {
            "class": product.is_a(),
            "name": product.Name or product.GlobalId,
            "type": getattr(product, "ObjectType", None),
            "listed": _listed(product),
            "materials": [one.Name for one in element.get_materials(product) if getattr(one, "Name", None)],
            "styles": [_style(file, style) for style in mesh.materials],
        }
        if len(triangles):
            yield told, vertices, triangles, np.array(mesh.material_ids, np.int64)
        if not iterator.next():
            return


def _listed(product) -> int:
    """The number of triangles that the file lists for a product; 0 where its shape is something else, or has openings."""
    shapes = [shape for shape in product.Representation.Representations if shape.RepresentationIdentifier == "Body"]
    items = [item for shape in shapes for item in shape.Items]
    whole = not getattr(product, "HasOpenings", ()) and all(item.is_a("IfcTriangulatedFaceSet") for item in items)
    return sum(len(item.CoordIndex) for item in items) if whole else 0


def _style(file, style) -> dict:
    """The name, colour, transparency and side of a style, and a factor of its colour; None where it is only a default.

    ifcopenshell multiplies the colour of the surface by a diffuse colour or factor. Here a diffuse colour takes its place.
    """
    number = style.instance_id()
    if not number:
        return dict.fromkeys(("name", "color", "transparency", "side", "factor"))
    shown, clear, own = style.diffuse, float(style.transparency), file.by_id(number)
    color, factor = [float(shown.r()), float(shown.g()), float(shown.b())], None
    for look in getattr(own, "Styles", None) or ():
        if look.is_a("IfcSurfaceStyleShading"):
            diffuse = getattr(look, "DiffuseColour", None)
            factor = float(diffuse.wrappedValue) if diffuse is not None and not diffuse.is_a("IfcColourRgb") else None
            rgb = look.SurfaceColour if diffuse is None or factor is not None else diffuse
            color = [float(rgb.Red), float(rgb.Green), float(rgb.Blue)]
    return {
        "name": getattr(own, "Name", None),
        "color": color,
        "transparency": clear if np.isfinite(clear) else None,
        "side": getattr(own, "Side", None),
        "factor": factor,
    }


if __name__ == "__main__":
    convert(*sys.argv[1:3])
