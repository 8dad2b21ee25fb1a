"""Per-surface results."""

import numpy as np


def surface_table(solution) -> list[dict]:
    """A row for each surface.

    Keys: surface, patches, area (m²), then for each band (suffix " [band]" where there are several): radiosity and
    irradiance (area means), emitted, received, reflected, absorbed, left (emitted + reflected: the power that leaves),
    net (left - received), all in W or lm; interval (half the 95 % interval of the mean irradiance, relative, the largest of the
    bands), error (relative, RMS over the patches), arrivals, few (patches with few arrivals), unvisited (patches).
    """
    patches, scene = solution.patches, solution.patches.scene
    n, area = len(scene.names), patches.area
    surface = patches.surface

    def total(values):
        return np.bincount(surface, weights=values, minlength=n)

    count, areas = np.bincount(surface, minlength=n), total(area)
    safe = np.where(areas > 0, areas, 1)
    columns: dict[str, np.ndarray] = {"patches": count, "area": areas}
    for band, name in enumerate(scene.bands):
        tail = f" [{name}]" if len(scene.bands) > 1 else ""
        power = area * solution.irradiance[:, band]
        reflected = patches.reflectance[:, band] * power
        emitted = area * patches.emission[:, band]
        columns[f"radiosity{tail}"] = (total(emitted) + total(reflected)) / safe
        columns[f"irradiance{tail}"] = total(power) / safe
        columns[f"emitted{tail}"] = total(emitted)
        columns[f"received{tail}"] = total(power)
        columns[f"reflected{tail}"] = total(reflected)
        columns[f"absorbed{tail}"] = total(power - reflected)
        columns[f"left{tail}"] = total(emitted) + total(reflected)
        columns[f"net{tail}"] = total(emitted) + total(reflected) - total(power)
    order = np.argsort(surface, kind="stable")
    groups = np.split(order, np.cumsum(count)[:-1])
    low, high = solution.surface_interval()
    middle = np.stack([columns[f"irradiance{f' [{name}]' if len(scene.bands) > 1 else ''}"] for name in scene.bands], axis=1)
    with np.errstate(over="ignore"):  # of what is next to nothing
        wide = np.divide((high - low) / 2, middle, out=np.full(middle.shape, np.nan), where=middle > 0)
    columns["interval"] = np.array([row[~np.isnan(row)].max() if (~np.isnan(row)).any() else np.nan for row in wide])
    columns["error"] = np.array([solution._relative(rows) if len(rows) else np.nan for rows in groups])
    columns["arrivals"] = total(solution.arrivals).astype(np.int64)
    columns["few"] = np.bincount(surface[solution.few], minlength=n)
    columns["unvisited"] = np.bincount(surface[solution.arrivals == 0], minlength=n)
    return [{"surface": name, **{key: column[i].item() for key, column in columns.items()}} for i, name in enumerate(scene.names)]
