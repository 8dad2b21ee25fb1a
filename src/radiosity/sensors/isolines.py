"""Lines of equal light over a grid."""

import numpy as np

LEVELS = 8  # at most, about


def draw(axes, x: np.ndarray, y: np.ndarray, values: np.ndarray) -> None:
    """Draw labelled isolines between the lowest and the highest value; none where all values are equal.

    Lines at the lowest value itself would only follow noise: around a dark place, that at 0.

    Args:
        x, y: (columns,) and (rows,) places.
        values: (rows, columns), NaN where unknown.
    """
    from matplotlib.ticker import MaxNLocator

    known = values[np.isfinite(values)]
    if min(values.shape) < 2 or not known.size or known.max() <= known.min() * (1 + 1e-6):
        return
    ticks = MaxNLocator(LEVELS + 1).tick_values(known.min(), known.max())
    levels = ticks[(ticks > known.min()) & (ticks < known.max())]
    if len(levels):
        lines = axes.contour(x, y, np.ma.masked_invalid(values), levels=levels, colors="white", linewidths=0.8)
        axes.clabel(lines, fmt="%g", fontsize=7)
