"""Length units: those of a .toml, and what files say of theirs in comments."""

import re
from collections.abc import Iterable
from math import isclose

from ..assemble import ReadOptions, warn

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}  # metres
WORDS = {
    "m": "m",
    "meter": "m",
    "metre": "m",
    "cm": "cm",
    "centimeter": "cm",
    "centimetre": "cm",
    "mm": "mm",
    "millimeter": "mm",
    "millimetre": "mm",
    "in": "in",
    "inch": "in",
    "inche": "in",
    "ft": "ft",
    "foot": "ft",
    "feet": "ft",
}
SAID = re.compile(r"\bunits?\s*(?:[:=]|\bis\b|\bare\b|\bin\b)?\s*[\"']?([a-z]+)", re.IGNORECASE)


def said(comments: Iterable[str]) -> str | None:
    """The unit (a key of `UNITS`) that comments such as ``File units = inches`` name first, or None."""
    found = (WORDS.get(word.lower().removesuffix("s")) for comment in comments for word in SAID.findall(comment))
    return next((unit for unit in found if unit), None)


def warn_of_unit(source, comments: Iterable[str], options: ReadOptions) -> None:
    """Tell where comments name another unit than lengths are taken in: comments are not followed."""
    unit = said(comments)
    if unit is not None and not isclose(UNITS[unit], options.unit, rel_tol=1e-6):
        text = f"says that its unit is {unit}, and lengths are taken in units of {options.unit:g} m"
        warn(f'{source}: {text}; if the comment is right, write unit = "{unit}" in a .toml (docs/scene-toml.md)')
