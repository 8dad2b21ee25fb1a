"""`Scene.from_arrays`: plain arrays, checked, become a scene."""

import numpy as np

from ..errors import SceneError
from .model import Back, Camera, Scene
from .paint import Paint

PARALLEL_TOLERANCE = 2e-6  # of the longest edge: what single precision coordinates can hold


def build(vertices, faces, reflectance, emission, *, source, **rest) -> Scene:
    """See `Scene.from_arrays`."""
    return build_rows(vertices, faces, reflectance, emission, source=source, **rest)[0].without_degenerate_faces()


def build_rows(vertices, faces, reflectance, emission, *, surface=None, names=None, two_sided=False, back=None,
               back_reflectance=None, back_emission=None, bands=None, photometric=False, cameras=(),
               source="arrays") -> tuple[Scene, np.ndarray]:  # fmt: skip
    """The scene with degenerate faces still in it, and the input row that each of its faces came from."""
    vertices = _array(vertices, np.float64, "vertices", source)
    faces = _indices(faces, source)
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise SceneError(f"{source}: vertices have shape {vertices.shape}; expected (n_vertices, 3)")
    n = len(faces)
    if n == 0:
        raise SceneError(f"{source}: the scene has no faces; add geometry")
    _check_indices(faces, len(vertices), source)
    used = np.unique(faces[faces >= 0])
    bad = used[~np.isfinite(vertices[used]).all(axis=1)]
    if len(bad):
        face = int(np.flatnonzero((faces == bad[0]).any(axis=1))[0])
        raise SceneError(f"{source}: vertex {bad[0]} of face {face} is {vertices[bad[0]].tolist()}; coordinates must be finite")
    if np.abs(vertices[used]).max() > 1e18:
        raise SceneError(f"{source}: coordinates reach {np.abs(vertices[used]).max():.3g} m; check the unit (at most 1e18)")
    reflectance = _per_face(reflectance, n, "reflectance", source)
    emission = _per_face(emission, n, "emission", source)
    back_reflectance = reflectance if back_reflectance is None else _per_face(back_reflectance, n, "back_reflectance", source)
    back_emission = emission if back_emission is None else _per_face(back_emission, n, "back_emission", source)
    n_bands = max(a.shape[1] for a in (reflectance, emission, back_reflectance, back_emission))
    values = [_widen(a, n_bands, source) for a in (reflectance, emission, back_reflectance, back_emission)]
    surface, names = _surfaces(surface, names, n, source)
    back = _backs(back, two_sided, n, source)
    for value, what in zip(values, ("reflectance", "emission", "back reflectance", "back emission"), strict=True):
        _check_values(value, what, surface, names, source)
    bands = _bands(bands, n_bands, source)
    faces, rows = _parallelograms(vertices, faces)
    reflectance, emission, back_reflectance, back_emission = (value[rows] for value in values)
    scene = Scene(
        vertices, faces, reflectance, emission, back[rows], back_reflectance, back_emission, surface[rows], names, bands,
        bool(photometric), np.full(len(names), np.nan), cameras=_cameras(cameras, source), source=str(source),
    )  # fmt: skip
    return scene, rows


def split_paint(paint: Paint, scene: Scene, rows: np.ndarray, faces: np.ndarray) -> Paint:
    """A paint of input faces, carried to the scene's faces where quadrilaterals were split."""
    corner = np.argmax(faces[rows][:, None, :] == scene.faces[:, :, None], axis=2)
    at = np.arange(len(rows))[:, None]
    return Paint(paint.images, paint.image[rows], paint.uv[rows][at, corner], paint.color[rows][at, corner], paint.limit)


def _array(value, dtype, what, source) -> np.ndarray:
    if isinstance(value, np.ndarray) and np.iscomplexobj(value):
        raise SceneError(f"{source}: {what} cannot be read as numbers (they are complex)")
    try:
        return np.array(value, dtype=dtype)
    except (TypeError, ValueError, OverflowError) as error:
        raise SceneError(f"{source}: {what} cannot be read as numbers ({error})") from None


def _whole(value, what, kind, source) -> np.ndarray:
    raw = _array(value, np.float64, what, source)
    if not np.isfinite(raw).all() or (raw != np.floor(raw)).any() or np.abs(raw).max(initial=0) > 2**53:
        raise SceneError(f"{source}: {what} must hold whole {kind}")
    return raw.astype(np.int64)


def _words(value, what, source) -> tuple[str, ...]:
    if isinstance(value, str) or not np.iterable(value):
        raise SceneError(f"{source}: {what} is {value!r}; expected a sequence of names")
    return tuple(str(word) for word in value)


def _cameras(value, source) -> tuple[Camera, ...]:
    if not np.iterable(value) or not all(isinstance(camera, Camera) for camera in value):
        raise SceneError(f"{source}: cameras must be a sequence of Camera")
    return tuple(value)


def _indices(faces, source) -> np.ndarray:
    raw = _whole(faces, "faces", "vertex numbers", source)
    if raw.size == 0:
        return np.zeros((0, 4), np.int64)
    if raw.ndim != 2 or raw.shape[1] not in (3, 4):
        raise SceneError(f"{source}: faces have shape {raw.shape}; expected (n_faces, 3) or (n_faces, 4)")
    result = np.full((len(raw), 4), -1, np.int64)
    result[:, : raw.shape[1]] = raw
    return result


def _check_indices(faces, n_vertices, source) -> None:
    low = faces.copy()
    low[:, 3] = np.maximum(low[:, 3], 0 if n_vertices else -1)
    wrong = (low < 0) | (low >= n_vertices) | (faces < -1)
    if wrong.any():
        face, corner = np.argwhere(wrong)[0]
        raise SceneError(f"{source}: face {face} names vertex {faces[face, corner]}; there are {n_vertices} (0 to {n_vertices - 1})")


def _per_face(value, n, what, source) -> np.ndarray:
    value = _array(value, np.float64, what, source)
    if value.ndim == 0:
        return np.full((n, 1), value)
    if value.ndim == 1 and len(value) == n:
        return value[:, None]
    if value.ndim == 2 and value.shape[0] in (1, n) and value.shape[1] >= 1:
        return np.broadcast_to(value, (n, value.shape[1])).copy()
    raise SceneError(f"{source}: {what} has shape {value.shape}; expected one number, ({n},), (1, n_bands) or ({n}, n_bands)")


def _widen(value, n_bands, source) -> np.ndarray:
    if value.shape[1] not in (1, n_bands):
        raise SceneError(f"{source}: values have {value.shape[1]} and {n_bands} bands; give all the same number, or one")
    return np.broadcast_to(value, (len(value), n_bands)).copy()


def _surfaces(surface, names, n, source) -> tuple[np.ndarray, tuple[str, ...]]:
    index = np.zeros(n, np.int64) if surface is None else _whole(surface, "surface", "surface numbers", source)
    if index.shape != (n,):
        raise SceneError(f"{source}: surface has shape {index.shape}; expected ({n},)")
    if index.min() < 0:
        raise SceneError(f"{source}: surface of face {int(index.argmin())} is {index.min()}; expected 0 or more")
    if names is None:
        if index.max() >= max(n, 1) * 4 + 1024:
            raise SceneError(f"{source}: surface of face {int(index.argmax())} is {index.max()}; number the surfaces from 0 without gaps")
        names = ("surface",) if index.max() == 0 else tuple(f"surface {i}" for i in range(int(index.max()) + 1))
    names = _words(names, "names", source)
    if index.max() >= len(names):
        raise SceneError(f"{source}: face {int(index.argmax())} has surface {index.max()}, but there are {len(names)} names")
    return index.astype(np.int32), names


def _backs(back, two_sided, n, source) -> np.ndarray:
    if back is None:
        sides = _array(two_sided, np.float64, "two_sided", source)
        if sides.shape not in ((), (n,)) or not np.isin(sides, (0, 1)).all():
            raise SceneError(f"{source}: two_sided must be True, False or ({n},) of them")
        return np.where(np.broadcast_to(sides.astype(bool), (n,)), Back.RADIATES, Back.ABSORBS).astype(np.uint8)
    values = _whole(back, "back", "numbers", source)
    values = np.broadcast_to(values, (n,)) if values.ndim == 0 else values
    if values.shape != (n,) or not np.isin(values, tuple(Back)).all():
        raise SceneError(f"{source}: back must hold {', '.join(f'{int(b)} ({b.name.lower()})' for b in Back)} for each of {n} faces")
    return values.astype(np.uint8)


def _check_values(value, what, surface, names, source) -> None:
    top = 1.0 if "reflectance" in what else np.inf
    wrong = ~((value >= 0) & (value < top))
    if wrong.any():
        face, band = np.argwhere(wrong)[0]
        rule = "must lie in [0, 1)" if top == 1.0 else "must be finite and not negative"
        raise SceneError(f"{source}: {what} of face {face} (surface '{names[surface[face]]}', band {band}) is {value[face, band]:g}; it {rule}")


def _bands(bands, n_bands, source) -> tuple[str, ...]:
    if bands is None:
        bands = {1: ("grey",), 3: ("red", "green", "blue")}.get(n_bands, tuple(f"band {i}" for i in range(n_bands)))
    bands = _words(bands, "bands", source)
    if len(bands) != n_bands:
        raise SceneError(f"{source}: {len(bands)} band names for {n_bands} bands")
    return bands


def _parallelograms(vertices, faces) -> tuple[np.ndarray, np.ndarray]:
    """Split quadrilaterals that are no parallelograms in two; also the row each face came from."""
    quad = faces[:, 3] >= 0
    a, b, c, d = (vertices[np.where(quad, faces[:, i], faces[:, 0])] for i in range(4))
    size = np.maximum(np.linalg.norm(b - a, axis=1), np.linalg.norm(d - a, axis=1))
    split = quad & ~(np.linalg.norm(a + c - b - d, axis=1) <= PARALLEL_TOLERANCE * size)
    rows = np.repeat(np.arange(len(faces)), 1 + split)
    result = faces[rows]
    first = np.flatnonzero(np.diff(rows, prepend=-1) & split[rows])
    corners = faces[rows[first]]
    points = vertices[corners]
    # along the diagonal that keeps both halves on one side, also where the quadrilateral is concave
    inside = np.einsum("ij,ij->i", np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]),
                       np.cross(points[:, 2] - points[:, 0], points[:, 3] - points[:, 0])) > 0  # fmt: skip
    one = np.where(inside[:, None], corners[:, [0, 1, 2]], corners[:, [1, 2, 3]])
    two = np.where(inside[:, None], corners[:, [0, 2, 3]], corners[:, [1, 3, 0]])
    result[first] = np.column_stack([one, np.full(len(first), -1)])
    result[first + 1] = np.column_stack([two, np.full(len(first), -1)])
    return result, rows
