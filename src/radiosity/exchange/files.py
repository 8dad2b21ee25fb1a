"""Files of a radiative exchange: tables and pictures."""

from pathlib import Path

from ..errors import OutputError
from ..image.output import check_writable as check_one
from ..image.output import require
from ..solution.csv_rows import write_rows
from .report import SURROUNDINGS

SUFFIXES = (".npz", ".csv", ".png")
BESIDE = {".csv": ("exchange",), ".png": ("exchange", "flows")}  # words of the files beside one
UNITS = {"area": "m²", "flux": "W/m²"} | {
    f"{what}{end}": unit for what, unit in (("temperature", "K"), ("net", "W")) for end in ("", " error", " low", " high")
}


def files_of(path) -> tuple[Path, ...]:
    """Return the files that `export` writes for a path.

    Beside ``x.csv`` goes ``x.exchange.csv``, and beside ``x.png``, the picture of net heat, ``x.exchange.png`` and
    ``x.flows.png``.
    """
    path = Path(path)
    return (path, *(path.with_name(f"{path.stem}.{word}{path.suffix}") for word in BESIDE.get(path.suffix.lower(), ())))


def check_writable(path) -> None:
    """Refuse, before any work, a file that could not be written.

    Raises:
        OutputError: the format is unknown, the folder cannot be written, or a library is missing.
    """
    for file in files_of(path):
        check_one(file, SUFFIXES)
    if Path(path).suffix.lower() == ".png":
        require("PIL", f"{path}: writing PNG")
        require("matplotlib", f"{path}: a picture of heat")


def export(found, path: Path) -> Path:
    """Write the files of a path; see `RadiativeExchange.export`."""
    check_writable(path)
    suffix = path.suffix.lower()
    if suffix == ".npz":
        return found.save(path)
    files = files_of(path)
    if suffix == ".csv":
        _table(found, files[0])
        _exchange(found, files[1])
    elif suffix == ".png":
        from . import flow_picture, pictures

        pictures.heat(found, files[0])
        pictures.exchange(found, files[1])
        flow_picture.flows(found, files[2])
    else:
        raise OutputError(f"{path}: unknown output format '{path.suffix}'; known are {', '.join(SUFFIXES)}")
    return path


def _table(found, path: Path) -> None:
    rows = found.table()
    for row in rows:
        bands = row["emissivity"]
        row["emissivity"] = " ".join(f"{value:.9g}" for value in bands) if isinstance(bands, list) else bands
    titles = [f"{key} [{UNITS[key]}]" if key in UNITS else key for key in rows[0]]
    # a reader of the file sees what the sign means
    titles = ["net heat given off [W]" if title == "net [W]" else title for title in titles]
    write_rows(rows, path, titles)


def _exchange(found, path: Path) -> None:
    """Watts of each pair of surfaces, once, in the direction in which they go."""
    names = (*found.names, SURROUNDINGS)
    rows = []
    for i in range(len(names)):
        for j in range(i):
            watts, error = float(found.exchange[i, j]), float(found.exchange_standard_error[i, j])
            if watts or error:
                one, other = (i, j) if watts >= 0 else (j, i)
                rows.append({"from": names[one], "to": names[other], "heat": abs(watts), "heat error": error})
    rows.sort(key=lambda row: -row["heat"])
    rows = rows or [{"from": names[0], "to": names[0], "heat": 0.0, "heat error": 0.0}]
    write_rows(rows, path, ["from", "to", "net heat straight from one to the other [W]", "standard error [W]"])
