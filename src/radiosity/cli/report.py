"""``radiosity report``"""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import Group, Parameter

from ..errors import printable
from .options import Count, Outputs, Seed
from .streams import tell

Text = Annotated[str, Parameter(show_default=False)]
Names = Annotated[tuple[str, ...], Parameter(consume_multiple=(1, None), negative=(), show_default=False)]
Numbers = Annotated[tuple[int, ...], Parameter(consume_multiple=(1, None), negative=(), show_default=False)]
Paths = Annotated[tuple[Path, ...], Parameter(consume_multiple=(1, None), negative=(), show_default=False)]


@dataclass(frozen=True)
class FirstPage:
    """What stands on the first page.

    Attributes:
        title: Of the report. Default: the name of the scene.
        project: Name of the project.
        client: For whom it is.
        author: Who made it.
        date: A date, as it shall be written. No date is written unless it is given.
        remarks: A text below these.
    """

    title: str | None = None
    project: Text = ""
    client: Text = ""
    author: Text = ""
    date: Text = ""
    remarks: Text = ""


@dataclass(frozen=True)
class Contents:
    """What the report holds.

    Attributes:
        camera: Numbers of the scene's cameras, from 0, for the views. Default: the first four, or one fitted to the scene.
        width: Of the views, in pixels. Default: 900.
        final_gather: Lines for each pixel of the views, such as 64, that make shadows sharp. Default: no such lines.
        seed: Of the final gather and the sensors.
        plan: Names of level surfaces to draw from above, or patterns such as desk*. Default: the three that receive most light.
        measure: Tables of sensors that `radiosity measure` wrote (.csv). Default: the sensors that the scene asks for.
        sensors: Measure the sensors that the scene asks for.
        check: Look for gaps and mistakes in the scene.
        rows: Rows of the tables of surfaces and light sources, at most. Default: 60.
    """

    camera: Numbers = ()
    width: Count = None
    final_gather: Count = None
    seed: Seed = 0
    plan: Names = ()
    measure: Paths = ()
    sensors: bool = True
    check: bool = True
    rows: Count = None


FIRST = Annotated[FirstPage, Parameter(name="*", group=Group("First page", sort_key=1))]
HELD = Annotated[Contents, Parameter(name="*", group=Group("Contents", sort_key=2))]
NOBODY, USUAL = FirstPage(), Contents()


def report(solution: Path, /, *, output: Outputs = (), first_page: FIRST = NOBODY, contents: HELD = USUAL) -> None:
    """Write a report for a client: one HTML page that needs no other file, or its PDF.

    It has views, plans in false colours with isolines, measuring points, tables of surfaces and light sources, the energy
    balance, how sure the figures are, warnings, and how they were calculated.

    Parameters
    ----------
    solution
        An .npz file that `radiosity solve` wrote.
    output
        Files to write: .html, and .pdf, which Chromium or Chrome prints.
    """
    from ..report_page import page

    page.check(output)

    import radiosity as rd

    from .progress import bar

    asked = asdict(contents)
    wishes = {"cameras": asked.pop("camera"), "plans": asked.pop("plan"), "measured": asked.pop("measure")} | {
        name: value for name, value in asked.items() if value is not None
    }
    loaded = rd.load_solution(solution)
    with bar() as progress:
        rd.write_report(loaded, *output, progress=progress, **asdict(first_page), **wishes)
    for path in output:
        tell(f"wrote {printable(path)}")
