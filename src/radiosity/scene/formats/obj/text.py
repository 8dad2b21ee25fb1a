"""Statements of OBJ and MTL files."""

import re
from collections.abc import Iterator
from pathlib import Path

COMMENT = re.compile(r"(?:^|\s)#.*")  # a # within a name is part of it


def lines(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Number and words of every line that has any; lines that end in a backslash go on in the next."""
    data = path.read_bytes()
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    held: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = (COMMENT.sub("", line) if "#" in line else line).split()
        if words and words[-1].endswith("\\"):
            held += [*words[:-1], *filter(None, [words[-1][:-1]])]
        elif held or words:
            yield number, held + words
            held = []
    if held:
        yield number, held
