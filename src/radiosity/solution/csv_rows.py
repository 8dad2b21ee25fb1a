"""CSV files of rows with the same keys: UTF-8, comma separated, a header row; unknown values are ``nan``.

No name is a formula in spreadsheets (`scene.csv_cells`).
"""

import csv
from collections.abc import Iterable
from pathlib import Path
from typing import TextIO

from ..scene.csv_cells import guarded
from .replacing import replacing


def write_rows(rows: list[dict], path, titles: Iterable[str] | None = None) -> None:
    """Write a table, a line for each row.

    Args:
        rows: at least one row, all with the same keys.
        path: the file to write.
        titles: titles of the columns; default: the keys.

    Raises:
        OutputError: the file cannot be written.
    """
    with replacing(path) as temporary, open_text(temporary) as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(map(guarded, rows[0] if titles is None else titles))
        writer.writerows(map(guarded, row.values()) for row in rows)


def open_text(path: Path) -> TextIO:
    """Open a CSV file for writing."""
    return path.open("w", encoding="utf-8", errors="backslashreplace", newline="")
