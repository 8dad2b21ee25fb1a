"""The command line. It may import the library; the library never imports it (a test holds this)."""


def main(arguments: list[str] | None = None) -> int:
    """Run ``radiosity`` and return its exit status.

    0: done; 1: it could not be done, `check` and `doctor` found something serious, or `compare` a difference;
    2: the input is wrong; 130: interrupted, with all results so far written; 143 and 129: interrupted by SIGTERM and SIGHUP.

    Without ``arguments`` it is the program itself: it takes those of the command line, and Ctrl-C has no effect after it.
    """
    import sys

    try:
        from . import interrupts

        with interrupts.heard(main.__code__, last=arguments is None):
            from .app import run

            return run(sys.argv[1:] if arguments is None else list(arguments))
    except KeyboardInterrupt:  # raised outside of `run`
        print("radiosity: interrupted", file=sys.stderr)
        from .interrupts import status

        return status()
