"""Text of files that do not say how it is encoded: UTF-8, UTF-16, or the code page of the system that wrote them, told by names.

In Shift-JIS, GBK and Big5 the second byte of a character may be that of a backslash, so that a name at the end of a line looks
like a line to be continued: a file must be decoded before it is cut into words.
"""

import codecs
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ...errors import SceneError
from ..assemble import warn

MARKS = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe\0\0", "utf-32"), (b"\0\0\xfe\xff", "utf-32"), (b"\xff\xfe", "utf-16"),
         (b"\xfe\xff", "utf-16"))  # fmt: skip
MOST_WORDS = 1000  # that are weighed
RARE = math.log(1e-6)  # weight of a character that names hardly have
SURE = math.log(100)  # by which the best code page must lead the second
# characters that names of things in rooms are made of, which tell code pages apart that give the same bytes to others
SIMPLIFIED = frozenset(
    "地板墙壁面天花顶灯光窗户门玻璃木材料质白黑红绿蓝黄灰色金属铁钢铝铜石砖瓷水泥土混凝房间屋室厅厨卫浴床"
    "桌椅子沙发柜架台阶楼梯柱梁上下左右前后内外东南西北大小中高低长一二三四五六七八九十号层组对象物体模型"
    "默认新建平立方球圆形布纸塑漆植树草叶框线条块片管道电器"
)
TRADITIONAL = frozenset(
    "地板牆壁面天花頂燈光窗戶門玻璃木材料質白黑紅綠藍黃灰色金屬鐵鋼鋁銅石磚瓷水泥土混凝房間屋室廳廚衛浴床"
    "桌椅子沙發櫃架臺台階樓梯柱樑上下左右前後內外東南西北大小中高低長一二三四五六七八九十號層組對象物體模"
    "型預設新建平立方球圓形布紙塑膠漆植樹草葉框線條塊片管道電器"
)
KOREAN = frozenset(
    "바닥벽천장조명유리창문나무재질흰검빨파초노회색금속철강석돌타일콘크트방실거주욕침대책상의자소계단기둥"
    "보위아래왼오른앞뒤안밖동서남북큰작중높낮긴이삼사육칠팔구십호층그룹물체모델본새평면입원형종플라스틱페"
    "인식잎틀선블록판관도전등가"
)
HIGH = re.compile(rb"[\x80-\xff]")


@dataclass(frozen=True)
class CodePage:
    """A code page: how Python and people call it, and the weight (log of a share) of a non-ASCII character between two others."""

    codec: str
    title: str
    weight: Callable[[str, str, str], float]


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
    ranked = sorted(((_weight(words, page), -number) for number, page in enumerate(CODE_PAGES)), reverse=True)
    best, second = (CODE_PAGES[-number] for _, number in ranked[:2])
    sure = ranked[0][0] - ranked[1][0] > SURE
    hinted = next((page for page in CODE_PAGES if page.codec == hint and _weight(words, page) > -math.inf), None)
    if hinted is None:
        doubt = "" if sure else f", or perhaps as {second.title}"
        warn(f"{source}: is not UTF-8; its names are read as {best.title}{doubt}: save it as UTF-8 where they come out wrong")
    page = hinted or best
    return Text(data.decode(page.codec, "replace" if page.codec != "cp1252" else "cp1252_or_latin_1"), page.codec)


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
    for line in re.finditer(rb"[^\r\n]*[\x80-\xff][^\r\n]*", data):
        text = re.sub(rb"(?:^|\s)#.*", b"", line[0])
        found.update((word, None) for word in text.split() if HIGH.search(word))
        if len(found) > MOST_WORDS:
            break
    return list(found)


def _weight(words: list[bytes], page: CodePage) -> float:
    """Log of the likelihood of the words; minus infinity where one cannot be decoded."""
    total = 0.0
    for word in words:
        try:
            text = word.decode(page.codec, "strict" if page.codec != "cp1252" else "cp1252_or_latin_1")
        except UnicodeDecodeError:
            return -math.inf
        around = f" {text} "
        total += sum(page.weight(around[i - 1], c, around[i + 1]) for i, c in enumerate(around) if c > "\x7f")
    return total


def _lead(character: str, codec: str) -> int:
    """First byte of a character of two bytes, else 0."""
    data = character.encode(codec, "ignore")
    return data[0] if len(data) == 2 else 0


def _japanese(before: str, character: str, after: str) -> float:
    if "\u3040" <= character <= "\u30ff":  # kana
        return -math.log(200)
    return -math.log(3000) if 0x88 <= _lead(character, "cp932") <= 0x98 else RARE


def _simplified(before: str, character: str, after: str) -> float:
    if character in SIMPLIFIED:
        return -math.log(300)
    data = character.encode("gb18030", "ignore")
    return -math.log(3760) if len(data) == 2 and 0xB0 <= data[0] <= 0xD7 and data[1] >= 0xA1 else RARE


def _traditional(before: str, character: str, after: str) -> float:
    if character in TRADITIONAL:
        return -math.log(300)
    return -math.log(5500) if 0xA4 <= _lead(character, "cp950") <= 0xC6 else RARE


def _korean(before: str, character: str, after: str) -> float:
    if character in KOREAN:
        return -math.log(300)
    data = character.encode("cp949", "ignore")
    return -math.log(2350) if len(data) == 2 and 0xB0 <= data[0] <= 0xC8 and data[1] >= 0xA1 else RARE


def _western(before: str, character: str, after: str) -> float:
    if not character.isalpha():
        return RARE
    alone = before <= "\x7f" and after <= "\x7f"
    return -math.log(64) if alone else -math.log(64) - 4  # such letters seldom stand side by side


def _cyrillic(before: str, character: str, after: str) -> float:
    if not "\u0401" <= character <= "\u0451":
        return RARE
    beside = "\u0401" <= before <= "\u0451" or "\u0401" <= after <= "\u0451"
    return -math.log(64) if beside else -math.log(64) - 8


CODE_PAGES = (
    CodePage("cp1252", "Latin-1 (Western Windows)", _western),
    CodePage("cp932", "Shift-JIS", _japanese),
    CodePage("gb18030", "GBK", _simplified),
    CodePage("cp950", "Big5", _traditional),
    CodePage("cp949", "EUC-KR", _korean),
    CodePage("cp1251", "Cyrillic Windows", _cyrillic),
)


def _latin_1(error):
    """The few bytes that Western Windows leaves free, as Latin-1 has them."""
    return error.object[error.start : error.end].decode("latin-1"), error.end


codecs.register_error("cp1252_or_latin_1", _latin_1)
