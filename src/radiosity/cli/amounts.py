"""Numbers as people write them: 10M rays, 5 min, 1%."""

import math
import re

COUNT = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9, "b": 10**9}
TIME = {"": 1.0, "s": 1.0, "min": 60.0, "m": 60.0, "h": 3600.0}
LENGTH = {"": 1.0, "m": 1.0, "cm": 0.01, "mm": 0.001}
LARGEST = 2**62


def _split(text: str) -> tuple[float, str] | None:
    match = re.fullmatch(r"\s*([+-]?(?:\d[\d_]*\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*([a-z%]*)\s*", text, re.IGNORECASE)
    return (float(match.group(1)), match.group(2).lower()) if match else None


def count(text: str, least: int = 1) -> int:
    """``10M``, ``500k``, ``1e7``, ``10_000_000``: a whole number of ``least`` (0 or 1) or more.

    Raises:
        ValueError: it is none; the message says what to write.
    """
    parts = _split(text)
    if parts is None or parts[1] not in COUNT:
        raise ValueError(f"'{text}' is no count; write a whole number such as 10M, 500k or 1e7")
    value = parts[0] * COUNT[parts[1]]
    if value < least or value > LARGEST or abs(value - round(value)) > 1e-9 * value:
        raise ValueError(f"'{text}' must be a whole number from {least} to {LARGEST:.1e}, such as 10M, 500k or 1e7")
    plain = text.strip().replace("_", "")
    return int(plain) if plain.isdecimal() else round(value)  # digits alone are taken to the last one


def seconds(text: str) -> float:
    """``60``, ``90s``, ``5min``, ``1.5h``: more than zero.

    Raises:
        ValueError: it is none; the message says what to write.
    """
    form = f"'{text}' is no duration; write seconds, or such as 90s, 5min or 1h"
    return _measured(text, TIME, form, f"'{text}' must be a finite time above zero, such as 60, 5min or 1h")


def share(text: str) -> float:
    """``1%`` or ``0.01``: above 0 and below 1.

    Raises:
        ValueError: it is none; the message says what to write.
    """
    parts = _split(text)
    if parts is None or parts[1] not in ("", "%"):
        raise ValueError(f"'{text}' is no relative error; write such as 1% or 0.01")
    value = parts[0] / (100 if parts[1] else 1)
    if not 0 < value < 1:
        raise ValueError(f"'{text}' must lie between 0 and 100 %, above 0 and strictly below 100; write such as 1% or 0.01")
    return value


def length(text: str) -> float:
    """Metres, with or without unit: ``0.1``, ``10cm``, ``5mm``, ``2m``; above zero.

    Raises:
        ValueError: it is none; the message says what to write.
    """
    form = f"'{text}' is no length; write metres such as 0.1, or 10cm"
    return _measured(text, LENGTH, form, f"'{text}' must be a finite length above zero, in metres")


def height(text: str) -> float:
    """``1.5``, ``-20cm``: a finite height.

    Raises:
        ValueError: it is none; the message says what to write.
    """
    parts = _split(text)
    if parts is None or parts[1] not in LENGTH or not math.isfinite(parts[0]):
        raise ValueError(f"'{text}' is no height; write metres such as 1.5, or 150cm")
    return parts[0] * LENGTH[parts[1]]


def density(text: str) -> float:
    """``20``: a finite number of texels per metre above zero.

    Raises:
        ValueError: it is none; the message says what to write.
    """
    form = f"'{text}' is no density; write a number of texels per metre, such as 20"
    return _measured(text, {"": 1.0}, form, f"'{text}' must be a finite number of texels per metre, above zero")


def _measured(text: str, units: dict[str, float], form: str, bound: str) -> float:
    """A finite amount above zero in one of the units; else a ValueError with one of the two messages."""
    parts = _split(text)
    if parts is None or parts[1] not in units:
        raise ValueError(form)
    value = parts[0] * units[parts[1]]
    if not 0 < value < math.inf:
        raise ValueError(bound)
    return value


def stops(text: str) -> float:
    """``1``, ``-0.5``: a finite number of stops of exposure.

    Raises:
        ValueError: it is none; the message says what to write.
    """
    parts = _split(text)
    if parts is None or parts[1] or not abs(parts[0]) <= 100:
        raise ValueError(f"'{text}' is no exposure; write a number of stops between -100 and 100, such as 1 or -0.5")
    return parts[0]


def numbers(text: str, many: int) -> tuple[float, ...]:
    """``many`` finite numbers with commas between: ``1,2,3``.

    Raises:
        ValueError: it is none; the message says what to write.
    """
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) != many or not all(map(math.isfinite, values)):
        raise ValueError(f"'{text}' is not {many} numbers; write such as {','.join(['0', '1.5', '-2'][:many])}")
    return values


def short(value: float) -> str:
    """``12.3M``: a large number for a narrow place."""
    for limit, suffix in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if abs(value) >= limit:
            return f"{value / limit:.3g}{suffix}"
    return f"{value:.3g}"
