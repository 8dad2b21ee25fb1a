"""The check of `Scene.from_arrays`: plain arrays become the fields of a scene."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..errors import SceneError, shown
from . import arguments, panes
from .habits import warn
from .paint import Paint

OPPOSITE = 1e-6  # cosine between halves that rounding does not make
FARTHEST = 1e18  # metres
PARALLEL_TOLERANCE = 2e-6  # of the longest edge: what single precision coordinates can hold


def checked_fields(
    vertices,
    faces,
    reflectance,
    emission,
    *,
    surface=None,
    names=None,
    two_sided: ArrayLike = False,
    back=None,
    back_reflectance=None,
    back_emission=None,
    bands=None,
    photometric=False,
    transmittance=None,
    diffuse_transmittance=None,
    refractive_index=None,
    cameras=(),
    source="arrays",
    copy: bool = True,
    known: bool = False,
) -> tuple[dict[str, Any], np.ndarray | slice]:
    """The fields of a `Scene` by name, with degenerate faces still in it, and the input row that each of its faces came from.

    Arguments and errors are those of `Scene.from_arrays`.

    Args:
        copy: arrays are copied. Without, those that are given may be parts of the scene.
        known: faces are (n_faces, 4) int64 and name vertices that there are, as was found out.
    """
    vertices = arguments.array(vertices, np.float64, "vertices", source, copy)
    faces = faces if known else arguments.indices(faces, source, copy)
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise SceneError(f"{source}: vertices have shape {vertices.shape}; expected (n_vertices, 3)")
    n = len(faces)
    if n == 0:
        raise SceneError(f"{source}: the scene has no faces; add geometry")
    if not known:
        arguments.check_indices(faces, len(vertices), source)
    if not -FARTHEST <= vertices.min() <= vertices.max() <= FARTHEST:
        _check_used(vertices, faces, source)
    reflectance = arguments.per_face(reflectance, n, "reflectance", source, copy)
    emission = arguments.per_face(emission, n, "emission", source, copy)
    back_reflectance = (
        reflectance.copy()
        if back_reflectance is None
        else arguments.per_face(back_reflectance, n, "back_reflectance", source, copy)
    )
    back_emission = (
        emission.copy() if back_emission is None else arguments.per_face(back_emission, n, "back_emission", source, copy)
    )
    diffuse = panes.diffuse_transmittances(diffuse_transmittance, n, source)
    given = (reflectance, emission, back_reflectance, back_emission)
    n_bands = max(a.shape[1] for a in (*given, *([] if diffuse is None else [diffuse])))
    values = [arguments.widen(a, n_bands, source) for a in given]
    surface, names = arguments.surfaces_of(surface, names, n, source, copy)
    back = arguments.backs_of(back, two_sided, n, source, copy)
    for value, what in zip(values, ("reflectance", "emission", "back reflectance", "back emission"), strict=True):
        arguments.check_values(value, what, surface, names, source)
    arguments.check_open(back, values[0], surface, names, source)
    transmittance = panes.transmittances(transmittance, n, source)
    diffuse = None if diffuse is None else arguments.widen(diffuse, n_bands, source)
    panes.check(transmittance, back, (values[0], values[2]), surface, names, source, diffuse)
    index = panes.indices(refractive_index, n, source)
    panes.check_glass(index, transmittance, (*values, *([] if diffuse is None else [diffuse])), surface, names, source)
    bands = arguments.bands_of(bands, n_bands, source)
    rows: np.ndarray | slice = slice(None)
    if faces[:, 3].max() >= 0:
        crossed = _crossed(vertices, faces)
        if len(crossed):
            where = shown(dict.fromkeys(names[i] for i in surface[crossed]))
            text = f"{len(crossed)} quadrilaterals whose outline crosses itself became two triangles that face opposite ways"
            warn(f"{source}: {text} (first: face {crossed[0]}; surfaces {where}); put their corners in order")
        faces, rows = _parallelograms(vertices, faces)
    reflectance, emission, back_reflectance, back_emission = (value[rows] for value in values)
    fields = {
        "vertices": vertices,
        "faces": faces,
        "reflectance": reflectance,
        "emission": emission,
        "back": back[rows],
        "back_reflectance": back_reflectance,
        "back_emission": back_emission,
        "surface": surface[rows],
        "names": names,
        "bands": bands,
        "photometric": bool(photometric),
        "transmittance": None if transmittance is None else transmittance[rows],
        "diffuse_transmittance": None if diffuse is None else diffuse[rows],
        "refractive_index": None if index is None else index[rows],
        "patch_size": np.full(len(names), np.nan),
        "cameras": arguments.cameras_of(cameras, source),
        "source": str(source),
    }
    return fields, rows


def _check_used(vertices: np.ndarray, faces: np.ndarray, source: str) -> None:
    """Refuse vertices of faces that are not finite, or too far away."""
    used = np.unique(faces[faces >= 0])
    bad = used[~np.isfinite(vertices[used]).all(axis=1)]
    if len(bad):
        face = int(np.flatnonzero((faces == bad[0]).any(axis=1))[0])
        raise SceneError(f"{source}: vertex {bad[0]} of face {face} is {vertices[bad[0]].tolist()}; coordinates must be finite")
    if np.abs(vertices[used]).max() > FARTHEST:
        raise SceneError(f"{source}: coordinates reach {np.abs(vertices[used]).max():.3g} m; check the unit (at most 1e18)")


def split_paint(paint: Paint, split: np.ndarray, rows: np.ndarray | slice, faces: np.ndarray) -> Paint:
    """A paint of input faces, carried to the faces of the scene.

    Args:
        paint: of the input faces.
        split: (n_faces, 4) corners of the scene's faces, where quadrilaterals were split.
        rows: (n_faces,) the input face of each; a slice of all where none was split.
        faces: (n_input, 4) corners of the input faces.
    """
    corner = np.argmax(faces[rows][:, None, :] == split[:, :, None], axis=2)
    at = np.arange(len(split))[:, None]
    return replace(paint, image=paint.image[rows], uv=paint.uv[rows][at, corner], color=paint.color[rows][at, corner])


def _crossed(vertices, faces) -> np.ndarray:
    """Quadrilaterals whose halves face opposite ways along whichever diagonal they are cut."""
    quad = np.flatnonzero(faces[:, 3] >= 0)
    a, b, c, d = vertices[faces[quad]].transpose(1, 0, 2)
    result = np.ones(len(quad), bool)
    for one, two, three, four in ((a, b, c, d), (b, c, d, a)):
        halves = np.cross(two - one, three - one), np.cross(three - one, four - one)
        sizes = np.linalg.norm(halves[0], axis=1) * np.linalg.norm(halves[1], axis=1)
        result &= np.einsum("ij,ij->i", *halves) < -OPPOSITE * sizes
    return quad[result]


def _parallelograms(vertices, faces) -> tuple[np.ndarray, np.ndarray | slice]:
    """Split quadrilaterals that are no parallelograms in two; also the row each face came from."""
    quad = faces[:, 3] >= 0
    a, b, c, d = (vertices[np.where(quad, faces[:, i], faces[:, 0])] for i in range(4))
    size = np.maximum(np.linalg.norm(b - a, axis=1), np.linalg.norm(d - a, axis=1))
    split = quad & ~(np.linalg.norm(a + c - b - d, axis=1) <= PARALLEL_TOLERANCE * size)
    if not split.any():
        return faces, slice(None)
    rows = np.repeat(np.arange(len(faces)), 1 + split)
    result = faces[rows]
    first = np.flatnonzero(np.diff(rows, prepend=-1) & split[rows])
    corners = faces[rows[first]]
    points = vertices[corners]
    # along the diagonal that keeps both halves on one side, also where the quadrilateral is concave
    inside = (
        np.einsum(
            "ij,ij->i",
            np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]),
            np.cross(points[:, 2] - points[:, 0], points[:, 3] - points[:, 0]),
        )
        > 0
    )
    one = np.where(inside[:, None], corners[:, [0, 1, 2]], corners[:, [1, 2, 3]])
    two = np.where(inside[:, None], corners[:, [0, 2, 3]], corners[:, [1, 3, 0]])
    result[first] = np.column_stack([one, np.full(len(first), -1)])
    result[first + 1] = np.column_stack([two, np.full(len(first), -1)])
    return result, rows
