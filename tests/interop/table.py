"""The table of explained differences as docs/interop.md shows it: ``python tests/interop/table.py`` prints it."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from interop.explained import EXPLAINED


def rows(name: str) -> list[str]:
    """A line of Markdown for each explained difference of a format."""
    mine = [one for one in EXPLAINED if one.format == name]
    return [f"| {one.reader} | {one.feature} | {', '.join(one.quantities)} | {one.why} |" for one in mine]


if __name__ == "__main__":
    for name in dict.fromkeys(one.format for one in EXPLAINED):
        print(name, *rows(name), sep="\n")
