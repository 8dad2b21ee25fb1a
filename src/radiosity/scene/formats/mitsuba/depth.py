"""What must hold before Mitsuba's XML parser sees a file: it is XML, and not nested so deep that recursion ends the process."""

from pathlib import Path
from xml.parsers import expat

from ....errors import SceneError

DEEPEST = 100  # elements within each other; Mitsuba needs fewer than ten and dies at some ten thousand
MOST_INCLUDES = 15  # files within each other, as in Mitsuba


def check_depth(path: Path) -> None:
    """Refuse malformed XML, and elements nested so deep that Mitsuba's parser would end the process.

    Raises:
        SceneError: file, line and column.
    """
    folders, defaults = [path.parent.resolve(), Path()], {}
    _check_file(path, folders, defaults, 0)


def _check_file(path: Path, folders: list[Path], defaults: dict[str, str], above: int) -> None:
    depth, includes = 0, []
    parser = expat.ParserCreate()

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
        elif tag == "include":
            name = attributes.get("filename", "")
            for key in sorted(defaults, key=len, reverse=True):
                name = name.replace(f"${key}", defaults[key])
            includes.append(name)

    def end(tag):
        nonlocal depth
        depth -= 1

    parser.StartElementHandler, parser.EndElementHandler = start, end
    try:
        parser.Parse(path.read_bytes(), True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError(f"{path}: malformed XML ({error}); the file is damaged or truncated") from None
    for name in includes if above < MOST_INCLUDES else []:
        for folder in folders:
            if (folder / name).is_file():
                _check_file(folder / name, folders, defaults, above + 1)
