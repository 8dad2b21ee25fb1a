"""The server of the page: on this machine alone unless asked otherwise, and nothing of it leaves by itself."""

import io
import os
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from urllib.parse import urlsplit

from ..errors import OutputError, installing
from .library import Server

PORT = 8080
HERE = ("localhost", "127.0.0.1", "::1")


def require() -> None:
    """Refuse where the libraries of the viewer are missing.

    Raises:
        OutputError: one is not installed.
    """
    from importlib.util import find_spec

    for module in ("viser", "matplotlib"):
        if find_spec(module) is None:
            raise OutputError(f"the viewer needs '{module}', which is not installed; {installing('view')}")


@contextmanager
def serving(host: str = HERE[0], port: int = PORT) -> Iterator[Server]:
    """Serve a page during a block.

    Args:
        host: the address to listen at; ``0.0.0.0``: all networks that the machine is in.
        port: the first port to try; 0: any that is free.

    Raises:
        OutputError: a library is missing, or the address is none of this machine's.
    """
    require()
    import viser

    check_address(host, port)
    with redirect_stdout(io.StringIO()):  # what it prints is not for our output
        server = viser.ViserServer(host=host, port=port, verbose=False)
    try:
        _refuse_others(server, host)
        yield server
    finally:
        with redirect_stdout(io.StringIO()):
            server.stop()


def address(server: Server) -> str:
    """Return the URL of the page, as a browser on this machine opens it."""
    host = server.get_host()
    name = "localhost" if host in ("", "0.0.0.0", "::") else host
    return f"http://{f'[{name}]' if ':' in name else name}:{server.get_port()}"


def check_address(host: str, port: int) -> None:
    """Find out whether there is such an address: the library would try a thousand ports and wait for ever.

    Raises:
        OutputError: there is none.
    """
    import socket

    if not 0 <= port <= 65535:
        raise OutputError(f"port is {port}; it must be a whole number from 0 to 65535")
    try:
        kind, *_, place = socket.getaddrinfo(host or None, 0, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        with socket.socket(kind, socket.SOCK_STREAM) as trial:
            trial.bind(place)
    except OSError as error:
        raise OutputError(f"host '{host}': no address of this machine ({error.strerror or error}); take localhost") from None
    if port and port < 1024 and hasattr(os, "geteuid") and os.geteuid() != 0:
        raise OutputError(f"port {port} is for the system's administrator; take one from 1024 on, such as {PORT}")


def _refuse_others(server: Server, host: str) -> None:
    """Close connections that pages of other sites open, and never send the scene to a public service.

    A browser lets any page open a connection to this machine; it says which page that is. The library takes all of them, and
    has a button that shares the page through a server on the internet.
    """
    server.gui.set_panel_label("radiosity")
    server.gui.configure_theme(show_logo=False, show_share_button=False, dark_mode=True)
    server.request_share_url = lambda verbose=True: None

    async def look(connection) -> None:
        live = server._websock_server._live_connections.get(connection.client_id)
        request = None if live is None else live.request
        if (
            live is not None
            and request is not None
            and not allowed(request.headers.get("Origin"), request.headers.get("Host"), host)
        ):
            await live.close(1008, "opened by a page of another site")

    server._websock_server.on_client_connect(look)


def allowed(origin: str | None, asked: str | None, host: str) -> bool:
    """Return whether a connection may go on.

    Args:
        origin: the page that opens it, as its browser says; None: no browser.
        asked: the name and port that were asked for.
        host: where the server listens; where that is this machine alone, only its own names may be asked for.
    """
    if origin is None:
        return True
    if host in HERE and urlsplit(f"//{asked}").hostname not in HERE:
        return False
    return urlsplit(origin).netloc == asked
