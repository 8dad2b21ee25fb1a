"""Differences that have a reason: what the other program does, and why ours differs (docs/interop.md shows the table)."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Explained:
    """A difference that files with a feature show.

    Attributes:
        format: a key of ``readers.FORMATS``.
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

COLORS = ("reflectance", "power")
REFUSED = ("refused",)
SPACE = ("area", "vector", "volume", "bounds")
CUT = "cuts polygons otherwise, and so weighs the colours of their corners otherwise"
FAN = "cuts every polygon from its first corner"
OPTIONS = "does not load a map_Kd that has options"
WHITE = "takes it as white; we say that it is unknown and take 0.5"

EXPLAINED = (
    Explained("gltf", "trimesh", "sparse", SPACE + COLORS, "leaves sparse values out and says nothing"),
    Explained("gltf", "trimesh", "fans", (*SPACE, *COLORS, "refused"), "leaves fans of triangles out and says nothing"),
    Explained("gltf", "trimesh", "instancing extension", SPACE + COLORS, "shows the mesh once"),
    Explained("gltf", "trimesh", "morphs", SPACE + COLORS, "leaves the morphs out"),
    Explained("gltf", "trimesh", "skins", SPACE + COLORS, "leaves the skins out and places the node"),
    Explained("gltf", "trimesh", "hidden nodes", SPACE + COLORS, "shows them"),
    Explained("gltf", "trimesh", "no base colour", ("reflectance",), WHITE),
    Explained("gltf", "blender", "hidden nodes", ("names",), "shows them"),
    Explained("gltf", "blender", "no base colour", ("reflectance",), WHITE),
    Explained("gltf", "blender", "instances of morphs", REFUSED, "its importer fails"),
    Explained("gltf", "trimesh", "buffer name with a blank", REFUSED, "does not decode %20 in the name of a file"),
    Explained("gltf", "trimesh", "emissive strength", ("power",), "does not read KHR_materials_emissive_strength"),
    Explained("gltf", "blender", "unequal wraps", COLORS, "does not blend over the rim where u and v wrap differently"),
    Explained("obj", "trimesh", "comments after a face", REFUSED, "refuses a comment on the line of a face"),
    Explained("obj", "trimesh", "relative indices", (*SPACE, "reflectance"), "counts back from the end of the file"),
    Explained("obj", "trimesh", "texture scale", ("reflectance",), OPTIONS),
    Explained("obj", "trimesh", "texture offset", ("reflectance",), OPTIONS),
    Explained("obj", "trimesh", "texture clamp", ("reflectance",), OPTIONS),
    Explained("obj", "trimesh", "concave polygon", ("area", "volume", "reflectance"), FAN),
    Explained("obj", "mitsuba", "line continuation", SPACE, "does not know it, drops corners and says nothing"),
    Explained("obj", "mitsuba", "relative indices", REFUSED, "does not know them"),
    Explained("obj", "mitsuba", "concave polygon", ("area", "volume"), FAN),
    Explained("obj", "blender", "Kd beside a texture", ("reflectance",), "takes the texture in place of Kd, not times Kd"),
    Explained("obj", "blender", "Ke beside a texture", ("power",), "takes the texture in place of Ke, not times Ke"),
    Explained("obj", "blender", "texture clamp", ("reflectance",), "repeats the image whatever -clamp says"),
    Explained("obj", "blender", "coloured polygons", ("reflectance",), CUT),
    Explained("ply", "trimesh", "lists before", REFUSED, "refuses lists of unequal length before the vertices"),
    Explained("ply", "trimesh", "binary, polygons of several sizes", REFUSED, "refuses them"),
    Explained("ply", "trimesh", "polygons with face colours", ("reflectance",), "loses face colours where it cuts polygons"),
    Explained("ply", "trimesh", "texture and colours", ("reflectance",), "takes the texture in place of the colours"),
    Explained("ply", "trimesh", "coloured polygons", ("reflectance",), CUT),
    Explained("ply", "trimesh", "concave polygon", ("area", "volume", "reflectance"), FAN),
    Explained("ply", "mitsuba", "polygons", REFUSED, "reads triangles only"),
    Explained("ply", "mitsuba", "obj_info", REFUSED, "does not know the header line obj_info"),
    Explained("ply", "blender", "coloured polygons", ("reflectance",), CUT),
    Explained("ply", "blender", "texture", ("reflectance",), "does not read the comment TextureFile"),
    Explained("stl", "trimesh", "trailing bytes", REFUSED, "refuses bytes after the last triangle"),
    Explained("stl", "blender", "trailing bytes", REFUSED, "reads nothing, and says nothing"),
    Explained("stl", "blender", "upper case", REFUSED, "reads no facet whose keywords are capitals, and says nothing"),
    Explained("mitsuba", "mitsuba", "round shapes", ("bounds",), "has them round; ours are flat faces of equal area"),
    Explained("mitsuba", "mitsuba", "conductors", ("reflectance", "sides"), "gives the mirror's value, not the diffuse one"),
    Explained("mitsuba", "mitsuba", "constant radiance", ("power",), "has it reddish; ours is grey in a grey scene"),
    Explained("mgf", "radiance", "curved primitives", (*SPACE, "power"), "has them round; ours have 20 inscribed edges"),
    Explained("mgf", "radiance", "specular", ("reflectance",), "gives rd and rs one colour between them"),
    Explained("mgf", "radiance", "mixed spectra", COLORS, "mixes spectra; ours mixes chromaticities"),
    Explained("mgf", "radiance", "spectra", COLORS, "keeps spectra; mgfilt hands us chromaticities of four digits"),
)
