"""The summary of a solution as text."""

import math

from ..errors import printable, shown
from .intervals import FEW
from .percent import UNKNOWN, number, percent
from .sides import BACK
from .status import NOT_REACHED

MOST_ROWS = 24
WIDEST = 32  # most letters of a surface's name


def report(solution) -> str:
    """Lines, time, error, energy balance, warnings and the surfaces with the largest radiant power."""
    scene, unit = solution.patches.scene, solution.patches.scene.power_unit
    rate = solution.rays / solution.seconds / 1e6 if solution.seconds > 0 else math.nan
    error = _error(solution)
    inside = ~solution.sides.dark
    lines = [
        f"scene     {printable(scene.source)}: {scene.n_faces} faces, {len(scene.names)} surfaces, "
        f"{len(solution.patches)} patches",
        f"method    {solution.provenance['method']}, seed {solution.provenance['seed']}",
        *_chosen(solution),
        *_importance(solution),
        f"lines     {solution.rays:,} in {solution.seconds:.2f} s ({number(rate, '.1f')} million a second), {_counted(solution)}",
        f"error     {error}",
        f"status    {_status(solution)}",
    ]
    few = solution.few & inside
    unvisited = int((few & (solution.arrivals == 0)).sum())
    if few.any():
        none = f", of which no line reached {unvisited} (their value is unknown)" if unvisited else ""
        count = f"{few.sum()} patches that fewer than {FEW} lines reached{none}"
        lines.append(f"few       {count}: their errors are rough (see the .csv)")
    for name, book in zip(scene.bands, solution.books, strict=True):
        label = f"power [{name}]" if len(scene.bands) > 1 else "power"
        closed = {True: "closes exactly", False: "DOES NOT CLOSE", None: "the residual is shown as rounding"}[book["closes"]]
        lines.append(
            f"{label}: emitted {number(book['emitted'], '.6g')} {unit} + rounding {number(book['rounding'], '.3g')} = "
            f"absorbed {number(book['absorbed'], '.6g')} + escaped {number(book['escaped'])} + lost on backs "
            f"{number(book['lost'])} ({closed})"
        )
    warned = [f"warning   {printable(text)}" for text in solution.warnings]
    return "\n".join([*lines, *warned, "", *_surfaces(solution)])


def _chosen(solution) -> list[str]:
    auto = solution.provenance.get("auto")
    return [f"chosen    {auto['chosen']}: {auto['why']}"] if auto else []


def _importance(solution) -> list[str]:
    name = solution.provenance.get("importance")
    return [f"shared    lines are shared out for {printable(name)}; other patches have larger errors"] if name else []


def _counted(solution) -> str:
    if not len(solution.history):
        return f"{solution.replicates} replicates of {solution.quanta:,} quanta"
    steps, left = solution.history[-1]
    return f"{steps:,.0f} steps, which left {left:.2g}"


def _error(solution) -> str:
    if solution.quanta == 0:
        return "unknown (no stage is complete yet)"
    if solution.by_baseline:
        return "unknown: it is that of the form factors, which replicates cannot measure"
    if solution.replicates < 2:
        return "unknown (one replicate; from 2 on there are errors)"
    if not solution.irradiance.any():
        return "unknown: no line hit a patch"
    if not math.isfinite(solution.error):
        return "unknown: no line hit where light would be reflected" + (" in some band" if len(solution.bands) > 1 else "")
    reflected = solution.patches.scatter.of(solution.irradiance).any()
    return f"{percent(solution.error)} of the {'reflected light' if reflected else 'irradiance (nothing is reflected)'}"


def _status(solution) -> str:
    if solution.status != NOT_REACHED:
        return solution.status
    return f"{NOT_REACHED}: the error asked for was {100 * solution.provenance['budget']['error']:.3g}%"


def _surfaces(solution) -> list[str]:
    rows, scene = solution.surface_table(), solution.patches.scene
    tails = [f" [{name}]" for name in scene.bands] if len(scene.bands) > 1 else [""]
    rows.sort(key=lambda row: -sum(row[f"left{tail}"] for tail in tails))
    twice = {row["surface"] for row in rows if row["side"] == BACK and not row["dark"]}
    names = [_called(row["surface"], row["side"] if row["surface"] in twice else "") for row in rows[:MOST_ROWS]]
    width = max(len("surface"), *map(len, names))
    short = [name[0].upper() if len(scene.bands) == 3 else name for name in scene.bands] if len(tails) > 1 else [""]
    heads = [f"B {s}".strip() for s in short] + [f"H {s}".strip() for s in short]
    one = ["illuminance"] if "illuminance" in rows[0] else []  # of red, green and blue together
    heads += ["E"] * len(one)
    heads = [f"{head:>9}" for head in heads] + [f"{head:>7}" for head in ("H ±", "error")]
    title = f"{'surface':<{width}} {'patches':>8} {'area m²':>9} " + " ".join(heads)
    units = (
        f"radiosity B in {scene.unit} and irradiance H in {scene.irradiance_unit}"
        if scene.photometric
        else (f"radiosity B and irradiance H in {scene.unit}")
    )
    units += ", E: all bands of H by photopic weights, in lx" if one else ""
    about = f"{units}; area means; ±: 95 % interval of H; error: RMS over patches, relative"
    result = [about, title]
    for name, row in zip(names, rows, strict=False):
        values = [row[f"radiosity{t}"] for t in tails] + [row[f"irradiance{t}"] for t in tails]
        values += [row[key] for key in one]
        error, sure = (percent(row[key]) for key in ("error", "interval"))
        result.append(
            f"{name:<{width}} {row['patches']:>8} {row['area']:>9.4g} "
            + " ".join(f"{number(v):>9}" for v in values)
            + f" {sure:>7} {error:>7}"
        )
    if len(rows) > MOST_ROWS:
        result.append(f"... and {len(rows) - MOST_ROWS} more surfaces (export a .csv for all)")
    result += _dark(rows)
    if any(line.rstrip().endswith(UNKNOWN) or f" {UNKNOWN} " in line for line in result[2:]):
        result.append(f"{UNKNOWN}: unknown, {_why(solution)}")
    return result


def _called(surface: str, side: str) -> str:
    """Return a surface's name for a narrow column, and its side where both sides have a row."""
    tail = f" ({side})" if side else ""
    return printable(surface)[: WIDEST - len(tail)] + tail


def _dark(rows: list[dict]) -> list[str]:
    """A line about the sides that no line reached, which have no row."""
    names = list(dict.fromkeys(row["surface"] for row in rows if row["dark"] > 0))
    if not names:
        return []
    area = sum(row["dark"] for row in rows)
    return [
        f"two-sided, lit on one side alone: {printable(shown(names, 4))}; their other sides ({area:.4g} m²), which no line "
        "reached, are left out of areas and means"
    ]


def _why(solution) -> str:
    if solution.quanta == 0:
        return "since no stage is complete yet"
    if solution.by_baseline:
        return "since replicates cannot measure the error of form factors"
    if solution.replicates < 2:
        return "since errors need 2 replicates or more"
    return "since no line hit it" if solution.surface_power is not None else "since none hit it, or the file is old"
