"""The table of patches, which .csv files and data frames hold."""

from collections.abc import Iterator

import numpy as np

from ..pieces import pieces
from ..scene.photopic import photopic
from .sides import sides_of


def patch_columns(solution) -> dict[str, np.ndarray]:
    """Return the columns by title, with the unit in brackets; each is (n_patches,)."""
    return next(column_pieces(solution, len(solution.patches)))


def column_pieces(solution, size: int) -> Iterator[dict[str, np.ndarray]]:
    """Yield the columns of so many patches at a time, from the first ones on; what is not held by the solution is not kept."""
    few = np.asarray(solution.few) & ~sides_of(solution).dark
    for part in pieces(len(solution.patches), size):
        yield _columns(solution, part, few[part])


def _columns(solution, part: slice, few: np.ndarray) -> dict[str, np.ndarray]:
    patches = solution.patches
    bands, unit, received = [str(band) for band in solution.bands], solution.unit, solution.irradiance_unit
    names = np.array(patches.scene.names, object)
    sides = np.array(["front", "back"], object)
    columns = {"patch": np.arange(part.start, part.stop), "surface": names[patches.surface[part]]}
    columns["side"] = sides[patches.is_back[part].astype(int)]
    for title, values in (("centroid", patches.centroids(part)), ("normal", patches.normals(part))):
        columns |= {f"{title} {axis}{' [m]' if title == 'centroid' else ''}": values[:, i] for i, axis in enumerate("xyz")}
    columns["area [m²]"] = patches.area[part]
    for title, values, measure in (
        ("reflectance", patches.reflectances(part), ""),
        ("emission", patches.emissions(part), unit),
        ("radiosity", solution.radiosity[part], unit),
        ("standard error of radiosity", solution.standard_error[part], unit),
        ("irradiance", solution.irradiance[part], received),
        ("standard error of irradiance", solution.irradiance_standard_error[part], received),
    ):
        if title == "emission" and patches.scene.transmittance is not None:
            columns["transmittance"] = patches.transmittance[part]
        if title == "emission" and patches.diffuse_transmittance is not None:
            for i, band in enumerate(bands):
                label = f"diffuse transmittance {band}" if len(bands) > 1 else "diffuse transmittance"
                columns[label] = patches.diffuse_transmittance[part, i]
        for i, band in enumerate(bands):
            label = f"{title} {band}" if len(bands) > 1 else title
            columns[f"{label} [{measure}]" if measure else label] = np.asarray(values)[:, i]
    columns |= _coefficients(solution, part, bands, received)
    columns["arrivals"] = np.asarray(solution.arrivals)[part]
    columns["few arrivals"] = few.astype(int)
    low, high = solution.interval(0.95, "irradiance", part)
    for title, values in (("irradiance, 95 % from", low), ("irradiance, 95 % to", high)):
        for i, band in enumerate(bands):
            columns[f"{title}{f' {band}' if len(bands) > 1 else ''} [{received}]"] = values[:, i]
    for title, values in (("", solution.irradiance), ("standard error of ", solution.irradiance_standard_error)):
        one = photopic(patches.scene, np.asarray(values)[part])
        if one is not None:  # errors of bands are of the same lines: their sum is never too small
            columns[f"{title}illuminance [lx]"] = one
    return columns


def _coefficients(solution, part: slice, bands: list[str], unit: str) -> dict[str, np.ndarray]:
    """Return the columns of the coefficients of polynomials after the mean, and of their errors (docs/bases.md)."""
    columns, several = {}, len(bands) > 1
    if getattr(solution, "irradiance_coefficients", None) is None:
        return columns
    parts = ("", solution.irradiance_coefficients), ("standard error of ", solution.irradiance_coefficients_standard_error)
    for title, values in parts:
        for i, band in enumerate(bands):
            for k in range(values.shape[2]):
                columns[f"{title}irradiance coefficient {k + 1}{f' {band}' if several else ''} [{unit}]"] = values[part, i, k]
    return columns
