"""Solutions for notebooks: HTML, and tables of pandas and xarray."""

import html as markup
from importlib.util import find_spec

import numpy as np

from ..errors import INSTALL, OutputError
from .brief import brief
from .percent import number, percent

MOST_ROWS = 24
SIDES = np.array(["front", "back"])


def html(solution) -> str:
    """Return the five lines of `repr`, and a table of the surfaces that send out most power."""
    head = f"<pre>{markup.escape(brief(solution))}</pre>"
    if solution.quanta == 0:
        return head
    tails = [f" [{band}]" for band in solution.bands] if len(solution.bands) > 1 else [""]
    rows = sorted(solution.surface_table(), key=lambda row: -sum(row[f"left{tail}"] for tail in tails))
    units = {"radiosity": solution.unit, "irradiance": solution.irradiance_unit}
    shown = [(what, tail) for what in ("radiosity", "irradiance") for tail in tails]
    heads = ["surface", "side", "area m²", *(f"{what}{tail} {units[what]}" for what, tail in shown), "±"]
    lines = ["".join(f"<th>{markup.escape(head)}</th>" for head in heads)]
    for row in rows[:MOST_ROWS]:
        values = [number(row[f"{what}{tail}"]) for what, tail in shown]
        cells = [row["surface"], row["side"], f"{row['area']:.4g}", *values, percent(row["interval"])]
        lines.append("".join(f"<td>{markup.escape(str(cell))}</td>" for cell in cells))
    more = f"<p>and {len(rows) - MOST_ROWS} more rows</p>" if len(rows) > MOST_ROWS else ""
    return f"{head}<table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>{more}"


def to_dataframe(solution):
    """Return the data frame of `Solution.to_dataframe`."""
    _require("pandas")
    import pandas

    from .columns import patch_columns

    return pandas.DataFrame(patch_columns(solution)).set_index("patch")


def to_xarray(solution):
    """Return the dataset of `Solution.to_xarray`."""
    _require("xarray")
    import xarray

    patches, both = solution.patches, ("patch", "band")
    low, high = solution.interval(0.95, "irradiance")
    low_radiosity, high_radiosity = solution.interval(0.95, "radiosity")
    measured = {
        "radiosity": solution.radiosity,
        "radiosity_standard_error": solution.standard_error,
        "radiosity_low": low_radiosity,
        "radiosity_high": high_radiosity,
        "irradiance": solution.irradiance,
        "irradiance_standard_error": solution.irradiance_standard_error,
        "irradiance_low": low,
        "irradiance_high": high,
        "emission": patches.emission,
    }
    variables = {name: (both, values, {"units": _unit(solution, name)}) for name, values in measured.items()}
    variables |= {
        "reflectance": (both, patches.reflectance, {"units": "1"}),
        "area": ("patch", patches.area, {"units": "m2"}),
        "centroid": (("patch", "axis"), patches.centroid, {"units": "m"}),
        "normal": (("patch", "axis"), patches.normal, {"units": "1"}),
        "arrivals": ("patch", np.asarray(solution.arrivals), {"units": "1"}),
    }
    names = np.array(patches.scene.names, object)[patches.surface].astype(str)
    coordinates = {
        "patch": np.arange(len(patches)),
        "band": list(solution.bands),
        "axis": list("xyz"),
        "surface": ("patch", names),
        "side": ("patch", SIDES[patches.is_back.astype(int)]),
    }
    facts = {
        "source": patches.scene.source,
        "method": str(solution.provenance["method"]),
        "rays": solution.rays,
        "replicates": solution.replicates,
        "status": solution.status,
    }
    return xarray.Dataset(variables, coords=coordinates, attrs=facts)


def _unit(solution, name: str) -> str:
    return solution.irradiance_unit if name.startswith("irradiance") else solution.unit


def _require(module: str) -> None:
    if find_spec(module) is None:
        raise OutputError(f"this needs '{module}', which is not installed; {INSTALL}")
