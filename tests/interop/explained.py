"""Differences that have a reason: what the other program does, and why ours differs (docs/interop.md shows the table)."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Explained:
    """A difference that files with a feature show.

    Attributes:
        format: suffix of the file.
        reader: the other program, a key of ``VERSIONS``.
        feature: of the file.
        quantities: what may differ.
        why: what the other program does.
    """

    format: str
    reader: str
    feature: str
    quantities: tuple[str, ...]
    why: str

    def covers(self, sample, reader: str, quantity: str) -> bool:
        own = self.format == sample.format and self.reader == reader
        return own and self.feature in sample.features and quantity in self.quantities


VERSIONS = {
    "mitsuba": "Mitsuba 3.9.1",
    "trimesh": "trimesh 5.2.0",
    "numpy-stl": "numpy-stl 4.1.1",
    "blender": "Blender 5.0.1 (bpy)",
    "radiance": "Radiance's mgf2rad and rtrace of pyradiance 1.3.1",
}  # with which the table was made

REFUSED = ("refused",)
CUT = "cuts polygons in another way, and so weighs the colours of their corners otherwise"

EXPLAINED = (
    Explained("ply", "trimesh", "lists before", REFUSED, "refuses lists of unequal length before the vertices"),
    Explained("ply", "trimesh", "binary, polygons of several sizes", REFUSED, "refuses them"),
    Explained("ply", "trimesh", "polygons with face colours", ("reflectance",), "loses face colours where it cuts polygons"),
    Explained("ply", "trimesh", "coloured polygons", ("reflectance",), CUT),
    Explained("ply", "trimesh", "concave polygon", ("area", "volume"), "cuts every polygon from its first corner"),
    Explained("ply", "mitsuba", "polygons", REFUSED, "reads triangles only"),
    Explained("ply", "mitsuba", "obj_info", REFUSED, "does not know the header line obj_info"),
    Explained("ply", "blender", "coloured polygons", ("reflectance",), CUT),
    Explained("ply", "blender", "texture", ("reflectance",), "does not read the comment TextureFile"),
)
