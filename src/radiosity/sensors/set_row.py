"""The figures of a set of sensors."""

from typing import Any

import numpy as np

from .target import half_width


def set_row(found: Any, number: int, level: float) -> dict:
    """Return the figures of a set of sensors, see `Measurement.table`.

    Args:
        found: a `Measurement`.
        number: of the set.
        level: of intervals.
    """
    chosen = (found.sensors.set == number) & ~found.inside
    values = found.single[:, chosen] if chosen.any() else np.full((len(found.single), 1), np.nan)
    each = values.mean(axis=0)
    low, mean, high = (float(f(each)) for f in (np.min, np.mean, np.max))
    row = {"name": found.sensors.names[number], "sensors": int(chosen.sum()), "min": low, "mean": mean, "max": high}
    least, most, means = values[:, each.argmin()], values[:, each.argmax()], values.mean(axis=1)
    for name, below, ratio in (("U0", means, mean), ("U1", most, high)):
        share = low / ratio if ratio else float("nan")
        row[name] = share
        # to first order: the ratio of means errs as this mean of replicates does
        row[f"{name} ±"] = float(half_width((least - share * below) / ratio, level)) if ratio else float("nan")
    return row | {"mean ±": float(half_width(means, level)), "sensor ±": float(np.max(half_width(values, level)))}
