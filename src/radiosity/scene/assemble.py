"""What the readers of files share: parts with materials become one scene, and strangers' habits are named aloud."""

import warnings
from dataclasses import dataclass, field, replace

import numpy as np

from ..errors import RadiosityWarning, SceneError, shown
from .model import Back, Camera, Scene
from .paint import Paint
from .quads import merge_triangles

DEFAULT_REFLECTANCE = 0.5


@dataclass(frozen=True)
class ReadOptions:
    """How to take a file.

    Attributes:
        max_reflectance: larger reflectances are brought down to this, with a warning.
        strict: faults that can be skipped are errors.
    """

    max_reflectance: float = 0.95
    strict: bool = False

    def __post_init__(self):
        if not 0 < self.max_reflectance < 1:
            raise SceneError(f"max_reflectance is {self.max_reflectance}; it must lie between 0 and 1")


@dataclass(frozen=True)
class Material:
    """Of one side, or of both. Bands are 1 (grey) or 3 numbers.

    Attributes:
        reflectance: diffuse reflectance, or None where the file gives no material.
        emission: exitance, W/m² or lm/m² (pi times the radiance of a diffuse emitter).
        back: what the back does.
        back_reflectance, back_emission: of a radiating back; None: as the front.
        diffuse: False where the file's material is not diffuse and was taken by its diffuse albedo.
    """

    reflectance: tuple[float, ...] | None = None
    emission: tuple[float, ...] = (0.0,)
    back: Back = Back.RADIATES
    back_reflectance: tuple[float, ...] | None = None
    back_emission: tuple[float, ...] | None = None
    diffuse: bool = True


@dataclass(frozen=True, eq=False)
class Part:
    """Faces of one surface (object x material).

    Attributes:
        name: of the surface. Parts of equal name become one surface.
        vertices: (n, 3) metres.
        faces: (m, 3) or (m, 4) int, as in `Scene.from_arrays`.
        material: of all its faces.
        uv: (n, 2) texture coordinates of the vertices, or None.
        color: (n, n_bands) linear vertex colours that multiply the reflectance, or None.
        texture, emission_texture: (height, width, 1 or 3) linear images that multiply reflectance, emission; or None.
        patch_size: metres, or NaN.
    """

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    material: Material = field(default_factory=Material)
    uv: np.ndarray | None = None
    color: np.ndarray | None = None
    texture: np.ndarray | None = None
    emission_texture: np.ndarray | None = None
    patch_size: float = np.nan


def assemble(parts: list[Part], source: str, options: ReadOptions, *, photometric: bool = False,
             cameras: tuple[Camera, ...] = (), scale: float = 1.0) -> Scene:  # fmt: skip
    """One scene from parts whose vertices are in metres already; ``scale`` is only recorded.

    Triangles that are the halves of a parallelogram become one face again; faces without area are left out;
    missing materials and reflectances above ``options.max_reflectance`` are replaced. One warning for each kind.

    Raises:
        SceneError: values that make no sense, or no face left.
    """
    parts = [part for part in parts if len(part.faces)]
    if not parts:
        raise SceneError(f"{source}: the file holds no faces; export geometry as polygons or triangles")
    colored = any(_n_bands(part) == 3 for part in parts)
    bands = ("red", "green", "blue") if colored else ("grey",)
    parts = _habits(parts, source, options)
    names = tuple(dict.fromkeys(part.name for part in parts))
    index = {name: i for i, name in enumerate(names)}
    starts = np.cumsum([0] + [len(part.vertices) for part in parts])
    faces = [_offset(part, start, source) for part, start in zip(parts, starts, strict=False)]
    sizes = [len(f) for f in faces]

    def each(values, dtype=np.float64):
        return np.repeat(np.array(values, dtype), sizes, axis=0)

    def spread(value):
        value = np.asarray(value, np.float64).ravel()
        return np.broadcast_to(value, (len(bands),)) if len(value) == 1 else value

    material = [part.material for part in parts]
    scene = _from_parts(
        np.concatenate([part.vertices for part in parts]), np.concatenate(faces),
        each([spread(m.reflectance) for m in material]), each([spread(m.emission) for m in material]),
        surface=each([index[part.name] for part in parts], np.int64), names=names,
        back=each([m.back for m in material], np.int64),
        back_reflectance=each([spread(m.reflectance if m.back_reflectance is None else m.back_reflectance) for m in material]),
        back_emission=each([spread(m.emission if m.back_emission is None else m.back_emission) for m in material]),
        bands=bands, photometric=photometric, cameras=cameras, source=source,
        paints=_paints(parts, sizes, len(bands), options),
    )  # fmt: skip
    sizes_asked = np.full(len(names), np.nan)
    for part in parts:
        if np.isfinite(part.patch_size):
            sizes_asked[index[part.name]] = part.patch_size
    return replace(merge_triangles(scene).without_degenerate_faces(), patch_size=sizes_asked, scale=scale)


def _from_parts(vertices, faces, reflectance, emission, *, paints, **rest) -> Scene:
    from . import arrays

    # as Scene.from_arrays, but rows must stay aligned with the paints until both are attached
    scene, rows = arrays.build_rows(vertices, faces, reflectance, emission, **rest)
    reflectance_paint, emission_paint = (
        paint and arrays.split_paint(paint, scene, rows, np.asarray(faces)) for paint in paints
    )
    return replace(scene, reflectance_paint=reflectance_paint, emission_paint=emission_paint)


def _n_bands(part: Part) -> int:
    m = part.material
    values = [m.reflectance, m.emission, m.back_reflectance, m.back_emission]
    arrays = [part.color, part.texture, part.emission_texture]
    return max([1] + [len(v) for v in values if v is not None] + [a.shape[-1] for a in arrays if a is not None])


def _offset(part: Part, start: int, source: str) -> np.ndarray:
    faces = np.asarray(part.faces, np.int64)
    if faces.shape[1] == 3:
        faces = np.column_stack([faces, np.full(len(faces), -1)])
    wrong = (faces[:, :3] < 0).any(axis=1) | (faces >= len(part.vertices)).any(axis=1)
    if wrong.any():
        face = int(np.flatnonzero(wrong)[0])
        raise SceneError(
            f"{source}: face {face} of surface '{part.name}' names vertex {int(faces[face].max())}; there are {len(part.vertices)}"
        )
    return np.where(faces >= 0, faces + start, -1)


def _habits(parts: list[Part], source: str, options: ReadOptions) -> list[Part]:
    """Values that strangers' files hold by habit are taken, each kind with one warning."""
    missing, bright, glossy, result = {}, {}, {}, []
    for part in parts:
        m = part.material
        if not m.diffuse:
            glossy[part.name] = True
        if m.reflectance is None:
            missing[part.name] = True
            m = replace(m, reflectance=(DEFAULT_REFLECTANCE,))
        peak = 1.0
        for factor in (part.color, part.texture):
            peak *= 1.0 if factor is None or not factor.size else float(factor.max())
        capped = {}
        for which in ("reflectance", "back_reflectance"):
            value = getattr(m, which)
            if value is None:
                continue
            for v in value:
                if not v >= 0 or np.isinf(v):
                    raise SceneError(f"{source}: {which.replace('_', ' ')} of surface '{part.name}' is {v:g}; it must lie in [0, 1)")
            if max(value) * peak > options.max_reflectance + 1e-12:
                bright[part.name] = max(bright.get(part.name, 0.0), max(value) * peak)
            if peak <= 1.0:  # else the paint brings the product down
                capped[which] = tuple(min(v, options.max_reflectance) for v in value)
            else:
                capped[which] = tuple(min(v, np.nextafter(1.0, 0.0)) for v in value)
        for v in (*m.emission, *(m.back_emission or ())):
            if not v >= 0 or np.isinf(v):
                raise SceneError(f"{source}: emission of surface '{part.name}' is {v:g}; it must be finite and not negative")
        result.append(replace(part, material=replace(m, **capped)))
    if missing:
        _warn(f"{source}: no material for {shown(missing)}; reflectance {DEFAULT_REFLECTANCE} taken")
    if bright:
        _warn(f"{source}: reflectance above {options.max_reflectance:g} brought down to it (at most "
              f"{max(bright.values()):.4g}): {shown(bright)}; --max-reflectance sets the bound")  # fmt: skip
    if glossy:
        _warn(f"{source}: not diffuse, taken by the diffuse albedo: {shown(glossy)}")
    return result


def _warn(text: str) -> None:
    warnings.warn(text, RadiosityWarning, stacklevel=4)


def _paints(parts: list[Part], sizes: list[int], n_bands: int, options: ReadOptions):
    """Paint of reflectance and of emission by input face, or None."""
    result = []
    for which in ("texture", "emission_texture"):
        colored = which == "texture"
        if all(getattr(p, which) is None and not (colored and p.color is not None) for p in parts):
            result.append(None)
            continue
        images: list[np.ndarray] = []
        known: dict[int, int] = {}
        total = sum(sizes)
        image = np.full(total, -1, np.int32)
        uv = np.zeros((total, 4, 2), np.float32)
        color = np.ones((total, 4, n_bands), np.float32)
        at = 0
        for part, size in zip(parts, sizes, strict=True):
            rows, corners = slice(at, at + size), np.asarray(part.faces)[:, [0, 1, 2, -1]]
            texture = getattr(part, which)
            if texture is not None and part.uv is not None:
                if id(texture) not in known:
                    known[id(texture)] = len(images)
                    images.append(np.broadcast_to(texture, (*texture.shape[:2], n_bands)).astype(np.float32))
                image[rows] = known[id(texture)]
                uv[rows] = np.asarray(part.uv, np.float32)[corners]
            if colored and part.color is not None:
                color[rows] = np.asarray(part.color, np.float32)[corners]
            at += size
        result.append(Paint(tuple(images), image, uv, color, options.max_reflectance if colored else np.inf))
    return result
