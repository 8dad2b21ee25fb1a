"""Names of pieces that a format can hold: each is another one, and what changes is told."""

import re
import unicodedata
from collections.abc import Callable

from ..errors import printable
from .pieces import Piece
from .told import Told

LONGEST = 100  # bytes of a word: Radiance's programs take 127
IDENTIFIER = 90  # characters of an identifier of honeybee before its number: it takes 100
RESERVED = ("void", "inherit", "alias", "=")


def unique_names(parts: list[Piece], told: Told, clean: Callable[[str], str], *, mark: str = ".") -> list[str]:
    """Return a name for each piece.

    Args:
        clean: returns the name that stands for one in the format; "" where there is none.
        mark: stands before the number of a piece.
    """
    result: list[str] = []
    held: set[str] = set()
    taken = {piece.name for piece in parts}
    for piece in parts:
        name = clean(piece.name) or clean(f"surface {piece.surface}")
        if piece.number:
            told.add(f"surfaces of several materials become one for each, called NAME{mark}2 and so on", [piece.name])
            name = f"{name}{mark}{piece.number + 1}"
        while name in held or (name in taken and name != piece.name):
            name += "'"
        if name != piece.name and not piece.number:
            told.add("names that the format cannot hold are changed", [f"{piece.name} -> {name}"])
        held.add(name)
        result.append(name)
    return result


def word(name: str) -> str:
    """Return a name as a word, as Radiance has them: without blanks, and not too long."""
    name = printable("_".join(name.split()))
    whole = len(name.encode()) <= LONGEST and name not in RESERVED
    return name if whole and not name.startswith(("#", "!", '"', "'", "|")) else ""


def plain_word(name: str) -> str:
    """Return a name as MGF's programs take them: a letter, and then letters, digits and signs of ASCII."""
    plain = "".join(c for c in unicodedata.normalize("NFKD", word(name)) if not unicodedata.combining(c))
    plain = "".join(c if c.isascii() else "_" for c in plain)
    return plain if plain.lstrip("_")[:1].isalpha() or not plain else f"s{plain}"


class Identifiers:
    """Identifiers that honeybee takes, each given out once."""

    def __init__(self):
        self._used: dict[str, int] = {}

    def of(self, name: str) -> str:
        """Return one for a name; some of its characters become ``_``, and a number follows where it was given out before."""
        base = re.sub(r"[^.A-Za-z0-9_-]", "_", plain_word(name[:IDENTIFIER]))[:IDENTIFIER] or "surface"
        while True:
            number = self._used[base] = self._used.get(base, 0) + 1
            found = base if number == 1 else f"{base}_{number}"
            if number == 1 or found not in self._used:
                self._used.setdefault(found, 1)
                return found
