"""Drawings of matplotlib as images within the page: the same bytes for the same values."""

import io

from .markup import Markup, png_image

DPI = 150


def new_figure(width: float, height: float):
    """Return a figure of so many inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained", facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def drawn(figure, alt: str) -> Markup:
    """Return a figure as an image of the page."""
    file = io.BytesIO()
    figure.savefig(file, format="png", metadata={"Software": None})
    return png_image(file.getvalue(), alt)
