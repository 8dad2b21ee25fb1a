"""Output files of comparisons, by their suffix."""

import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import OutputError, printable
from ..image.output import check_writable, require
from ..image.tables import surfaces_path
from ..patches.model import Patches
from ..solution.csv_rows import write_rows
from ..solution.replacing import replacing
from ..solution.whole import whole_file
from .report import bin_name

SUFFIXES = (".json", ".csv", ".png", ".svg", ".pdf")
COLOR_MAP = "RdBu_r"  # red where the first is larger, blue where the second is
TOP = 99.0  # percentile of the sizes of differences at which the automatic range ends


def files_of(path) -> tuple[Path, ...]:
    """The files that `write` makes for a path: itself, and beside ``x.csv`` the table of surfaces."""
    path = Path(path)
    return (path, surfaces_path(path)) if path.suffix.lower() == ".csv" else (path,)


def check(paths) -> None:
    """Refuse, before any work, outputs that could not be written after it.

    Raises:
        OutputError: an unknown format, a folder that cannot be written to, or one file named twice.
    """
    seen: set[Path] = set()
    for path in paths:
        for file in files_of(path):
            if check_writable(file, SUFFIXES).resolve() in seen:
                raise OutputError(f"{path} is named twice; give each output its own name")
            seen.add(file.resolve())
        if path.suffix.lower() not in (".json", ".csv"):
            require("matplotlib", f"{path}: false colours and histograms")
        if path.suffix.lower() == ".png":
            require("PIL", f"{path}: writing PNG")


def write(found, path: Path, *, camera=None, width=None, height=None, limit: float | None = None) -> None:
    """Write a file of a comparison.

    Args:
        found: the `Comparison`.
        path: .json, .csv, .png, .svg or .pdf.
        camera, width, height: of a picture, see `radiosity.image.render`.
        limit: of a picture: the difference at which colours end, on both sides of zero. Default: the 99th percentile.

    Raises:
        OutputError: another suffix, a file that cannot be written, or a picture of scenes whose faces differ.
    """
    check([path])
    suffix = path.suffix.lower()
    if suffix == ".json":
        with whole_file(path) as file:
            file.write(
                (json.dumps(_plain(facts(found)), indent=1, ensure_ascii=False) + "\n").encode("utf-8", "backslashreplace")
            )
    elif suffix == ".csv":
        write_rows(found.surfaces, surfaces_path(path), _titles(found, found.surfaces[0]))
        patches = _patch_rows(found)
        write_rows(patches or found.surfaces, path, _titles(found, (patches or found.surfaces)[0]))
    elif suffix == ".png":
        from ..image.bitmap import write_png

        pixels, told = picture(found, camera=camera, width=width, height=height, limit=limit)
        write_png(pixels, path, told)
    else:
        _histogram(found, path)


def facts(found) -> dict:
    """All figures of a comparison as plain values; NaN where unknown."""
    by = found.by_patch
    return {
        "first": found.names[0],
        "second": found.names[1],
        "quantity": found.quantity,
        "unit": found.unit,
        "bands": list(found.bands),
        "agrees": found.agrees,
        "within": found.within,
        "of": found.of,
        "alpha": found.alpha,
        "probability": found.chance,
        "rms": found.rms,
        "relative rms": found.relative,
        "relative rms of errors alone": found.expected,
        "largest relative difference of a surface": found.largest,
        "compared": "surfaces" if by is None else "patches" if by.equal else "overlaps",
        "patches": 0 if by is None else int(by.counted.sum()),
        "tested patches": 0 if by is None else int(by.tested.sum()),
        "chi square": found.rows.chi,
        "independent means": found.rows.independent,
        "probability of chi square": found.rows.chance,
        "notes": list(found.notes),
        "surfaces": found.surfaces,
        "histogram of scores": found.histogram(),
    }


def picture(found, *, camera=None, width=None, height=None, limit: float | None = None) -> tuple[np.ndarray, dict[str, str]]:
    """The differences in a colour scale that is white at zero, (height, width, 3) uint8, and facts about them.

    Raises:
        OutputError: the faces of the scenes differ, or the limit is no range.
    """
    from ..image import false_color, tone
    from ..image.picture import choose_camera, first_hits, take
    from ..image.quantity import Quantity

    by = found.by_patch
    if by is None:
        raise OutputError("a picture of differences needs scenes with the same faces; here surfaces alone can be compared")
    title = f"{found.quantity}, difference"
    if len(found.bands) == 3:
        title += ", bands weighted as the eye does"
    elif len(found.bands) > 1:
        title += ", mean of the bands"
    values = tone.luminance(by.difference) if len(found.bands) > 1 else by.difference[:, 0]
    shown = Quantity(values[:, None], title, found.unit, ("all",), np.zeros(len(values), bool))
    on = _OnPatches(by.patches, by.values[0])
    view = choose_camera(on, camera, width, height, first_hits)
    taken = take(on, shown, view)
    if limit is None:
        sizes = np.abs(taken.values[taken.cover > 0])
        sizes = sizes[np.isfinite(sizes)]
        limit = float(np.percentile(sizes, TOP)) if sizes.size else 0.0
        limit = limit if limit > 0 else 1.0
    elif not 0 < limit < math.inf:
        raise OutputError(f"the limit of the colours is {limit!r}; it must be a number above 0, in {found.unit}")
    colours = false_color.colour(taken, title=title, unit=found.unit, limits=(-limit, limit), color_map=COLOR_MAP)
    return colours, {
        "quantity": title,
        "unit": found.unit,
        "camera": repr(view),
        "first": found.names[0],
        "second": found.names[1],
    }


@dataclass(frozen=True, eq=False)
class _OnPatches:
    """What pictures ask of a solution: patches, and the light by which a camera is found."""

    patches: Patches
    radiosity: np.ndarray


def _patch_rows(found) -> list[dict]:
    """A row for each patch and band that is counted."""
    by = found.by_patch
    if by is None:
        return []
    patches, names = by.patches, by.patches.scene.names
    centroid, surface, area, back = patches.centroid, patches.surface, patches.area, patches.is_back
    rows = []
    for i in np.flatnonzero(by.counted):
        for j, band in enumerate(found.bands):
            first, second = by.values[:, i, j].tolist()
            one, two = by.errors[:, i, j].tolist()
            rows.append(
                {
                    "patch": int(i),
                    "surface": names[surface[i]],
                    "side": "back" if back[i] else "front",
                    "band": band,
                    **{f"centroid {axis} [m]": float(centroid[i, k]) for k, axis in enumerate("xyz")},
                    "area": float(area[i]),
                    "first": first,
                    "first error": one,
                    "second": second,
                    "second error": two,
                    "difference": first - second,
                    "score": float(by.test.score[i, j]),
                    "probability": float(by.test.chance[i, j]),
                }
            )
    return rows


def _titles(found, row: dict) -> list[str]:
    units = dict.fromkeys(("first", "first error", "second", "second error", "difference"), found.unit) | {"area": "m²"}
    return [f"{key} [{units[key]}]" if key in units else key for key in row]


def _plain(value):
    """Values for JSON, which has no NaN: unknown ones are null."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_plain(one) for one in value]
    return value if not isinstance(value, float) or math.isfinite(value) else None


def _histogram(found, path: Path) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    rows = found.histogram()
    figure = Figure(figsize=(6.4, 4.0), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes, x = figure.subplots(), np.arange(len(rows))
    axes.bar(x, [row["count"] for row in rows], 0.9, color="#4477aa", label="found")
    axes.plot(x, [row["expected"] for row in rows], "ko", markersize=4, label="expected from the errors alone")
    axes.set_xticks(x, [bin_name(row) for row in rows], rotation=30, fontsize=8)
    axes.set_xlabel("normal score of the difference")
    axes.set_ylabel("number")
    axes.set_title(f"{printable(found.names[0])} - {printable(found.names[1])}", fontsize=9, parse_math=False)
    axes.legend(frameon=False)
    with replacing(path) as temporary:
        metadata = {"Date": None} if path.suffix.lower() == ".svg" else {"CreationDate": None}
        figure.savefig(temporary, format=path.suffix.lower()[1:], metadata=metadata)
