"""Run commands of ``radiosity`` in processes forked from this one, which has loaded slow libraries, but not Dr.Jit and Mitsuba.

So what those two keep in a process is as in a fresh one, for less time. On each line of stdin: a folder and a command's words, as
JSON. The answer is a line with the status (as `subprocess` has it; null where it did not end in time) and the output.
"""

import json
import os
import signal
import sys
import time
from importlib import import_module

SLOW = (
    "scipy.stats",
    "scipy.sparse.linalg",
    "scipy.spatial",
    "scipy.ndimage",
    "PIL.Image",
    "rich.console",
    "rich.table",
    "rich.progress",
    "pydantic",
    "radiosity.cli.app",
    "radiosity.solution.report",
)
NEVER = ("drjit", "mitsuba")
LOOK = 0.01  # seconds between two looks at a process


def ended(child: int, seconds: float) -> int | None:
    """The status of a process when it has ended; it is killed after some time."""
    begun = time.monotonic()
    while time.monotonic() - begun < seconds:
        found, status = os.waitpid(child, os.WNOHANG)
        if found:
            return os.waitstatus_to_exitcode(status)
        time.sleep(LOOK)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None


def serve(seconds: float) -> list[str] | None:
    """Answer until stdin ends. In a child: the words of its command."""
    while line := sys.stdin.readline():
        folder, words = json.loads(line)
        output = os.path.join(folder, ".output")
        child = os.fork()
        if child == 0:
            os.chdir(folder)
            nothing, file = os.open(os.devnull, os.O_RDONLY), os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            for number, to in enumerate((nothing, file, file)):
                os.dup2(to, number)
            return words
        status = ended(child, seconds)
        with open(output, errors="replace") as file:
            said = file.read()
        os.remove(output)
        print(json.dumps([status, said]), flush=True)
    return None


if __name__ == "__main__":
    for name in SLOW:
        import_module(name)
    assert not set(NEVER) & set(sys.modules)
    command = serve(float(sys.argv[1]))
    if command is not None:
        from radiosity.cli import main

        sys.argv = ["radiosity", *command]
        sys.exit(main())
