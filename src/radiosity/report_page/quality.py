"""Sections about the figures: where the light goes, how sure they are, and warnings."""

import math

import numpy as np

from ..diagnostics.report import SERIOUS, WARNING, Report
from ..solution.model import Solution
from .drawing import drawn, new_figure
from .markup import Markup, element, figure, section, table
from .words import Words, number, percent

SHOWN = 12  # names in a sentence
CLOSES = {
    True: "The sums on both sides are equal to the last digit of the calculation.",
    False: "The sums on both sides differ: the figures of this report are not to be trusted.",
    None: "What is missing between both sides is the error of the method; it is shown as rounding.",
}


def balance(solution: Solution) -> Markup:
    """Return the table of what becomes of the light."""
    scene = solution.patches.scene
    words, several = Words.of(scene), scene.n_bands > 1
    heads = ["band"] if several else [words.power]
    heads += [
        f"{name} [{words.power_unit}]" for name in ("sent out", "absorbed", "left the scene", "absorbed by backs", "rounding")
    ]
    rows = []
    for band, book in zip(scene.bands, solution.books, strict=True):
        values = [book[name] for name in ("emitted", "absorbed", "escaped", "lost", "rounding")]
        rows.append([band if several else "all", *(number(value) for value in values)])
    closed = {book["closes"] for book in solution.books}
    worst = False if False in closed else None if None in closed else True
    about = "All light that is sent out is absorbed by surfaces, leaves the scene, or meets backs of one-sided surfaces."
    return section(
        "Where the light goes",
        element("p", about),
        table("Energy balance", heads, rows),
        element("p", CLOSES[worst]),
        kind="keep",
    )


def certainty(solution: Solution) -> Markup:
    """Return what is known about the error, and how it fell where that was recorded."""
    scene = solution.patches.scene
    low, high = solution.scene_interval()
    inside = ~solution.sides.left_out
    area = solution.patches.solid.area[inside]
    mean = area @ solution.irradiance[inside] / area.sum()
    half = np.divide((high - low) / 2, mean, out=np.full(len(mean), np.nan), where=mean > 0)
    known = half[np.isfinite(half)]
    words = Words.of(scene)
    if solution.by_baseline:
        how = "The method solves the equations directly; repetitions that would show its error there are not."
    else:
        how = (
            f"Light was followed along {solution.rays:,} lines in {solution.replicates} independent repetitions. Their scatter "
            "tells how sure the figures are."
        )
    mean_error = f"± {percent(float(known.max()))}" if known.size else "an unknown error"
    spot = spot_error(solution)
    known_spots = f"± {percent(spot)}: half of the lit area is known better" if math.isfinite(spot) else "unknown"
    sure = (
        f"The mean {words.falling} of the scene is known to {mean_error} (in 95 of 100 calculations). The typical error of a "
        f"single spot is {known_spots}."
    )
    mesh = (
        f"Surfaces are divided into {len(solution.patches):,} patches, and {words.falling} is one number for each of them. Finer "
        "patches would show finer shadows; what they would change is not in the errors above."
    )
    parts = [element("p", how), element("p", sure), element("p", mesh)]
    if len(solution.history) > 1:
        parts.append(_history(solution))
    return section("How sure the figures are", *parts, kind="keep")


def spot_error(solution: Solution) -> float:
    """Return half of the 95 % interval of a patch's irradiance over its value, the median over the lit area; NaN where unknown.

    `Solution.error` is no such figure: where little of a scene is bright, it tells of that part alone.
    """
    low, high = (end.sum(axis=1) for end in solution.interval(0.95, "irradiance"))  # bands share lines: never too small
    light = solution.irradiance.sum(axis=1)
    lit = np.flatnonzero(~solution.sides.left_out & (light > 0))
    share = ((high - low) / 2)[lit] / light[lit]
    if not len(lit) or np.isnan(share).any():
        return math.nan
    order = np.argsort(share, kind="stable")
    below = np.cumsum(solution.patches.area[lit][order])
    return float(share[order][np.searchsorted(below, below[-1] / 2)])


def _history(solution: Solution) -> Markup:
    steps, left = solution.history.T
    drawing = new_figure(6.0, 2.8)
    axes = drawing.subplots()
    axes.semilogy(steps, np.where(left > 0, left, np.nan), "o-", markersize=3, color="#0b5394")
    axes.set_xlabel("steps")
    axes.set_ylabel("what was left")
    axes.grid(visible=True, linewidth=0.4)
    alt = f"Convergence: after {steps[-1]:,.0f} steps {left[-1]:.2g} of the light was left"
    return figure(drawn(drawing, alt), alt)


def to_know(solution: Solution, checked: Report | None, told: list[str]) -> Markup:
    """Return what the calculation and the check of the scene warn of.

    Args:
        told: what was told while the report was made.
    """
    notes = [*_of_solution(solution), *solution.warnings, *told]
    if checked is not None:
        notes += [finding.message for finding in checked.findings if finding.severity in (SERIOUS, WARNING)]
    good = "Nothing unusual was found." if checked is not None else "The calculation tells of nothing unusual."
    parts = [element("p", note, class_="note") for note in dict.fromkeys(notes)] or [element("p", good, class_="note good")]
    if checked is None:
        parts.append(element("p", "The scene was not checked for gaps and mistakes.", class_="small"))
    return section("What to know about these figures", *parts)


def _of_solution(solution: Solution) -> list[str]:
    notes, scene = [], solution.patches.scene
    if solution.status != "complete":
        notes.append(f"The calculation ended early: {solution.status}. Its figures are less sure than was asked for.")
    if any(book["closes"] is False for book in solution.books):
        notes.append(CLOSES[False])
    inside, patches = ~solution.sides.dark, solution.patches
    lit = patches.area[inside].sum()
    for some, what in (
        (solution.arrivals > 0, "were met by few lines: their figures are rough"),
        (solution.arrivals == 0, "were met by no line: their figures are unknown"),
    ):
        few = solution.few & inside & some
        if few.any():
            share = percent(float(patches.area[few].sum() / lit))
            notes.append(f"{few.sum():,} of {len(patches):,} patches ({share} of the area) {what}.")
    if scene.assumed:
        names = ", ".join(scene.assumed[:SHOWN]) + (
            f" and {len(scene.assumed) - SHOWN} more" if len(scene.assumed) > SHOWN else ""
        )
        notes.append(f"The reflectance of these surfaces is in no file and was assumed: {names}.")
    return notes
