"""The summary of a solution as text."""

import math

import numpy as np

from ..errors import printable
from .intervals import FEW

MOST_ROWS = 24


def report(solution) -> str:
    """Lines, time, error, books and the surfaces with the largest radiant power."""
    scene, unit = solution.patches.scene, solution.patches.scene.power_unit
    rate = solution.rays / solution.seconds if solution.seconds > 0 else math.nan
    error = _error(solution)
    unvisited = int((solution.arrivals == 0).sum())
    lines = [
        f"scene     {printable(scene.source)}: {scene.n_faces} faces, {len(scene.names)} surfaces, "
        f"{len(solution.patches)} patches",
        f"method    {solution.provenance['method']}, seed {solution.provenance['seed']}",
        f"lines     {solution.rays:,} in {solution.seconds:.2f} s ({rate / 1e6:.1f} million a second), {_counted(solution)}",
        f"error     {error}",
        f"status    {solution.status}",
    ]
    few = int(solution.few.sum())
    if few:
        none = f", {unvisited} of them none (their zero is no measurement)" if unvisited else ""
        lines.append(f"few       {few} patches that fewer than {FEW} lines reached{none}: their errors are rough (see the .csv)")
    for name, book in zip(scene.bands, solution.books, strict=True):
        label = f"power [{name}]" if len(scene.bands) > 1 else "power"
        closed = {True: "closes exactly", False: "DOES NOT CLOSE", None: "rounding is what does not balance"}[book["closes"]]
        lines.append(
            f"{label}: emitted {book['emitted']:.6g} {unit} + rounding {book['rounding']:.3g} = absorbed {book['absorbed']:.6g} "
            f"+ escaped {book['escaped']:.4g} + lost on backs {book['lost']:.4g} ({closed})"
        )
    return "\n".join([*lines, "", *_surfaces(solution)])


def _counted(solution) -> str:
    if not len(solution.history):
        return f"{solution.replicates} replicates of {solution.quanta:,} quanta"
    steps, left = solution.history[-1]
    return f"{steps:,.0f} steps, which left {left:.2g}"


def _error(solution) -> str:
    if solution.quanta == 0:
        return "unknown (no stage is complete yet)"
    if solution.by_baseline:
        return "unknown: it is that of the form factors, which replicates do not show"
    if solution.replicates < 2:
        return "unknown (one replicate; from 2 on there are errors)"
    if np.isnan(solution.error):
        return "none: no line landed anywhere"
    reflected = (solution.patches.reflectance * solution.irradiance).any()
    return f"{solution.error:.2%} of the {'reflected light' if reflected else 'irradiance (nothing is reflected)'}"


def _surfaces(solution) -> list[str]:
    rows, scene = solution.surface_table(), solution.patches.scene
    tails = [f" [{name}]" for name in scene.bands] if len(scene.bands) > 1 else [""]
    rows.sort(key=lambda row: -sum(row[f"left{tail}"] for tail in tails))
    width = max(len("surface"), *(min(len(printable(row["surface"])), 32) for row in rows[:MOST_ROWS]))
    short = [name[0].upper() if len(scene.bands) == 3 else name for name in scene.bands] if len(tails) > 1 else [""]
    heads = [f"B {s}".strip() for s in short] + [f"H {s}".strip() for s in short]
    heads = [f"{head:>9}" for head in heads] + [f"{head:>7}" for head in ("H ±", "error")]
    title = f"{'surface':<{width}} {'patches':>8} {'area m²':>9} " + " ".join(heads)
    about = f"radiosity B and irradiance H in {scene.unit}, area means; ±: 95 % interval of H; error: RMS over patches, relative"
    result = [about, title]
    for row in rows[:MOST_ROWS]:
        values = [row[f"radiosity{t}"] for t in tails] + [row[f"irradiance{t}"] for t in tails]
        error, sure = ("?" if np.isnan(row[key]) else f"{row[key]:.2%}" for key in ("error", "interval"))
        result.append(
            f"{printable(row['surface'])[:32]:<{width}} {row['patches']:>8} {row['area']:>9.4g} "
            + " ".join(f"{v:>9.4g}" for v in values)
            + f" {sure:>7} {error:>7}"
        )
    if len(rows) > MOST_ROWS:
        result.append(f"... and {len(rows) - MOST_ROWS} more surfaces (export a .csv for all)")
    return result
