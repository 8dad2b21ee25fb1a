"""The commands, and how they show errors, warnings and interruptions."""

import sys
import warnings
from contextlib import contextmanager
from io import TextIOWrapper

from cyclopts import App, CoercionError, CycloptsError

from ..errors import INSTALL, DeviceError, RadiosityError, RadiosityWarning, keeping
from . import interrupts
from .annual import annual
from .check import check
from .compare import compare
from .conductors import conductors
from .convert import convert
from .doctor import doctor
from .exchange import exchange
from .experiment import experiment
from .factors import factors
from .lightmap import lightmap
from .lines import lines
from .measure import measure
from .methods import methods
from .relight import relight
from .render import render
from .report import report
from .solve import solve
from .streams import say, silence
from .view import view

FAILED, WRONG_INPUT = 1, 2
ARGUMENTS = {  # of arguments that may be left out or given several times, which the library would call ARGS
    methods: "[NAME]",
    relight: "[OPTIONS] LINES [MORE...]",
    convert: "[OPTIONS] SOURCE TARGETS...",
    experiment: "[OPTIONS] [WHICH...]",
}


def _version() -> str:
    from importlib.metadata import version

    return version("radiosity")


app = App(
    name="radiosity",
    help="Radiosity of real scenes by tracing lines, with error bars on every patch.",
    help_epilogue="`radiosity COMMAND --help` explains a command. With --debug, errors come with a traceback.",
    version=_version,
    help_format="markdown",
    suppress_keyboard_interrupt=False,
)
for place, command in enumerate(
    (
        solve,
        measure,
        annual,
        methods,
        lines,
        relight,
        factors,
        conductors,
        exchange,
        render,
        view,
        lightmap,
        report,
        compare,
        convert,
        check,
        experiment,
        doctor,
    )
):
    usage = f"Usage: radiosity {command.__name__} {ARGUMENTS[command]}" if command in ARGUMENTS else None
    app.command(command, sort_key=place, usage=usage)


def run(arguments: list[str]) -> int:
    """Run a command and return the exit status; errors become one line on stderr."""
    debug = "--debug" in arguments
    arguments = [argument for argument in arguments if argument != "--debug"]
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without m² gets m?, not an error after a long run
    try:
        with tidy_warnings(debug), interrupts.kept():
            status = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
        sys.stdout.flush()
        return status if isinstance(status, int) else 0
    except CycloptsError as error:
        if debug:
            raise
        hint = "" if isinstance(error, CoercionError) else " (--help lists what there is)"
        say("error", f"{error}{hint}")
        return WRONG_INPUT
    except RadiosityError as error:
        if debug:
            raise
        say("error", error)
        return FAILED if isinstance(error, DeviceError) else WRONG_INPUT
    except KeyboardInterrupt:
        say("interrupted", "stopped before the end; what was not written yet is lost")
        return interrupts.status()
    except BrokenPipeError:
        silence(1)  # the reader of our output has gone: nothing more is written there, not even by Python when it ends
        return FAILED
    except ModuleNotFoundError as error:
        if debug or error.name is None or error.name.startswith("radiosity"):
            raise
        say("error", f"this needs the package '{error.name}'; {INSTALL}")
        return FAILED
    except MemoryError:
        if debug:
            raise
        say("error", "out of memory; take larger patches (--patch-size, --cells) or fewer replicates")
        return FAILED
    except Exception as error:
        if debug:
            raise
        say("error", f"a fault of the program, not of your input: {type(error).__name__}: {error} (--debug shows where)")
        return FAILED


@contextmanager
def tidy_warnings(debug: bool):
    """Show our warnings as one line each, once, and keep them for solutions; those of other packages only with ``--debug``."""
    seen = set()

    def show(message, category, filename, lineno, file=None, line=None):
        if issubclass(category, RadiosityWarning):
            if str(message) not in seen:
                seen.add(str(message))
                say("warning", message)
        elif debug:
            sys.stderr.write(warnings.formatwarning(message, category, filename, lineno, line))

    with warnings.catch_warnings(), keeping():
        warnings.simplefilter("always", RadiosityWarning)
        warnings.showwarning = show
        yield
