"""False colours: values as colours of a map, with a legend in physical units beside the picture."""

import textwrap

import numpy as np

from ..errors import OutputError
from . import tone
from .picture import Picture

UNKNOWN = 0.5  # grey of pixels whose value is unknown
TOP = 99.0  # percentile of the values at which the automatic range ends
DECADES = 4  # of an automatic logarithmic range, at most
LOWEST_LEGEND = 240  # pixels


def colour(picture: Picture, *, title: str, unit: str, limits=None, log=False, color_map="viridis") -> np.ndarray:
    """Return the picture at its full resolution and its legend to the right, (height, width, 3) uint8.

    Args:
        picture: a picture with one value a pixel.
        title, unit: of the value, for the legend.
        limits: (low, high) in ``unit``; default: 0 (or the lowest value, if logarithmic) to the 99th percentile of what
            does not emit by itself, or 1 where nothing is lit.
        log: logarithmic scale.
        color_map: one of matplotlib's.

    Raises:
        OutputError: the limits are not a range, or the colour map is unknown.
    """
    import matplotlib
    from matplotlib.colors import LogNorm, Normalize

    if color_map not in matplotlib.colormaps:
        raise OutputError(f"colour map '{color_map}' does not exist; take viridis, inferno, turbo or another of matplotlib's")
    values = picture.values[..., 0]
    low, high = _checked(limits, log) if limits is not None else automatic_limits(picture.counted[:, 0], log)
    norm, shades = (LogNorm if log else Normalize)(low, high, clip=True), matplotlib.colormaps[color_map]
    display = shades(norm(np.maximum(np.nan_to_num(values), low)))[..., :3]
    unknown = ~np.isfinite(values) & (picture.cover > 0)
    display[unknown] = UNKNOWN
    display = tone.eight_bits(display * picture.cover[..., None])
    known = values[(picture.cover > 0) & ~unknown]
    beyond = known.size and known.max() > high * (1 + 1e-9), known.size and known.min() < low * (1 - 1e-9)
    extend = {(True, True): "both", (True, False): "max", (False, True): "min"}.get((bool(beyond[0]), bool(beyond[1])), "neither")
    if unknown.any():
        title += " (grey: unknown)"
    return _beside(display, _legend(norm, shades, f"{title} [{unit}]", extend, max(len(display), LOWEST_LEGEND)))


def automatic_limits(values: np.ndarray, log: bool) -> tuple[float, float]:
    """Return the automatic range for values (m,), NaN allowed."""
    values = values[np.isfinite(values) & (values > 0)]
    if not len(values):
        return (0.1, 1.0) if log else (0.0, 1.0)
    high = float(np.percentile(values, TOP))
    low = max(float(values.min()), high / 10**DECADES) if log else 0.0
    return (low, high) if low < high else (high / 10, high)


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


def _legend(norm, shades, label: str, extend: str, height: int) -> np.ndarray:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    dpi = 100 * max(1.0, height / 600)
    label = "\n".join(textwrap.wrap(label, max(16, int(height / dpi * 12))))
    width = int((1.05 + 0.16 * label.count("\n")) * dpi)
    figure = Figure(figsize=(width / dpi, height / dpi), dpi=dpi, facecolor="white")
    canvas = FigureCanvasAgg(figure)
    bar = figure.add_axes((0.12 * dpi / width, 0.06, 0.2 * dpi / width, 0.88))
    scale = figure.colorbar(ScalarMappable(norm, shades), cax=bar, extend=extend)
    scale.set_label(label, fontsize=8)
    bar.tick_params(labelsize=8)
    if isinstance(norm, LogNorm):
        # 1, 2, 5, 10 rather than powers in small print; more of them where the range is short
        low, high = bar.get_ylim()
        steps = (1, 2, 5) if high > 6 * low else tuple(np.arange(1, 10, 0.5))
        bar.yaxis.set_major_locator(LogLocator(10, steps))
        bar.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        bar.yaxis.set_minor_formatter(NullFormatter())
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3]


def _beside(picture: np.ndarray, legend: np.ndarray) -> np.ndarray:
    height = max(len(picture), len(legend))
    pad = [np.pad(part, ((0, height - len(part)), (0, 0), (0, 0)), constant_values=255) for part in (picture, legend)]
    return np.concatenate(pad, axis=1)
