"""Output files: they are refused before the run where they cannot be written, and one that fails does not stop the others."""

import os
import tempfile
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from ..errors import OutputError, RadiosityError, printable
from .streams import tell

PICTURES = (".png", ".exr")
Tasks = Iterable[tuple[Any, Callable[[], object]]]  # names or paths, and what to do


def check(paths) -> None:
    """Refuse, before any work, outputs that could not be written after it.

    Raises:
        OutputError: an unknown format, a folder that is not there or not writable, or one file named twice.
    """
    from ..image import check_writable, files_of

    seen: dict[Path, Path] = {}
    for path in paths:
        for place in (file.resolve() for file in files_of(path)):
            if place in seen:
                also = "" if seen[place] == path else f" ({printable(seen[place])} writes {printable(place.name)}, too)"
                raise OutputError(f"{path} is named twice{also}; give each output its own name")
            seen[place] = path
        check_writable(path)


def scene_of(name: str, reading, written: Iterable[Path]):
    """Read a scene, for a command that writes files.

    Args:
        name: as `load_scene` takes it.
        reading: the options of reading it.
        written: all files that will be written.

    Raises:
        OutputError: one of them is read: see `spare`.
    """
    from ..scene import load_with_files

    scene, files = load_with_files(name, **asdict(reading))
    spare(files, written)
    return scene


def spare(read: Iterable, written: Iterable[Path]) -> None:
    """Refuse, before any work, to write over a file that is read: over a scene, its geometry or its images, lines, or points.

    Raises:
        OutputError: there is one.
    """
    files = {what: file for file in read if (what := _identity(file)) is not None}
    for path in written:
        if (what := _identity(path)) in files and what is not None:
            raise OutputError(f"{path}: {printable(files[what])} is read, and would be written over; choose another name")


def _identity(path) -> tuple[int, int] | None:
    """What a file is, under whatever name; None where there is none."""
    with suppress(OSError, ValueError):
        found = os.stat(path)
        return found.st_dev, found.st_ino
    return None


def files_of(paths) -> list[Path]:
    """Return all files that outputs of a solution are written to."""
    from ..image import files_of as of_one

    return [file for path in paths for file in of_one(path)]


def write(solution, paths, *, exposure: float | None = None, checkpoint: Path | None = None, also: Tasks = ()) -> None:
    """Do the tasks of ``also`` and write each output, pictures last, which fail most often (a back end and libraries).

    Where one fails the others are still written; then its error is raised.

    Raises:
        OutputError: at least one file could not be written. The solution has then been saved as NPZ, as ``checkpoint`` or in a
            new folder, if there is any place for it.
    """
    in_order = sorted(paths, key=lambda path: Path(path).suffix.lower() in PICTURES)
    failures = attempt([*also, *((path, partial(_export, solution, path, exposure)) for path in in_order)])
    if failures:
        saved = any(Path(path).suffix.lower() == ".npz" and path not in failures for path in paths)
        kept = "" if saved else f"; {_rescue(solution, checkpoint)}"
        raise OutputError("; ".join(told(failures)) + kept)


def attempt(tasks: Tasks) -> dict[Any, Exception]:
    """Do each task, whether or not those before it failed, and return the errors by the names of the tasks."""
    failures = {}
    for name, task in tasks:
        try:
            task()
        except Exception as error:  # the other tasks are still done
            failures[name] = error
    return failures


def told(failures: dict[Any, Exception]) -> list[str]:
    """Return each error text once."""
    texts = [
        str(error) if isinstance(error, RadiosityError) else f"{name}: {type(error).__name__}: {error}"
        for name, error in failures.items()
    ]
    return list(dict.fromkeys(texts))


def _export(solution, path, exposure: float | None) -> None:
    solution.export(path, exposure=exposure)
    tell(f"wrote {printable(path)}")


def _rescue(solution, checkpoint: Path | None) -> str:
    """Save the solution where it is possible, and say where."""
    if checkpoint is not None:
        with suppress(RadiosityError):
            solution.save(checkpoint)
            return f"the solution was kept in {checkpoint} (make room, then --resume it)"
    with suppress(RadiosityError, OSError):
        folder = Path(tempfile.mkdtemp(prefix="radiosity-"))
        try:
            solution.save(folder / "solution.npz")
        except RadiosityError:
            folder.rmdir()
            raise
        resume = "" if checkpoint is None else " (make room, then --resume it)"
        return f"the solution was kept in {folder / 'solution.npz'}{resume}"
    if checkpoint is not None and checkpoint.exists():
        return f"there was no place for the solution; make room, and go on with --resume {checkpoint}"
    return "there was no place for the solution either; make room, and solve the scene again"
