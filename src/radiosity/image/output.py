"""Files appear whole or not at all, and what would stop them is found before a run."""

import os
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path

from ..errors import INSTALL, OutputError, RadiosityError
from ..solution.whole import reason, refused, standing, try_out


def check_writable(path, suffixes) -> Path:
    """Find out, without leaving a trace, whether a file can be written.

    Args:
        path: of the file.
        suffixes: those that are known.

    Returns:
        The path.

    Raises:
        OutputError: unknown suffix, a read-only folder, a folder or a read-only file of that name.
    """
    path = Path(path)
    if path.suffix.lower() not in suffixes:
        raise OutputError(f"{path}: unknown output format '{path.suffix}'; known are {', '.join(suffixes)}")
    with refused(path):
        if path.is_dir():
            raise OutputError(f"{path}: is a folder; name a file in it")
        try:
            folder = standing(path.parent)  # the rest is made when the file is written
        except OutputError as error:
            raise OutputError(f"{path}: {error}") from None
        if path.exists() and not os.access(path, os.W_OK):
            raise OutputError(f"{path}: the file is read-only; remove it or choose another name")
        try_out(folder / _beside(path).name)
    return path


def require(module: str, purpose: str) -> None:
    """Refuse in time where an optional library is missing.

    Raises:
        OutputError: it is not installed.
    """
    if find_spec(module) is None:
        raise OutputError(f"{purpose} needs '{module}', which is not installed; {INSTALL}")


def require_results(solution) -> None:
    """Refuse a run's checkpoint that has no results yet.

    Raises:
        OutputError: the first stage was not complete.
    """
    if solution.quanta == 0:
        raise OutputError(
            "there are no results yet: the run was stopped within its first stage; `radiosity solve --resume` goes on"
        )


@contextmanager
def replacing(path):
    """A path in the same folder to write to; the finished file then takes the place of ``path`` in one step.

    Raises:
        OutputError: the system refuses; nothing is left behind, and a file that was there stays as it was.
    """
    path = Path(os.path.realpath(path))
    temporary = _beside(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        temporary.replace(path)
    except RadiosityError:
        raise
    except OSError as error:
        raise OutputError(f"{path}: cannot be written ({reason(error)})") from error
    finally:
        with suppress(OSError):
            temporary.unlink()


def _beside(path: Path) -> Path:
    return path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
