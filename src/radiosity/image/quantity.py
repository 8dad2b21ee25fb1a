"""Quantities of a solution that a picture or a mesh shows, in all bands or one."""

from dataclasses import dataclass

import numpy as np

from ..errors import OutputError
from ..patches.polynomials import Polynomials
from . import tone

NAMES = {
    "radiosity": "radiosity",
    "irradiance": "irradiance",
    "standard_error": "standard error of the radiosity",
    "irradiance_standard_error": "standard error of the irradiance",
    "relative_error": "relative standard error of the radiosity",
    "luminance": "luminance",
    "radiance": "radiance",
}

LIGHT = ("radiosity", "irradiance", "luminance", "radiance")
OF_DIRECTIONS = ("luminance", "radiance")  # radiosity over pi: what a diffuse surface sends to every direction


@dataclass(frozen=True, eq=False)
class Quantity:
    """Values to show.

    Attributes:
        values: (n_patches, n) float64 in ``unit``; NaN where unknown.
        title: what they are, in words.
        unit: W/m², lm/m², lx, W/(m² sr), cd/m² or %.
        bands: names of the columns.
        own_light: (n_patches,) bool, patches that emit; they are left out where scales are found.
        adds: values of a pane and of what is behind it add up.
        light: the polynomials that ``values`` are the means of, where the solution has them; None elsewhere.
        unmet: (n_patches,) bool, patches of the value 0 that no line met: their light is unknown. None where lines are not
            counted, and for colours of the light itself.
    """

    values: np.ndarray
    title: str
    unit: str
    bands: tuple[str, ...]
    own_light: np.ndarray
    adds: bool = False
    light: Polynomials | None = None
    unmet: np.ndarray | None = None


def choose(solution, name: str = "radiosity", band: str | int | None = None, *, single: bool = False) -> Quantity:
    """Return a quantity of a solution.

    Args:
        solution: to show.
        name: a key of `NAMES`.
        band: a band by name or number; default: all of them.
        single: reduce all bands to one number for each patch: three weighted as the eye does, or the mean of others.

    Raises:
        OutputError: there is no such quantity or band.
    """
    if name not in NAMES:
        raise OutputError(f"quantity '{name}' does not exist; known are {', '.join(NAMES)}")
    names = [str(b) for b in solution.bands]
    rows, title = _columns(band, names), NAMES[name]
    if solution.patches.scene.photometric:
        title = title.replace("irradiance", "illuminance")
    names, several = names[rows], len(names) > 1
    own = (solution.patches.emission[:, rows] > 0).any(axis=1)
    if name == "luminance" and not solution.patches.scene.photometric:
        raise OutputError("luminance is of scenes in lm and lx; this one is in W: take radiance")
    values, light = _values(solution, name)[:, rows], _light(solution, name)
    light = None if light is None else light.columns(lambda column: column[:, rows])
    base = np.asarray(solution.radiosity, np.float64)[:, rows]
    if several and band is not None:
        title += f", {names[0]}"
    elif several and single:
        title += ", bands weighted as the eye does" if len(names) == 3 else ", mean of the bands"
        # errors of the bands come from the same lines, so they are added as if fully correlated: never too small
        values, base, names = tone.luminance(values)[:, None], tone.luminance(base)[:, None], ["all"]
        light = None if light is None else light.columns(_one_column)
    if name != "relative_error":
        unmet, adds = _unmet(solution, name, values) if single else None, name in ("radiosity", *OF_DIRECTIONS)
        return Quantity(values, title, _unit(solution, name), tuple(names), own, adds, light, unmet)
    ratio = np.divide(values, base, out=np.full(values.shape, np.nan), where=base > 0)
    return Quantity(100 * ratio, title, "%", tuple(names), own)


def in_columns(solution, values: np.ndarray, band: str | int | None, *, single: bool) -> np.ndarray:
    """Return the columns that `choose` makes of values in all bands, (m, n_bands) to (m, n)."""
    names = [str(b) for b in solution.bands]
    values = values[:, _columns(band, names)]
    return tone.luminance(values)[:, None] if single and len(names) > 1 and band is None else values


def _columns(band: str | int | None, names: list[str]) -> slice:
    return slice(None) if band is None else slice(_index(band, names), _index(band, names) + 1)


def _values(solution, name: str) -> np.ndarray:
    """Return a quantity of all bands, (n_patches, n_bands) float64."""
    if name in OF_DIRECTIONS:
        return np.asarray(solution.radiosity, np.float64) / np.pi
    return np.asarray(getattr(solution, "standard_error" if name == "relative_error" else name), np.float64)


def _unmet(solution, name: str, values: np.ndarray) -> np.ndarray | None:
    """Return the patches of value 0 that no line met, (n_patches,) bool, or None; radiosity of what reflects nothing is known."""
    if name not in LIGHT or solution.by_own_lines or getattr(solution, "by_baseline", False):
        return None
    patches, unmet = solution.patches, (np.asarray(solution.arrivals) == 0) & (values == 0).all(axis=1)
    if name == "irradiance":
        return unmet
    return unmet & ((patches.reflectance > 0).any(axis=1) | patches.scene.diffusers[patches.face])


def _one_column(values: np.ndarray) -> np.ndarray:
    """Return bands reduced to one number, (n_patches, 1) or (n_patches, 1, K - 1)."""
    return tone.luminance(np.moveaxis(values, 1, -1))[:, None]


def _light(solution, name: str) -> Polynomials | None:
    """Return the polynomials of a quantity in all bands, without their noise; None where light is constant on patches."""
    found = getattr(solution, "irradiance_coefficients", None)  # what is shown need not be a solution
    if name not in LIGHT or found is None:
        return None
    patches, errors = solution.patches, solution.irradiance_coefficients_standard_error
    if name == "irradiance":
        light = Polynomials(patches, solution.basis, solution.irradiance, found, (solution.irradiance_standard_error, errors))
        return light.without_noise
    errors = solution.standard_error, patches.scatter.of_moments(errors)
    light = Polynomials(patches, solution.basis, solution.radiosity, solution.radiosity_coefficients, errors)
    return (light.columns(lambda column: column / np.pi) if name in OF_DIRECTIONS else light).without_noise


def _unit(solution, name: str) -> str:
    if name.startswith("irradiance"):
        return solution.irradiance_unit
    return solution.patches.scene.radiance_unit if name in OF_DIRECTIONS else solution.unit


def _index(band: str | int, names: list[str]) -> int:
    if str(band) in names:
        return names.index(str(band))
    if str(band).isdigit() and int(band) < len(names):
        return int(band)
    raise OutputError(f"band '{band}' does not exist; known are {', '.join(names)} (or 0 to {len(names) - 1})")
