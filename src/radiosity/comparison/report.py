"""The summary of a comparison as text."""

import numpy as np

from ..errors import printable
from ..solution.percent import UNKNOWN, number, percent
from ..solution.report import WIDEST

MOST_ROWS = 24
WIDTH = 40  # letters of the longest bar


def report(found) -> str:
    """The verdict, differences of patches and of surfaces, and the histogram of scores."""
    rows = sorted(found.surfaces, key=_order)
    lines = [
        f"first     {printable(found.names[0])}",
        f"second    {printable(found.names[1])}",
        f"quantity  {found.quantity} in {found.unit}; differences are first - second",
        f"verdict   {_verdict(found)}",
        *(_patches(found)),
        f"surfaces  {_chi(found)}",
        *(f"note      {printable(note)}" for note in found.notes),
        "",
        *_table(found, rows),
    ]
    histogram = found.histogram()
    if any(row["count"] for row in histogram):
        lines += ["", *_bars(found, histogram)]
    return "\n".join(lines)


def _verdict(found) -> str:
    if found.within is not None:
        what = "RMS difference of patches" if found.of == "patches" else "largest difference of a surface's mean"
        value = found.relative if found.of == "patches" else found.largest
        word = "agree" if found.agrees else "DIFFER"
        return f"they {word}: {what} {percent(value)}, allowed {percent(found.within)}"
    if found.agrees is None:
        return f"{UNKNOWN}: no error is known; give a tolerance (--within 2%), or --reference where the second is exact"
    if found.agrees:
        return f"they agree within their errors (probability of such a difference {found.chance:.2g}, alpha {found.alpha:g})"
    return f"they DIFFER by more than their errors (probability by chance {found.chance:.2g}, alpha {found.alpha:g})"


def _patches(found) -> list[str]:
    by = found.by_patch
    what = "surfaces and sides" if by is None else "patches" if by.equal else "overlaps"
    count = len(found.rows.area) if by is None else int(by.counted.sum())
    told = f"RMS difference {number(found.rms, '.3g')} {found.unit}, {percent(found.relative)} of the second"
    lines = [f"{count:,} {what}: {told}; errors alone would give {percent(found.expected)}"]
    if by is not None and (few := int((by.counted & ~by.tested).sum())):
        lines.append(f"{few:,} of them are not tested one by one, since too few lines hit them")
    return [f"{'patches' if i == 0 else '':<9} {line}" for i, line in enumerate(lines)]


def _chi(found) -> str:
    rows = found.rows
    if not np.isfinite(rows.chi):
        return "not tested together: errors are unknown"
    return (
        f"chi square {rows.chi:.3g} for each of {rows.values[0].size} means, which count as {rows.independent:.3g} independent "
        f"ones; probability {number(rows.chance, '.2g')}"
    )


def _order(row: dict) -> float:
    """Sort by significance, unknown ones by size."""
    return row["probability"] if np.isfinite(row["probability"]) else 2.0 - abs(row["difference"]) / (1 + abs(row["difference"]))


def _table(found, rows: list[dict]) -> list[str]:
    several = len(found.bands) > 1
    names = [printable(row["surface"])[:WIDEST] + (f" [{row['band']}]" if several else "") for row in rows[:MOST_ROWS]]
    width = max(len("surface"), *map(len, names))
    lines = [f"{'surface':<{width}} {'side':<6} {'first':>10} {'second':>10} {'difference':>11} {'relative':>9} {'score':>6}"]
    for name, row in zip(names, rows, strict=False):
        lines.append(
            f"{name:<{width}} {row['side']:<6} {number(row['first']):>10} {number(row['second']):>10} "
            f"{number(row['difference'], '+.3g'):>11} {percent(row['relative'], '+.2%'):>9} {number(row['score'], '+.1f'):>6}"
        )
    if len(rows) > MOST_ROWS:
        lines.append(f"... and {len(rows) - MOST_ROWS} more rows (-o x.csv has all)")
    return lines


def _bars(found, histogram: list[dict]) -> list[str]:
    what = "surfaces and sides" if found.by_patch is None else "patches" if found.by_patch.equal else "overlaps"
    most = max(row["count"] for row in histogram)
    lines = [f"scores of {what}: found, and (expected from the errors alone)"]
    for row in histogram:
        bar = "#" * round(WIDTH * row["count"] / most)
        lines.append(f"{bin_name(row):>10} {row['count']:>8,} ({row['expected']:>9,.1f}) {bar}".rstrip())
    return lines


def bin_name(row: dict) -> str:
    """Return the name of a bin of the histogram."""
    low, high = row["from"], row["to"]
    if low == high:
        return "equal"
    if np.isinf(low):
        return f"below {high:+g}"
    if np.isinf(high):
        return f"above {low:+g}"
    return " to ".join("0" if end == 0 else f"{end:+g}" for end in (low, high))
