"""Checks of a file before Mitsuba's XML parser sees it: it is XML, not nested so deep that recursion ends the process, declares
no entities, and includes nothing from outside the scene's folder. Rotations that Mitsuba makes no rotations of are told."""

import math
from pathlib import Path
from xml.parsers import expat

from ....errors import SceneError, shown
from ...assemble import warn
from ...parts import ReadOptions

DEEPEST = 100  # elements within each other; Mitsuba needs fewer than ten and dies at some ten thousand
UNIT = 1e-3  # largest difference between the length of a rotation's axis and 1 that is rounding
MOST_INCLUDES = 15  # files within each other, as in Mitsuba


def check(path: Path, options: ReadOptions) -> None:
    """Look through a file and those it includes; warn of rotations about an axis that is not of unit length.

    Raises:
        SceneError: file, line and column of malformed XML, of elements nested so deep that Mitsuba's parser would end the
            process, of a document type, and of files outside the scene's folder that the parser itself would read.
    """
    uneven: list[str] = []
    _check_file(path, [path.parent.resolve(), Path()], {}, options, uneven, 0)
    if uneven:
        text = "Mitsuba makes no rotation of these <rotate>, but stretches and shears; give each an axis of length 1"
        warn(f"{path}: {text}: {shown(uneven, 4)}")


def _check_file(
    path: Path, folders: list[Path], defaults: dict[str, str], options: ReadOptions, uneven: list[str], above: int
) -> None:
    depth, includes = 0, []
    parser = expat.ParserCreate()

    def document_type(*_):
        raise SceneError(
            f"{path} (line {parser.CurrentLineNumber}): declares a document type; entities are not expanded, and scenes need "
            "none: take the <!DOCTYPE ...> out"
        )

    def start(tag, attributes):
        nonlocal depth
        depth += 1
        if depth > DEEPEST:
            raise SceneError(f"{path} (line {parser.CurrentLineNumber}): elements are nested more than {DEEPEST} deep")
        value = attributes.get("value", "")
        if tag == "default":
            defaults.setdefault(attributes.get("name", ""), value)
        elif tag == "path":
            folders.extend([folder / value for folder in folders[:2]])
        elif "filename" in attributes:  # what the parser reads itself: includes, and spectra
            name = _filled(attributes["filename"], defaults)
            place = f"{path} (line {parser.CurrentLineNumber})"
            found = [options.admit(folder / name, place) for folder in folders if (folder / name).is_file()]
            includes.extend(found if tag == "include" else [])
        length = _length({key: _filled(text, defaults) for key, text in attributes.items()}) if tag == "rotate" else None
        if length is not None:
            uneven.append(f"{path.name}, line {parser.CurrentLineNumber} (length {length:.4g})")

    def end(tag):
        nonlocal depth
        depth -= 1

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.StartDoctypeDeclHandler = document_type
    try:
        parser.Parse(path.read_bytes(), True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError(f"{path}: malformed XML ({error}); the file is damaged or truncated") from None
    for file in includes if above < MOST_INCLUDES else []:
        _check_file(file, folders, defaults, options, uneven, above + 1)


def _filled(text: str, defaults: dict[str, str]) -> str:
    """A text with the values of its parameters."""
    for key in sorted(defaults, key=len, reverse=True):
        text = text.replace(f"${key}", defaults[key])
    return text


def _length(attributes: dict[str, str]) -> float | None:
    """The length of the axis of a rotation that turns by an angle, if it is not 1; Mitsuba's parser judges what is no number."""
    words = attributes.get("value", "").replace(",", " ").split() or [attributes.get(axis, "0") for axis in "xyz"]
    try:
        length, angle = math.hypot(*map(float, words)), float(attributes.get("angle", "0"))
    except ValueError:
        return None
    return length if angle and abs(length - 1) > UNIT else None
