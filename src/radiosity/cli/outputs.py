"""Output files: refused before the run where they cannot be written, and none lost because of another."""

import tempfile
from contextlib import suppress
from pathlib import Path

from ..errors import OutputError, RadiosityError, printable
from .streams import tell


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


def write(solution, paths, *, exposure: float | None = None, checkpoint: Path | None = None) -> None:
    """Write each output. Where one fails the others are written all the same; then its error is raised.

    Raises:
        OutputError: at least one file could not be written. The solution has then been saved as NPZ, as ``checkpoint`` or in a
            new folder, if there is any place for it.
    """
    failures, saved = [], False
    for path in paths:
        try:
            solution.export(path, exposure=exposure)
        except RadiosityError as error:
            failures.append(str(error))
        except Exception as error:  # one output must not take the others with it
            failures.append(f"{path}: {type(error).__name__}: {error}")
        else:
            saved |= Path(path).suffix.lower() == ".npz"
            tell(f"wrote {printable(path)}")
    if failures:
        kept = "" if saved else f"; {_rescue(solution, checkpoint)}"
        raise OutputError("; ".join(failures) + kept)


def _rescue(solution, checkpoint: Path | None) -> str:
    """Save it where it can be, and say where."""
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
        return f"the solution was kept in {folder / 'solution.npz'}"
    if checkpoint is not None and checkpoint.exists():
        return f"there was no place for the solution; make room, and go on with --resume {checkpoint}"
    return "there was no place for the solution either; make room, and solve the scene again"
