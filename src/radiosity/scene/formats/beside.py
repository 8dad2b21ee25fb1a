"""Files that a scene names in another case than theirs: they are found on all systems, and told."""

from collections.abc import Iterable
from pathlib import Path

from ...errors import shown
from ..assemble import warn


def in_any_case(folder: Path, name: str) -> Path | None:
    """The one file at a relative path below a folder whose name differs from ``name`` in nothing but case; None where there is
    none, or where several are alike. What leads out of the folder is not looked for."""
    place = folder
    for step in Path(name).parts:
        if step in ("..", "/", "\\") or not place.is_dir():
            return None
        if not (place / step).exists():
            alike = [entry for entry in place.iterdir() if entry.name.casefold() == step.casefold()]
            if len(alike) != 1:
                return None
            step = alike[0].name
        place = place / step
    return place if place.is_file() else None


def warn_of_case(source, renamed: Iterable[tuple[str, Path]]) -> None:
    """Tell once which files were found under a name of other case, from pairs of the name asked for and the file."""
    pairs = dict.fromkeys(f"{name} (it is {file.name})" for name, file in renamed)
    if pairs:
        warn(f"{source}: files whose names differ in case: {shown(pairs)}; other systems may not find them")
