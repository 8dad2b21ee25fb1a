"""Pictures of a radiative exchange: a false-colour view of net heat, and the watts between surfaces as a matrix."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np

from ..errors import printable
from ..image import bitmap, false_color
from ..image.lookup import Lookup
from ..image.picture import choose_camera, first_hits, take
from ..image.quantity import Quantity
from ..solution.replacing import replacing
from .picture_words import LONGEST, in_watts, most_active
from .report import SIGN, SURROUNDINGS

COLORS = "coolwarm"  # blue takes heat, red gives it off


def heat(found, path: Path) -> None:
    """Write a view of the net heat of patches, W/m², by the scene's first camera or a fitted one."""
    net = found.patch_net
    shown = Quantity(net[:, None], "net heat given off", "W/m²", ("heat",), np.zeros(len(net), bool))
    stage = SimpleNamespace(patches=found.patches, radiosity=np.abs(net)[:, None] + 1e-300)
    camera = choose_camera(stage, None, None, None, first_hits)
    picture = take(stage, shown, camera, look=Lookup(stage.patches, shown.values, smooth=False))
    size = float(np.percentile(np.abs(net), 99)) or 1.0
    pixels = false_color.colour(picture, title=shown.title, unit=shown.unit, limits=(-size, size), color_map=COLORS)
    bitmap.write_png(pixels, path, {"quantity": shown.title, "unit": shown.unit, "sign": SIGN, "camera": repr(camera)})


def exchange(found, path: Path) -> None:
    """Write a matrix of watts that go straight from the surface of a row to that of a column, less what comes back."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import SymLogNorm
    from matplotlib.figure import Figure

    watts, names = found.exchange, np.array([*found.names, SURROUNDINGS], object)
    rows, left_out = most_active(watts)
    watts = watts[np.ix_(rows, rows)]
    labels = [printable(name)[:LONGEST] for name in names[rows]]
    figure = Figure(figsize=(3 + 0.55 * len(rows), 2.4 + 0.5 * len(rows)), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    top = float(np.abs(watts).max()) or 1.0
    shades = axes.imshow(watts, cmap=COLORS, norm=SymLogNorm(top / 100, vmin=-top, vmax=top, base=10))
    axes.set_xticks(range(len(rows)), labels, rotation=90)
    axes.set_yticks(range(len(rows)), labels)
    axes.set_xlabel("to")
    axes.set_ylabel("from")
    for i, j in np.argwhere(watts > 0):
        axes.text(j, i, in_watts(watts[i, j]), ha="center", va="center", fontsize=7)
    left = f" ({len(rows)} surfaces that exchange most)" if left_out else ""
    axes.set_title(f"net heat straight from one to another [W]{left}", fontsize=9)
    figure.colorbar(shades, ax=axes, label="W")
    with replacing(path) as temporary:
        figure.savefig(temporary, format="png")
