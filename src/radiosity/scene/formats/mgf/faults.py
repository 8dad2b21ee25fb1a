"""Faulty lines of an MGF file: each is left out with a warning that names file and line, or is an error where asked."""

import warnings
from dataclasses import dataclass, field

from ....errors import RadiosityWarning, SceneError

NAMED = 30  # faults that get a warning of their own


@dataclass(frozen=True, slots=True)
class Statement:
    """One statement, continuation lines joined: ``text`` without line end, and the place of its first line."""

    text: bytes
    file: str
    line: int

    @property
    def place(self) -> str:
        return f"{self.file}:{self.line}"


@dataclass
class Faults:
    """Faults found so far, by place.

    Attributes:
        strict: the first fault is an error.
        found: what is wrong, by place; a line included several times counts once.
    """

    strict: bool
    found: dict[str, str] = field(default_factory=dict)

    def add(self, place: str, what: str) -> None:
        """Raises: SceneError where ``strict``."""
        if self.strict:
            raise SceneError(f"{place}: {what}; correct the line, or read the file without strict")
        self.found.setdefault(place, what)

    def first(self) -> str:
        """The first fault, to end an error message with; empty where there is none."""
        return next((f"; first fault: {place}: {what}" for place, what in self.found.items()), "")

    def warn(self) -> None:
        """One warning a fault, and one for the rest where there are very many."""
        for place, what in list(self.found.items())[:NAMED]:
            warnings.warn(f"{place}: {what}; line left out", RadiosityWarning, stacklevel=5)
        if len(self.found) > NAMED:
            last = list(self.found)[-1]
            warnings.warn(f"{len(self.found) - NAMED} more lines left out, the last {last}", RadiosityWarning, stacklevel=5)


def decode(word: bytes) -> str:
    """A name of a file: UTF-8 where it is that, Latin-1 otherwise."""
    try:
        return word.decode()
    except UnicodeDecodeError:
        return word.decode("latin-1")
