"""Sets of sensors: of a measurement, or of a table that `radiosity measure` wrote."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import SceneError
from ..scene.csv_cells import unguarded
from ..sensors.result import Measurement
from ..sensors.target import half_width

MOST = 1_000_000  # rows of a table
PLACE = ("x_m", "y_m", "z_m")


@dataclass(frozen=True, eq=False)
class SensorSet:
    """A set of sensors, without those that lie inside of something.

    Attributes:
        name: of the set.
        points: (n, 3) m.
        values: (n,) in the unit of the scene.
        half_width: (n,) half of the 95 % interval; NaN where unknown.
        inside: the number of sensors that are left out, since they see mostly backs.
    """

    name: str
    points: np.ndarray
    values: np.ndarray
    half_width: np.ndarray
    inside: int


def of_measurement(found: Measurement) -> list[SensorSet]:
    """Return the sets of a measurement."""
    sensors, values, wide = found.sensors, found.single.mean(axis=0), half_width(found.single)
    return _sets(np.asarray(sensors.names)[sensors.set], sensors.points, values, wide, found.inside)


def of_table(path: Path, *, photometric: bool) -> list[SensorSet]:
    """Read a .csv that `radiosity measure` wrote.

    Raises:
        SceneError: it is missing, no such table, in another unit, or a value is no number.
    """
    wanted, other = ("illuminance_lx", "irradiance_W/m2") if photometric else ("irradiance_W/m2", "illuminance_lx")
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = [row for _, row in zip(range(MOST + 1), csv.DictReader(file), strict=False)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise SceneError(f"{path}: cannot be read as a table of sensors ({error})") from None
    if not rows or len(rows) > MOST:
        raise SceneError(
            f"{path}: holds {'no rows' if not rows else f'more than {MOST:,} rows'}; give a .csv of `radiosity measure`"
        )
    keys = set(rows[0])
    if wanted not in keys:
        why = f"is in another unit ({other}) than the solution" if other in keys else f"has no column {wanted}"
        raise SceneError(f"{path}: {why}; give a .csv that `radiosity measure` wrote of the same scene")
    wide = wanted.replace("illuminance", "half_width_95").replace("irradiance", "half_width_95")
    try:
        points = np.array([[float(row[key]) for key in PLACE] for row in rows])
        values = np.array([float(row[wanted]) for row in rows])
        halves = np.array([float(row.get(wide) or "nan") for row in rows])
        inside = np.array([(row.get("inside") or "0") == "1" for row in rows])
        names = np.array([unguarded(row["set"]) for row in rows], object)
    except (KeyError, TypeError, ValueError) as error:
        raise SceneError(f"{path}: a row is not understood ({error}); give a .csv that `radiosity measure` wrote") from None
    if not (np.isfinite(points).all() and np.isfinite(values).all()):
        raise SceneError(f"{path}: a place or a value is not finite")
    return _sets(names, points, values, halves, inside)


def _sets(names: np.ndarray, points, values, wide, inside) -> list[SensorSet]:
    found = []
    for name in dict.fromkeys(names.tolist()):
        own = names == name
        some = own & ~inside
        found.append(SensorSet(str(name), points[some], values[some], wide[some], int((own & inside).sum())))
    return found
