"""``radiosity solve --live``: the run in a browser while it goes on. Whatever becomes of the page, the run goes on."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Annotated, Any

from cyclopts import Group, Parameter

from ..errors import MethodError
from . import interrupts
from .options import Flag
from .streams import say, tell
from .view import Served, address_told

PAGE = 1.0  # seconds between two looks whether the page is still open


@dataclass(frozen=True)
class Live:
    """The run in a browser.

    Attributes:
        live: Show in a browser how the solution improves, with a plot of its error. The results stay the same to the last bit.
        host: The address to listen at. Default: only this machine can open the page. 0.0.0.0 lets everybody in the same network
            open it, who needs no password.
        port: The first port to try; 0: any that is free. Default: 8080.
    """

    live: Flag = False
    host: str | None = None
    port: int | None = None

    def check(self, *, refines: bool) -> None:
        """Refuse what does not go together.

        Raises:
            MethodError: an address without a page, or a page of two runs.
        """
        given = [f"--{name}" for name in ("host", "port") if getattr(self, name) is not None]
        if given and not self.live:
            raise MethodError(f"{' and '.join(given)}: of the page that --live shows; add --live")
        if self.live and refines:
            raise MethodError("--live shows one run, and --refine-check makes two; leave one of them out")


LiveOptions = Annotated[Live, Parameter(name="*", group=Group("In a browser", sort_key=7))]
UNSEEN = Live()


@contextmanager
def page(options: Live, scene) -> Iterator[Any]:
    """Serve the page of a run during a block; yield what shows it, or None where none was asked for.

    Args:
        options: where.
        scene: a scene, or its patches, that are shown until the first stage is complete.
    """
    if not options.live:
        yield None
        return
    import radiosity as rd

    from ..viewer.live import Live as Page

    shown = rd.subdivide(scene, cells=1) if isinstance(scene, rd.Scene) else scene
    host, port = Served(options.host, options.port).place
    with rd.view(shown, host=host, port=port) as viewer:
        tell(address_told(viewer.url, port, "ends the run early"))
        yield Page(viewer)


def listeners(shown, bar: Callable | None) -> dict[str, Any]:
    """Return what `solve` is to tell, and how: the bar of the terminal, and the page, whose faults end nothing."""
    if shown is None:
        return {"progress": bar}
    watch, progress = _harmless(shown.watch), _harmless(shown.progress)

    def both(state) -> None:
        if bar is not None:
            bar(state)
        progress(state)

    return {"progress": both, "watch": watch}


def finish(shown, solution) -> None:
    """Show the result; where a person is at the terminal and the page is open, wait until it is closed, or for Ctrl-C."""
    if shown is None:
        return
    _harmless(shown.finish)(solution)
    shown.viewer.page.settled(60.0)
    if not sys.stderr.isatty() or not shown.viewer.server.get_clients():
        return
    say("done", "the page stays until it is closed, or until Ctrl-C")
    try:
        while shown.viewer.server.get_clients():
            shown.viewer.pause(PAGE)
    except KeyboardInterrupt:
        interrupts.answer()


def _harmless(action: Callable) -> Callable:
    """Return an action whose errors are told once, and then ignored."""
    told = []

    def act(value) -> None:
        try:
            action(value)
        except Exception as error:  # a fault of the page must not end the run
            if not told:
                told.append(error)
                say("warning", f"the page of --live does not follow: {type(error).__name__}: {error}; the run goes on")

    return act
