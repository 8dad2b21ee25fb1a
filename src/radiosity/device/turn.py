"""A lock: one thread of the process at a time works with Dr.Jit, and the others wait.

Dr.Jit's threads add to copies of counters, one copy a thread. A Python thread that waits for a kernel works too, on any kernel
there is, and all Python threads count as the same thread. Where two of them wait at once, both add to one copy, and hits are
lost without a message (in 8 of 540 runs). Kernels that other packages launch from other threads do the same harm, and cannot
be made to wait; `Run` detects it by the energy balance.
"""

import os
import sys
import threading
from contextlib import contextmanager

AWAKE = 0.2  # seconds: where waiting cannot be interrupted, Ctrl-C is looked for that often

_changed = threading.Condition()
_turns: list[tuple[int, object]] = []  # all of one thread, one for each block that it has entered


@contextmanager
def turn():
    """Keep all other threads out of such blocks during a block, or a function that it decorates.

    A thread that is in such a block may enter more of them.

    Raises:
        KeyboardInterrupt: Ctrl-C came while it waited.
    """
    mine = (threading.get_ident(), object())
    try:
        _take([mine])
        yield
    finally:
        _leave([mine])


@contextmanager
def aside():
    """Let other threads work during a block, which calls a user's function that may wait for another thread.

    Where this thread is in no `turn`, nothing changes.
    """
    mine = [entry for entry in _turns if entry[0] == threading.get_ident()]
    if not mine:
        yield
        return
    _leave(mine)
    try:
        yield
    finally:
        _take(mine)


def _take(entries: list) -> None:
    """Wait until no other thread is in a block of `turn`, then enter."""
    with _changed:
        while _turns and _turns[0][0] != entries[0][0]:
            _changed.wait(AWAKE)
        _turns.extend(entries)


def _leave(entries: list) -> None:
    """Remove entries; those that are not there are left out, so that an interruption at any moment leaves none behind."""
    try:
        if set(_turns) <= set(entries) and "drjit" in sys.modules:
            import drjit as dr

            dr.sync_thread()  # kernels of this thread may still be at work
    finally:
        with _changed:
            _turns[:] = [entry for entry in _turns if entry not in entries]
            _changed.notify_all()


def _forked() -> None:
    """Forget the entries of other threads, which do not exist in a child process."""
    global _changed
    _changed = threading.Condition()
    _turns[:] = [entry for entry in _turns if entry[0] == threading.get_ident()]


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forked)
