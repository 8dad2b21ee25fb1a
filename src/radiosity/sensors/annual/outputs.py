"""The report of annual daylight, and its files."""

import csv
import io
from pathlib import Path

import numpy as np

from ...errors import printable
from ...image.output import each_writable
from ...scene.csv_cells import guarded
from ...solution.percent import margin
from ...solution.whole import whole_file
from ..outputs import DIGITS
from .figures import BINS, ENOUGH, OF_HOURS, SUNNY

SUFFIXES = (".csv", ".npz")
LOW, MIDDLE, HIGH = (f"{value:g}" for value in BINS)
BOUNDS = (f"below {LOW}", f"{LOW} to {MIDDLE}", f"{MIDDLE} to {HIGH}", f"above {HIGH}")
COLUMNS = {  # of tables: the figure's name, and the column's
    "DA": f"DA_{ENOUGH:g}lx_percent",
    "cDA": f"continuous_DA_{ENOUGH:g}lx_percent",
    "UDI below": f"UDI_below_{LOW}lx_percent",
    "UDI supplementary": f"UDI_{LOW}_to_{MIDDLE}lx_percent",
    "UDI autonomous": f"UDI_{MIDDLE}_to_{HIGH}lx_percent",
    "UDI above": f"UDI_above_{HIGH}lx_percent",
    "sun hours": f"sun_above_{SUNNY:g}lx_hours",
    "mean": "mean_illuminance_lx",
}
NOTES = (
    f"DA: share of occupied hours with {ENOUGH:g} lx or more; cDA counts those below in part; UDI by bins, lx",
    f"sDA: share of sensors with DA of 50 % or more; ASE: share with more than 250 h of {SUNNY:g} lx straight from the sun (IES "
    "LM-83-12, without blinds)",
    "± holds what lines leave unknown: not the size of patches, not the weather",
)


def check(paths) -> None:
    """Refuse, before any work, outputs that could not be written after it.

    Raises:
        OutputError: an unknown format, a folder that cannot be written to, or one file named twice.
    """
    each_writable(paths, SUFFIXES)


def report(found) -> str:
    """Return what the year is, and a paragraph of lines for each set of sensors; ± is half of the 95 % interval."""
    hours = int(found.occupied.sum())
    lines = [
        f"daylight of a year at {len(found.sensors):,} sensors: {found.weather.place}, {hours:,} occupied hours, "
        f"{len(found.sky) - 1} sky patches; {found.rays:,} lines, {found.seconds:.2g} s"
        + ("" if found.status == "complete" else f", {found.status}")
    ]
    for row in found.table():
        if not row["sensors"]:
            lines.append(f"{printable(row['name'])}: no sensor is left; all see mostly backs of surfaces")
            continue
        udi = ", ".join(f"{bounds} {row[key]:.1%}" for key, bounds in zip(OF_HOURS[2:], BOUNDS, strict=True))
        shares = "   ".join(f"{key} {row[key]:.1%} ± {row[key + ' ±']:.1%}" for key in ("DA", "cDA", "sDA", "ASE"))
        lines += [
            f"{printable(row['name'])}, {row['sensors']:,} sensors: {shares}",
            f"  UDI {udi}; mean {row['mean']:.4g} ± {margin(row['mean ±'])} lx",
        ]
    return "\n".join([*lines, *NOTES])


def write(found, path: Path) -> None:
    """Write a table of all sensors, or all numbers."""
    check([path])
    if path.suffix.lower() == ".csv":
        content = _table(found).encode()
    else:
        file = io.BytesIO()
        np.savez_compressed(file, allow_pickle=False, **_arrays(found))
        content = file.getvalue()
    with whole_file(path) as file:
        file.write(content)


def _table(found) -> str:
    sensors, widths, text = found.sensors, found.half_widths(), io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    names = [name for column in COLUMNS.values() for name in (column, f"half_width_95_{column}")]
    rows.writerow(["set", "x_m", "y_m", "z_m", "nx", "ny", "nz", "kind", "inside", *names])
    kinds = np.where(sensors.cylindrical, "cylindrical", "plane")
    for i in range(len(sensors)):
        place = [f"{value:.{DIGITS}g}" for value in (*sensors.points[i], *sensors.normals[i])]
        values = []
        for key in COLUMNS:
            factor = 100 if key in OF_HOURS else 1
            values += [f"{factor * column[key][i]:.{DIGITS}g}" for column in (found.values, widths)]
        rows.writerow([guarded(sensors.names[sensors.set[i]]), *place, kinds[i], int(found.inside[i]), *values])
    return text.getvalue()


def _arrays(found) -> dict[str, np.ndarray]:
    """Return all numbers by name."""
    sensors, of = found.sensors, found.coefficients
    arrays = {
        "points": sensors.points,
        "normals": sensors.normals,
        "set": sensors.set,
        "names": np.array(sensors.names),
        "inside": found.inside,
        "date": found.weather.date,
        "occupied": found.occupied,
        "coefficients_straight": of.straight,
        "coefficients_reflected": of.reflected,
    }
    arrays |= {COLUMNS[key]: 100 * value if key in OF_HOURS else value for key, value in found.values.items()}
    return arrays if found.hourly is None else arrays | {"hourly_illuminance_lx": found.hourly}
