"""Text and numbers of luminaire files."""

import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from ...errors import SceneError, printable

LARGEST_FILE = 16 << 20  # bytes; the largest luminaire files that are measured have some 2 million
SHOWN = 40  # characters of a faulty word in a message


def lines_of(path: Path) -> list[str]:
    """Return the lines of a file, whatever its line ends; text that is no Unicode is taken as Latin-1, which has every byte.

    Raises:
        SceneError: there is no such file, it is too large, or it holds zeros, as no text does.
    """
    try:
        size = path.stat().st_size
        data = path.read_bytes() if size <= LARGEST_FILE else b""
    except FileNotFoundError:
        raise SceneError(f"{path}: no such file") from None
    except (OSError, ValueError) as error:
        raise SceneError(f"{path}: cannot be read ({error})") from None
    if size > LARGEST_FILE:
        raise SceneError(f"{path}: has {size} bytes; luminaire files of more than {LARGEST_FILE} are not read")
    text = _decoded(data)
    if "\0" in text:
        raise SceneError(f"{path}: is no text; a luminaire file is a text file, .ies or .ldt")
    return re.split("\r\n|\n|\r", text)


def _decoded(data: bytes) -> str:
    for codec in ("utf-16",) if data[:2] in (b"\xff\xfe", b"\xfe\xff") else ("utf-8-sig",):
        try:
            return data.decode(codec)
        except UnicodeDecodeError:
            pass
    return data.decode("latin-1")


def number(word: str, where: str, what: str, comma: bool = False) -> float:
    """Return the finite number that a word is.

    Args:
        where: file and line, for the message. what: what the number means.
        comma: a decimal comma is read as a point.

    Raises:
        SceneError: it is none.
    """
    text = word.strip()
    try:
        value = float(text.replace(",", ".") if comma else text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or "_" in text:
        raise SceneError(f"{where}: {what}: there is '{printable(text[:SHOWN])}', which is no number")
    return value


def whole(value: float, where: str, what: str, least: int, most: int) -> int:
    """Return the whole number that a value is.

    Raises:
        SceneError: it is none, or lies outside of least to most.
    """
    if value != int(value) or not least <= value <= most:
        raise SceneError(f"{where}: {what} is {value:g}; expected a whole number from {least} to {most}")
    return int(value)


@dataclass
class Words:
    """Words of a file in turn, with the lines that they stand in.

    Attributes:
        source: the file. words: pairs of a word and the number of its line.
    """

    source: str
    words: list[tuple[str, int]]
    at: int = field(default=0, init=False)

    @staticmethod
    def of(lines: list[str], first: int, source: str) -> "Words":
        """Cut lines at blanks and commas; the first of them has the number ``first``."""
        found = [(word, i) for i, line in enumerate(lines, first) for word in re.split(r"[\s,]+", line) if word]
        return Words(source, found)

    @property
    def where(self) -> str:
        """File and line of the last word taken."""
        return f"{self.source}, line {self.words[max(self.at - 1, 0)][1]}" if self.words else self.source

    @property
    def left(self) -> int:
        return len(self.words) - self.at

    def take(self, what: str) -> float:
        """Return the next number."""
        return self.several(1, what)[0]

    def several(self, count: int, what: str) -> list[float]:
        """Return the next numbers.

        Raises:
            SceneError: the file ends before, or a word is no number.
        """
        if count > self.left:
            raise SceneError(f"{self.source}: ends before {what}: {count} numbers expected, {self.left} are left; is it cut off?")
        result = []
        for word, line in self.words[self.at : self.at + count]:
            result.append(number(word, f"{self.source}, line {line}", what))
        self.at += count
        return result
