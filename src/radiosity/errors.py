"""Errors and warnings. Each message says what, where, the value, and what to do."""

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar

_KEPT: ContextVar[list[str] | None] = ContextVar("kept", default=None)


class RadiosityError(Exception):
    """Every error that the library raises on purpose.

    Example:
        >>> try:
        ...     rd.load_scene("missing.obj")
        ... except rd.RadiosityError as error:
        ...     print(error)
        missing.obj: no such file; built-in scenes are ...
    """


class SceneError(RadiosityError, ValueError):
    """A scene, or the file it comes from, cannot be used as it is.

    Example:
        >>> try:
        ...     rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], reflectance=1.5, emission=0)
        ... except rd.SceneError as error:
        ...     print(error)
        arrays: reflectance of face 0 (surface 'surface', band 0) is 1.5; it must lie in [0, 1): strictly below 1
    """


class MethodError(RadiosityError, ValueError):
    """A method, one of its axes, or a budget does not exist or makes no sense.

    Example:
        >>> try:
        ...     rd.Method(numbers="dice")
        ... except rd.MethodError as error:
        ...     print(error)
        numbers 'dice' does not exist; known are faure, ...
    """


class OutputError(RadiosityError, OSError):
    """A file cannot be written.

    Example:
        >>> solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), rays=10_000)
        >>> try:
        ...     solution.export("room.doc")
        ... except rd.OutputError as error:
        ...     print(error)
        room.doc: unknown output format '.doc'; known are .npz, ...
    """


class DeviceError(RadiosityError, RuntimeError):
    """The ray tracing back end cannot run on this machine as it is set up.

    Example:
        >>> try:
        ...     rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), rays=1000, device="abacus")
        ... except rd.DeviceError as error:
        ...     print(error)
        device 'abacus' does not exist; known are auto, cpu, cuda
    """


class RadiosityWarning(UserWarning):
    """Something in the input was taken differently from what it says; the message says how.

    Example:
        >>> import warnings
        >>> with warnings.catch_warnings(record=True) as told:
        ...     warnings.simplefilter("always", rd.RadiosityWarning)
        ...     corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]]
        ...     scene = rd.Scene.from_arrays(corners, [[0, 1, 2], [0, 1, 3]], reflectance=0.5, emission=0)
        >>> print(told[0].message)
        arrays: 1 face without area left out ...
    """

    def __init__(self, *args):
        super().__init__(*args)
        if (kept := _KEPT.get()) is not None:
            kept.append(str(self))


@contextmanager
def keeping() -> Iterator[None]:
    """Keep the texts of all warnings of a block for `kept_warnings`, whether or not the user's filters show them.

    Within another such block that one keeps them.
    """
    kept = _KEPT.get()
    token = _KEPT.set([] if kept is None else kept)
    try:
        yield
    finally:
        _KEPT.reset(token)


def kept_warnings() -> tuple[str, ...]:
    """Return the different texts of the warnings that the `keeping` block around this call has had so far."""
    return tuple(dict.fromkeys(_KEPT.get() or ()))


@contextmanager
def untold() -> Iterator[None]:
    """Neither show nor keep the warnings of a block: what runs later tells them again."""
    token = _KEPT.set(None)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RadiosityWarning)
            yield
    finally:
        _KEPT.reset(token)


@contextmanager
def result_kept() -> Iterator[None]:
    """Show on stderr the warnings of a block that the user has made errors (``python -W error``), and raise nothing.

    So what was computed before is not lost.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    for one in caught:
        try:
            warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)
        except Warning as error:
            tell_instead(warnings.formatwarning(error, one.category, one.filename, one.lineno))


def tell_instead(text: str) -> None:
    """Show a warning that must not end the program."""
    with suppress(OSError, AttributeError, ValueError):  # stderr may be closed
        sys.stderr.write(text)


def installing(extra: str) -> str:
    """Return how to install an extra that brings an optional library."""
    return f"pip install 'radiosity[{extra}]' brings it (in a clone of the project: pip install '.[{extra}]')"


INSTALL = installing("all")


def shown(names, most: int = 8) -> str:
    """Return the first names of a long list, for a message, such as ``'a', 'b' and 12 more``."""
    names = [str(name) for name in names]
    text = ", ".join(f"'{name}'" for name in names[:most])
    return text if len(names) <= most else f"{text} and {len(names) - most} more"


def printable(text) -> str:
    """Return a text for one line of a terminal: control characters, which could move the cursor or hide text, become escapes."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape", "backslashreplace").decode() for c in str(text))
