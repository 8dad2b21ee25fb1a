"""False colours: values as colours of a map, with a legend in physical units beside the picture."""

from dataclasses import dataclass

import numpy as np

from ..errors import OutputError
from . import legend, tone
from .picture import Picture

UNKNOWN = 0.5  # grey of pixels whose value is unknown
TOP = 99.0  # percentile of the values at which the automatic range ends
DECADES = 4  # of an automatic logarithmic range, at most
LOWEST_LEGEND = 240  # pixels


def colour(
    picture: Picture, *, title: str, unit: str, limits=None, log=False, color_map="viridis", top=TOP, letters=1.0
) -> np.ndarray:
    """Return the picture at its full resolution and its legend to the right, (height, width, 3) uint8.

    Args:
        picture: a picture with one value a pixel.
        title, unit: of the value, for the legend.
        limits: (low, high) in ``unit``; default: 0 (or the lowest value, if logarithmic) to a percentile of what does not emit
            by itself, or 1 where nothing is lit. The legend tells that some is brighter.
        log: logarithmic scale.
        color_map: one of matplotlib's.
        top: the percentile.
        letters: size of the legend's letters, 1 as usual.

    Raises:
        OutputError: the limits are not a range, or the colour map is unknown.
    """
    values = picture.values[..., 0]
    counted = picture.counted[:, 0]
    low, high = _checked(limits, log) if limits is not None else automatic_limits(counted, log, top=top)
    palette = Palette(low, high, log, color_map)
    display, seen = palette(values), picture.cover > 0
    display = tone.eight_bits(display * picture.cover[..., None])
    if (seen & ~np.isfinite(values)).any():
        title += " (grey: unknown)"
    label = f"{title} [{unit}]"
    if limits is None and (counted > high).any():
        label += f"; arrow: brighter than {top:g} % of the view without lamps"
    return beside(display, palette.legend(label, values[seen], max(len(display), LOWEST_LEGEND), letters))


def check(limits, log: bool, color_map: str) -> None:
    """Refuse options of `colour` that make no sense, before a picture is taken.

    Raises:
        OutputError: the limits are not a range, or the colour map is unknown.
    """
    Palette(*((0.1, 1.0) if limits is None else _checked(limits, log)), log, color_map)


@dataclass(frozen=True)
class Palette:
    """The colours of values: from ``low`` to ``high`` through a colour map, linear or logarithmic; grey where unknown.

    Raises:
        OutputError: the colour map is unknown, or the values are no range.
    """

    low: float
    high: float
    log: bool = False
    color_map: str = "viridis"

    def __post_init__(self):
        import matplotlib

        if self.color_map not in matplotlib.colormaps:
            raise OutputError(
                f"colour map '{self.color_map}' does not exist; take viridis, inferno, turbo or another of matplotlib's"
            )
        _checked((self.low, self.high), self.log)

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Return sRGB colours, (..., 3) in [0, 1], of values (...), NaN allowed."""
        display = self._shades(self._norm(np.maximum(np.nan_to_num(values), self.low)))[..., :3]
        display[~np.isfinite(values)] = UNKNOWN
        return display

    def legend(self, label: str, values: np.ndarray, height: int, letters: float = 1.0) -> np.ndarray:
        """Return a picture of the scale, (height, width, 3) uint8; arrows say that some of the values lie beyond its ends.

        ``letters`` is the size of letters, 1 as usual.
        """
        known = values[np.isfinite(values)]
        beyond = known.size and known.max() > self.high * (1 + 1e-9), known.size and known.min() < self.low * (1 - 1e-9)
        names = {(True, True): "both", (True, False): "max", (False, True): "min"}
        extend = names.get((bool(beyond[0]), bool(beyond[1])), "neither")
        return legend.drawn(self._norm, self._shades, label, extend, height, letters)

    @property
    def _norm(self):
        from matplotlib.colors import LogNorm, Normalize

        return (LogNorm if self.log else Normalize)(self.low, self.high, clip=True)

    @property
    def _shades(self):
        import matplotlib

        return matplotlib.colormaps[self.color_map]


def automatic_limits(values: np.ndarray, log: bool, area: np.ndarray | None = None, top: float = TOP) -> tuple[float, float]:
    """Return the automatic range for values (m,), NaN allowed.

    Args:
        area: (m,) that each value stands for. Default: all the same.
        top: percentile of the values at which the range ends.
    """
    known = np.isfinite(values) & (values > 0)
    values = values[known]
    if not len(values):
        return (0.1, 1.0) if log else (0.0, 1.0)
    high = float(np.percentile(values, top) if area is None else _percentile(values, area[known], top))
    low = max(float(values.min()), high / 10**DECADES) if log else 0.0
    return (low, high) if low < high else (high / 10, high)


def _percentile(values: np.ndarray, area: np.ndarray, share: float) -> float:
    """Return the least value below or at which ``share`` percent of the area lie."""
    order = np.argsort(values, kind="stable")
    below = np.cumsum(area[order])
    return float(values[order][min(np.searchsorted(below, share / 100 * below[-1]), len(values) - 1)])


def _checked(limits, log: bool) -> tuple[float, float]:
    try:
        low, high = (float(value) for value in limits)
    except (TypeError, ValueError):
        raise OutputError(f"range is {limits!r}; give two numbers, low and high") from None
    if not (np.isfinite([low, high]).all() and low < high):
        raise OutputError(f"range is {low} to {high}; the first must be the smaller one")
    if log and low <= 0:
        raise OutputError(f"range is {low} to {high}; a logarithmic scale must begin above 0")
    return low, high


def beside(picture: np.ndarray, legend: np.ndarray) -> np.ndarray:
    """Return a picture and its legend to the right of it, on white."""
    height = max(len(picture), len(legend))
    pad = [np.pad(part, ((0, height - len(part)), (0, 0), (0, 0)), constant_values=255) for part in (picture, legend)]
    return np.concatenate(pad, axis=1)
