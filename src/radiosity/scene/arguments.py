"""Checks of the arguments of `Scene.from_arrays`: each returns an array of its full shape, or raises a SceneError."""

import numpy as np

from ..errors import SceneError
from .back import Back
from .camera import Camera
from .one_row import is_one_row, row_or_all

MOST = 2**53  # of whole numbers: all up to there are numbers of double precision, too
LARGEST = 1e30  # of emission, colours and texture coordinates: products and single precision copies of them are finite


def array(value, dtype, what, source, copy: bool = True) -> np.ndarray:
    """An array of numbers; without ``copy`` perhaps the one that is given."""
    if isinstance(value, np.ndarray) and np.iscomplexobj(value):
        raise SceneError(f"{source}: {what} cannot be read as numbers (they are complex)")
    try:
        return np.array(value, dtype=dtype) if copy else np.asarray(value, dtype=dtype)
    except (TypeError, ValueError, OverflowError) as error:
        raise SceneError(f"{source}: {what} cannot be read as numbers ({error})") from None


def whole(value, what, kind, source, copy: bool = True) -> np.ndarray:
    """An array of whole numbers, int64; without ``copy`` perhaps the one that is given."""
    if isinstance(value, np.ndarray) and value.dtype.kind in "iu":
        some = row_or_all(value)
        if value.dtype.itemsize <= 4 or -MOST <= some.min(initial=0) <= some.max(initial=0) <= MOST:
            return np.array(value, np.int64) if copy else np.asarray(value, np.int64)
    raw = array(value, np.float64, what, source)
    if not np.isfinite(raw).all() or (raw != np.floor(raw)).any() or np.abs(raw).max(initial=0) > MOST:
        raise SceneError(f"{source}: {what} must hold whole {kind}")
    return raw.astype(np.int64)


def words(value, what, source) -> tuple[str, ...]:
    """A sequence of names."""
    if isinstance(value, str) or not np.iterable(value):
        raise SceneError(f"{source}: {what} is {value!r}; expected a sequence of names")
    return tuple(str(word) for word in value)


def cameras_of(value, source) -> tuple[Camera, ...]:
    """A sequence of cameras."""
    if not np.iterable(value) or not all(isinstance(camera, Camera) for camera in value):
        raise SceneError(f"{source}: cameras must be a sequence of Camera")
    return tuple(value)


def indices(faces, source, copy: bool = True) -> np.ndarray:
    """Return the corners of faces, (n_faces, 4) int64, -1 in the last column of triangles."""
    raw = whole(faces, "faces", "vertex numbers", source, copy)
    if raw.size == 0:
        return np.zeros((0, 4), np.int64)
    if raw.ndim != 2 or raw.shape[1] not in (3, 4):
        raise SceneError(f"{source}: faces have shape {raw.shape}; expected (n_faces, 3) or (n_faces, 4)")
    if raw.shape[1] == 4:
        return raw
    result = np.full((len(raw), 4), -1, np.int64)
    result[:, : raw.shape[1]] = raw
    return result


def check_indices(faces, n_vertices, source) -> None:
    """Refuse corners that are no vertices."""
    if n_vertices and faces.min() >= -1 and faces[:, :3].min() >= 0 and faces.max() < n_vertices:
        return
    low = faces.copy()
    low[:, 3] = np.maximum(low[:, 3], 0 if n_vertices else -1)
    wrong = (low < 0) | (low >= n_vertices) | (faces < -1)
    if wrong.any():
        face, corner = np.argwhere(wrong)[0]
        raise SceneError(
            f"{source}: face {face} names vertex {faces[face, corner]}; there are {n_vertices} (0 to {n_vertices - 1})"
        )


def per_face(value, n, what, source, copy: bool = True) -> np.ndarray:
    """Return a value of each face, (n, 1) or (n, n_bands) float64."""
    value = array(value, np.float64, what, source, copy)
    if value.ndim == 0:
        return np.full((n, 1), value)
    if value.ndim == 1 and len(value) == n:
        return value[:, None]
    if value.ndim == 2 and value.shape[0] == n and value.shape[1] >= 1:
        return value
    if value.ndim == 2 and value.shape[0] == 1 and value.shape[1] >= 1:
        return np.broadcast_to(value, (n, value.shape[1])).copy()
    raise SceneError(f"{source}: {what} has shape {value.shape}; expected one number, ({n},), (1, n_bands) or ({n}, n_bands)")


def widen(value, n_bands, source) -> np.ndarray:
    """Return values of faces in all bands, from one or all of them, (n, n_bands) float64."""
    if value.shape[1] not in (1, n_bands):
        raise SceneError(f"{source}: values have {value.shape[1]} and {n_bands} bands; give all the same number, or one")
    return value if value.shape[1] == n_bands else np.broadcast_to(value, (len(value), n_bands)).copy()


def surfaces_of(surface, names, n, source, copy: bool = True) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return the surface of each face, (n,) int32, and the names of all surfaces."""
    index = np.zeros(n, np.int64) if surface is None else whole(surface, "surface", "surface numbers", source, copy)
    if index.shape != (n,):
        raise SceneError(f"{source}: surface has shape {index.shape}; expected ({n},)")
    least, most = int(row_or_all(index).min()), int(row_or_all(index).max())
    if least < 0:
        raise SceneError(f"{source}: surface of face {int(index.argmin())} is {least}; expected 0 or more")
    if names is None:
        if most >= max(n, 1) * 4 + 1024:
            raise SceneError(
                f"{source}: surface of face {int(index.argmax())} is {most}; number the surfaces from 0 without gaps"
            )
        names = ("surface",) if most == 0 else tuple(f"surface {i}" for i in range(int(most) + 1))
    names = words(names, "names", source)
    if most >= len(names):
        raise SceneError(f"{source}: face {int(index.argmax())} has surface {most}, but there are {len(names)} names")
    return _narrow(index, np.int32), names


def backs_of(back, two_sided, n, source, copy: bool = True) -> np.ndarray:
    """Return the `Back` of each face, (n,) uint8."""
    if back is None:
        sides = array(two_sided, np.float64, "two_sided", source)
        if sides.shape not in ((), (n,)) or not np.isin(sides, (0, 1)).all():
            raise SceneError(f"{source}: two_sided must be True, False or ({n},) of them")
        return np.where(np.broadcast_to(sides.astype(bool), (n,)), Back.RADIATES, Back.ABSORBS).astype(np.uint8)
    values = whole(back, "back", "numbers", source, copy)
    values = np.broadcast_to(values, (n,)) if values.ndim == 0 else values
    some = row_or_all(values)
    if values.shape != (n,) or not 0 <= some.min() <= some.max() <= max(Back):
        raise SceneError(
            f"{source}: back must hold {', '.join(f'{int(b)} ({b.name.lower()})' for b in Back)} for each of {n} faces"
        )
    return _narrow(values, np.uint8)


def _narrow(values: np.ndarray, dtype) -> np.ndarray:
    """Return whole numbers, (n,), in a narrower type; of equal ones there is one in memory where it was so before."""
    return np.broadcast_to(values[:1].astype(dtype), len(values)) if is_one_row(values) else values.astype(dtype)


def check_values(value, what, surface, names, source) -> None:
    """Refuse reflectances and emissions out of range."""
    top, some = 1.0 if "reflectance" in what else LARGEST, row_or_all(value)
    if not value.size or 0 <= some.min() <= some.max() < top:
        return
    wrong = ~((value >= 0) & (value < top))
    if wrong.any():
        face, band = np.argwhere(wrong)[0]
        rule = "must lie in [0, 1): strictly below 1" if top == 1.0 else f"must be finite and not negative, below {LARGEST:g}"
        raise SceneError(
            f"{source}: {what} of face {face} (surface '{names[surface[face]]}', band {band}) is {value[face, band]:g}; it {rule}"
        )


def check_open(back, reflectance, surface, names, source) -> None:
    """Refuse open faces that reflect: lines pass through them."""
    if not (row_or_all(back) == Back.OPEN).any():
        return
    wrong = (back == Back.OPEN) & (reflectance > 0).any(axis=1)
    if wrong.any():
        face = int(np.flatnonzero(wrong)[0])
        raise SceneError(
            f"{source}: face {face} (surface '{names[surface[face]]}') is open, so that lines pass, and has a reflectance of "
            f"{reflectance[face].max():g}; set it to 0, or choose another back"
        )


def bands_of(bands, n_bands, source) -> tuple[str, ...]:
    """The names of the bands."""
    if bands is None:
        bands = {1: ("grey",), 3: ("red", "green", "blue")}.get(n_bands, tuple(f"band {i}" for i in range(n_bands)))
    bands = words(bands, "bands", source)
    if len(bands) != n_bands:
        raise SceneError(f"{source}: {len(bands)} band names for {n_bands} bands")
    return bands
