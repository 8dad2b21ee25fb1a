"""View3D's geometry (.vs3): numbered vertices, and surfaces of three or four of them with an emissivity and a name.

Format 3 is read. The front of a surface is where its vertices go counter-clockwise; the back absorbs. The emissivity is that of
heat, and 1 - emissivity the reflectance. Surfaces that are combined with an earlier one belong to it. Control lines (C) are about
View3D's own run, and left out.
"""

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ...errors import SceneError, shown
from ..assemble import Material, Part, ReadOptions, assemble, warn
from ..heat import Heat
from ..model import Back, Scene
from .encoding import decode
from .names import numbered, repeated

COMMENT = re.compile(r"(?:^|(?<=[\s,]))!")
SURFACES = {"S": "surface", "M": "mask", "N": "null surface", "O": "obstruction"}
OBSTRUCTION = "obstruction"  # name of what only obstructs
COLUMNS = "number v1 v2 v3 v4 base cmb emissivity name (v4 is 0 in triangles)"


@dataclass(frozen=True)
class Row:
    """A surface of the file, on a line of it.

    Attributes:
        kind: S, M, N or O.
        corners: three or four numbers of vertices, from 0.
        base, combined: the number of another surface, or 0.
    """

    line: int
    kind: str
    corners: tuple[int, ...]
    base: int = 0
    combined: int = 0
    emissivity: float = 1.0
    name: str = OBSTRUCTION


def read(path: Path, options: ReadOptions) -> Scene:
    """Read a .vs3 file.

    Raises:
        SceneError: another format than 3, damaged, or with surfaces within surfaces.
    """
    vertices, rows = _lines(path, options)
    if not rows:
        raise SceneError(f"{path}: the file holds no surfaces (lines that begin with S)")
    within = [f"{row.name} ({SURFACES[row.kind]}, line {row.line})" for row in rows if row.base or row.kind in "MN"]
    if within:
        raise SceneError(
            f"{path}: surfaces within surfaces are not read: {shown(within)}; cut the surface that holds them into pieces around "
            "them, and combine the pieces (cmb)"
        )
    owners = [_owner(path, number, rows) for number in range(len(rows))]
    names = _names(path, rows, owners)
    corners: dict[int, list[tuple[int, ...]]] = {}
    for owner, row in zip(owners, rows, strict=True):
        corners.setdefault(owner, []).append(tuple(row.corners) + (-1,) * (4 - len(row.corners)))
    called = dict(zip(owners, names, strict=True))
    parts = [_part(called[owner], vertices, np.array(found), _material(rows[owner], path)) for owner, found in corners.items()]
    scene = assemble(parts, str(path), options)
    emissivity = {names[owner]: (rows[owner].emissivity,) for owner in owners if rows[owner].kind == "S"}
    heat = replace(Heat.none(len(scene.names)), emissivity=tuple(emissivity.get(name) for name in scene.names))
    return replace(scene, heat=heat)


def _part(name: str, vertices: np.ndarray, corners: np.ndarray, material: Material) -> Part:
    """Return a surface with the vertices that it has: one list of all of them for each surface would not fit into memory."""
    own, index = np.unique(corners[corners >= 0], return_inverse=True)
    faces = np.full(corners.shape, -1)
    faces[corners >= 0] = index.reshape(-1)
    return Part(name, vertices[own], faces, material)


def _lines(path: Path, options: ReadOptions) -> tuple[np.ndarray, list[Row]]:
    """Return vertices, (n, 3), and surfaces in the order of the file."""
    vertices: list[tuple[float, ...]] = []
    rows: list[Row] = []
    unknown: list[str] = []
    for line, text in enumerate(decode(path.read_bytes(), str(path)).text.splitlines(), 1):
        words = COMMENT.split(text)[0].replace(",", " ").split()
        kind = words[0][0].upper() if words else "/"
        if kind in "*E":
            break
        where = f"{path}: line {line}"
        if kind == "F":
            _refuse_other(where, words[1:])
        elif kind == "V":
            number, *place = _numbers(where, words, 4, "a vertex is: V number x y z")
            _that(
                number == len(vertices) + 1,
                f"{where}: vertex {number:g} comes where {len(vertices) + 1} should; number them in turn",
            )
            vertices.append(tuple(place))
        elif kind in SURFACES:
            rows.append(_row(where, line, kind, words, len(rows) + 1, len(vertices)))
        elif kind not in "/TC":
            unknown.append(f"{words[0]} (line {line})")
    if unknown:
        text = f"{path}: lines that begin with something else than V, S and O are left out: {shown(unknown)}"
        if options.strict:
            raise SceneError(text)
        warn(text)
    return np.array(vertices, float).reshape(-1, 3), rows


def _refuse_other(where: str, words: list[str]) -> None:
    _that(words == ["3"], f"{where}: format F {' '.join(words)} is not read; only F 3 is (vertices and surfaces apart, in space)")


def _row(where: str, line: int, kind: str, words: list[str], due: int, n_vertices: int) -> Row:
    what = f"a {SURFACES[kind]} is: {kind} number v1 v2 v3 v4" if kind == "O" else f"a {SURFACES[kind]} is: {kind} {COLUMNS}"
    number, *corners = _numbers(where, words, 5, what)
    _that(number == due, f"{where}: surface {number:g} comes where {due} should; number them in turn")
    corners = corners[:3] if corners[3] == 0 else corners
    for corner in corners:
        _that(
            corner == int(corner) and 1 <= corner <= n_vertices,
            f"{where}: surface {due} names vertex {corner:g}; there are {n_vertices} before it",
        )
    found = Row(line, kind, tuple(int(corner) - 1 for corner in corners))
    if kind == "O":
        return found
    base, combined, emissivity = _numbers(where, words[5:], 3, what)
    _that(0 < emissivity <= 1, f"{where}: the emissivity of surface {due} is {emissivity:g}; it must be above 0, and 1 at most")
    _that(
        base == int(base) >= 0 and combined == int(combined) >= 0, f"{where}: base and cmb of surface {due} must be whole numbers"
    )
    name = words[9] if len(words) > 9 else f"surface {due}"
    return replace(found, base=int(base), combined=int(combined), emissivity=emissivity, name=name)


def _numbers(where: str, words: list[str], many: int, what: str) -> list[float]:
    """Return so many finite numbers behind the first word."""
    try:
        values = [float(word) for word in words[1 : many + 1]]
    except ValueError:
        values = []
    _that(len(values) == many and bool(np.isfinite(values).all()), f"{where}: '{' '.join(words)[:80]}' cannot be read; {what}")
    return values


def _owner(path: Path, number: int, rows: list[Row]) -> int:
    """Return the index of the surface that one belongs to: its own, or that of the earlier one that it is combined with."""
    row = rows[number]
    if row.combined == 0:
        return number
    where = f"{path}: line {row.line}: '{row.name}'"
    _that(row.combined <= number, f"{where} is combined with surface {row.combined}; that must be an earlier one")
    owner = rows[row.combined - 1]
    _that(owner.combined == 0 and owner.kind == "S", f"{where} is combined with '{owner.name}', which is no surface of its own")
    alike = owner.emissivity == row.emissivity
    _that(
        alike,
        f"{where} has the emissivity {row.emissivity:g}, and '{owner.name}', with which it is combined, {owner.emissivity:g}",
    )
    return row.combined - 1


def _names(path: Path, rows: list[Row], owners: list[int]) -> list[str]:
    """Return the name of each surface's owner; equal names get numbers. What only obstructs has one name."""
    own = [rows[i].name for i in sorted(set(owners)) if rows[i].kind == "S"]
    if several := repeated(own):
        warn(f"{path}: surfaces of the same name get numbers (name#2, ...) in the order of the file: {shown(several)}")
    obstructing = [f"line {row.line}" for row in rows if row.kind == "O"]
    if obstructing:
        text = f"obstructions are black surfaces called '{OBSTRUCTION}' here, which radiate to both sides"
        warn(f"{path}: {text}: {shown(obstructing)}")
    taken: dict[str, int] = {}
    given = {i: numbered(rows[i].name, taken) for i in sorted(set(owners)) if rows[i].kind == "S"}
    return [given.get(owner, OBSTRUCTION) for owner in owners]


def _material(row: Row, path: Path) -> Material:
    back = Back.RADIATES if row.kind == "O" else Back.ABSORBS
    return Material(reflectance=(1 - row.emissivity,), back=back, given=True, origin=str(path))


def _that(holds: bool, otherwise: str) -> None:
    if not holds:
        raise SceneError(otherwise)
