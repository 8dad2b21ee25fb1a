"""The table of patches, which .csv files and data frames hold."""

import numpy as np

from ..scene.photopic import photopic
from .sides import sides_of


def patch_columns(solution) -> dict[str, np.ndarray]:
    """Return the columns by title, with the unit in brackets; each is (n_patches,)."""
    patches = solution.patches
    bands, unit, received = [str(band) for band in solution.bands], solution.unit, solution.irradiance_unit
    names = np.array(patches.scene.names, object)
    sides = np.array(["front", "back"], object)
    columns = {"patch": np.arange(len(patches)), "surface": names[patches.surface], "side": sides[patches.is_back.astype(int)]}
    for title, values in (("centroid", patches.centroid), ("normal", patches.normal)):
        columns |= {f"{title} {axis}{' [m]' if title == 'centroid' else ''}": values[:, i] for i, axis in enumerate("xyz")}
    columns["area [m²]"] = patches.area
    for title, values, measure in (
        ("reflectance", patches.reflectance, ""),
        ("emission", patches.emission, unit),
        ("radiosity", solution.radiosity, unit),
        ("standard error of radiosity", solution.standard_error, unit),
        ("irradiance", solution.irradiance, received),
        ("standard error of irradiance", solution.irradiance_standard_error, received),
    ):
        if title == "emission" and patches.scene.transmittance is not None:
            columns["transmittance"] = patches.transmittance
        if title == "emission" and patches.diffuse_transmittance is not None:
            for i, band in enumerate(bands):
                label = f"diffuse transmittance {band}" if len(bands) > 1 else "diffuse transmittance"
                columns[label] = patches.diffuse_transmittance[:, i]
        for i, band in enumerate(bands):
            label = f"{title} {band}" if len(bands) > 1 else title
            columns[f"{label} [{measure}]" if measure else label] = np.asarray(values)[:, i]
    columns |= _coefficients(solution, bands, received)
    columns["arrivals"] = np.asarray(solution.arrivals)
    columns["few arrivals"] = (np.asarray(solution.few) & ~sides_of(solution).dark).astype(int)
    low, high = solution.interval(0.95, "irradiance")
    for title, values in (("irradiance, 95 % from", low), ("irradiance, 95 % to", high)):
        for i, band in enumerate(bands):
            columns[f"{title}{f' {band}' if len(bands) > 1 else ''} [{received}]"] = values[:, i]
    for title, values in (("", solution.irradiance), ("standard error of ", solution.irradiance_standard_error)):
        one = photopic(patches.scene, np.asarray(values))
        if one is not None:  # errors of bands are of the same lines: their sum is never too small
            columns[f"{title}illuminance [lx]"] = one
    return columns


def _coefficients(solution, bands: list[str], unit: str) -> dict[str, np.ndarray]:
    """Return the columns of the coefficients of polynomials after the mean, and of their errors (docs/bases.md)."""
    columns, several = {}, len(bands) > 1
    if getattr(solution, "irradiance_coefficients", None) is None:
        return columns
    parts = ("", solution.irradiance_coefficients), ("standard error of ", solution.irradiance_coefficients_standard_error)
    for title, values in parts:
        for i, band in enumerate(bands):
            for k in range(values.shape[2]):
                columns[f"{title}irradiance coefficient {k + 1}{f' {band}' if several else ''} [{unit}]"] = values[:, i, k]
    return columns
