"""The figure of experiment 7: error against patches, and against lines."""

from pathlib import Path

from ..patches.bases import BASES
from .figures import COLOURS, drawn
from .slopes import mean_error
from .varying import Curve

STYLES = dict(zip(BASES, zip(COLOURS, ("-", "--", "-."), strict=False), strict=False))


def draw(found: dict[str, list[Curve]], title: str, path: Path) -> None:
    """Draw a row for each scene: error against patches with the most lines, and against lines on each mesh.

    Args:
        found: by scene.
    """
    with drawn(path, (8.4, 3.2 * len(found) + 0.4), title) as figure:
        rows = figure.subplots(len(found), 2, squeeze=False)
        for (left, right), (scene, curves) in zip(rows, found.items(), strict=True):
            left.set(xscale="log", yscale="log", title=scene, xlabel="patches", ylabel="RMS error of reflected light")
            right.set(xscale="log", yscale="log", title=scene, xlabel="lines of one replicate")
            for basis, (colour, line) in STYLES.items():
                mine = [one for one in curves if one.basis == basis]
                ends = [mean_error(one.errors)[-1] for one in mine]
                left.plot([one.patches for one in mine], ends, line, color=colour, marker="o", label=basis)
                for one, mark in zip(mine, ("v", "o", "^", "s"), strict=False):
                    name = f"{basis}, {one.patches}"
                    right.plot(one.lines, mean_error(one.errors), line, color=colour, marker=mark, label=name)
            left.legend(fontsize=8)
            right.legend(fontsize=6, title="basis, patches", title_fontsize=6)
