"""The table of sensors in text."""

import io

import numpy as np

from ..errors import printable, shown
from ..solution.percent import margin

WIDE = 1000  # columns; names are never cut off
MESH = "± holds what lines leave unknown, not the size of patches: finer ones (--cells, --patch-size) show what that is"


def _groups(found) -> list[str]:
    """Return a line for each set of sensors: what each group of lights gives in the mean."""
    lines = []
    for number, name in enumerate(found.sensors.names if found.parts else ()):
        chosen = (found.sensors.set == number) & ~found.inside
        means = {group: float(values[:, chosen].mean()) if chosen.any() else 0.0 for group, values in found.single_parts.items()}
        shares = ", ".join(f"{printable(group)} {mean:.4g}" for group, mean in means.items())
        lines.append(f"mean {found.unit} by group of lights, {printable(name)}: {shares}")
    return lines


def _daylight(found) -> list[str]:
    """Return a line for each set of sensors: its share of what the sky gives outside, where there is no other light."""
    lines = []
    for number, name in enumerate(found.sensors.names if found.outside is not None else ()):
        factor = found.daylight_factor[(found.sensors.set == number) & ~found.inside]
        if len(factor):
            least, middle, mean = (f"{value:.2%}" for value in (factor.min(), np.median(factor), factor.mean()))
            lines.append(f"daylight factor, {printable(name)}: mean {mean}, median {middle}, min {least}")
    return lines


def _uniformity(row: dict, name: str) -> str:
    """Return a uniformity with half of its interval, or a word where there is none."""
    if np.isnan(row[name]):
        return "dark" if row["sensors"] else "-"
    return f"{row[name]:.3f}" if np.isnan(row[f"{name} ±"]) else f"{row[name]:.3f} ± {row[f'{name} ±']:.1g}"


def _dark(found) -> list[str]:
    """Return a line that names the sets of sensors that no light reaches."""
    names = [row["name"] for row in found.table() if row["sensors"] and row["max"] == 0]
    return [f"no light reaches any sensor of {shown(names)}: uniformity has no meaning there"] if names else []


def report(found) -> str:
    """Return a head, a row for each set of sensors, and what the figures mean; ± is half of the 95 % interval."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("sensors", no_wrap=True)
    for name in ("number", f"min {found.unit}", f"mean {found.unit}", f"max {found.unit}", "U0", "U1", "sensor ±"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in found.table():
        table.add_row(
            Text(printable(row["name"])),
            f"{row['sensors']:,}",
            f"{row['min']:.4g}",
            f"{row['mean']:.4g} ± {margin(row['mean ±'])}",
            f"{row['max']:.4g}",
            _uniformity(row, "U0"),
            _uniformity(row, "U1"),
            margin(row["sensor ±"]),
        )
    text = io.StringIO()
    Console(file=text, width=WIDE, highlight=False, color_system=None).print(table)
    what = "illuminance" if found.photometric else "irradiance"
    head = (
        f"{what} at {len(found.sensors):,} sensors: {found.rays:,} lines, {len(found.values)} replicates, {found.seconds:.2g} s"
    )
    head += "" if found.status == "complete" else f", {found.status}"
    lines = [line.rstrip() for line in text.getvalue().splitlines()]
    notes = [*_dark(found), *_groups(found), *_daylight(found)]
    notes += ["U0 = min / mean, U1 = min / max; sensor ±: of the least certain sensor", MESH]
    if len(found.values) < 2:
        notes.append("errors are unknown: one replicate tells none")
    return "\n".join([head, *lines, *notes])
