"""An MGF file and those it includes, as one list of statements that know where they come from."""

import os
from dataclasses import dataclass, field
from pathlib import Path

from ....errors import SceneError
from ...parts import ReadOptions
from ..beside import in_any_case, warn_of_case
from ..encoding import decode
from .faults import Faults, Statement
from .faults import decode as name_of

ENTITIES = set(
    b"o xf i ies c cxy cspec cct cmix m sides rd td ed rs ts ir v p n f fh sph cyl cone prism ring torus".split()
)  # of the MGF specification 2.0; fh is a face with holes
DEEPEST = 32  # files that include each other
LONGEST = 4000  # bytes of a statement that the standard parser takes
MOST = 20_000_000  # statements


@dataclass
class Known:
    """Files that were read: their statements by name, and the code page of the first that is not Unicode, which others share."""

    statements: dict[str, list[Statement]] = field(default_factory=dict)
    codec: str | None = None


def read_source(path: Path, faults: Faults, options: ReadOptions) -> list[Statement]:
    """All statements in order. ``i file [transform]`` becomes the file's statements, between two ``xf`` if transformed.

    Statements that the standard parser would stop at for their form are faults.

    Raises:
        SceneError: the file cannot be read or is not text; the includes unfold without end, or lie outside the scene's folder;
            a line that would run a command.
    """
    result: list[Statement] = []
    _include(os.fspath(path), (), Known(), result, faults, options)
    return result


def _include(
    name: str, above: tuple[str, ...], known: Known, result: list[Statement], faults: Faults, options: ReadOptions
) -> None:
    if name not in known.statements:
        known.statements[name] = _statements(name, known)
    for statement in known.statements[name]:
        words = statement.text.split()
        if words[0] == b"i":
            _include_statement(statement, words, (*above, name), known, result, faults, options)
        elif words[0].startswith(b"!"):
            raise SceneError(
                f"{statement.place}: '{name_of(statement.text)[:60]}' would run a command; a scene is data, and nothing in it is "
                "run: take the line out, or put there what the command writes"
            )
        elif words[0] == b"ies":
            faults.add(statement.place, "the luminaire is not read: IES photometry is no diffuse surface")
        elif words[0] not in ENTITIES:
            faults.add(statement.place, f"unknown entity '{name_of(words[0])[:40]}'")
        elif len(statement.text) > LONGEST:
            faults.add(statement.place, f"the statement has {len(statement.text)} bytes; at most {LONGEST} are read")
        else:
            result.append(statement)
    if len(result) > MOST:
        raise SceneError(f"{name}: the included files unfold to more than {MOST} statements; split the scene")


def _include_statement(
    statement: Statement, words, above, known, result: list[Statement], faults: Faults, options: ReadOptions
) -> None:
    if len(words) < 2:
        return faults.add(statement.place, "an include names no file")
    name = os.path.normpath(Path(statement.file).parent / os.fsdecode(words[1].lstrip(b"/")))
    options.admit(Path(name), statement.place)
    if name in above:
        return faults.add(statement.place, f"'{name}' includes itself")
    if len(above) >= DEEPEST:
        return faults.add(statement.place, f"files include each other more than {DEEPEST} deep")
    if not os.path.isfile(name) and (other := in_any_case(Path(statement.file).parent, os.fsdecode(words[1].lstrip(b"/")))):
        warn_of_case(statement.place, [(Path(name).name, other)])
        name = os.fspath(options.admit(other, statement.place))
    if not os.path.isfile(name):
        return faults.add(statement.place, f"included file '{name}' does not exist")
    transformed = len(words) > 2
    if transformed:
        result.append(Statement(b" ".join([b"xf", *words[2:]]), statement.file, statement.line))
    try:
        _include(name, above, known, result, faults, options)
    except (OSError, ValueError) as error:
        if isinstance(error, SceneError):
            raise
        faults.add(statement.place, f"included file '{name}' cannot be read ({error})")
    if transformed:
        result.append(Statement(b"xf", statement.file, statement.line))


def _statements(name: str, known: Known) -> list[Statement]:
    data = Path(name).read_bytes()
    if not data.isascii():  # in some code pages the last byte of a name may be that of a backslash
        text = decode(data, name, hint=known.codec)
        known.codec = known.codec or (None if text.codec.startswith("utf") else text.codec)
        data = text.text.encode()
    if b"\0" in data:
        raise SceneError(f"{name}: is not an MGF file (it holds binary data)")
    result: list[Statement] = []
    parts: list[bytes] = []
    for number, line in enumerate(data.splitlines(), 1):
        parts.append(line)
        if line.endswith(b"\\"):
            parts[-1] = line[:-1]
            continue
        text = b" ".join(parts).strip()
        if text and not text.startswith(b"#"):
            result.append(Statement(text, name, number - len(parts) + 1))
        parts = []
    if parts and (text := b" ".join(parts).strip()):
        result.append(Statement(text, name, number - len(parts) + 1))
    return result
