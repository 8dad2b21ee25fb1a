"""Text of files that do not say how it is encoded: UTF-8, UTF-16, or the code page of the system that wrote them, told by names.

In Shift-JIS, GBK and Big5 the second byte of a character may be that of a backslash, so that a name at the end of a line looks
like a line to be continued: a file must be decoded before it is cut into words.
"""

import math
import re
from dataclasses import dataclass
from pathlib import Path

from ...errors import SceneError
from ..assemble import warn
from .code_pages import CODE_PAGES, weight_of

MARKS = (
    (b"\xef\xbb\xbf", "utf-8-sig"),
    (b"\xff\xfe\0\0", "utf-32"),
    (b"\0\0\xfe\xff", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)
MOST_WORDS = 1000  # that are weighed
SURE = math.log(100)  # by which the best code page must lead the second
HIGH = re.compile(rb"[\x80-\xff]")


@dataclass(frozen=True)
class Text:
    """Decoded text, and the codec that it was decoded with."""

    text: str
    codec: str


def decode(data: bytes, source: str, *, hint: str | None = None) -> Text:
    """Decode a file's bytes; one warning names the code page where it was guessed.

    Args:
        source: names the file in the warning.
        hint: the codec of a file that belongs to this one, which is taken where it fits.

    Raises:
        SceneError: a file that begins as UTF-16 or UTF-32 and does not go on so.
    """
    for mark, codec in MARKS:
        if data.startswith(mark):
            return _unicode(data, codec, source)
    for codec, zeros in (("utf-16-le", data[1:200:2]), ("utf-16-be", data[0:200:2])):
        if len(zeros) > 1 and zeros.count(0) * 2 > len(zeros):
            return _unicode(data, codec, source)
    try:
        return Text(data.decode("utf-8"), "utf-8")
    except UnicodeDecodeError:
        pass
    words = _words(data)
    if not words:  # comments alone
        return Text(data.decode("latin-1"), "latin-1")
    ranked = sorted(((weight_of(words, page), -number) for number, page in enumerate(CODE_PAGES)), reverse=True)
    best, second = (CODE_PAGES[-number] for _, number in ranked[:2])
    sure = ranked[0][0] - ranked[1][0] > SURE
    hinted = next((page for page in CODE_PAGES if page.codec == hint and weight_of(words, page) > -math.inf), None)
    if hinted is None:
        doubt = "" if sure else f", or perhaps as {second.title}"
        warn(f"{source}: is not UTF-8; its names are read as {best.title}{doubt}: save it as UTF-8 where they come out wrong")
    page = hinted or best
    return Text(data.decode(page.codec, page.errors or "replace"), page.codec)


def _unicode(data: bytes, codec: str, source: str) -> Text:
    try:
        return Text(data.decode(codec).removeprefix("\ufeff"), codec)
    except UnicodeDecodeError as error:
        text = f"{source}: begins as {codec.upper()} text does, and does not go on so ({error})"
        raise SceneError(f"{text}; the file is damaged") from None


def read_text(path: Path, *, hint: str | None = None) -> Text:
    """A file's text."""
    return decode(path.read_bytes(), str(path), hint=hint)


def _words(data: bytes) -> list[bytes]:
    """Different words with bytes beyond ASCII, comments (from # to the end of the line) left out."""
    found: dict[bytes, None] = {}
    for line in re.split(rb"[\r\n]+", data):
        if not HIGH.search(line):
            continue
        text = re.sub(rb"(?:^|\s)#.*", b"", line)
        found.update((word, None) for word in text.split() if HIGH.search(word))
        if len(found) > MOST_WORDS:
            break
    return list(found)
