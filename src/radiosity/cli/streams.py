"""Lines to whoever may have gone: nothing is left undone because nobody can be told."""

import errno
import os
import sys

from ..errors import printable

GONE = (errno.EPIPE, errno.EIO)  # of a pipe's reader, of a terminal


def tell(text: str) -> None:
    """Lines on stdout, at once; none any more where they cannot be written, with a warning unless their reader has gone."""
    try:
        print(text, flush=True)
    except OSError as error:
        silence(1)
        if error.errno not in GONE:
            say("warning", f"standard output cannot be written to ({error.strerror})")


def say(kind: str, message) -> None:
    """One line on stderr, at once: ``radiosity: error: ...``; none any more where it cannot be written."""
    try:
        print(f"radiosity: {kind}: {printable(' '.join(str(message).split()))}", file=sys.stderr, flush=True)
    except OSError:
        silence(2)


def silence(number: int) -> None:
    """What is written to a descriptor from now on, and what Python still holds of it, goes nowhere."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, number)
    os.close(nothing)
