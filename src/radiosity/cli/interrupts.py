"""Interruptions: Ctrl-C at any moment ends the program with one line and status 130, SIGTERM with 143 and SIGHUP with 129.

An exception from a signal handler that goes through a half-done import leaves libraries broken: some swallow it, some
turn it into another error, and compiled ones may end the process. So an interruption waits until no import is under way.
"""

import os
import signal
import stat
import threading
import time
from contextlib import contextmanager, suppress
from types import CodeType

from .streams import silence

AGAIN = 0.02  # seconds until an interruption during an import is tried again
TOGETHER = 2.0  # seconds: shells and sessions that end send several of `ENDS`, which count as one
ENDS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))  # asked to end, terminal gone


class _Ears:
    """The handler of SIGINT and `ENDS`: raises KeyboardInterrupt, but never through an import."""

    def __init__(self, top: CodeType | None = None):
        self.top = top
        self.raised = False
        self.number = int(signal.SIGINT)
        self.heard = -TOGETHER
        self.timer: threading.Timer | None = None

    def __call__(self, number, frame) -> None:
        if not _importing(frame, self.top):
            self.raised = True
            raise KeyboardInterrupt
        self.cancel()
        self.heard = -TOGETHER  # not yet
        self.timer = threading.Timer(AGAIN, signal.raise_signal, [number])
        self.timer.daemon = True
        self.timer.start()

    def end(self, number, frame) -> None:
        """Do what Ctrl-C does at this moment, or what it would do where it is ignored."""
        if number != signal.SIGTERM:
            _speak_to_nobody()
        if time.monotonic() - self.heard < TOGETHER:
            return
        self.heard, self.number = time.monotonic(), number
        handler = signal.getsignal(signal.SIGINT)
        (handler if callable(handler) else self)(number, frame)

    def cancel(self) -> None:
        if self.timer is not None:
            self.timer.cancel()


_ears = _Ears()


def status() -> int:
    """The exit status of an interrupted program: 128 and the signal's number, as in shells."""
    return 128 + _ears.number


def asked_to_end() -> bool:
    """Return whether a signal of `ENDS` was heard, and not Ctrl-C alone."""
    return _ears.number != signal.SIGINT


def answer() -> None:
    """Note that the code that caught an interruption reported it, so that `kept` does not raise it again."""
    _ears.raised = False


@contextmanager
def heard(top: CodeType, *, last: bool):
    """Take over SIGINT and `ENDS` in the main thread, each unless another handler is set (in the background of a shell SIGINT is
    ignored, by ``nohup`` SIGHUP).

    Args:
        top: of the function that calls this, the first of the program: imports that callers of it have under way do not count.
        last: nothing but the end of the process follows: SIGINT is then ignored, so that the exit status stays.
    """
    global _ears
    _ears = _Ears(top)
    here = threading.current_thread() is threading.main_thread()
    interrupts = here and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    ends = [number for number in ENDS if here and signal.getsignal(number) is signal.SIG_DFL]
    for number in ends:
        signal.signal(number, _ears.end)
    if interrupts:
        signal.signal(signal.SIGINT, _ears)
    try:
        yield
    finally:
        if interrupts:
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        _ears.cancel()
        for number in ends:
            signal.signal(number, signal.SIG_DFL)
        if interrupts and not last:
            signal.signal(signal.SIGINT, signal.default_int_handler)


@contextmanager
def kept():
    """End the block with KeyboardInterrupt where an interruption in it was swallowed or turned into another error."""
    try:
        yield
    except Exception:
        if _ears.raised:
            raise KeyboardInterrupt from None
        raise
    if _ears.raised:
        raise KeyboardInterrupt


def _speak_to_nobody() -> None:
    """Send output nowhere: the terminal has gone, and with it programs at the end of pipes.

    A write there would fail, and nothing after it would be done.
    """
    for number in (1, 2):
        with suppress(OSError):
            if not stat.S_ISREG(os.fstat(number).st_mode):
                silence(number)


def _importing(frame, top: CodeType | None) -> bool:
    """Return whether an import is under way, in or below the function of code ``top``."""
    while frame is not None and frame.f_code is not top:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False
