"""Sensors in tables of comma-separated values."""

import csv
from pathlib import Path

import numpy as np

from ..errors import SceneError, shown
from .csv_cells import is_number, unguarded
from .habits import warn

POINT, NORMAL = ("x", "y", "z"), ("nx", "ny", "nz")
COLUMNS = (*POINT, *NORMAL, "name")
UP = (0.0, 0.0, 1.0)


def read(path, name: str | None = None, normal=UP) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Return the sets of sensors of a table, see `sensors.model.Sensors.from_csv`: name, points and normals, (n, 3) each."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError(f"{path}: cannot be read as a table of sensors ({error})") from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")]
    if not lines:
        raise SceneError(f"{path}: has no sensors; give a line x,y,z for each")
    mark = next((mark for mark in (";", "\t", ",") if mark in lines[0][1]), " ")
    rows = [(number, _cells(line, mark)) for number, line in lines]
    head = [cell.lower() for cell in rows[0][1]]
    if is_number(head[0]):
        head = list(COLUMNS[: len(head)]) if len(head) in (3, 6, 7) else []
        if not head:
            raise SceneError(f"{path}, line {rows[0][0]}: has {len(rows[0][1])} values; points have 3, or 6 with a normal")
    else:
        rows = rows[1:]
    if missing := [one for one in POINT if one not in head]:
        raise SceneError(f"{path}: has no column {', '.join(missing)}; it has {', '.join(head)}")
    given = [one for one in NORMAL if one in head]
    if 0 < len(given) < len(NORMAL):
        lacks = ", ".join(one for one in NORMAL if one not in head)
        raise SceneError(f"{path}: has the columns {', '.join(given)}, and not {lacks}; give all of a normal, or none")
    if twice := sorted({one for one in head if head.count(one) > 1}):
        raise SceneError(f"{path}: has two columns {', '.join(twice)}; give each its own name")
    if others := [one for one in head if one not in COLUMNS]:
        warn(f"{path}: the columns {shown(others)} are not read; sensors have {', '.join(COLUMNS)}")
    has_normals = bool(given)
    points, normals, names = [], [], []
    for number, cells in rows:
        if len(cells) != len(head):
            raise SceneError(f"{path}, line {number}: has {len(cells)} values, and the head has {len(head)}")
        row = dict(zip(head, cells, strict=True))
        points.append([_number(row, key, path, number) for key in POINT])
        normals.append([_number(row, key, path, number) for key in NORMAL] if has_normals else list(normal))
        names.append(unguarded(row.get("name") or "") or name or path.stem)
    if not points:
        raise SceneError(f"{path}: has a head and no sensors")
    rows_of = {one: [i for i, other in enumerate(names) if other == one] for one in dict.fromkeys(names)}
    return [(one, np.array(points)[some], np.array(normals)[some]) for one, some in rows_of.items()]


def _cells(line: str, mark: str) -> list[str]:
    if mark == " ":
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=mark))]


def _number(row: dict[str, str], key: str, path: Path, number: int) -> float:
    try:
        return float(row[key])
    except ValueError:
        raise SceneError(f"{path}, line {number}: {key} is '{row[key]}'; it must be a number") from None
