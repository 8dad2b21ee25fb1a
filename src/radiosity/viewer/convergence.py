"""The plot of a run: its error against its lines, both logarithmic."""

import numpy as np

SIZE, DPI = (3.2, 2.2), 200  # inches, and pixels of an inch


def plot(rays: list[float], errors: list[float]) -> np.ndarray:
    """Return a picture, (height, width, 3) uint8, of relative errors, in %, against lines."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import EngFormatter, FuncFormatter, LogLocator, NullFormatter

    figure = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    canvas, axes = FigureCanvasAgg(figure), figure.add_subplot()
    axes.loglog(rays, errors, "o-", markersize=3, linewidth=1)
    axes.set_xlabel("lines", fontsize=8)
    axes.set_ylabel("relative error, %", fontsize=8)
    axes.set_ylim(min(errors) / 2, max(errors) * 2)
    axes.set_xlim(min(rays) / 2, max(rays) * 2)
    axes.tick_params(labelsize=7)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(10, (1.0, 2.0, 5.0)))
        axis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_major_formatter(EngFormatter(sep=""))
    axes.grid(which="both", linewidth=0.3)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()
