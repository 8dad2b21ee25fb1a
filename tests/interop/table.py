"""The table of explained differences as docs/interop.md shows it: ``python tests/interop/table.py`` prints it."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from interop.explained import EXPLAINED, VERSIONS

FORMATS = {"gltf": "glTF", "obj": "OBJ", "ply": "PLY", "stl": "STL", "xml": "Mitsuba XML", "mgf": "MGF"}


def rows() -> list[str]:
    """A line of Markdown for each explained difference."""
    return [
        f"| {FORMATS[one.format]} | {VERSIONS[one.reader]} | {one.feature} | {', '.join(one.quantities)} | {one.why} |"
        for kind in FORMATS
        for one in EXPLAINED
        if one.format == kind
    ]


if __name__ == "__main__":
    print("\n".join(rows()))
