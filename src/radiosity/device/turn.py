"""One thread of the process at a time works with Dr.Jit; others wait for their turn.

Dr.Jit's threads add to copies of counters, one copy a thread. A Python thread that waits for a kernel works too, on whatever
kernel there is, and all Python threads count as the same thread: where two of them wait at once, both add to one copy, and hits
are lost without a word (in 8 of 540 runs). Kernels that other packages launch from other threads do the same harm, and cannot
be kept away; `Run` finds their traces in the energy balance.
"""

import os
import sys
import threading
from contextlib import contextmanager

AWAKE = 0.2  # seconds: where waiting cannot be interrupted, Ctrl-C is heard that often

_changed = threading.Condition()
_turns: list[tuple[int, object]] = []  # all of one thread, one a block that it has entered


@contextmanager
def turn():
    """For a block, or as a decorator of a function: no other thread is in such a block. A thread that is may enter more of them.

    Raises:
        KeyboardInterrupt: Ctrl-C while waiting.
    """
    mine = (threading.get_ident(), object())
    try:
        _take([mine])
        yield
    finally:
        _leave([mine])


@contextmanager
def aside():
    """For a block that calls a stranger's function, which may wait for another thread: other threads may have their turns
    meanwhile. For a thread whose turn it is not nothing changes."""
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
    """Wait until no other thread is in its turn."""
    with _changed:
        while _turns and _turns[0][0] != entries[0][0]:
            _changed.wait(AWAKE)
        _turns.extend(entries)


def _leave(entries: list) -> None:
    """Give back what was taken; what was not is passed over, so that an interruption at any moment leaves nothing behind."""
    try:
        if set(_turns) <= set(entries) and "drjit" in sys.modules:
            import drjit as dr

            dr.sync_thread()  # kernels of this thread may still be at work
    finally:
        with _changed:
            _turns[:] = [entry for entry in _turns if entry not in entries]
            _changed.notify_all()


def _forked() -> None:
    """In a child process no other thread is left, whose turn it might be."""
    global _changed
    _changed = threading.Condition()
    _turns[:] = [entry for entry in _turns if entry[0] == threading.get_ident()]


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forked)
