"""Checks of outputs before a run: what would stop an output is found in time."""

import os
from importlib.util import find_spec
from pathlib import Path

from ..errors import OutputError, installing
from ..solution.replacing import beside
from ..solution.whole import refused, standing, try_out


def check_writable(path, suffixes) -> Path:
    """Find out, without leaving a trace, whether a file can be written.

    Args:
        path: of the file.
        suffixes: those that are known.

    Returns:
        The path.

    Raises:
        OutputError: the suffix is unknown, the folder is read-only, or there is a folder or a read-only file of that name.
    """
    path = Path(path)
    if path.suffix.lower() not in suffixes:
        raise OutputError(f"{path}: unknown output format '{path.suffix}'; known are {', '.join(suffixes)}")
    with refused(path):
        if path.is_dir():
            raise OutputError(f"{path}: is a folder; name a file in it")
        try:
            folder = standing(path.parent)  # missing folders are made when the file is written
        except OutputError as error:
            raise OutputError(f"{path}: {error}") from None
        if path.exists() and not os.access(path, os.W_OK):
            raise OutputError(f"{path}: the file is read-only; remove it or choose another name")
        try_out(folder / beside(path).name)
    return path


def each_writable(paths, suffixes) -> list[Path]:
    """Find out whether files can be written that are made together, and return their paths.

    Raises:
        OutputError: as of `check_writable`, or one file is named twice.
    """
    seen: dict[Path, Path] = {}
    for path in paths:
        place = check_writable(path, suffixes).resolve()
        if place in seen:
            raise OutputError(f"{path} is named twice; give each output its own name")
        seen[place] = Path(path)
    return list(seen.values())


def require(module: str, purpose: str, extra: str = "all") -> None:
    """Refuse an output whose optional library is missing.

    Args:
        module: of the library.
        purpose: what needs it.
        extra: that brings it.

    Raises:
        OutputError: the library is not installed.
    """
    if find_spec(module) is None:
        raise OutputError(f"{purpose} needs '{module}', which is not installed; {installing(extra)}")


def require_results(solution) -> None:
    """Refuse a run's checkpoint that has no results yet.

    Raises:
        OutputError: the first stage was not complete.
    """
    if solution.quanta == 0:
        raise OutputError(
            "there are no results yet: the run was stopped within its first stage; `radiosity solve --resume` goes on"
        )
