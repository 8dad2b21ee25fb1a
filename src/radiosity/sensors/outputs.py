"""Output files of sensors, by their suffix."""

import csv
import io
from pathlib import Path

import numpy as np

from ..errors import OutputError, printable
from ..image.output import each_writable, require
from ..scene.csv_cells import guarded
from ..solution.replacing import replacing
from ..solution.whole import whole_file
from .isolines import draw
from .target import half_width

SUFFIXES = (".csv", ".png", ".svg", ".pdf")
DIGITS = 9


def check(paths) -> None:
    """Refuse, before any work, outputs that could not be written after it.

    Raises:
        OutputError: an unknown format, a folder that cannot be written to, or one file named twice.
    """
    for path in each_writable(paths, SUFFIXES):
        if path.suffix.lower() != ".csv":
            require("matplotlib", f"{path}: isolines")


def write(found, path: Path) -> None:
    """Write a table of all sensors, or isolines of all grids."""
    check([path])
    if path.suffix.lower() == ".csv":
        _table(found, path)
    else:
        _isolines(found, path)


def _table(found, path: Path) -> None:
    what = "illuminance" if found.photometric else "irradiance"
    unit = "lx" if found.photometric else "W/m2"
    bands = [""] if len(found.bands) == 1 else [f"_{band}" for band in found.bands]
    columns: dict[str, np.ndarray] = {}
    if len(bands) > 1:
        columns[f"{what}_{unit}"] = found.single.mean(axis=0)
        columns[f"half_width_95_{unit}"] = half_width(found.single)
    for number, band in enumerate(bands):
        columns[f"{what}{band}_{unit}"] = found.illuminance[:, number]
        columns[f"half_width_95{band}_{unit}"] = half_width(found.values[..., number])
    for group, values in found.single_parts.items():
        columns[f"{what}_by_{group}_{unit}"] = values.mean(axis=0)
    if found.outside is not None:
        columns["daylight_factor_percent"] = 100 * found.daylight_factor
    sensors, text = found.sensors, io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["set", "x_m", "y_m", "z_m", "nx", "ny", "nz", "kind", "inside", *columns])
    kinds = np.where(sensors.cylindrical, "cylindrical", "plane")
    for i in range(len(sensors)):
        place = [f"{value:.{DIGITS}g}" for value in (*sensors.points[i], *sensors.normals[i])]
        values = [f"{column[i]:.{DIGITS}g}" for column in columns.values()]
        rows.writerow([guarded(sensors.names[sensors.set[i]]), *place, kinds[i], int(found.inside[i]), *values])
    with whole_file(path) as file:
        file.write(text.getvalue().encode())


def _isolines(found, path: Path) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    grids = [number for number in range(len(found.sensors.names)) if not np.isnan(found.sensors.spacings[number]).any()]
    if not grids:
        raise OutputError(f"{path}: isolines need a grid of sensors; these are single points: write a .csv")
    figure = Figure(figsize=(6.4, 5.2 * len(grids)), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    for place, number in enumerate(grids):
        _grid(found, number, figure.add_subplot(len(grids), 1, place + 1), figure)
    with replacing(path) as temporary:
        figure.savefig(temporary, format=path.suffix.lower()[1:])


def _grid(found, number: int, axes, figure) -> None:
    sensors = found.sensors
    rows = np.flatnonzero(sensors.set == number)
    cells, (along, across) = sensors.cells[rows], sensors.spacings[number]
    shape: tuple[int, ...] = tuple((cells.max(axis=0) + 1).tolist())
    values = np.full(shape, np.nan)
    values[cells[:, 0], cells[:, 1]] = np.where(found.inside, np.nan, found.single.mean(axis=0))[rows]
    height, width = len(values), len(values[0])
    extent = (0, width * along, 0, height * across)
    shades = axes.imshow(values, origin="lower", extent=extent, cmap="inferno", interpolation="nearest")
    draw(axes, (np.arange(width) + 0.5) * along, (np.arange(height) + 0.5) * across, values)
    row = next(row for row in found.table() if row["name"] == sensors.names[number])
    what = "illuminance" if found.photometric else "irradiance"
    uniformity = "dark" if np.isnan(row["U0"]) else f"U0 {row['U0']:.2f}"
    figures = f"mean {row['mean']:.4g} {found.unit}, min {row['min']:.4g}, {uniformity}"
    axes.set_title(f"{printable(row['name'])}: {figures}", fontsize=9)
    axes.set_xlabel("m")
    axes.set_ylabel("m")
    figure.colorbar(shades, ax=axes, label=f"{what} [{found.unit}]")
