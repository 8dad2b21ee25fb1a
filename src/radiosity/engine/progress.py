"""What a run tells about itself while it goes on, and how it is asked to stop."""

import signal
import threading
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """A moment of a run.

    Attributes:
        stage: how many stages are complete.
        rays: lines traced so far, replicates together.
        rays_per_second: since the start of the first sweep.
        error: relative error after the last complete stage, NaN where unknown.
        fraction: of the budget, 0 to 1, or None where it cannot be told yet.
        seconds_left: an estimate, or None.
        message: what is being done.
    """

    stage: int
    rays: int
    rays_per_second: float
    error: float
    fraction: float | None
    seconds_left: float | None
    message: str


Listener = Callable[[Progress], None]


class Interrupted(Exception):
    """The run was asked to stop between two sweeps."""


class Stop:
    """Set by Ctrl-C; looked at between sweeps, where the counters are whole. A second Ctrl-C stops at once."""

    def __init__(self):
        self.asked = False

    @contextmanager
    def listening(self):
        """Take over SIGINT in the main thread for a while."""
        if threading.current_thread() is not threading.main_thread():
            yield self
            return
        before = signal.getsignal(signal.SIGINT)

        def handle(number, frame):
            if self.asked:
                raise KeyboardInterrupt
            self.asked = True

        signal.signal(signal.SIGINT, handle)
        try:
            yield self
        finally:
            signal.signal(signal.SIGINT, before)
