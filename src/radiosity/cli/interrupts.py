"""Ctrl-C at any moment ends the program with one line and status 130.

An exception out of a signal handler that goes through a half-done import leaves libraries broken: some swallow it, some
turn it into another error, and compiled ones may end the process. So an interruption waits until no import is under way.
"""

import signal
import threading
from contextlib import contextmanager

AGAIN = 0.02  # seconds until an interruption that fell into an import is tried again


class _Ears:
    """The handler of SIGINT: raises KeyboardInterrupt, but never through an import."""

    def __init__(self):
        self.raised = False
        self.timer: threading.Timer | None = None

    def __call__(self, number, frame) -> None:
        if not _importing(frame):
            self.raised = True
            raise KeyboardInterrupt
        self.cancel()
        self.timer = threading.Timer(AGAIN, signal.raise_signal, [signal.SIGINT])
        self.timer.daemon = True
        self.timer.start()

    def cancel(self) -> None:
        if self.timer is not None:
            self.timer.cancel()


_ears = _Ears()


@contextmanager
def heard(*, last: bool):
    """Take over SIGINT, unless this is no main thread or another handler is set (in the background it is ignored).

    Args:
        last: nothing but the end of the process follows: SIGINT is then ignored, so that the exit status stays.
    """
    global _ears
    _ears = _Ears()
    here = threading.current_thread() is threading.main_thread()
    if not here or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, _ears)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        _ears.cancel()
        if not last:
            signal.signal(signal.SIGINT, signal.default_int_handler)


@contextmanager
def kept():
    """An interruption that was swallowed in the block, or turned into another error, ends it as KeyboardInterrupt after all."""
    try:
        yield
    except Exception:
        if _ears.raised:
            raise KeyboardInterrupt from None
        raise
    if _ears.raised:
        raise KeyboardInterrupt


def _importing(frame) -> bool:
    """Is an import under way, in or below ``main``?"""
    from . import main

    while frame is not None and frame.f_code is not main.__code__:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False
