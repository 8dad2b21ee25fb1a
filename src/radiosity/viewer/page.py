"""The page: the meshes that it has been sent, and the thread that sends others when something changes."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from hashlib import blake2b
from typing import Any

from ..errors import RadiosityError
from . import content as contents
from .library import Server
from .look import Look
from .shades import Colours
from .subject import Subject

EDGES = "/edges"
UNSHADOWED: dict[str, Any] = {"cast_shadow": False, "receive_shadow": False}


@dataclass(eq=False)
class Page:
    """A subject on a server's page.

    Attributes:
        server: of the page.
        content: what is shown; changed by `show`.
        look: how; changed by `show`.
        drawn: called with the colours after each change was sent.
        failed: called with a text where a look makes no sense; the page then stays as it was.
    """

    server: Server
    content: contents.Content
    look: Look
    drawn: Callable[[Colours], None] = lambda colours: None
    failed: Callable[[str], None] = lambda text: None
    _nodes: dict[str, Any] = field(default_factory=dict)
    _sent: dict[str, bytes] = field(default_factory=dict)
    _lock: threading.RLock = field(default_factory=threading.RLock)
    _wake: threading.Condition = field(default_factory=threading.Condition)
    _asked: int = 0
    _done: int = 0
    _ended: bool = False

    def show(self, look: Look | None = None, subject: Subject | None = None) -> None:
        """Ask for a change; it is sent soon, with all that was asked for until then."""
        with self._wake:
            self.look = self.look if look is None else look
            if subject is not None:
                self.content = self.content.at(subject)
            self._asked += 1
            self._wake.notify_all()

    def change(self, **changes) -> None:
        """Ask for a change of some fields of the look."""
        with self._wake:
            self.show(replace(self.look, **changes))

    def start(self) -> None:
        """Begin to send changes, in a thread of their own."""
        threading.Thread(target=self._work, name="radiosity viewer", daemon=True).start()

    def end(self) -> None:
        """Send no more changes."""
        with self._wake:
            self._ended = True
            self._wake.notify_all()

    def settled(self, seconds: float) -> bool:
        """Wait until all that was asked for has been sent; return whether it was within the time."""
        with self._wake:
            return self._wake.wait_for(lambda: self._done == self._asked, seconds)

    def _work(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._ended or self._done != self._asked)
                if self._ended:
                    return
                asked, look, content = self._asked, self.look, self.content
            try:
                self.draw(look, content)
            except RadiosityError as error:
                self._tell(str(error))
            except Exception as error:  # the page of a run must never end the run
                self._tell(f"a fault of the program, not of your input: {type(error).__name__}: {error}")
            with self._wake:
                self._done = asked
                self._wake.notify_all()

    def _tell(self, text: str) -> None:
        with suppress(Exception):  # the page may have gone, which is no fault
            self.failed(text)

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Draw nothing during a block, which changes the panel."""
        with self._lock:
            yield

    def draw(self, look: Look, content: contents.Content) -> Colours:
        """Send what a look shows of a content, as far as it differs from what was sent before."""
        with self._lock:
            colours = content.colours(look)
            meshes = dict(content.meshes(look, colours))
            edges = content.edges(look) if look.wireframe else None
            if edges is not None:
                meshes[EDGES] = edges
            for name, data in meshes.items():
                self._send(name, data)
            for name, node in self._nodes.items():
                if node.visible != (name in meshes):
                    node.visible = name in meshes
            marks = self.server.scene.get_handle_by_name("/marks")
            if marks is not None and marks.visible != look.marks:
                marks.visible = look.marks
            self.drawn(colours)
            return colours

    def _send(self, name: str, data: bytes) -> None:
        digest = blake2b(data, digest_size=16).digest()
        if self._sent.get(name) == digest:
            return
        if name in self._nodes:
            self._nodes[name].glb_data = data
        else:
            self._nodes[name] = self.server.scene.add_glb(name, data, **UNSHADOWED)
        self._sent[name] = digest
