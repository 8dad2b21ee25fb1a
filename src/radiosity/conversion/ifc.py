"""Industry Foundation Classes (IFC4) through ifcopenshell: a building element proxy for each surface, with triangles and a style.

The ``ObjectType`` of these proxies is `OWN`. By it `scene.formats.ifc` knows that names, sides and colours are to be read as they
were written. The colour of a style is the reflectance as sRGB, and its side tells whether backs radiate. IFC is z-up.
"""

import uuid
from importlib import import_module
from pathlib import Path

import numpy as np

from ..errors import OutputError, installing, printable
from ..image.tone import srgb
from ..scene.formats.ifc import ONE_SIDED, OWN
from ..scene.model import Back, Scene
from ..solution.whole import whole_file
from .names import unique_names
from .pieces import Piece, called, pieces, tell_of_rest, triangles
from .plain import plain
from .told import Told
from .upright import upright

HOLDS = frozenset({"names", "reflectance", "backs", "panes"})
LONGEST = 255  # characters of a name
PRECISION = 1e-9  # of the largest coordinate: nearer points are one to programs that read the file
UNITS = (("LENGTHUNIT", "METRE"), ("AREAUNIT", "SQUARE_METRE"), ("VOLUMEUNIT", "CUBIC_METRE"), ("PLANEANGLEUNIT", "RADIAN"))


def write(scene: Scene, path: Path, told: Told) -> None:
    """Write the file.

    Raises:
        OutputError: ifcopenshell is not installed, or the file cannot be written.
    """
    try:
        library = import_module("ifcopenshell")
    except ImportError:
        raise OutputError(f"{path}: writing .ifc files needs 'ifcopenshell'; {installing('ifc')}") from None
    tell_of_rest(scene, told, HOLDS)
    told.add("backs that let lines pass become backs that absorb", called(scene, scene.back == Back.PASSES))
    points = upright(scene, told, "IFC models")(scene.vertices)
    surfaces: dict[str, list[Piece]] = {}
    for piece in pieces(plain(scene, of_surfaces=True), told):
        surfaces.setdefault(piece.name, []).append(piece)
    names = unique_names([parts[0] for parts in surfaces.values()], told, _name)
    model = _Model(library, path.stem, scene.hash, PRECISION * float(np.abs(scene.vertices).max()))
    for name, parts in zip(names, surfaces.values(), strict=True):
        model.add(name, parts, points)
    text = model.text()
    with whole_file(path) as file:
        file.write(text.encode())


def _name(name: str) -> str:
    """Return a name of one line, and no longer than labels of IFC are."""
    name = printable(" ".join(name.split()))
    return name if len(name) <= LONGEST else ""


class _Model:
    """A file of a project with a site, a building and one storey, to which surfaces are added."""

    def __init__(self, library, name: str, key: str, precision: float):
        """Begin with what holds the surfaces.

        Args:
            library: the module ifcopenshell.
            name: of the project.
            key: GlobalIds follow from it, and differ where it does.
            precision: m.
        """
        self._library, self._key, self._count = library, key, 0
        self._file = library.file(schema="IFC4")
        self._new = self._file.create_entity
        self._origin = self._new("IfcAxis2Placement3D", self._new("IfcCartesianPoint", (0.0, 0.0, 0.0)))
        context = self._new("IfcGeometricRepresentationContext", None, "Model", 3, precision, self._origin)
        self._body = self._new("IfcGeometricRepresentationSubContext", "Body", "Model")
        self._body.ParentContext, self._body.TargetView = context, "MODEL_VIEW"
        units = [self._new("IfcSIUnit", None, kind, None, unit) for kind, unit in UNITS]
        name = _name(name)
        project = self._rooted("IfcProject", Name=name, RepresentationContexts=[context])
        project.UnitsInContext = self._new("IfcUnitAssignment", units)
        self._place, within = None, project
        for kind, title in (("IfcSite", "Site"), ("IfcBuilding", name), ("IfcBuildingStorey", "Storey")):
            self._place = self._new("IfcLocalPlacement", self._place, self._origin)
            part = self._rooted(kind, Name=title, ObjectPlacement=self._place, CompositionType="ELEMENT")
            self._rooted("IfcRelAggregates", RelatingObject=within, RelatedObjects=[part])
            within = part
        self._storey, self._proxies = within, []

    def add(self, name: str, parts: list[Piece], points: np.ndarray) -> None:
        """Add a surface.

        Args:
            name: of the surface.
            parts: its pieces.
            points: (n, 3) m, what the corners of pieces are numbers of.
        """
        items = [self._shape(piece, points) for piece in parts]
        shape = self._new("IfcShapeRepresentation", self._body, "Body", "Tessellation", items)
        proxy = self._rooted("IfcBuildingElementProxy", Name=name, ObjectType=OWN, PredefinedType="USERDEFINED")
        proxy.ObjectPlacement = self._new("IfcLocalPlacement", self._place, self._origin)
        proxy.Representation = self._new("IfcProductDefinitionShape", None, None, [shape])
        for item, piece in zip(items, parts, strict=True):
            label = name if len(parts) == 1 else f"{name}.{piece.number + 1}"
            self._new("IfcStyledItem", item, [self._style(label, piece)])
        self._proxies.append(proxy)

    def text(self) -> str:
        """Return the file's text."""
        self._rooted("IfcRelContainedInSpatialStructure", RelatedElements=self._proxies, RelatingStructure=self._storey)
        return self._file.to_string()

    def _rooted(self, kind: str, **values):
        """Return a new object with a GlobalId."""
        self._count += 1
        number = uuid.uuid5(uuid.NAMESPACE_OID, f"{self._key} {self._count}")
        return self._new(kind, GlobalId=import_module("ifcopenshell.guid").compress(number.hex), **values)

    def _shape(self, piece: Piece, points: np.ndarray):
        """Return the triangles of a piece."""
        halves = triangles(piece.corners)
        vertex, index = np.unique(np.take_along_axis(piece.corners[halves[:, 0]], halves[:, 1:], axis=1), return_inverse=True)
        corners = self._new("IfcCartesianPointList3D", points[vertex].tolist())
        return self._new("IfcTriangulatedFaceSet", corners, None, False, (index.reshape(-1, 3) + 1).tolist())

    def _style(self, name: str, piece: Piece):
        """Return the style of a piece: its colour, how transparent it is, and its sides."""
        red, green, blue = map(float, np.broadcast_to(srgb(piece.reflectance), 3))
        color = self._new("IfcColourRgb", None, red, green, blue)
        look = self._new("IfcSurfaceStyleRendering", color, piece.transmittance, ReflectanceMethod="MATT")
        return self._new("IfcSurfaceStyle", name[:LONGEST], "BOTH" if piece.back == Back.RADIATES else ONE_SIDED, [look])
