"""`view`: a solution or a scene in the browser, or as an HTML file."""

import threading
from collections.abc import Iterable
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from types import TracebackType

from ..diagnostics.report import Finding
from ..patches import Patches
from ..scene import Scene
from ..solution import Solution
from ..solution.replacing import replacing
from . import about, eye, html, marks
from .content import MOST_EDGED, Content
from .look import Look
from .page import Page
from .panel import Panel
from .server import HERE, PORT, address, serving
from .shades import Colours, Shades
from .subject import Subject

WAIT = 600.0  # seconds for a page to be made


class Viewer:
    """A page that shows a solution, or a scene; `radiosity.view` opens one. It ends with `close`, or
    with the block that it is used in.

    Example:
        >>> solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), rays=10_000)
        >>> with rd.view(solution, port=0) as viewer:  # doctest: +SKIP
        ...     viewer.save_html("room.html")
    """

    def __init__(self, subject: Subject, look: Look, host: str, port: int, findings: Iterable[Finding] = ()):
        content = Content.of(subject)
        content.colours(look)  # what makes no sense is refused before the server starts
        views = eye.cameras(subject)
        self._stack = ExitStack()
        with ExitStack() as stack:
            server = stack.enter_context(serving(host, port))
            lines = marks.add(server, subject.patches.scene, content.frame)
            eye.stand(server, next(iter(views.values())), subject, content.frame)
            self.server, self.page = server, Page(server, content, look)
            self._marks, self._views = lines, views
            self.panel = Panel(self.page, about.text(subject, findings, lines), views)
            self.panel.build()
            self.page.drawn, self.added = self._drawn, lambda: None
            server.scene.on_click()(lambda event: self.panel.clicked(event))
            self.page.start()
            stack.callback(self.page.end)
            self.page.show()
            self._stack = stack.pop_all()

    @property
    def url(self) -> str:
        """The address of the page."""
        return address(self.server)

    def show(self, solution: Solution) -> None:
        """Show another solution, such as a better one of the same scene."""
        subject, before = Subject.of(solution), self.page.content.subject
        if subject.names == before.names:
            self.page.show(subject=subject)
            self.panel.parts["about"].content = about.text(subject, (), self._marks)
            return
        with self.page.paused(), self.server.atomic():  # there are other quantities to choose from
            self.page.show(replace(self.page.look, quantity=None, band=None, wireframe=False), subject)
            self.server.gui.reset()
            self.panel = Panel(self.page, about.text(subject, (), self._marks), self._views)
            self.panel.build()
            self.page.drawn = self._drawn

    def _drawn(self, colours: Colours) -> None:
        """Bring the panel up to date after the page, and what `Live` adds to it."""
        self.panel.drawn(colours)
        self.added()

    def save_html(self, path) -> Path:
        """Write the page as it is now to one HTML file, which needs no server and no network.

        Raises:
            OutputError: it cannot be written.
        """
        self.page.settled(WAIT)
        text = html.document(self.server, self.page.content.colours(self.page.look))
        with replacing(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
        return Path(path)

    def wait(self) -> None:
        """Wait until Ctrl-C."""
        while True:
            self.pause(3600.0)

    def pause(self, seconds: float) -> None:
        """Let the page work for some time."""
        threading.Event().wait(seconds)

    def close(self) -> None:
        """End the page."""
        self._stack.close()

    def __enter__(self) -> "Viewer":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


def view(
    what: Solution | Scene | Patches,
    *,
    host: str = HERE[0],
    port: int = PORT,
    quantity: str | None = None,
    band: str | None = None,
    smooth: bool = True,
    false_color: bool = False,
    range: tuple[float, float] | None = None,
    log: bool = False,
    color_map: str = "viridis",
    exposure: float = 0.0,
    findings: Iterable[Finding] = (),
) -> Viewer:
    """Show a solution, or a scene that is not solved yet, in a browser.

    The page is served until the viewer is closed. Nobody but this machine can open it, unless ``host`` says so.

    Args:
        what: a solution; or a scene or patches, of which reflectance and emission are shown.
        host: the address to listen at; "0.0.0.0" lets everybody in the same network open the page, who needs no password.
        port: the first port to try; 0: any that is free.
        quantity: what is shown first: radiosity, irradiance, luminance (photometric scenes), radiance, standard_error,
            irradiance_standard_error, relative_error, arrivals, reflectance, emission.
        band: one band by name; default: all.
        smooth: interpolate within surfaces, or show each patch as it is.
        false_color, range, log, color_map, exposure: as in `radiosity.image.render`.
        findings: those of `check`, which the page tells of a scene.

    Raises:
        OutputError: viser is not installed, the address is none of this machine's, or there is no such quantity or band.
        MethodError: ``what`` is something else.

    Example:
        >>> viewer = rd.view(rd.load_scene("room"), port=0)  # doctest: +SKIP
        >>> viewer.url  # doctest: +SKIP
        'http://localhost:41873'
    """
    shades = Shades(false_color, log, None if range is None else (float(range[0]), float(range[1])), color_map, exposure or 0.0)
    subject = Subject.of(what)
    edges = subject.solution is None and len(subject.patches) <= MOST_EDGED  # there is no light yet that would show shapes
    return Viewer(subject, Look(quantity, band, smooth, shades, wireframe=edges), host, port, findings)
