"""IES LM-63 files: 1986, 1991, 1995, 2002 and 2019, photometric types A, B and C (docs/luminaires.md)."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import SceneError, printable
from .angle_types import to_type_c
from .photometry import AGREE, Photometry
from .text import Words, lines_of, whole
from .tilt import Tilt, read_tilt, tilt_of_file
from .unfold import checked_angles, checked_intensities, unfolded
from .web import Web

VERSION = re.compile(r"\s*(?:IESNA(91)|IES(?:NA)?:LM-63-(\d{4}))\b", re.IGNORECASE)
OLDEST, NEWEST = 1986, 2019  # the oldest has no first line of its own
TILT = re.compile(r"\s*TILT\s*=", re.IGNORECASE)
TYPES = {1: "C", 2: "B", 3: "A"}
UNITS = {1: 0.3048, 2: 1.0}  # feet, metres
MOST_ANGLES = 8000
LEAST_EFFICIENCY = 0.02  # of the lamps' flux: a file whose luminaire sends less is told
NAMES = ("LUMINAIRE", "LUMCAT")
FACTOR_1, KEYWORD = 1e-6, re.compile(r"\s*\[(\w+)\]\s*(.*)")


@dataclass(frozen=True)
class _Header:
    """The thirteen numbers before the angles."""

    lamps: float
    lumens: float
    multiplier: float
    n_vertical: int
    n_horizontal: int
    kind: str
    unit: float
    width: float
    length: float
    height: float
    ballast: float
    second: float
    watts: float


def read(path: Path) -> Photometry:
    """Read an IES file.

    Raises:
        SceneError: it is none, or damaged; the message names the line and the value.
    """
    lines, source = lines_of(path), str(path)
    tilt = next((i for i, line in enumerate(lines) if TILT.match(line)), None)
    if tilt is None:
        raise SceneError(f"{source}: has no line TILT=, so it is no IES file (LM-63)")
    keywords = _keywords(lines[:tilt])
    words, notes = Words.of(lines[tilt + 1 :], tilt + 2, source), []
    version = _version(lines[0], notes)
    leaning = _tilt(lines[tilt].split("=", 1)[1].strip(), words, path, notes)
    header = _header(words)
    vertical = words.several(header.n_vertical, "the vertical angles")
    horizontal = words.several(header.n_horizontal, "the horizontal angles")
    values = words.several(header.n_vertical * header.n_horizontal, "the candela values")
    if words.left:
        notes.append(f"{words.left} numbers follow the last candela value; they are left out")
    table = np.array(values, np.float64).reshape(header.n_horizontal, header.n_vertical)
    web = _web(header, vertical, horizontal, table * _factor(header, version, notes), source, notes)
    _compare(header, web.flux, notes)
    size, disc = _size(header)
    name = next((keywords[key] for key in NAMES if keywords.get(key)), path.stem)
    stated = np.nan  # a file states the lamps' flux, and that of the luminaire nowhere
    maker = keywords.get("MANUFAC", "")
    return Photometry(web, web.flux, stated, size, disc, name, maker, header.watts, source, tuple(notes), leaning)


def _version(line: str, notes: list[str]) -> int:
    """Return the year of the standard that the first line names."""
    match = VERSION.match(line)
    if match is None:
        return OLDEST
    year = 1991 if match[1] else int(match[2])
    if year > NEWEST:
        notes.append(f"follows LM-63-{year}, which is newer than this reader; it is read as one of {NEWEST}")
    return year


def _keywords(lines: list[str]) -> dict[str, str]:
    """Return the first text of each keyword."""
    found: dict[str, str] = {}
    for line in lines:
        if match := KEYWORD.match(line):
            found.setdefault(match[1].upper(), printable(match[2].strip()))
    return found


def _tilt(said: str, words: Words, path: Path, notes: list[str]) -> Tilt | None:
    """Return what the file says of the lamp's light at other tilts; None where it says nothing."""
    if said.upper() == "NONE":
        return None
    tilt = read_tilt(words) if said.upper() == "INCLUDE" else tilt_of_file(path, said, notes)
    return tilt if tilt is not None and tilt.matters else None


def _header(words: Words) -> _Header:
    lamps, lumens, multiplier = (words.take(what) for what in ("the number of lamps", "the lumens per lamp", "the multiplier"))
    if not multiplier > 0:
        raise SceneError(f"{words.where}: the multiplier is {multiplier:g}; it must be above zero")
    n_vertical = _count(words, "the number of vertical angles")
    n_horizontal = _count(words, "the number of horizontal angles")
    kind = whole(words.take("the photometric type"), words.where, "the photometric type (C 1, B 2, A 3)", 1, 3)
    unit = whole(words.take("the unit"), words.where, "the unit (feet 1, metres 2)", 1, 2)
    width, length, height = (words.take(f"the luminous {what}") for what in ("width", "length", "height"))
    ballast = words.take("the ballast factor")
    if not ballast > 0:
        raise SceneError(f"{words.where}: the ballast factor is {ballast:g}; it must be above zero")
    second, watts = words.take("the number after the ballast factor"), words.take("the watts")
    sizes = (width, length, height)
    return _Header(lamps, lumens, multiplier, n_vertical, n_horizontal, TYPES[kind], UNITS[unit], *sizes, ballast, second, watts)


def _count(words: Words, what: str) -> int:
    return whole(words.take(what), words.where, what, 1, MOST_ANGLES)


def _factor(header: _Header, version: int, notes: list[str]) -> float:
    """Return what candela values are multiplied by. The number after the ballast factor is one until 1991; later it is none."""
    factor = header.multiplier * header.ballast
    if version < 1995:
        return factor * header.second
    if version < 2019 and abs(header.second - 1) > FACTOR_1:
        notes.append(f"the number after the ballast factor is {header.second:g}; in files of {version} it is no factor")
    return factor


def _web(header: _Header, vertical, horizontal, table: np.ndarray, source: str, notes: list[str]) -> Web:
    if header.n_vertical < 2:
        raise SceneError(f"{source}: has one vertical angle; two or more are needed")
    low = 0.0 if header.kind == "C" else -90.0
    across = checked_angles(vertical, "the vertical angles", low, low + 180, source)
    around = checked_angles(horizontal, "the horizontal angles", low, low + 180 + (180 if header.kind == "C" else 0), source)
    table = checked_intensities(table, (around, across), source, notes)
    if header.kind != "C":
        return to_type_c(header.kind, around, across, table, notes)
    if not (across[0] in (0.0, 90.0) and across[-1] in (90.0, 180.0)):
        notes.append(f"the vertical angles are {across[0]:g} to {across[-1]:g}; it sends nothing outside of them")
    return unfolded(around, across, table, source, notes)


def _compare(header: _Header, flux: float, notes: list[str]) -> None:
    """Hold the flux of the intensities against that of the lamps, which the luminaire cannot exceed."""
    lamps = header.lamps * header.lumens * header.ballast
    if header.lumens <= 0 or header.lamps <= 0:
        return  # absolute photometry: the intensities are all there is
    if flux > lamps * (1 + AGREE):
        notes.append(f"its intensities make {flux:.5g} lm, more than its lamps send ({lamps:.5g} lm); {flux:.5g} lm are taken")
    elif flux < lamps * LEAST_EFFICIENCY:
        notes.append(f"its intensities make {flux:.5g} lm, hardly any of what its lamps send ({lamps:.5g} lm)")


def _size(header: _Header) -> tuple[np.ndarray, bool]:
    """Return the luminous length, width and height in metres, and whether the area is round: negative numbers mean diameters."""
    length, width = abs(header.length), abs(header.width)
    disc = header.width < 0 or header.length < 0
    if disc:  # a circle has one of them, or both
        length, width = length or width, width or length
    return np.array([length, width, abs(header.height)]) * header.unit, disc
