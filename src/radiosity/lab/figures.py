"""Figures of error against lines, in one style for all experiments."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from . import slopes
from .results import Results
from .start import Start
from .study import Arm

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")  # safe for colour-blind readers
NARROW = 18  # letters of an arm's name: below this a row of the legend has four names
MARKS = ("o", "s", "^", "D", "v", "P", "X")
STYLE: Any = {
    "font.size": 9,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.hashsalt": "radiosity",
    "svg.fonttype": "path",
    "legend.frameon": False,
}
LINES = "lines of one replicate (a span counts two)"


@contextmanager
def drawn(path: Path, size: tuple[float, float], title: str = "") -> Iterator[Any]:
    """Give a figure to draw on, in the common style; it is written as ``path`` with .png and .svg."""
    import matplotlib

    with matplotlib.rc_context(STYLE):
        from matplotlib.figure import Figure

        figure = Figure(figsize=size, layout="constrained")
        yield figure
        if title:
            figure.suptitle(title)
        figure.savefig(path.with_suffix(".png"), dpi=130)
        figure.savefig(path.with_suffix(".svg"), metadata={"Date": None})


def convergence(
    results: Results,
    arms: tuple[Arm, ...],
    scenes: tuple[str, ...],
    title: str,
    path: Path,
    *,
    seconds: bool = False,
    picture: bool = False,
) -> None:
    """Draw error against lines, one panel a scene; the band is one standard error over replicates.

    Curves of random numbers are dashed, those of low discrepancy numbers solid.

    Args:
        seconds: draw against wall time, not lines.
        picture: draw the RMS of tone-mapped pictures, not of the radiosity of patches.
    """
    families = list(dict.fromkeys(arm.family for arm in arms))
    with drawn(path, (8.4, 7.2), title) as figure:
        panels = figure.subplots(2, (len(scenes) + 1) // 2, squeeze=False).ravel()
        for panel, scene in zip(panels, scenes, strict=False):
            what = "RMS error of the picture" if picture else "RMS error of the radiosity"
            panel.set(xscale="log", yscale="log", title=scene, xlabel="seconds" if seconds else LINES, ylabel=what)
            for number, arm in enumerate(arms):
                series = results.series[scene, arm.name]
                errors = series.picture if picture else series.area_weighted
                colour = COLOURS[families.index(arm.family) % len(COLOURS)]
                look = _look(number, len(arms)) | {"color": colour, "linestyle": "-" if arm.quasi else "--", "label": arm.name}
                _curve(panel, series.seconds if seconds else series.lines, errors, look)
            _guide(panel)
        for panel in panels[len(scenes) :]:
            panel.set_axis_off()
        handles, labels = panels[0].get_legend_handles_labels()
        columns = min(4 if max(map(len, labels)) < NARROW else 3, len(labels))
        figure.legend(handles, labels, fontsize=8.5, loc="outside lower center", ncols=columns, handlelength=3.5)


def contests(found: dict, title: str, path: Path) -> None:
    """Draw error against seconds and memory, a row for each scene and size; Monte Carlo methods solid, baselines dashed.

    Args:
        found: by (scene, patches), `contest.Entry` of every run.
    """
    from .contest import ARMS

    with drawn(path, (8.4, 2.9 * len(found)), title) as figure:
        rows = figure.subplots(len(found), 2, squeeze=False)
        for panels, ((scene, n), entries) in zip(rows, found.items(), strict=True):
            for panel, what, scale in zip(panels, ("seconds", "memory"), (1, 2**20), strict=True):
                label = "seconds" if what == "seconds" else "MiB beyond the scene"
                panel.set(xscale="log", yscale="log", title=f"{scene}, {n} patches", xlabel=label, ylabel="RMS error")
                for colour, (name, arm) in zip(COLOURS, ARMS.items(), strict=False):
                    points = [(getattr(e, what) / scale, e.error) for e in entries if e.arm == name]
                    style = "-" if arm.monte_carlo else "--"
                    panel.plot(*zip(*points, strict=True) if points else ([], []), style, color=colour, marker=".", label=name)
        rows[0][0].legend(fontsize=6)


def starts(found: dict[str, list[Start]], title: str, path: Path) -> None:
    """Draw the first lines of runs in different orders, a panel a scene."""
    with drawn(path, (4.2 * len(found) + 1.5, 3.6), title) as figure:
        panels = figure.subplots(1, len(found), squeeze=False).ravel()
        for panel, (scene, orders) in zip(panels, found.items(), strict=True):
            panel.set(xscale="log", yscale="log", title=scene, xlabel=LINES, ylabel="RMS error of the radiosity")
            for order, colour, mark in zip(orders, COLOURS, (".", "s", "x"), strict=False):
                error = slopes.mean_error(order.errors)
                panel.plot(order.lines, error, color=colour, marker=mark, markersize=5, linewidth=1, label=order.order)
            panel.legend(fontsize=8)


def _look(number: int, count: int) -> dict[str, Any]:
    """Return a style by which curves that lie on each other can be told apart.

    The first curves are thick and the later ones thin; each has other marks at other places.
    """
    thin = number / max(count - 1, 1)
    return {
        "linewidth": 3.4 - 2.4 * thin,
        "marker": MARKS[number % len(MARKS)],
        "markersize": 7 - 2 * thin,
        "markevery": (number % 3, 3),
        "markeredgecolor": "white",
        "markeredgewidth": 0.6,
    }


def _curve(panel, x, errors, look: dict[str, Any]) -> None:
    middle = slopes.mean_error(errors)
    spread = errors.std(axis=0, ddof=1) / len(errors) ** 0.5
    panel.plot(x, middle, **look)
    panel.fill_between(x, (middle - spread).clip(middle * 1e-3), middle + spread, color=look["color"], alpha=0.15, linewidth=0)


def _guide(panel) -> None:
    """Draw a line of slope -1/2 to compare with."""
    (low, high), (bottom, top) = panel.get_xlim(), panel.get_ylim()
    begin = max(low, high / 1e4)
    panel.plot([begin, high], [top, top * (high / begin) ** -0.5], color="0.6", linewidth=0.8, linestyle=":", zorder=0)
    panel.set(xlim=(low, high), ylim=(bottom, top))
