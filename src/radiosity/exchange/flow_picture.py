"""A picture of the heat that flows from surface to surface: bands from those that give, on the left, to those that take."""

from pathlib import Path

import numpy as np

from ..errors import printable
from ..solution.replacing import replacing
from .picture_words import LONGEST, MOST, in_watts, most_active
from .report import SURROUNDINGS

COLORS = "plasma"  # of the temperature of what gives
BARS, GAPS = 0.04, 0.6  # width of the bars, and all gaps between them, relative to the picture
WHITE = 0.92  # of the colours: the last of them are too bright on white


def flows(found, path: Path) -> None:
    """Write the picture. A band is as wide as the watts that go straight from a surface to another, less what comes back."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    rows, left_out = most_active(found.exchange)
    watts = np.maximum(found.exchange[np.ix_(rows, rows)], 0)
    names = [printable(name)[:LONGEST] for name in np.array([*found.names, SURROUNDINGS], object)[rows]]
    around = np.nan if found.surroundings is None else found.surroundings
    kelvin = np.append(found.temperature, around)[rows]
    given, taken = (np.flatnonzero(watts.sum(axis=axis) > 0) for axis in (1, 0))
    given, taken = given[np.argsort(-kelvin[given], kind="stable")], taken[np.argsort(-kelvin[taken], kind="stable")]
    figure = Figure(figsize=(9, 2.2 + 0.45 * max(len(given), len(taken))), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set_axis_off()
    axes.set_xlim(-0.45, 1.45)
    axes.set_ylim(1 + GAPS, -0.02)
    told = f" ({MOST} surfaces that exchange most)" if left_out else ""
    axes.set_title(f"net heat straight from one to another{told}", fontsize=9)
    if watts.any():
        cold, hot = np.nanmin(kelvin[given]), np.nanmax(kelvin[given])
        colors = ScalarMappable(Normalize(cold, cold + (hot - cold or 1) / WHITE), COLORS)
        _draw(axes, watts, given, taken, names, colors.to_rgba(kelvin))
        bar = figure.colorbar(colors, ax=axes, shrink=0.5)
        bar.set_label("temperature of what gives [K]", fontsize=8)
        bar.ax.tick_params(labelsize=7)
    else:
        axes.text(0.5, 0.5, "no heat flows", ha="center")
    with replacing(path) as temporary:
        figure.savefig(temporary, format="png")


def _draw(axes, watts: np.ndarray, given: np.ndarray, taken: np.ndarray, names: list[str], colors: np.ndarray) -> None:
    """Draw bars with names, and a band for each pair."""
    whole = watts.sum()
    starts, ends = _tops(watts.sum(axis=1)[given] / whole), _tops(watts.sum(axis=0)[taken] / whole)
    for side, nodes, tops, totals in ((0.0, given, starts, watts.sum(axis=1)), (1.0, taken, ends, watts.sum(axis=0))):
        for node, top in zip(nodes, tops, strict=True):
            height = totals[node] / whole
            axes.add_patch(_bar(side, top, height, colors[node] if side == 0 else "0.45"))
            x, align = (side - BARS, "right") if side == 0 else (side + BARS, "left")
            axes.text(x, top + height / 2, f"{names[node]}  {in_watts(totals[node])} W", ha=align, va="center", fontsize=8)
    leave, arrive = dict(zip(given, starts, strict=True)), dict(zip(taken, ends, strict=True))
    for i in given:
        for j in taken:
            if watts[i, j] > 0:
                width = watts[i, j] / whole
                axes.add_patch(_band(leave[i], arrive[j], width, colors[i]))
                leave[i] += width
                arrive[j] += width


def _tops(heights: np.ndarray) -> np.ndarray:
    """Return the upper ends of bars one below the other; the gaps between them are alike."""
    gap = GAPS / len(heights)
    return np.cumsum(heights + gap) - heights - gap / 2


def _bar(x: float, top: float, height: float, color):
    from matplotlib.patches import Rectangle

    return Rectangle((x - BARS / 2, top), BARS, height, color=color, lw=0.5)


def _band(left: float, right: float, width: float, color):
    """Return a band from a height on the left to one on the right, both its upper end."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Curve

    a, b = BARS / 2, 1 - BARS / 2
    points = [(a, left), (0.5, left), (0.5, right), (b, right)]
    points += [(b, right + width), (0.5, right + width), (0.5, left + width), (a, left + width), (a, left)]
    codes = [Curve.MOVETO, *[Curve.CURVE4] * 3, Curve.LINETO, *[Curve.CURVE4] * 3, Curve.CLOSEPOLY]
    return PathPatch(Curve(points, codes), facecolor=color, alpha=0.55, lw=0)
