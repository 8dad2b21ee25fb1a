"""CSV files: ``x.csv`` with a row for each patch, and beside it ``x.surfaces.csv`` with a row for each surface.

A surface has a row for each side where light reached both; `solution.table.surface_table` explains the columns. ``few arrivals``
is 0 on the dark side of a face. Files are in UTF-8, comma separated, with units in the header row; unknown values are ``nan``.
"""

import csv
import io
from pathlib import Path

import numpy as np

from ..scene.csv_cells import guarded
from ..solution.columns import column_pieces
from ..solution.csv_rows import open_text, write_rows
from ..solution.replacing import replacing
from .look import Look

CHUNK = 1 << 12  # patches: as text, in Python's numbers, they take a few MiB
POWERS = ("emitted", "received", "reflected", "transmitted", "absorbed", "left", "net", "net error", "net low", "net high")


def write(solution, path, look: Look | None = None) -> None:
    """Write both tables; they hold all quantities for any look."""
    _patches(solution, Path(path))
    _surfaces(solution, surfaces_path(path))


def surfaces_path(path) -> Path:
    """Return ``x.surfaces.csv`` for ``x.csv``."""
    path = Path(path)
    return path.with_name(f"{path.stem}.surfaces{path.suffix}")


def _patches(solution, path: Path) -> None:
    names, begin = np.array([_cells([name]) for name in solution.patches.scene.names], object), 0
    with replacing(path) as temporary, open_text(temporary) as file:
        for columns in column_pieces(solution, CHUNK):
            if begin == 0:
                file.write(_cells(columns) + "\n")
            part = slice(begin, begin := begin + len(columns["patch"]))
            columns["surface"] = names[solution.patches.surface[part]]
            row = ",".join("%.9g" if value.dtype.kind == "f" else "%s" for value in columns.values()).__mod__
            file.write("\n".join(map(row, zip(*(value.tolist() for value in columns.values()), strict=True))) + "\n")


def _surfaces(solution, path: Path) -> None:
    rows, scene = solution.surface_table(), solution.patches.scene
    units = {"area": "m²", "dark": "m²", "radiosity": solution.unit, "irradiance": solution.irradiance_unit}
    units["illuminance"] = "lx"
    units |= dict.fromkeys(POWERS, scene.power_unit)
    write_rows(rows, path, [_titled(key, units) for key in rows[0]])


def _titled(key: str, units: dict[str, str]) -> str:
    """Return a title such as ``radiosity red [W/m²]`` for ``radiosity [red]``."""
    quantity, _, band = key.removesuffix("]").partition(" [")
    title = f"{quantity} {band}" if band else key
    return f"{title} [{units[quantity]}]" if quantity in units else title


def _cells(values) -> str:
    """Return values as the text of a row, quoted where CSV needs it."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\r\n").writerow(map(guarded, values))  # so that either of them within a name is quoted
    return text.getvalue()[:-2]
