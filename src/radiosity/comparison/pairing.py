"""What can be compared of two solutions: rows of their tables, and patches, or overlaps of patches where these differ."""

import numpy as np

from ..errors import SceneError, shown
from ..scene.model import Scene
from ..solution.model import Solution
from .refinement import Places, refined
from .whole_faces import WholeFaces

SHOWN = 6  # names in a note
SAME_AREA = 1e-3  # relative


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
    """The patches that both solutions have, or what their patches have in common; None where their faces differ."""
    one, two = a.patches, b.patches
    if one.scene.geometry_hash == two.scene.geometry_hash and one.cut_hash == two.cut_hash:
        every = np.arange(len(one))
        return Places(one, every, every, True)
    return refined(one, two)


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
    alike = _otherwise_alike(a, b)
    if a.cut is not None or b.cut is not None:
        a, b = (one.take(WholeFaces.among(one).largest) for one in (a, b))
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
    if not found and not alike:
        found.append("the scenes differ in their lights or textures")
    return found


def _otherwise_alike(a: Scene, b: Scene) -> bool:
    """Return whether scenes with the same faces, of which none is a cut of the other, can have the same lights and textures."""
    if a.cut is None or b.cut is None:
        return a.cut is b.cut and a.hash == b.hash
    return a.cut.whole == b.cut.whole and a.lights.digest() == b.lights.digest()


def _keys(solution: Solution) -> dict[tuple[str, str], int]:
    sides, names = solution.sides, solution.patches.scene.names
    return {(names[surface], side): i for i, (surface, side) in enumerate(zip(sides.surface, sides.side, strict=True))}


def _called(key: tuple[str, str]) -> str:
    return f"{key[0]} ({key[1]})"
