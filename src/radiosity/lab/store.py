"""Files of results: a table of numbers, and NetCDF."""

import csv
from pathlib import Path

import numpy as np

from .results import Results

COLUMNS = (
    "experiment",
    "scene",
    "arm",
    "method",
    "replicate",
    "lines",
    "seconds",
    "error_area_weighted",
    "error_plain",
    "error_picture",
)


def write_csv(path: Path, found: dict[int, tuple[Results, dict[str, str]]]) -> None:
    """Write a row for each experiment, arm, scene, replicate and rung.

    Args:
        found: by number of the experiment, its results and the method of each arm.
    """
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(COLUMNS)
        for number, (results, methods) in found.items():
            _rows(table, number, results, methods)


def _rows(table, number: int, results: Results, methods: dict[str, str]) -> None:
    for (scene, arm), series in results.series.items():
        errors = zip(series.area_weighted, series.plain, series.picture, strict=True)
        for replicate, (weighted, plain, picture) in enumerate(errors):
            for row in zip(series.lines, series.seconds, weighted, plain, picture, strict=True):
                table.writerow([number, scene, arm, methods[arm], replicate, *(f"{value:.9g}" for value in row)])


def write_netcdf(path: Path, results: Results, facts: dict[str, str]) -> None:
    """Write arm x scene x replicate x rung as NetCDF (version 3), with facts about how it was made."""
    import xarray

    scenes = list(dict.fromkeys(scene for scene, _ in results.series))
    arms = list(dict.fromkeys(arm for _, arm in results.series))

    def stack(name):
        return np.array([[getattr(results.series[scene, arm], name) for scene in scenes] for arm in arms])

    curves, single = ("arm", "scene", "replicate", "rung"), ("arm", "scene", "rung")
    xarray.Dataset(
        {
            "error_area_weighted": (curves, stack("area_weighted")),
            "error_plain": (curves, stack("plain")),
            "error_picture": (curves, stack("picture")),
            "lines": (single, stack("lines")),
            "seconds": (single, stack("seconds")),
        },
        coords={"arm": arms, "scene": scenes},
        attrs=facts,
    ).to_netcdf(path, engine="scipy")
