"""Quantities of a solution that a picture or a mesh shows, in all bands or one."""

from dataclasses import dataclass

import numpy as np

from ..errors import OutputError
from . import tone

NAMES = {
    "radiosity": "radiosity",
    "irradiance": "irradiance",
    "standard_error": "standard error of the radiosity",
    "irradiance_standard_error": "standard error of the irradiance",
    "relative_error": "relative standard error of the radiosity",
}


@dataclass(frozen=True, eq=False)
class Quantity:
    """Values to show.

    Attributes:
        values: (n_patches, n) float64 in ``unit``; NaN where unknown.
        title: what they are, in words.
        unit: W/m², lm/m² or %.
        bands: names of the columns.
        own_light: (n_patches,) bool, patches that emit; they are left out where scales are found.
        adds: values of a pane and of what is behind it add up.
    """

    values: np.ndarray
    title: str
    unit: str
    bands: tuple[str, ...]
    own_light: np.ndarray
    adds: bool = False


def choose(solution, name: str = "radiosity", band: str | int | None = None, *, single: bool = False) -> Quantity:
    """Return a quantity of a solution.

    Args:
        solution: to show.
        name: a key of `NAMES`.
        band: a band by name or number; default: all of them.
        single: reduce all bands to one number for each patch, the luminance of three bands or the mean of others.

    Raises:
        OutputError: there is no such quantity or band.
    """
    if name not in NAMES:
        raise OutputError(f"quantity '{name}' does not exist; known are {', '.join(NAMES)}")
    names = [str(b) for b in solution.bands]
    rows, title = slice(None), NAMES[name]
    if band is not None:
        rows = slice(_index(band, names), _index(band, names) + 1)
    names, several = names[rows], len(names) > 1
    own = (solution.patches.emission[:, rows] > 0).any(axis=1)
    values = np.asarray(getattr(solution, "standard_error" if name == "relative_error" else name), np.float64)[:, rows]
    base = np.asarray(solution.radiosity, np.float64)[:, rows]
    if several and band is not None:
        title += f", {names[0]}"
    elif several and single:
        title += ", luminance of three bands" if len(names) == 3 else ", mean of the bands"
        # errors of the bands come from the same lines, so they are added as if fully correlated: never too small
        values, base, names = tone.luminance(values)[:, None], tone.luminance(base)[:, None], ["all"]
    if name != "relative_error":
        return Quantity(values, title, solution.unit, tuple(names), own, name == "radiosity")
    ratio = np.divide(values, base, out=np.full(values.shape, np.nan), where=base > 0)
    return Quantity(100 * ratio, title, "%", tuple(names), own)


def legend_unit(name: str, unit: str) -> str:
    """Return the unit as people who measure light read it: lux for irradiance in lm/m²."""
    if unit != "lm/m²":
        return unit
    return "lux" if name.startswith("irradiance") else "lm/m² (lux)"


def _index(band: str | int, names: list[str]) -> int:
    if str(band) in names:
        return names.index(str(band))
    if str(band).isdigit() and int(band) < len(names):
        return int(band)
    raise OutputError(f"band '{band}' does not exist; known are {', '.join(names)} (or 0 to {len(names) - 1})")
