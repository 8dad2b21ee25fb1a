"""CSV files of view factors, in two layouts.

"matrix": a row for each group: surface, area m², F to each group in the same order, escaped, lost, then the standard errors of
all of them (``± NAME``).

"long": a row for each pair that a line joined: from, to, area m² (of ``from``), view factor, standard error, lines. What escapes
and what is lost are rows whose ``to`` is ``(escaped)`` and ``(lost)``.

Unknown errors are ``nan``. ``lines`` is -1 where the value does not come from counts.
"""

from ..errors import OutputError
from ..solution.csv_rows import write_rows

LAYOUTS = ("matrix", "long")
WIDEST = 1000  # groups of a matrix: spreadsheets hold 16 384 columns, and readers fewer
ESCAPED, LOST = "escaped", "lost"


def write(factors, path, layout: str = "matrix") -> None:
    """Write the file.

    Args:
        factors: the `ViewFactors` to write.
        path: the file.
        layout: "matrix" or "long".

    Raises:
        OutputError: there is no such layout, too many groups for a matrix, or the file cannot be written.
    """
    if layout not in LAYOUTS:
        raise OutputError(f"{path}: layout '{layout}' does not exist; known are {', '.join(LAYOUTS)}")
    if layout == "long":
        rows = _long(factors)
    elif len(factors) > WIDEST:
        raise OutputError(
            f"{path}: {len(factors)} groups would be {2 * len(factors) + 6} columns; take the layout 'long', NPZ, or fewer groups"
        )
    else:
        rows = _matrix(factors)
    write_rows(rows, path, rows[0].keys() if layout == "long" else _titles(factors))


def _titles(factors) -> list[str]:
    columns = [*factors.names, ESCAPED, LOST]
    return ["surface", "area m²", *columns, *(f"± {name}" for name in columns)]


def _matrix(factors) -> list[dict]:
    shares = [factors.matrix, factors.escaped[:, None], factors.lost[:, None]]
    errors = [factors.standard_error, factors.escaped_standard_error[:, None], factors.lost_standard_error[:, None]]
    return [
        dict(enumerate([name, area, *(x for part in (*shares, *errors) for x in part[i].tolist())]))
        for i, (name, area) in enumerate(zip(factors.names, factors.area.tolist(), strict=True))
    ]


def _long(factors) -> list[dict]:
    names = [*factors.names, f"({ESCAPED})", f"({LOST})"]
    columns = (factors.rows, factors.columns, factors.values, factors.errors, factors.hits)
    return [
        {
            "from": names[row],
            "to": names[column],
            "area m²": float(factors.area[row]),
            "view factor": value,
            "standard error": error,
            "lines": hits,
        }
        for row, column, value, error, hits in zip(*(x.tolist() for x in columns), strict=True)
    ]
