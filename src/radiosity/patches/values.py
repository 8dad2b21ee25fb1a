"""Emission and reflectance that a caller gives for patches: one number, an array, or a dictionary by names of surfaces."""

from collections.abc import Mapping

import numpy as np

from ..errors import SceneError
from ..scene.arguments import LARGEST, array
from ..scene.heat import SIDES
from ..scene.named import surfaces_called
from .model import Patches


def values_of(patches: Patches, given, what: str) -> np.ndarray | None:
    """Return the values of all patches, (n_patches, n_bands) float64, or (n_patches, 1) for a value that all bands have.

    Args:
        given: None is what the patches have: None is returned. See `relit` for the others.
        what: "emission" or "reflectance".

    Raises:
        SceneError: other shapes, or values out of range. MethodError: no such surface.
    """
    if given is None:
        return None
    values = _by_name(patches, given, what) if isinstance(given, Mapping) else _by_array(patches, given, what)
    _check(patches, values, what)
    return values


def widened(values: np.ndarray, bands: int, what: str) -> np.ndarray:
    """Return values in a number of bands, from one or all of them.

    Raises:
        SceneError: there are others.
    """
    if values.shape[1] not in (1, bands):
        raise SceneError(f"{what} has {values.shape[1]} bands, and there are {bands}; give emission and reflectance in the same")
    return np.broadcast_to(values, (len(values), bands)).copy()


def _by_array(patches: Patches, given, what: str) -> np.ndarray:
    n, surfaces, source = len(patches), len(patches.scene.names), patches.scene.source
    value = array(given, np.float64, what, source)
    if value.ndim == 0:
        return np.full((n, 1), value)
    if value.ndim == 1:
        value = value[:, None]
    by_surface = len(value) == surfaces and (n != surfaces or np.array_equal(patches.surface, np.arange(n)))
    if value.ndim == 2 and value.shape[1] >= 1:
        if len(value) == n and (n != surfaces or by_surface):
            return value
        if by_surface:
            return value[patches.surface]
        if len(value) == 1:
            return np.repeat(value, n, axis=0)
        if len(value) == n:
            raise SceneError(
                f"{source}: {what} has {n} rows, and there are as many patches as surfaces, in another order; give a dictionary "
                "by names of surfaces"
            )
    raise SceneError(
        f"{source}: {what} has shape {np.shape(given)}; expected one number, (1, n_bands), ({n},) or ({n}, n_bands) for patches, "
        f"or ({surfaces},) or ({surfaces}, n_bands) for surfaces"
    )


def _by_name(patches: Patches, given: Mapping, what: str) -> np.ndarray:
    """Return the patches' own values with those of some surfaces replaced, in the order of the dictionary."""
    source, names = patches.scene.source, patches.scene.names
    result: np.ndarray = patches.emission if what == "emission" else patches.reflectance
    parts: list[tuple[np.ndarray, np.ndarray]] = []
    for name, value in given.items():
        if not isinstance(name, str):
            raise SceneError(f"{source}: {what} names a surface {name!r}; it must be a text")
        rows = np.isin(patches.surface, surfaces_called(names, name))
        for some, one in of_sides(patches, rows, value, what, name):
            row = array(one, np.float64, f"{what} of '{name}'", source)
            if row.ndim > 1 or row.size == 0:
                raise SceneError(f"{source}: {what} of '{name}' has shape {row.shape}; expected one number, or one for each band")
            parts.append((some, np.atleast_1d(row)))
    bands = max([result.shape[1], *(len(row) for _, row in parts)])
    result = widened(result, bands, what)
    for some, row in parts:
        result[some] = widened(row[None], bands, what)[0]
    return result


def of_sides(patches: Patches, rows: np.ndarray, value, what: str, name: str):
    """Yield which patches of a surface a value is for, and the value; a dictionary of sides has one for each.

    An emission without a side is that of the sides that emit in the scene, face by face; where none does, that of all.
    """
    if isinstance(value, Mapping):
        unknown = [str(side) for side in value if side not in SIDES]
        if unknown or not value:
            word = f"a side '{unknown[0]}'" if unknown else "no side"
            raise SceneError(f"{patches.scene.source}: {what} of '{name}' has {word}; sides are front and back")
        for side, one in value.items():
            some = rows & (patches.is_back == (side == "back"))
            if not some.any():
                raise SceneError(f"{patches.scene.source}: {what} of '{name}': its {side} does not radiate; leave the {side} out")
            yield some, one
    elif what == "emission":
        yield rows & _emitting(patches, rows), value
    else:
        yield rows, value


def _emitting(patches: Patches, rows: np.ndarray) -> np.ndarray:
    """Return the patches on sides that emit, of each face or else of any face of the surface; all of them where none emits."""
    emits = patches.emission.any(axis=1) & rows
    by_face = np.zeros((patches.scene.n_faces, 2), bool)
    by_face[patches.face[emits], patches.is_back[emits].astype(int)] = True
    surface = patches.scene.surface
    by_surface = np.zeros((len(patches.scene.names), 2), bool)
    np.logical_or.at(by_surface, surface, by_face)
    usual = np.where(by_surface.any(axis=1, keepdims=True), by_surface, True)[surface]
    chosen = np.where(by_face.any(axis=1, keepdims=True), by_face, usual)
    return chosen[patches.face, patches.is_back.astype(int)]


def _check(patches: Patches, values: np.ndarray, what: str) -> None:
    """Refuse values out of range, and panes that would give back more light than they get."""
    through, diffuse = patches.transmittance, patches.diffuse_transmittance
    if diffuse is not None and 1 in (diffuse.shape[1], values.shape[1], 1 + abs(diffuse.shape[1] - values.shape[1])):
        through = through + diffuse.max(axis=1) if values.shape[1] == 1 else through[:, None] + diffuse
    through = np.broadcast_to(through.reshape(len(values), -1), values.shape)
    excess = (through > 0) & (values + through >= 1)
    if what == "reflectance" and excess.any():
        patch, band = np.argwhere(excess)[0]
        where = f"patch {patch} (surface '{patches.scene.names[patches.surface[patch]]}', band {band})"
        raise SceneError(
            f"{patches.scene.source}: reflectance of {where} is {values[patch, band]:g}, and its transmittance "
            f"{through[patch, band]:g}; the sum must be strictly below 1"
        )
    top = 1.0 if what == "reflectance" else LARGEST
    wrong = ~((values >= 0) & (values < top))
    if wrong.any():
        patch, band = np.argwhere(wrong)[0]
        rule = "must lie in [0, 1): strictly below 1" if top == 1.0 else f"must be finite and not negative, below {LARGEST:g}"
        where = f"patch {patch} (surface '{patches.scene.names[patches.surface[patch]]}', band {band})"
        raise SceneError(f"{patches.scene.source}: {what} of {where} is {values[patch, band]:g}; it {rule}")
