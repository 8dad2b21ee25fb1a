"""Statements of OBJ and MTL files."""

import re
from collections.abc import Iterator

COMMENT = re.compile(r"(?:^|\s)#.*")  # a # within a name is part of it


def lines(text: str) -> Iterator[tuple[int, list[str]]]:
    """Number and words of every line that has any; lines that end in a backslash go on in the next."""
    held: list[str] = []
    number = 0
    # not splitlines, which also cuts at characters that code pages have within names
    for number, line in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1):
        words = (COMMENT.sub("", line) if "#" in line else line).split()
        if words and words[-1].endswith("\\"):
            held += [*words[:-1], *filter(None, [words[-1][:-1]])]
        elif held or words:
            yield number, held + words
            held = []
    if held:
        yield number, held
