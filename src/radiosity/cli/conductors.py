"""``radiosity conductors``"""

from pathlib import Path
from typing import Any

from ..errors import OutputError, printable
from . import outputs
from .exchange import Names, named_numbers
from .factors import merged_groups, tell_matrix
from .options import Outputs
from .streams import tell

KIND = ".csv"


def conductors(lines: Path, /, *, emissivity: Names, output: Outputs = (), merge: Names = ()) -> int:
    """Find radiative conductors between surfaces from counted lines: after all reflections. No line is traced.

    G in row i and column j is the share of what i emits that j absorbs (Gebhart's factor), with its standard error. The conductor
    in a .csv is the emissivity and area of i times G, in m²: times sigma (T_i⁴ - T_j⁴) it is the heat from i to j in W.

    Parameters
    ----------
    lines
        An .npz file of `radiosity lines`.
    emissivity
        Emissivities of surfaces, such as "*=0.9" shield=0.05, or of one side, such as shield:front=0.05. Every surface needs
        one; NAME may be a pattern.
    output
        Files to write: .csv, a row for each pair of surfaces.
    merge
        Groups of surfaces that count as one, such as "walls=north,south" "lamps=lamp*".
    """
    from ..solution.whole import check_place

    for path in output:
        if path.suffix.lower() != KIND:
            raise OutputError(f"{path}: conductors are written to {KIND} files; give it that suffix")
        check_place(path)
    import radiosity as rd

    values = named_numbers(emissivity, "emissivity", sides=True)
    group: Any = merged_groups(merge) if merge else "surface"
    found = rd.gebhart_factors(rd.load_lines(lines), emissivity=values, group=group)
    tasks: list = [("the report", lambda: _print(found))]
    failures = outputs.attempt([*tasks, *((path, lambda path=path: _write(found, path)) for path in output)])
    if failures:
        raise OutputError("; ".join(outputs.told(failures)))
    return 0


def _write(found, path: Path) -> None:
    found.to_csv(path)
    tell(f"wrote {printable(path)}")


def _print(found) -> None:
    tell(repr(found))
    tell_matrix(found.names, found.values, found.errors)
