"""Lines on stdout and stderr: where nobody can read them any more, the work still goes on."""

import errno
import os
import sys

from ..errors import printable

GONE = (errno.EPIPE, errno.EIO)  # errors of a pipe without a reader, and of a terminal that has gone


def tell(text: str) -> None:
    """Write lines to stdout at once.

    Where they cannot be written, no more are written, and there is a warning unless their reader has gone.
    """
    try:
        print(text, flush=True)
    except OSError as error:
        silence(1)
        if error.errno not in GONE:
            say("warning", f"standard output cannot be written to ({error.strerror})")


def say(kind: str, message) -> None:
    """Write one line to stderr at once: ``radiosity: error: ...``; where it cannot be written, write no more."""
    try:
        print(f"radiosity: {kind}: {printable(' '.join(str(message).split()))}", file=sys.stderr, flush=True)
    except OSError:
        silence(2)


def silence(number: int) -> None:
    """Send what is written to a descriptor from now on, and what Python still buffers for it, nowhere."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, number)
    os.close(nothing)
