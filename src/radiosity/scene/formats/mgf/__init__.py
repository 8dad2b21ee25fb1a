"""Read the Materials and Geometry Format (MGF) through the program of Radiance that reduces it to faces.

A surface is object x material: ``desk.drawer/wood``. ``rd`` and ``ed`` count, each with its colour. ``ts`` makes a clear pane, of
one transmittance for all angles and colours, and ``td`` a diffusing one, in colour. ``rs`` makes a material one that is not
diffuse. With ``sides 1`` a face
is invisible from behind. A two-sided face, the default, looks identical from both sides (specification, entity ``sides``): it
reflects, and emits ``ed`` lm/m², on either, as in RenderPark. Curved primitives arrive with 20 edges around, inscribed, so that
their area is a little small.
"""

from pathlib import Path

import numpy as np

from ....errors import SceneError, shown
from ...assemble import assemble, warn
from ...model import Back, Scene
from ...parts import Material, Part, ReadOptions
from ..color import is_neutral, unit_rgb
from ..faces import CROSSING
from ..polygon import triangulate
from .context import MgfMaterial
from .faces import FaceReader, Polygons
from .faults import Faults, Statement
from .filter import reduce_to_faces
from .source import read_source


def read(path: Path, options: ReadOptions) -> Scene:
    """Read an MGF file and those it includes; photometric, in metres.

    Faulty lines are left out, each with a warning that names file and line.

    Raises:
        SceneError: no faces are left, or a line is faulty and ``options.strict``.
        ModuleNotFoundError: pyradiance or mapbox-earcut is not installed.
    """
    faults = Faults(options.strict)
    statements = read_source(path, faults, options)
    reader = FaceReader(statements, faults)
    reader.follow(reduce_to_faces(statements, faults, str(path)))
    points = np.array(reader.contexts.points)
    transforms = np.array(reader.transforms)
    parts = [
        _part(name, _material(material), polygons, points, transforms, statements, faults)
        for (name, material), polygons in reader.polygons.items()
    ]
    if not any(len(part.faces) for part in parts):
        raise SceneError(f"{path}: no faces could be read from this MGF file{faults.first()}")
    faults.warn()
    tinted = {name: None for name, one in reader.polygons if one.transmittance > 0 and not is_neutral(*one.transmittance_color)}
    if tinted:
        warn(f"{path}: coloured panes let all colours through alike, by their luminance (ts): {shown(tinted)}")
    if one_sided := {name: None for name, one in reader.polygons if one.diffuse_transmittance > 0 and one.one_sided}:
        warn(f"{path}: materials of one side (sides 1) diffuse nothing here, and their td is left out: {shown(one_sided)}")
    if several := [f"{name} ({len(places)})" for name, places in reader.begun.items() if len(places) > 1]:
        warn(f"{path}: objects of the same name become one: {shown(several)}")
    return assemble(parts, str(path), options, photometric=True)


def _material(material: MgfMaterial) -> Material:
    return Material(
        reflectance=_colored(material.reflectance, material.reflectance_color) if material.defined else None,
        emission=_colored(material.emittance, material.emittance_color),
        back=Back.PASSES if material.one_sided else Back.RADIATES,
        diffuse=not material.not_diffuse,
        diffuse_transmittance=_through(material),
        transmittance=material.transmittance,
        origin=material.file,
    )


def _through(material: MgfMaterial) -> tuple[float, ...] | None:
    """Diffuse transmittance; light behind a face of one side passes it anyway."""
    value = 0.0 if material.one_sided else material.diffuse_transmittance
    return _colored(value, material.diffuse_transmittance_color) if value > 0 else None


def _colored(value: float, color: tuple[float, float]) -> tuple[float, ...]:
    return (value,) if value == 0 or is_neutral(*color) else tuple(float(v) for v in value * unit_rgb(*color))


def _part(
    name: str, material: Material, polygons: Polygons, points, transforms, statements: list[Statement], faults: Faults
) -> Part:
    sizes = np.array(polygons.sizes)
    starts = np.cumsum(sizes) - sizes
    face = np.repeat(np.arange(len(sizes)), sizes)
    transform = np.array(polygons.transform)[face]
    keys, corners = np.unique(np.array(polygons.corners) * len(transforms) + transform, return_inverse=True)
    matrices = transforms[keys % len(transforms)]
    with np.errstate(over="ignore", invalid="ignore"):  # a coordinate that is not finite is reported later
        vertices = np.einsum("ni,nij->nj", points[keys // len(transforms)], matrices[:, :3, :3]) + matrices[:, 3, :3]
    # a mirror turns the outline round: run backwards, the front stays the front
    mirrored = (np.linalg.det(transforms[:, :3, :3]) < 0)[transform]
    place = np.arange(len(face))
    corners = corners.ravel()[np.where(mirrored, (2 * starts + sizes - 1)[face] - place, place)]
    faces = [np.full((len(starts), 4), -1)[:0]]
    for size in (3, 4):
        rows = corners[starts[sizes == size][:, None] + np.arange(size)]
        faces.append(np.column_stack([rows, np.full((len(rows), 4 - size), -1)]))
    for large in np.flatnonzero(sizes > 4):
        ring = corners[starts[large] : starts[large] + sizes[large]]
        triangles = _cut(vertices[ring], name, statements[polygons.statement[large]], faults)
        faces.append(np.column_stack([ring[triangles], np.full(len(triangles), -1)]))
    return Part(name, vertices, np.concatenate(faces), material)


def _cut(ring: np.ndarray, name: str, statement: Statement, faults: Faults) -> np.ndarray:
    """Return the triangles of a face with more than four corners, (m, 3), none where it is faulty."""
    if not np.isfinite(ring).all():
        return np.array([[0, 1, 2]])
    triangles, difference = triangulate(ring)
    if len(triangles) == 0:
        faults.add(statement.place, f"the face of '{name}' has no area")
    elif difference > CROSSING:
        faults.add(statement.place, f"the outline of the face of '{name}' crosses itself")
        return triangles[:0]
    return triangles
