"""The table of a radiative exchange in text."""

import io
import math

from ..errors import printable

SIGN = "net: heat that a surface gives off to the others; positive: it must be heated, negative: it must be cooled"
SURROUNDINGS = "surroundings"  # name of the last row of tables
MESH = "± holds what lines leave unknown, not the size of patches: finer ones (--cells, --patch-size) show what that is"
WIDE = 1000  # columns; names are never cut off


def report(found) -> str:
    """Return the table with a head and the meaning of the sign; ± is half of the 95 % interval."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("surface", no_wrap=True)
    table.add_column("given", no_wrap=True)
    for name in ("area m²", "emissivity", "temperature K", "net W", "W/m²"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in found.table():
        bands = row["emissivity"] if isinstance(row["emissivity"], list) else [row["emissivity"]]
        floats = row["condition"] != "temperature"
        table.add_row(
            Text(printable(row["surface"])),
            row["condition"],
            _number(row["area"]),
            " / ".join(f"{value:.3g}" for value in bands),
            with_error(row["temperature"], row["temperature high"] - row["temperature"])
            if floats
            else f"{row['temperature']:.6g}",
            f"{row['net']:.6g}" if floats else with_error(row["net"], row["net high"] - row["net"]),
            _number(row["flux"]),
        )
    text = io.StringIO()
    Console(file=text, width=WIDE, highlight=False, color_system=None).print(table)
    lines = [line.rstrip() for line in text.getvalue().splitlines()]
    head = f"radiative exchange: {found.rays:,} lines, {found.replicates} replicates, {len(found.patches):,} patches, "
    head += f"{found.seconds:.2g} s" + ("" if found.status == "complete" else f", {found.status}")
    return "\n".join([head, *lines, SIGN, MESH, *_unknown(found)])


def _unknown(found) -> list[str]:
    return ["errors are unknown: one replicate tells none"] if found.replicates < 2 else []


def with_error(value: float, half: float) -> str:
    """Return a text such as ``1234.5 ± 1.2``: two digits of the error, and the value to the last of them."""
    if not math.isfinite(value):
        return "unknown"
    if not math.isfinite(half):
        return f"{value:.6g} ± unknown"
    if half <= 1e-9 * abs(value):
        return f"{value:.6g} ± 0"
    places = 1 - math.floor(math.log10(half))
    if places > 9 or places < -3:
        return f"{value:.10g} ± {half:.2g}"
    return f"{value:.{max(places, 0)}f} ± {half:.{max(places, 0)}f}"


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.4g}"
