"""The assembly of parts with materials to one scene, with warnings of values that differ from the file."""

from dataclasses import replace

import numpy as np

from ..errors import SceneError, shown
from ..pieces import pieces
from .arrays import checked_fields, split_paint
from .bends import straightened
from .habits import DEFAULT_REFLECTANCE, settle, warn
from .model import Camera, Scene
from .paint_parts import emission_paint, reflectance_paint
from .parts import Material, Part, ReadOptions
from .quads import merge_triangles
from .texture_memory import SMALL

PIECE = 1 << 14  # faces at a time

__all__ = ["DEFAULT_REFLECTANCE", "Material", "Part", "ReadOptions", "assemble", "warn"]


def assemble(
    parts: list[Part],
    source: str,
    options: ReadOptions,
    *,
    photometric: bool = False,
    cameras: tuple[Camera, ...] = (),
    scale: float = 1.0,
) -> Scene:
    """Return one scene from parts whose vertices are already in metres; ``scale`` is only recorded.

    Triangles that are the halves of a parallelogram become one face again; faces without area are left out;
    missing materials and reflectances above ``options.max_reflectance`` are replaced. One warning for each kind.

    Raises:
        SceneError: values that make no sense, or no face left.
    """
    parts = [part for part in parts if len(part.faces)]
    if not parts:
        raise SceneError(f"{source}: the file holds no faces; export geometry as polygons or triangles")
    for part in parts:
        _check_indices(part, source)
    if options.edit is not None:
        parts = options.edit(parts)
    bands = ("red", "green", "blue") if any(part.n_bands == 3 for part in parts) else ("grey",)
    assumed = tuple(dict.fromkeys(part.name for part in parts if part.material.reflectance is None))
    parts = [straightened(part) for part in settle(parts, source, options)]
    names = tuple(dict.fromkeys(part.name for part in parts))
    index = {name: i for i, name in enumerate(names)}
    starts = np.cumsum([0] + [len(part.vertices) for part in parts])
    faces = joined([_offset(part, start) for part, start in zip(parts, starts, strict=False)])
    sizes = [len(part.faces) for part in parts]
    distinct = {id(part.material): part.material for part in parts}
    material, place = list(distinct.values()), {key: row for row, key in enumerate(distinct)}
    of_parts = np.array([place[id(part.material)] for part in parts])

    def each(values, dtype: type = np.float64, of_parts=of_parts):
        rows = np.array(values, dtype)[of_parts]
        if (rows == rows[0]).all():  # one row in memory for all faces
            return np.broadcast_to(rows[0], (len(faces), *rows.shape[1:]))
        return np.repeat(rows, sizes, axis=0)

    def each_or_none(values):
        return each(values) if np.any(values) else None

    def spread(value):
        value = np.asarray(value, np.float64).ravel()
        return np.broadcast_to(value, (len(bands),)) if len(value) == 1 else value

    fields, rows = checked_fields(
        joined([part.vertices for part in parts]),
        faces,
        each([spread(m.reflectance) for m in material]),
        each([spread(m.emission) for m in material]),
        surface=each([index[part.name] for part in parts], np.int64, np.arange(len(parts))),
        names=names,
        back=each([m.back for m in material], np.int64),
        back_reflectance=each([spread(m.reflectance if m.back_reflectance is None else m.back_reflectance) for m in material]),
        back_emission=each([spread(m.emission if m.back_emission is None else m.back_emission) for m in material]),
        bands=bands,
        photometric=photometric,
        transmittance=each_or_none([m.transmittance for m in material]),
        refractive_index=each_or_none([m.refractive_index for m in material]),
        diffuse_transmittance=each_or_none([spread(m.diffuse_transmittance or 0.0) for m in material]),
        cameras=cameras,
        source=source,
        copy=False,
        known=True,
    )
    # the rows of the paints must follow where quadrilaterals were split
    paints = (reflectance_paint(parts, len(bands), options.max_reflectance), emission_paint(parts, len(bands)))
    of_reflectance, of_emission = (paint and split_paint(paint, fields["faces"], rows, faces) for paint in paints)
    scene = Scene(**fields, reflectance_paint=of_reflectance, emission_paint=of_emission)
    if options.textures.averaged:
        warn(
            f"{source}: images that are too large, alone or together, are averaged to {SMALL} pixels along an edge, and small "
            f"parts of them run into each other; scale them down, or cut them: {shown(options.textures.averaged)}"
        )
        options.textures.averaged.clear()
    sizes_asked = np.full(len(names), np.nan)
    for part in parts:
        if np.isfinite(part.patch_size):
            sizes_asked[index[part.name]] = part.patch_size
    whole = merge_triangles(scene.without_degenerate_faces())
    return replace(whole, patch_size=sizes_asked, scale=scale, assumed=assumed)


def joined(arrays: list[np.ndarray]) -> np.ndarray:
    """Return arrays one after another; a single one is not copied."""
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)


def _check_indices(part: Part, source: str) -> None:
    faces, n = np.asarray(part.faces), len(part.vertices)
    if faces.max() >= n or faces.min() < -1 or faces[:, :3].min() < 0:
        low = np.array([0, 0, 0, -1][: faces.shape[1]])
        face, corner = np.argwhere((faces < low) | (faces >= n))[0]
        raise SceneError(
            f"{source}: face {face} of surface '{part.name}' names vertex {int(faces[face, corner])}; there are {n} (from 0)"
        )


def _offset(part: Part, start: int) -> np.ndarray:
    faces = np.asarray(part.faces)
    if faces.shape[1] == 4:
        return np.where(faces >= 0, faces + start, -1).astype(np.int64, copy=False)
    result = np.empty((len(faces), 4), np.int64)
    for piece in pieces(len(faces), PIECE):
        some, of_result = faces[piece], result[piece]
        for corner in range(3):
            np.add(some[:, corner], start, out=of_result[:, corner], dtype=np.int64)
        of_result[:, 3] = -1
    return result
