"""Ctrl-C at any moment ends the program with one line and status 130; SIGTERM likewise, with status 143.

An exception out of a signal handler that goes through a half-done import leaves libraries broken: some swallow it, some
turn it into another error, and compiled ones may end the process. So an interruption waits until no import is under way.
"""

import signal
import threading
from contextlib import contextmanager

AGAIN = 0.02  # seconds until an interruption that fell into an import is tried again
INTERRUPTED, TERMINATED = 130, 143


class _Ears:
    """The handler of SIGINT and SIGTERM: raises KeyboardInterrupt, but never through an import."""

    def __init__(self):
        self.raised = self.terminated = False
        self.timer: threading.Timer | None = None

    def __call__(self, number, frame) -> None:
        if not _importing(frame):
            self.raised = True
            raise KeyboardInterrupt
        self.cancel()
        self.timer = threading.Timer(AGAIN, signal.raise_signal, [number])
        self.timer.daemon = True
        self.timer.start()

    def terminate(self, number, frame) -> None:
        """SIGTERM does what Ctrl-C does at this moment; where that is ignored, what it would do."""
        self.terminated = True
        handler = signal.getsignal(signal.SIGINT)
        (handler if callable(handler) else self)(number, frame)

    def cancel(self) -> None:
        if self.timer is not None:
            self.timer.cancel()


_ears = _Ears()


def status() -> int:
    """The exit status of an interrupted program."""
    return TERMINATED if _ears.terminated else INTERRUPTED


def answer() -> None:
    """An interruption was told by who caught it, and `kept` says no more."""
    _ears.raised = False


@contextmanager
def heard(*, last: bool):
    """Take over SIGINT and SIGTERM in the main thread, each unless another handler is set (in the background SIGINT is ignored).

    Args:
        last: nothing but the end of the process follows: SIGINT is then ignored, so that the exit status stays.
    """
    global _ears
    _ears = _Ears()
    here = threading.current_thread() is threading.main_thread()
    interrupts = here and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    ends = here and signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    if ends:
        signal.signal(signal.SIGTERM, _ears.terminate)
    if interrupts:
        signal.signal(signal.SIGINT, _ears)
    try:
        yield
    finally:
        if interrupts:
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        _ears.cancel()
        if ends:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
        if interrupts and not last:
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
