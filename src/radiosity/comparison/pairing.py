"""What can be compared of two solutions: rows of their tables, and patches, or points where the patches differ."""

from dataclasses import dataclass

import numpy as np

from ..errors import SceneError, shown
from ..patches import cells
from ..patches.model import Patches
from ..scene.model import Scene
from ..solution.model import Solution

SHOWN = 6  # names in a note
SAME_AREA = 1e-3  # relative


@dataclass(frozen=True, eq=False)
class Places:
    """Patches of which each lies within one patch of both solutions.

    Attributes:
        patches: they are cut as finely as the finer of both, face by face.
        first, second: (k,) int, the patch of each solution that the middle of each of these patches is on.
        equal: the patches of both solutions are these.
    """

    patches: Patches
    first: np.ndarray
    second: np.ndarray
    equal: bool


def check_comparable(a: Solution, b: Solution) -> None:
    """Refuse solutions of other bands or units, and those without results.

    Raises:
        SceneError: what differs.
    """
    for name, one in (("first", a), ("second", b)):
        if one.quanta == 0:
            raise SceneError(f"the {name} solution has no results yet: its run was stopped within its first stage; resume it")
    if a.bands != b.bands:
        raise SceneError(
            f"the first solution has the bands {shown(a.bands)} and the second {shown(b.bands)}; "
            "solve one of the scenes with the other's bands"
        )
    if a.unit != b.unit:
        raise SceneError(f"the first solution is in {a.unit} and the second in {b.unit}; their numbers mean different things")


def places(a: Solution, b: Solution) -> Places | None:
    """The patches or points that both solutions have; None where their faces differ."""
    one, two = a.patches, b.patches
    if one.scene.is_cut_of(two.scene, any_light=True):
        return Places(one, np.arange(len(one)), _within(one, two), False)
    if two.scene.is_cut_of(one.scene, any_light=True):
        return Places(two, _within(two, one), np.arange(len(two)), False)
    if one.scene.geometry_hash != two.scene.geometry_hash:
        return None
    if one.cut_hash == two.cut_hash:
        every = np.arange(len(one))
        return Places(one, every, every, True)
    common = Patches(one.scene, np.maximum(one.columns, two.columns), np.maximum(one.rows, two.rows))
    u, v = _middles(common)
    return Places(common, _number(one, common, u, v), _number(two, common, u, v), False)


def _within(parts: Patches, whole: Patches) -> np.ndarray:
    """The patch of a whole scene that the middle of each patch of a cut one is on (`Scene.cut`), (n_patches,) int."""
    cut = parts.scene.cut
    assert cut is not None
    face = cut.face[parts.face]
    origin, first, second = (frame[face] for frame in whole.scene.frames)
    from_origin = parts.centroid - origin
    products = [np.einsum("ij,ij->i", one, other) for one, other in ((first, first), (first, second), (second, second))]
    along = [np.einsum("ij,ij->i", from_origin, edge) for edge in (first, second)]
    determinant = products[0] * products[2] - products[1] ** 2
    u = (products[2] * along[0] - products[1] * along[1]) / determinant
    v = (products[0] * along[1] - products[1] * along[0]) / determinant
    u, v = np.clip(u, 0, 1), np.clip(v, 0, 1)
    cell = cells.number(u, v, whole.columns[face], whole.rows[face], whole.scene.is_quad[face])
    return whole.first[face] + np.where(parts.is_back, whole.cells_per_face[face], 0) + cell


def _middles(patches: Patches) -> tuple[np.ndarray, np.ndarray]:
    """Face coordinates of the middle of each patch, (n_patches,) each."""
    column, row, inverted = patches.place
    middle = np.where(patches.scene.is_quad[patches.face], 0.5, np.where(inverted, 2 / 3, 1 / 3))
    return (column + middle) / patches.columns[patches.face], (row + middle) / patches.rows[patches.face]


def _number(patches: Patches, common: Patches, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    face = common.face
    cell = cells.number(u, v, patches.columns[face], patches.rows[face], patches.scene.is_quad[face])
    return patches.first[face] + np.where(common.is_back, patches.cells_per_face[face], 0) + cell


def paired_rows(a: Solution, b: Solution) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Rows of both tables that are of the same surface and side, (k,) int each, and notes about the others.

    Raises:
        SceneError: no surface has the same name in both.
    """
    keys = [_keys(one) for one in (a, b)]
    both = [key for key in keys[0] if key in keys[1]]
    if not both:
        raise SceneError(
            f"the solutions have no surface in common: the first has {shown(a.patches.scene.names, SHOWN)}, "
            f"and the second {shown(b.patches.scene.names, SHOWN)}; compare solutions of one scene"
        )
    notes = []
    for which, own, other in (("first", *keys), ("second", *keys[::-1])):
        if alone := [_called(key) for key in own if key not in other]:
            notes.append(f"surfaces and sides that only the {which} solution has are left out: {shown(alone, SHOWN)}")
    rows = [np.array([own[key] for key in both]) for own in keys]
    areas = [row_areas(one)[row] for one, row in zip((a, b), rows, strict=True)]
    unlike = np.abs(areas[0] - areas[1]) > SAME_AREA * np.maximum(*areas)
    if unlike.any():
        names = [f"{_called(both[i])} ({areas[0][i]:.4g} and {areas[1][i]:.4g} m²)" for i in np.flatnonzero(unlike)]
        notes.append(f"areas differ, so that means are not of the same places: {shown(names, SHOWN)}")
    return rows[0], rows[1], notes


def row_areas(solution: Solution) -> np.ndarray:
    """Areas of the rows of the table, (n_rows,) m²."""
    row, patches = solution.sides.row, solution.patches
    return np.bincount(row[row >= 0], patches.area[row >= 0], len(solution.sides.surface))


def other_light(a: Scene, b: Scene) -> list[str]:
    """Notes about equal faces that emit or reflect differently: that is a difference that no error explains."""
    if a.is_cut_of(b) or b.is_cut_of(a):
        return []
    if a.cut is not None and a.is_cut_of(b, any_light=True):
        b = b.take(a.cut.face)
    elif b.cut is not None and b.is_cut_of(a, any_light=True):
        a = a.take(b.cut.face)
    found = []
    for what, names in (("reflectance", ("reflectance", "back_reflectance")), ("emission", ("emission", "back_emission"))):
        pairs = [(getattr(a, name), getattr(b, name)) for name in names]
        unlike = np.any([(one != two).any(axis=1) for one, two in pairs], axis=0)
        if unlike.any():
            surfaces = [a.names[i] for i in np.unique(a.surface[unlike])]
            found.append(f"the scenes differ in the {what} of {shown(surfaces, SHOWN)}")
    shares = [np.zeros(1) if one.diffuse_transmittance is None else one.diffuse_transmittance for one in (a, b)]
    unlike = np.broadcast_to((shares[0] != shares[1]).any(axis=-1), (a.n_faces,))
    if unlike.any():
        surfaces = [a.names[i] for i in np.unique(a.surface[unlike])]
        found.append(f"the scenes differ in the diffuse transmittance of {shown(surfaces, SHOWN)}")
    if not found and a.hash != b.hash:
        found.append("the scenes differ in their lights or textures")
    return found


def _keys(solution: Solution) -> dict[tuple[str, str], int]:
    sides, names = solution.sides, solution.patches.scene.names
    return {(names[surface], side): i for i, (surface, side) in enumerate(zip(sides.surface, sides.side, strict=True))}


def _called(key: tuple[str, str]) -> str:
    return f"{key[0]} ({key[1]})"
