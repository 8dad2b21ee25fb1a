"""One life of a run of ``soak.py``: ``radiosity`` with the arguments that are given, which also tells its lines and the time.

Rows of the standard output that begin with ``@`` hold the seconds of the clock, what happens, and the lines so far.
"""

import sys
import time

import radiosity as rd
from radiosity.cli import main
from radiosity.run.progress import Teller

BETWEEN = 0.1  # seconds between two rows, at least


def tell(what: str, lines: int) -> None:
    print("@", time.time(), what, lines, flush=True)


def live(arguments: list[str]) -> int:
    """Run the command; its exit status."""
    solve, begin, last = rd.solve, Teller.begin, 0.0

    def begun(teller: Teller, lines: int) -> None:
        begin(teller, lines)
        tell("begin", lines)

    def solved(*positional, progress=None, **options):
        def listen(moment) -> None:
            nonlocal last
            if progress is not None:
                progress(moment)
            if moment.message == "tracing" and time.monotonic() - last >= BETWEEN:
                last = time.monotonic()
                tell("tracing", moment.rays)

        solution = solve(*positional, progress=listen, **options)
        tell("end", solution.rays)
        return solution

    rd.solve, Teller.begin = solved, begun
    return main(arguments)


if __name__ == "__main__":
    sys.exit(live(sys.argv[1:]))
