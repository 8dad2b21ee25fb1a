"""The statements of a Radiance description (.rad): ``modifier type identifier``, then words, whole numbers and numbers."""

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, islice

from ....errors import SceneError

WORD = re.compile(r"""#[^\n]*|"[^"\n]*"|'[^'\n]*'|\S+""")
SHOWN = 60  # letters of a word or command in messages
EXPAND = "xform -e"  # Radiance's program that writes a file with the output of its commands


@dataclass(frozen=True)
class Primitive:
    """One statement.

    Attributes:
        modifier: what changes it: a material, pattern or texture, "void", or of an alias "inherit".
        kind: its type, such as polygon or plastic.
        name: its identifier.
        words: the first list of arguments; of an alias the name of what it stands for.
        numbers: the last list.
        line: from 1.
    """

    modifier: str
    kind: str
    name: str
    words: tuple[str, ...]
    numbers: tuple[float, ...]
    line: int


class Words:
    """The words of a text, one after another; comments begin with ``#`` and end with the line."""

    def __init__(self, text: str, source: str):
        self._source = source
        self._text = text
        self._found: Iterator[re.Match[str]] = WORD.finditer(text)
        self._ends: list[int] | None = None
        self.at = 0  # place of the last word

    def next(self) -> str | None:
        """The next word without quotes, None at the end."""
        for match in self._found:
            word = match.group()
            if not word.startswith("#"):
                self.at = match.start()
                return word[1:-1] if len(word) > 1 and word[0] in "\"'" and word[-1] == word[0] else word
        return None

    def of(self, what: str) -> str:
        """The next word.

        Raises:
            SceneError: the file ends here.
        """
        word = self.next()
        if word is None:
            raise SceneError(f"{self._source}: the file ends where {what} is expected; it is cut off")
        return word

    def count(self, what: str) -> int:
        """The next word as a number of arguments.

        Raises:
            SceneError: it is none.
        """
        word = self.of(f"the number of {what}")
        if not (word.isdecimal() and word.isascii() and len(word) < 10):
            text = f"{self._source}:{self.line()}: '{word[:SHOWN]}' stands where the number of {what} is expected"
            raise SceneError(f"{text}; a primitive has three lists of arguments, each after its number: correct the line")
        return int(word)

    def number(self, what: str) -> float:
        """The next word as a number.

        Raises:
            SceneError: it is none.
        """
        word = self.of(f"a number of {what}")
        try:
            return float(word)
        except ValueError:
            text = f"'{word[:SHOWN]}' stands where a number of {what} is expected; correct the line"
            raise SceneError(f"{self._source}:{self.line()}: {text}") from None

    def numbers(self, count: int, what: str) -> tuple[float, ...]:
        """The next words as numbers.

        Raises:
            SceneError: one is none, or the file ends before.
        """
        found = list(islice(self._found, count))
        try:
            values = tuple([float(match.group()) for match in found])
        except ValueError:  # a comment, quotes, or no number
            values = ()
        if len(values) < count:
            self._found = chain(found, self._found)
            return tuple([self.number(what) for _ in range(count)])
        if found:
            self.at = found[-1].start()
        return values

    def line(self) -> int:
        """The line of the last word, from 1."""
        if self._ends is None:
            self._ends = [match.start() for match in re.finditer("\n", self._text)]
        return bisect_right(self._ends, self.at) + 1

    def rest_of_line(self) -> str:
        """The text from the last word to the end of its line."""
        return self._text[self.at : self._text.find("\n", self.at) % (len(self._text) + 1)]


def primitives(text: str, source: str) -> Iterator[Primitive]:
    """The statements of a file, in order.

    Raises:
        SceneError: a line that would run a command, or text that is no statement.
    """
    words = Words(text, source)
    while (modifier := words.next()) is not None:
        line = words.line()
        if modifier.startswith("!"):
            raise SceneError(
                f"{source}:{line}: '{words.rest_of_line().strip()[:SHOWN]}' would run a command; a scene is data, and nothing in "
                f"it is run: write a file without commands by '{EXPAND} {source} > expanded.rad', and load that"
            )
        kind = words.of(f"the type of what '{modifier[:SHOWN]}' modifies")
        name = words.of(f"the name of a {kind[:SHOWN]}")
        if kind == "alias":
            yield Primitive(modifier, kind, name, (words.of(f"what the alias '{name[:SHOWN]}' stands for"),), (), line)
            continue
        what = f"{kind[:SHOWN]} '{name[:SHOWN]}'"
        strings = tuple([words.of(f"a word of {what}") for _ in range(words.count(f"words of {what}"))])
        for _ in range(words.count(f"whole numbers of {what}")):
            words.number(what)
        numbers = words.numbers(words.count(f"numbers of {what}"), what)
        yield Primitive(modifier, kind, name, strings, numbers, line)
