"""``radiosity view``"""

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import Group, Parameter

from ..errors import MethodError, OutputError, RadiosityWarning, SceneError, printable
from . import interrupts
from .false_colors import range_of
from .options import Flag, Pair, Stops
from .solve_options import SceneOptions, Size, Unset
from .streams import tell

HOST, PORT = "localhost", 8080


@dataclass(frozen=True)
class Shown:
    """The first sight of the page.

    Attributes:
        quantity: radiosity, irradiance, luminance in cd/m², radiance, standard_error, irradiance_standard_error, relative_error,
            arrivals (lines that hit each patch), reflectance or emission; of a scene that is not solved the last two.
        band: One band, by name. Default: all.
        smooth: Interpolate within surfaces, or show each patch as it is.
        exposure: Stops brighter than the automatic scale; +1 is twice.
        false_color: Colours for values, with a legend in physical units.
        limits: Of false colours: lowest and highest value of the legend, such as 0,500.
        log: Of false colours: a logarithmic legend.
        color_map: Of false colours: one of matplotlib's. Default: viridis.
    """

    quantity: str | None = None
    band: str | None = None
    smooth: bool = True
    exposure: Stops = None
    false_color: Flag = False
    limits: Annotated[Pair, Parameter(name="--range")] = None
    log: Flag = False
    color_map: str | None = None


@dataclass(frozen=True)
class Served:
    """The place of the page.

    Attributes:
        host: The address to listen at. Default: only this machine can open the page. 0.0.0.0 lets everybody in the same network
            open it, who needs no password.
        port: The first port to try; 0: any that is free. Default: 8080.
        html: Write the page to this .html file instead, which needs no server and no network.
    """

    host: str | None = None
    port: int | None = None
    html: Path | None = None

    @property
    def place(self) -> tuple[str, int]:
        """Host and port to listen at.

        Raises:
            OutputError: a file has neither.
        """
        if self.html is None:
            return self.host or HOST, PORT if self.port is None else self.port
        given = [f"--{name}" for name in ("host", "port") if getattr(self, name) is not None]
        if given:
            raise OutputError(f"{' and '.join(given)}: of a page that is served; leave out, or --html {self.html}")
        return HOST, 0


class Usual:
    """Each group of options where none of them is given."""

    shown, served, size = Shown(), Served(), Size()


def view(
    scene: str,
    /,
    *,
    served: Annotated[Served, Parameter(name="*", group=Group("The page", sort_key=1))] = Usual.served,
    shown: Annotated[Shown, Parameter(name="*", group=Group("What it shows first", sort_key=2))] = Usual.shown,
    size: Annotated[Size, Parameter(name="*", group=Group("Patches of a scene that is not solved", sort_key=3))] = Usual.size,
    reading: SceneOptions = Unset.reading,
) -> int:
    """Show a solution, or a scene, in a browser.

    It prints the address of the page, and serves it until Ctrl-C. It needs no screen: over ssh, forward the port.

    Parameters
    ----------
    scene
        An .npz file that `radiosity solve` wrote; or a scene file or built-in scene that is not solved yet, of which reflectance,
        emission and the findings of `radiosity check` are shown.
    """
    import radiosity as rd

    from ..viewer.server import check_address, require

    interval, (host, port) = range_of(shown), served.place
    require()
    check_address(host, port)
    if served.html is not None:
        _check_html(served.html)
    subject, findings = _subject(scene, size, reading)
    viewer = rd.view(
        subject,
        host=host,
        port=port,
        quantity=shown.quantity,
        band=shown.band,
        smooth=shown.smooth,
        false_color=shown.false_color,
        range=interval,
        log=shown.log,
        color_map=shown.color_map or "viridis",
        exposure=shown.exposure or 0.0,
        findings=findings,
    )
    with viewer:
        if served.html is not None:
            viewer.save_html(served.html)
            tell(f"wrote {printable(served.html)}")
            return 0
        tell(address_told(viewer.url, port))
        try:
            viewer.wait()
        except KeyboardInterrupt:  # the usual end
            interrupts.answer()
    return interrupts.status() if interrupts.asked_to_end() else 0


def address_told(url: str, asked: int, ends: str = "ends it") -> str:
    """Return the lines that say where the page is, and what Ctrl-C does."""
    port = int(url.rpartition(":")[2])
    taken = f" (port {asked} is taken)" if asked not in (0, port) else ""
    return f"{url}{taken}\nCtrl-C {ends}; over ssh, forward the port: ssh -L {port}:localhost:{port} MACHINE"


def _subject(scene: str, size: Size, reading):
    """Return what is to be shown, and the findings about it."""
    from dataclasses import asdict

    import radiosity as rd

    from ..diagnostics.check import check_file

    given = size.patch_size is not None or size.cells is not None
    if size.patch_size is not None and size.cells is not None:
        raise MethodError("give one of --patch-size and --cells, not both")
    if Path(scene).suffix.lower() == ".npz":
        if given:
            raise MethodError(f"{scene} holds a solution, whose patches are there already: leave --patch-size and --cells out")
        return rd.load_solution(scene), ()
    report = check_file(scene, **asdict(reading))
    if report.scene is None:
        raise SceneError(report.findings[0].message)
    for one in report.findings:
        if one.kind == "file":
            warnings.warn(one.message, RadiosityWarning, stacklevel=2)
    return rd.subdivide(report.scene, size=size.patch_size, cells=size.cells), report.findings


def _check_html(path: Path) -> None:
    from ..image.output import check_writable

    check_writable(path, (".html", ".htm"))
