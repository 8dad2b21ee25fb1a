"""The legend of false colours: a bar, its numbers, and what they mean."""

import textwrap

import numpy as np

MARGIN = 0.04  # inches between the text and the right edge
DIGITS = range(6, 18)  # of the numbers, from as many as usual to all that a number of double precision has


def drawn(norm, shades, label: str, extend: str, height: int, letters: float) -> np.ndarray:
    """Return a picture of the scale, (height, width, 3) uint8; it is as wide as its numbers and its text need.

    Args:
        norm, shades: matplotlib's, from values to [0, 1] and on to colours.
        label: quantity and unit.
        extend: which ends have an arrow: neither, both, min or max.
        height: pixels.
        letters: size of the letters, 1 as usual.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, NullFormatter

    dpi = 100 * max(1.0, height / 600) * letters
    label = "\n".join(textwrap.wrap(label, max(16, int(height / dpi * 12))))
    width = int((1.05 + 0.16 * label.count("\n")) * dpi)
    figure = Figure(figsize=(width / dpi, height / dpi), dpi=dpi, facecolor="white")
    canvas = FigureCanvasAgg(figure)
    bar = figure.add_axes(_place(width, dpi))
    scale = figure.colorbar(ScalarMappable(norm, shades), cax=bar, extend=extend)
    scale.set_label(label, fontsize=8)
    bar.tick_params(labelsize=8)
    if isinstance(norm, LogNorm):
        # 1, 2, 5, 10 rather than powers in small print; more of them where the range is short
        low, high = bar.get_ylim()
        steps = (1, 2, 5) if high > 6 * low else tuple(np.arange(1, 10, 0.5))
        bar.yaxis.set_major_locator(LogLocator(10, steps))
        _write_out(bar)
        bar.yaxis.set_minor_formatter(NullFormatter())
    canvas.draw()
    if bar.yaxis.get_offset_text().get_text():  # a factor of all numbers stands beside the bar, where it is cut off and missed
        _write_out(bar)
        canvas.draw()
    drawn_there = bar.get_tightbbox(canvas.get_renderer())
    needed = 0 if drawn_there is None else int(np.ceil(drawn_there.x1 + MARGIN * dpi))
    if needed > width:  # long numbers push the text over the edge
        figure.set_size_inches(needed / dpi, height / dpi)
        bar.set_position(_place(needed, dpi))
        canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3]


def numbers(values) -> list[str]:
    """Return values as text, with the fewest digits, six or more, that tell them apart.

    Example:
        >>> from radiosity.image.legend import numbers
        >>> numbers([0.5, 2.0]), numbers([20000.0, 20000.04])
        (['0.5', '2'], ['20000', '20000.04'])
    """
    different = len(set(values))
    for digits in DIGITS:
        found = [f"{value:.{digits}g}" for value in values]
        if len(set(found)) >= different:
            break
    return found


def _place(width: int, dpi: float) -> tuple[float, float, float, float]:
    """Return where the bar stands in a legend that is so many pixels wide, in shares of it."""
    return 0.12 * dpi / width, 0.06, 0.2 * dpi / width, 0.88


def _write_out(bar) -> None:
    """Have each number written out beside its mark, unlike those of other marks."""
    from matplotlib.ticker import Formatter

    class WrittenOut(Formatter):
        def format_ticks(self, values):
            return numbers(values)

        def __call__(self, x, pos=None):
            return numbers([x])[0]

    bar.yaxis.set_major_formatter(WrittenOut())
