"""The hours of a year in which somebody is there."""

from pathlib import Path

import numpy as np

from ...errors import SceneError

FIRST, LAST = 8, 18  # o'clock, each day: the hours of IES LM-83


def usual(date: np.ndarray) -> np.ndarray:
    """Return which hours are occupied, (n,) bool: 8 to 18 o'clock on all days, from (n, 3) month, day and hour."""
    return (date[:, 2] > FIRST) & (date[:, 2] <= LAST)


def read_schedule(path: str | Path, date: np.ndarray) -> np.ndarray:
    """Read which hours are occupied, (n,) bool: those whose value is above 0.

    A row has the value of an hour, or month, day, hour and the value, as DAYSIM writes them; lines that begin with # and one line
    of names are passed over.

    Args:
        date: (n, 3) month, day and hour of each hour of the year.

    Raises:
        SceneError: the file cannot be read, has another number of hours, or a value is no number of 0 or more.
    """
    try:
        lines = Path(path).read_text(encoding="utf-8-sig", errors="replace").splitlines()
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from None
    values: list[float] = []
    for number, line in enumerate(lines, 1):
        cells = [cell.strip() for cell in line.replace(";", ",").replace("\t", ",").split(",")]
        if not any(cells) or line.lstrip().startswith("#"):
            continue
        try:
            value = float(cells[-1])
        except ValueError:
            if not values:
                continue  # names of columns
            value = np.nan
        if not (np.isfinite(value) and value >= 0) or len(cells) not in (1, 4):
            raise SceneError(
                f"{path}: line {number}: '{line.strip()[:60]}' is no hour; write a number of 0 or more, or month,day,hour,number"
            )
        values.append(value)
    if len(values) != len(date):
        raise SceneError(
            f"{path}: has {len(values)} hours, and the weather {len(date)}; give one value for each hour of the year"
        )
    found = np.array(values) > 0
    if not found.any():
        raise SceneError(f"{path}: nobody is there in any hour (all values are 0)")
    return found
