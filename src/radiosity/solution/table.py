"""The table of surfaces."""

import numpy as np

from ..scene.photopic import photopic
from .means import of_rows


def surface_table(solution) -> list[dict]:
    """The rows of the table, one for each surface.

    A surface of two sides has two rows, front and back, or only the side that light reached. Sides that no line reached, of the
    surface or of parts of it, are in no row; ``dark`` is their area. Unknown values are NaN. The keys are:

    - surface
    - side: front, back, lit (fronts of some faces and backs of others), or both (no line hit either)
    - patches; area, m² of this side; dark, m²
    - for each band (suffix " [band]" where there are several): radiosity and irradiance (means); and in W or lm: emitted,
      received (of a pane: without what goes through), reflected, absorbed, left (emitted + reflected: the power that leaves),
      net (left - received = emitted - absorbed: above zero where the surface sends out more than it receives), net error
      (standard error of net), net low and net high (ends of its 95 % interval)
    - transmitted: what comes through from the other side of diffusing panes, W or lm; only where a scene has some. It is part of
      ``left``; the sides together have net = emitted - absorbed
    - illuminance: mean, lx; only where a photometric scene has red, green and blue
    - interval: half the 95 % interval of the mean irradiance, relative to it, the largest of the bands
    - error: relative, RMS over the patches
    - arrivals: hits
    - few (patches with few hits) and unvisited (patches), both without dark patches
    """
    patches, sides = solution.patches.solid, solution.sides
    scene, n, some = patches.scene, len(sides.surface), sides.row >= 0
    row, area, whole = sides.row[some], patches.area[some], patches.whole.area[some]

    def total(values):
        return np.bincount(row, weights=values, minlength=n)

    count, areas, solid = np.bincount(row, minlength=n), total(whole), total(area)
    safe, stops = (np.where(some > 0, some, 1) for some in (areas, solid))
    absorbs = of_rows(solution, 0.95, "absorbed")
    scatter = patches.scatter
    columns: dict[str, np.ndarray] = {"patches": count, "area": areas, "dark": sides.dark_area}
    for band, name in enumerate(scene.bands):
        tail = f" [{name}]" if len(scene.bands) > 1 else ""
        power = area * solution.irradiance[some, band]
        reflected = patches.reflectance[some, band] * power
        emitted = area * patches.emission[some, band]
        through, taken = (
            (np.zeros(n), power - reflected)
            if scatter.through is None
            else (
                total(area * (scatter.through[:, band] * solution.irradiance[scatter.other, band])[some]),
                power * (1 - scatter.albedo[some, band]),
            )
        )
        columns[f"radiosity{tail}"] = (total(emitted) + total(reflected) + through) / safe
        columns[f"irradiance{tail}"] = total(power) / stops
        columns[f"emitted{tail}"] = total(emitted)
        columns[f"received{tail}"] = total(power)
        columns[f"reflected{tail}"] = total(reflected)
        if scatter.through is not None:
            columns[f"transmitted{tail}"] = through
        columns[f"absorbed{tail}"] = total(taken)
        columns[f"left{tail}"] = total(emitted) + total(reflected) + through
        columns[f"net{tail}"] = total(emitted) + total(reflected) + through - total(power)
        columns[f"net error{tail}"] = absorbs.error[:, band] * areas
        columns[f"net low{tail}"] = total(emitted) - absorbs.high[:, band] * areas
        columns[f"net high{tail}"] = total(emitted) - absorbs.low[:, band] * areas
    groups = np.split(np.flatnonzero(some)[np.argsort(row, kind="stable")], np.cumsum(count)[:-1])
    ends = of_rows(solution, 0.95, "irradiance")
    middle = np.stack([columns[f"irradiance{f' [{name}]' if len(scene.bands) > 1 else ''}"] for name in scene.bands], axis=1)
    one = photopic(scene, middle)
    if one is not None:
        columns["illuminance"] = one
    with np.errstate(over="ignore"):  # quotients of values near zero
        wide = np.divide((ends.high - ends.low) / 2, middle, out=np.full(middle.shape, np.nan), where=middle > 0)
    columns["interval"] = np.array([row[~np.isnan(row)].max() if (~np.isnan(row)).any() else np.nan for row in wide])
    columns["error"] = np.array([solution._relative(rows) if len(rows) else np.nan for rows in groups])
    columns["arrivals"] = total(solution.arrivals[some]).astype(np.int64)
    columns["few"] = np.bincount(row, (solution.few & ~sides.dark)[some], n).astype(np.int64)
    columns["unvisited"] = np.bincount(row, ((solution.arrivals == 0) & ~sides.dark)[some], n).astype(np.int64)
    return [
        {"surface": scene.names[surface], "side": side, **{key: column[i].item() for key, column in columns.items()}}
        for i, (surface, side) in enumerate(zip(sides.surface, sides.side, strict=True))
    ]
