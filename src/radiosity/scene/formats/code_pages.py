"""Code pages, and how likely names are in each: so they are told apart where a file does not say."""

import codecs
import math
from collections.abc import Callable
from dataclasses import dataclass

RARE = math.log(1e-6)  # weight of a character that names hardly have
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


@dataclass(frozen=True)
class CodePage:
    """A code page: its name in Python, its usual name, the weight (log of a share) of a non-ASCII character between two others,
    and what Python does with bytes that the code page leaves free, where that is not an error."""

    codec: str
    title: str
    weight: Callable[[str, str, str], float]
    errors: str = ""


def weight_of(words: list[bytes], page: CodePage) -> float:
    """The logarithm of the likelihood of the words; minus infinity where one cannot be decoded."""
    total = 0.0
    for word in words:
        try:
            text = word.decode(page.codec, page.errors or "strict")
        except UnicodeDecodeError:
            return -math.inf
        around = f" {text} "
        total += sum(page.weight(around[i - 1], c, around[i + 1]) for i, c in enumerate(around) if c > "\x7f")
    return total


def _lead(character: str, codec: str) -> int:
    """The first byte of a character of two bytes, else 0."""
    data = character.encode(codec, "ignore")
    return data[0] if len(data) == 2 else 0


def _japanese(before: str, character: str, after: str) -> float:
    if "\u3040" <= character <= "\u30ff":  # kana
        return -math.log(200)
    return -math.log(3000) if 0x88 <= _lead(character, "cp932") <= 0x98 else RARE


def _of_table(character: str, listed, codec: str, last: int, count: int) -> float:
    """The weight of a character in a table of ``count`` characters, rows 0xB0 to ``last``; those ``listed`` are frequent."""
    if character in listed:
        return -math.log(300)
    data = character.encode(codec, "ignore")
    return -math.log(count) if len(data) == 2 and 0xB0 <= data[0] <= last and data[1] >= 0xA1 else RARE


def _simplified(before: str, character: str, after: str) -> float:
    return _of_table(character, SIMPLIFIED, "gb18030", 0xD7, 3760)


def _traditional(before: str, character: str, after: str) -> float:
    if character in TRADITIONAL:
        return -math.log(300)
    return -math.log(5500) if 0xA4 <= _lead(character, "cp950") <= 0xC6 else RARE


def _korean(before: str, character: str, after: str) -> float:
    return _of_table(character, KOREAN, "cp949", 0xC8, 2350)


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
    CodePage("cp1252", "Latin-1 (Western Windows)", _western, "cp1252_or_latin_1"),
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
