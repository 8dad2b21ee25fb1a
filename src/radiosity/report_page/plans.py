"""Plan views in false colours with isolines."""

import numpy as np

from ..image.false_color import UNKNOWN
from ..sensors.isolines import draw
from ..solution.model import Solution
from .drawing import drawn, new_figure
from .levels import Plan, plans
from .markup import Markup, element, figure, section
from .words import Words, number, percent

WIDTH, HIGHEST = 7.0, 8.5  # inches
DARK = 1e-6  # share of the highest value below which a value is shown as 0
TOP, FAR = 99.0, 1.5  # percentile at which colours end where the brightest place is so many times brighter


def plan_views(solution: Solution, wanted: tuple[str, ...]) -> Markup | None:
    """Return a plan of each level surface; None where no surface is level.

    Raises:
        MethodError: a surface is not there, or not level.
    """
    words = Words.of(solution.patches.scene)
    found = [plan for plan in plans(solution, wanted) if plan.seen.any()]
    if not found:
        return None
    parts = [_drawn(plan, words) for plan in found]
    intro = f"Level surfaces seen from above. Lines join points of equal {words.falling}; lengths are in metres."
    return section("Plans", element("p", intro, class_="small"), *parts, kind="page")


def _drawn(plan: Plan, words: Words) -> Markup:
    place = f"{plan.name}, at a height of {plan.height:g} m, {number(plan.area)} m²"
    if not np.isfinite(plan.values).any():
        return element("p", f"{place}: no line came there, so its {words.falling} is unknown.")
    left, right, bottom, top = plan.extent
    tall = min(max((top - bottom) / (right - left) * (WIDTH - 1.4), 1.6) + 0.7, HIGHEST)
    drawing = new_figure(WIDTH, tall)
    axes = drawing.subplots()
    isolines(axes, drawing, plan.values, plan.extent, f"{words.falling} [{words.falling_unit}]")
    if plan.unknown.any():
        grey = np.full((*plan.unknown.shape, 4), [UNKNOWN, UNKNOWN, UNKNOWN, 1.0])
        grey[~plan.unknown, 3] = 0
        axes.imshow(grey, origin="lower", extent=plan.extent, interpolation="nearest", aspect="equal")
    axes.set_xlabel(f"{plan.axes[0]} [m]")
    axes.set_ylabel(f"{plan.axes[1]} [m]")
    low, high = float(np.nanmin(plan.values)), float(np.nanmax(plan.values))
    low = low if low > DARK * high else 0.0
    told = f"mean {number(plan.mean)} {words.falling_unit}, from {number(low)} to {number(high)}"
    if plan.unknown.any():
        told += f"; {percent(plan.unknown.mean(where=plan.seen))} of it, grey, is unknown: no line came there"
    alt = f"Plan of {plan.name} in false colours with isolines of {words.falling}: {told}"
    return figure(drawn(drawing, alt), f"{place}: {told}")


def isolines(axes, drawing, values: np.ndarray, extent, label: str) -> None:
    """Draw values, (rows, columns), as colours with isolines and a colour bar; NaN stays white.

    Where a few places are far brighter than all others, the colours end before these, and the bar tells so.
    """
    high = highest(values)
    beyond = bool((values > high).any())
    shades = axes.imshow(
        values, origin="lower", extent=extent, cmap="viridis", interpolation="nearest", aspect="equal", vmax=high
    )
    left, right, bottom, top = extent
    rows, columns = values.shape
    x = left + (np.arange(columns) + 0.5) * (right - left) / columns
    y = bottom + (np.arange(rows) + 0.5) * (top - bottom) / rows
    draw(axes, x, y, np.minimum(values, high))
    label += f"; arrow: brighter than {TOP:g} % of the area" if beyond else ""
    drawing.colorbar(shades, ax=axes, label=label, extend="max" if beyond else "neither")


def highest(values: np.ndarray) -> float:
    """Return where colours end: the largest value, or a percentile where that one is far above it."""
    known = values[np.isfinite(values)]
    top = float(np.percentile(known, TOP))
    return top if 0 < FAR * top < known.max() else float(known.max())
