"""Loops that Dr.Jit records, and a check of what must not be done while it records.

Dr.Jit calls the body of a symbolic loop once, to record it. An array that is evaluated meanwhile ends the process (SIGABRT) where
its length is 1 or the loop's number of lanes; with other lengths it does no harm. So what a body reads is made before its loop.
"""

from collections.abc import Callable
from typing import Any


class RecordedError(RuntimeError):
    """Error: an array was to be made or read while a loop was recorded. It is a fault of the program, never of its input."""


def not_recorded(what: str) -> None:
    """Refuse what must be done before a loop.

    Raises:
        RecordedError: a loop is being recorded.
    """
    import drjit as dr

    if dr.flag(dr.JitFlag.SymbolicScope):
        raise RecordedError(f"{what} while a loop is recorded, which can end the process; do it before the loop")


def loop(state: tuple, going: Callable[..., Any], body: Callable[..., tuple]) -> tuple:
    """Record a loop: ``body`` turns the state into the next one while ``going`` holds, lane by lane. Return the last state.

    Raises:
        RecordedError: ``body`` makes or reads an array.
    """
    import drjit as dr

    try:
        return dr.while_loop(state, going, body, mode="symbolic")
    except RuntimeError as error:
        cause: BaseException | None = error
        while cause is not None:  # Dr.Jit wraps what a body raises
            if isinstance(cause, RecordedError):
                raise cause from None
            cause = cause.__cause__
        raise
