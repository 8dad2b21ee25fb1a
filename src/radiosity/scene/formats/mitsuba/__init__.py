"""Read Mitsuba 3 XML scenes: shapes, BSDFs by their diffuse albedo, emitters and perspective cameras, in metres.

A one-sided BSDF absorbs on the back, ``twosided`` radiates on either side, and an area emitter emits from the front only: without
a BSDF it is black, and with a ``null`` one lines pass through it. A partial ``mask`` is taken as opaque. A
radiance L is an exitance of pi L. A radiance that is constant over all wavelengths is grey where the whole scene is, and
otherwise what Mitsuba makes of it in linear sRGB.
"""

from pathlib import Path

import numpy as np

from ....errors import SceneError, shown
from ...assemble import assemble, warn
from ...lights.add import with_lights
from ...model import Scene
from ...parts import Part, ReadOptions
from ..names import repeated
from ..textures import warn_of_means, with_means
from .bsdf import of_shape
from .camera import read_camera
from .color import Colors
from .emitters import Emitters
from .image import find_file
from .mesh import read_mesh
from .node import Node
from .parse import parse
from .part import as_srgb, is_equal_energy, make_part
from .placement import check_round, placed, transformation
from .shapes import ANALYTIC, Geometry

MESHES = ("obj", "ply", "serialized")
GROUPS = ("instance", "shapegroup", "merge")
OTHERS = ("bsplinecurve", "ellipsoids", "ellipsoidsmesh", "linearcurve", "sdfgrid")
MOST_SHAPES = 200_000  # after instancing
MOST_FACES = 50_000_000


def read(path: Path, options: ReadOptions) -> Scene:
    """Read a Mitsuba scene file.

    Raises:
        SceneError: malformed XML, a file that is missing or damaged, or no shape that can be used.
    """
    root, folders = parse(path, options)
    reader = Reader(path, folders, options)
    for shape in root.of("Shape"):
        if shape.plugin != "shapegroup":  # it is seen through its instances
            reader.add(shape, np.eye(4), "")
    emitters = Emitters(reader.colors, str(path))
    for emitter in root.of("Emitter"):
        if not emitters.add(emitter):
            reader.left_out[f"{emitter.plugin} emitter"] = None
    cameras = tuple(camera for sensor in root.of("Sensor") if (camera := read_camera(sensor)))
    scene = assemble(reader.finished(options), str(path), options, cameras=cameras)
    return with_lights(scene, emitters.finished(scene.n_bands))


class Reader:
    """A reader that collects the parts of a file.

    Attributes:
        left_out: what does not take part, by name.
        colors: reads colours and images.
    """

    def __init__(self, path: Path, folders: list[Path], options: ReadOptions):
        self.left_out: dict[str, None] = {}
        self._path, self._folders, self._options = path, folders, options
        self.colors = Colors(folders, options)
        self._parts: list[Part] = []
        self._names: dict[str, int] = {}
        self._geometries: dict[int, Geometry] = {}
        self._equal_energy: list[int] = []  # parts by number
        self._averaged: list[str] = []
        self._given: list[str] = []  # names that the file gives, of shapes or of their files
        self._masked: dict[str, float] = {}
        self._shapes = self._faces = 0

    def add(self, node: Node, outer: np.ndarray, prefix: str) -> None:
        """Add a shape, or the shapes of a group, under the transformation ``outer`` of an instance.

        Raises:
            SceneError: numbers, files or types that make no shape.
        """
        given = node.name or Path(str(node.values.get("filename", ""))).stem
        label = prefix + (given or node.plugin)
        inner = transformation(node, label)
        self._shapes += 1
        if self._shapes > MOST_SHAPES or self._faces > MOST_FACES:
            raise SceneError(f"{self._path}: more than {MOST_SHAPES} shapes or {MOST_FACES} faces; split the scene")
        if node.plugin in GROUPS:
            if node.plugin == "instance":
                prefix = f"{self._unique(label)}/"
            for child in node.of("Shape"):
                self.add(child, outer @ inner, prefix)
            return
        if node.plugin not in (*ANALYTIC, *MESHES, *OTHERS):
            raise SceneError(f"{node.place}: Mitsuba has no shape of type '{node.plugin}'")
        area = [emitter for emitter in node.of("Emitter") if emitter.plugin == "area"]
        if len(area) > 1:
            raise SceneError(f"{node.place}: '{label}' has {len(area)} area emitters; Mitsuba takes one: leave out the others")
        sides = of_shape(node, bool(area), self.colors)
        if node.plugin in OTHERS or (sides.opacity == 0 and not area):
            self.left_out[f"{label} ({node.plugin if node.plugin in OTHERS else 'null'})"] = None
            return
        check_round(node, inner, label)
        geometry = placed(self._geometry(node), inner, outer, flip=bool(node.values.get("flip_normals", False)))
        self.left_out |= {f"{emitter.plugin} emitter": None for emitter in node.of("Emitter") if emitter not in area}
        if area and is_equal_energy(area[0]):
            self._equal_energy.append(len(self._parts))
        part, averaged = make_part(self._unique(label), geometry, sides, area[0] if area else None, self.colors)
        self._parts.append(part)
        self._given += [label] if given else []
        if 0 < sides.opacity < 1:
            self._masked[part.name] = sides.opacity
        self._averaged += [part.name] * averaged
        self._faces += len(part.faces)

    def finished(self, options: ReadOptions) -> list[Part]:
        """All parts, with a warning for each kind of thing that was taken differently.

        Raises:
            SceneError: there are none, or something is left out and ``options.strict``.
        """
        text = f"; left out: {shown(self.left_out)}" if self.left_out else ""
        if not self._parts:
            raise SceneError(f"{self._path}: the scene holds no shapes that can be used{text}")
        if text and options.strict:
            raise SceneError(f"{self._path}: cannot be used as it is{text}; remove that, or read the file without strict")
        if text:
            warn(f"{self._path}: only diffuse surfaces and emitters that are read take part{text}")
        if several := repeated(self._given):
            warn(f"{self._path}: shapes of the same name get numbers ('name 2', ...) in the order of the file: {shown(several)}")
        if self._masked:
            shares = [f"{name} ({1 - opacity:.3g})" for name, opacity in self._masked.items()]
            text = "with one transmittance for all places and angles of a shape, the mean"
            warn(f"{self._path}: masks, blends with nothing and thin dielectrics make clear panes, {text}: {shown(shares)}")
        if self._averaged:
            text = "textures averaged where the two sides differ, or for the light that goes through"
            warn(f"{self._path}: {text}: {shown(self._averaged)}")
        if any(part.n_bands == 3 for part in self._parts):
            for number in self._equal_energy:
                self._parts[number] = as_srgb(self._parts[number])
        means = [with_means(part, part.uv is None, part.emission_uv is None) for part in self._parts]
        warn_of_means(self._parts, means, str(self._path))
        return means

    def _geometry(self, node: Node) -> Geometry:
        if id(node) not in self._geometries:
            if node.plugin in ANALYTIC:
                self._geometries[id(node)] = ANALYTIC[node.plugin](node)
            else:
                file = find_file(self._folders, str(node.values.get("filename", "")), node, self._options)
                self._geometries[id(node)] = read_mesh(node, file)
        return self._geometries[id(node)]

    def _unique(self, label: str) -> str:
        name, number = label, self._names.get(label, 1)
        while name in self._names:
            number += 1
            name = f"{label} {number}"
        self._names[label] = number
        self._names.setdefault(name, 1)
        return name
