"""Files that a scene names in another case than theirs: they are found on all systems, and told."""

from collections.abc import Iterable
from pathlib import Path

from ...errors import SceneError, shown
from ..assemble import ReadOptions, warn


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


def named_file(source: Path, name: str, options: ReadOptions, what: str) -> Path:
    """Return the path of a file that a scene file names, relative to its folder.

    Args:
        source: the scene file.
        name: as it stands there.
        what: the kind of file, for messages.

    Raises:
        SceneError: it does not exist, or lies outside of the folder that files are read from.
    """
    path = source.parent / name
    options.admit(path, source)
    if not path.exists() and (other := in_any_case(source.parent, name)):
        warn_of_case(source, [(name, other)])
        path = options.admit(other, source)
    if not path.exists():
        hint = "; write / in place of the backslash" if "\\" in name else ""
        text = f"{what} '{name}' does not exist; paths are relative to the folder of the {source.suffix}"
        raise SceneError(f"{source}: {text}{hint}")
    return path
