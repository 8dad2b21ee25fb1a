"""Whole files: a file appears complete or not at all, also after a power cut."""

import os
import re
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import OutputError

LONGEST = 60  # most letters of the file's name in the name of its temporary file


@contextmanager
def whole_file(path: Path):
    """Open a binary file to write to; it takes the place of ``path`` once all of it is on the disk.

    Until then its name is ``.NAME.PID.part`` in the same folder. A file that a killed process left is removed by the next
    process that writes ``path``.

    Raises:
        OutputError: the system refuses; a file that was there stays as it was.
    """
    place = Path(os.path.realpath(path))
    temporary = place.with_name(f".{place.name[:LONGEST]}.{os.getpid()}.part")
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        remove_leftovers(place)
        with suppress(FileNotFoundError):
            temporary.unlink()
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
        with os.fdopen(os.open(temporary, flags, 0o666), "wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(place)
        _settle(place.parent)
    except OutputError:
        raise
    except (OSError, ValueError) as error:
        raise OutputError(f"{path}: cannot be written ({reason(error)})") from None
    finally:
        with suppress(OSError, ValueError):
            temporary.unlink()


def check_place(path: Path) -> None:
    """Refuse a place where `whole_file` could not write. It leaves no file behind, and removes what killed processes left.

    Raises:
        OutputError: ``path`` is a folder, or its folder is read-only. A missing folder is no error: it is made with the file.
    """
    with refused(path):
        place = Path(os.path.realpath(path))
        if place.is_dir():
            raise OutputError(f"{path}: is a folder; name a file in it")
        try_out(standing(place.parent) / f".{place.name[:LONGEST]}.{os.getpid()}.part")
        remove_leftovers(place)


def standing(folder: Path) -> Path:
    """Return the folder, or where it does not exist the first folder above it that exists.

    Raises:
        OutputError: a file stands in the way.
    """
    folder = Path(os.path.realpath(folder))
    for place in (folder, *folder.parents):
        if os.path.lexists(place):
            if not place.is_dir():
                raise OutputError(f"'{place}' is a file, not a folder; choose another place")
            return place
    return folder


def try_out(trial: Path) -> None:
    """Make an empty file and remove it: this also finds network drives and full disks that refuse a write."""
    trial.open("xb").close()
    trial.unlink()


@contextmanager
def refused(path):
    """Turn errors of the system about ``path`` into an `OutputError`; a context."""
    try:
        yield
    except OutputError:  # an OSError itself, with a complete message
        raise
    except (OSError, ValueError) as error:
        raise OutputError(f"{path}: cannot write there ({reason(error)}); choose another place") from None


def reason(error: Exception) -> str:
    """The text of an error without the file's name and the system's number."""
    return getattr(error, "strerror", None) or str(error)


def remove_leftovers(path: Path) -> None:
    """Remove the temporary files of ``path`` whose processes no longer run."""
    if os.name != "posix":  # on other systems a check for a process may end it
        return
    place = Path(os.path.realpath(path))
    pattern = re.compile(rf"\.{re.escape(place.name[:LONGEST])}\.(\d+)\.part")
    with suppress(OSError), os.scandir(place.parent) as entries:
        for entry in entries:
            found = pattern.fullmatch(entry.name)
            if found and not _alive(int(found[1])):
                with suppress(OSError):
                    os.unlink(entry.path)


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True


def _settle(folder: Path) -> None:
    """Write the new name to the disk too, where the system can."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
