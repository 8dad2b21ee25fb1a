"""The lines of an OBJ file as tables."""

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from ....errors import SceneError
from ..encoding import read_text
from .text import lines

NO_NAME = ("", "default", "off", "(null)")
FREE_FORM = ("curv", "curv2", "surf")
NO_FACES = {"p": "points", "l": "lines"}
# statements that change no face: normals, smoothing, what belongs to free forms, and how programs show things
WITHOUT_EFFECT = (
    "vn",
    "vp",
    "s",
    "deg",
    "bmat",
    "step",
    "cstype",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "mg",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
)
HEAD = 1 << 16  # characters in which comments are looked at
PAINTED = "#MRGB"  # ZBrush's colours
NONE = -1


@dataclass(eq=False)
class Tables:
    """The tables of a file: numbers, and the corners of the faces by surface."""

    vertices: list[list[float]] = field(default_factory=list)
    uv: list[list[float]] = field(default_factory=list)
    groups: dict[tuple[str, str], list[list[tuple[int, int]]]] = field(default_factory=dict)  # (name, material) -> faces
    libraries: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    free_form: int = 0
    left_out: Counter[str] = field(default_factory=Counter)  # statements that are not read, by what they are
    begun: Counter[str] = field(default_factory=Counter)  # how often each object begins
    codec: str = "utf-8"
    comments: list[str] = field(default_factory=list)  # those at the beginning
    highest: dict[str, tuple[int, int]] = field(default_factory=dict)  # number used of a table, and its line


def parse(path: Path) -> Tables:
    """The tables of all lines.

    Raises:
        SceneError: a line that is not understood, or a vertex that does not exist.
    """
    text = read_text(path)
    tables = Tables(codec=text.codec)
    tables.comments += [line for line in text.text[:HEAD].splitlines() if line.startswith("#")]
    if painted := text.text.count(PAINTED):
        tables.left_out[f"{PAINTED} (colours of vertices in comments)"] = painted
    name = {"o": "", "g": ""}
    material, faces = "", None
    for number, words in lines(text.text):
        key = words[0]
        try:
            if key == "v":
                tables.vertices.append(_floats(words[1:], 3))
            elif key == "vt":
                tables.uv.append([*_floats(words[1:], 1), 0.0][:2])
            elif key in ("f", "fo"):
                if faces is None:
                    full = "/".join(n for n in dict.fromkeys(name.values()) if n.lower() not in NO_NAME)
                    faces = tables.groups.setdefault((full, material), [])
                if len(words) < 4:
                    tables.faults.append(f"line {number}")
                else:
                    faces.append([_corner(word, tables, number) for word in words[1:]])
            elif key in ("o", "g"):
                name[key], faces = " ".join(words[1:]), None
                if key == "o":
                    name["g"] = ""
                    tables.begun[name["o"]] += 1
            elif key == "usemtl":
                material, faces = " ".join(words[1:]), None
            elif key == "mtllib":
                tables.libraries.append(" ".join(words[1:]))
            elif key in FREE_FORM:
                tables.free_form += 1
            elif key not in WITHOUT_EFFECT:
                tables.left_out[NO_FACES.get(key, key)] += 1
        except ValueError as error:
            raise SceneError(f"{path}, line {number}: '{' '.join(words)[:80]}' is not understood ({error})") from None
    for what, table in (("vertex", tables.vertices), ("texture vertex", tables.uv)):
        index, number = tables.highest.get(what, (0, 0))
        if index > len(table):
            raise SceneError(f"{path}, line {number}: a face names {what} {index}; there are {len(table)}")
    return tables


def _floats(words: list[str], least: int) -> list[float]:
    if len(words) < least:
        raise ValueError(f"expected {least} numbers")
    return [float(word) for word in words]


def _corner(word: str, tables: Tables, line: int) -> tuple[int, int]:
    """Vertex and texture vertex, from 0; relative numbers count back from the last one so far."""
    parts = word.split("/")
    vertex = _index(parts[0], len(tables.vertices), "vertex", tables, line)
    return vertex, _index(parts[1], len(tables.uv), "texture vertex", tables, line) if len(parts) > 1 and parts[1] else NONE


def _index(word: str, count: int, what: str, tables: Tables, line: int) -> int:
    index = int(word)
    if index == 0 or -index > count:
        raise ValueError(f"{what} {index} does not exist: {count} are given before this line, and numbers begin at 1")
    if index > tables.highest.get(what, (0, 0))[0]:
        tables.highest[what] = (index, line)
    return index - 1 if index > 0 else count + index
