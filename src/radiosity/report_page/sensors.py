"""Measuring points: a table of sets with their uniformity, and a map or a list of each."""

import numpy as np

from .drawing import drawn, new_figure
from .markup import Markup, element, figure, section, table
from .plans import isolines
from .sensor_sets import SensorSet
from .words import Words, number

LISTED = 40  # points of a set that are listed one by one
FILLED = 0.25  # least share of a lattice that holds sensors, for a map
WIDTH, HIGHEST = 7.0, 8.0  # inches


def sensor_tables(sets: list[SensorSet], words: Words) -> Markup | None:
    """Return the section, or None where there are no sensors."""
    if not sets:
        return None
    heads = [
        "set",
        "points",
        f"minimum [{words.falling_unit}]",
        f"mean [{words.falling_unit}]",
        f"maximum [{words.falling_unit}]",
    ]
    heads += ["uniformity min/mean", "min/max", "largest ± of a point"]
    rows = []
    for one in sets:
        if not len(one.values):
            rows.append([one.name, "0", *["unknown"] * 6])
            continue
        low, mean, high = (float(f(one.values)) for f in (np.min, np.mean, np.max))
        ratios = [f"{low / of:.2f}" if of > 0 else "unknown" for of in (mean, high)]
        wide = number(one.half_width.max()) if np.isfinite(one.half_width).all() else "unknown"
        rows.append([one.name, str(len(one.values)), *map(number, (low, mean, high)), *ratios, wide])
    parts = [table(f"Sets of measuring points, {words.falling} in {words.falling_unit}", heads, rows)]
    if left := [f"{one.name} ({one.inside})" for one in sets if one.inside]:
        parts.append(element("p", f"Points inside of furniture or walls are left out: {', '.join(left)}.", class_="note"))
    for one in sets:
        if len(one.values):
            parts += _details(one, words)
    return section("Measuring points", *parts, kind="page")


def _details(one: SensorSet, words: Words) -> list[Markup]:
    lattice = _lattice(one)
    parts: list[Markup] = [element("h3", one.name)]
    if lattice is not None:
        values, extent, axes = lattice
        tall = min(max((extent[3] - extent[2]) / (extent[1] - extent[0]) * (WIDTH - 1.4), 1.6) + 0.7, HIGHEST)
        drawing = new_figure(WIDTH, tall)
        place = drawing.subplots()
        isolines(place, drawing, values, extent, f"{words.falling} [{words.falling_unit}]")
        place.set_xlabel(f"{axes[0]} [m]")
        place.set_ylabel(f"{axes[1]} [m]")
        alt = f"Map of {words.falling} at the points of {one.name}: the figures are in the table of sets"
        parts.append(figure(drawn(drawing, alt), f"{words.falling.capitalize()} at the points of {one.name}"))
    if len(one.values) <= LISTED:
        heads = ["point", "x [m]", "y [m]", "z [m]", f"{words.falling} [{words.falling_unit}]", "±"]
        rows = [
            [str(i + 1), *(f"{x:.3g}" for x in point), number(value), number(half)]
            for i, (point, value, half) in enumerate(zip(one.points, one.values, one.half_width, strict=True))
        ]
        parts.append(table(f"Points of {one.name}", heads, rows))
    return parts if len(parts) > 1 else []


def _lattice(one: SensorSet) -> tuple[np.ndarray, tuple[float, float, float, float], tuple[str, str]] | None:
    """Values on a lattice along two axes of the scene, (rows, columns), with its extent and the axes; None where it is none."""
    spread = np.ptp(one.points, axis=0)
    level = int(np.argmin(spread))
    if spread[level] > 1e-6 * max(spread.max(), 1e-300):
        return None
    across = [i for i in range(3) if i != level]
    lines = [np.unique(np.round(one.points[:, i], 6)) for i in across]
    counts = [len(values) for values in lines]
    if min(counts) < 2 or len(one.values) < FILLED * counts[0] * counts[1]:
        return None
    steps = [float(np.diff(values).min()) for values in lines]
    if any(not np.allclose(np.diff(v) / s, np.round(np.diff(v) / s), atol=1e-3) for v, s in zip(lines, steps, strict=True)):
        return None
    index = [np.round((one.points[:, i] - v[0]) / s).astype(int) for i, v, s in zip(across, lines, steps, strict=True)]
    values = np.full((index[1].max() + 1, index[0].max() + 1), np.nan)
    values[index[1], index[0]] = one.values
    ends = [(v[0] - s / 2, v[-1] + s / 2) for v, s in zip(lines, steps, strict=True)]
    names = "xyz"
    return values, (*ends[0], *ends[1]), (names[across[0]], names[across[1]])
