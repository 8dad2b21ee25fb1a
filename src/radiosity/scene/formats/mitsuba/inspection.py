"""What must hold before Mitsuba's XML parser sees a file: it is XML, not nested so deep that recursion ends the process, declares
no entities, and includes nothing from outside the scene's folder."""

from pathlib import Path
from xml.parsers import expat

from ....errors import SceneError
from ...parts import ReadOptions

DEEPEST = 100  # elements within each other; Mitsuba needs fewer than ten and dies at some ten thousand
MOST_INCLUDES = 15  # files within each other, as in Mitsuba


def check(path: Path, options: ReadOptions) -> None:
    """Look through a file and those it includes.

    Raises:
        SceneError: file, line and column of malformed XML, of elements nested so deep that Mitsuba's parser would end the
            process, of a document type, and of files outside the scene's folder that the parser itself would read.
    """
    _check_file(path, [path.parent.resolve(), Path()], {}, options, 0)


def _check_file(path: Path, folders: list[Path], defaults: dict[str, str], options: ReadOptions, above: int) -> None:
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
            name = attributes["filename"]
            for key in sorted(defaults, key=len, reverse=True):
                name = name.replace(f"${key}", defaults[key])
            place = f"{path} (line {parser.CurrentLineNumber})"
            found = [options.admit(folder / name, place) for folder in folders if (folder / name).is_file()]
            includes.extend(found if tag == "include" else [])

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
        _check_file(file, folders, defaults, options, above + 1)
