"""EULUMDAT files, .ldt (docs/luminaires.md)."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import SceneError, printable
from .photometry import Photometry, differs
from .text import lines_of, number, whole
from .unfold import checked_angles, checked_intensities, unfolded
from .web import Web

MOST_ANGLES = 8000
MOST_SETS = 100
RATIOS = 10  # direct ratios for rooms, between the lamp sets and the angles
POINTS = 2.0  # percentage points by which the downward flux fraction may differ without a word


@dataclass
class _Lines:
    """The lines of a file in turn; each value has one of its own."""

    source: str
    lines: list[str]
    at: int = 0

    @property
    def where(self) -> str:
        return f"{self.source}, line {self.at}"

    def text(self, what: str) -> str:
        if self.at >= len(self.lines):
            raise SceneError(f"{self.source}: ends before {what}, after {len(self.lines)} lines; is it cut off?")
        self.at += 1
        return self.lines[self.at - 1].strip()

    def number(self, what: str, empty: float | None = None) -> float:
        """Return the number of the next line; ``empty`` where the line is empty."""
        text = self.text(what)
        return empty if empty is not None and not text else number(text, self.where, what, comma=True)

    def whole(self, what: str, least: int, most: int) -> int:
        return whole(self.number(what), self.where, what, least, most)

    def numbers(self, count: int, what: str) -> list[float]:
        return [self.number(f"{what} {i} of {count}") for i in range(1, count + 1)]


def read(path: Path, lamp_set: int | None = None) -> Photometry:
    """Read a EULUMDAT file.

    Args:
        lamp_set: the number of the lamp set that is mounted; None: the first, with a note where there are several.

    Raises:
        SceneError: it is none, or damaged; the message names the line and the value.
    """
    source, notes = str(path), []
    lines = lines_of(path)
    while lines and not lines[-1].strip():
        lines.pop()
    file = _Lines(source, lines)
    manufacturer = printable(file.text("the manufacturer"))
    file.whole("the type (Ityp)", 0, 3)
    symmetry = file.whole("the symmetry (Isym)", 0, 4)
    n_planes = file.whole("the number of planes C (Mc)", 1, MOST_ANGLES)
    file.number("the distance of the planes (Dc)", 0.0)
    n_gamma = file.whole("the number of angles (Ng)", 2, MOST_ANGLES)
    file.number("the distance of the angles (Dg)", 0.0)
    file.text("the report")
    name = printable(file.text("the luminaire's name"))
    for what in ("the luminaire's number", "the file name", "the date"):
        file.text(what)
    for what in ("the length", "the width", "the height"):
        file.number(f"{what} of the luminaire", 0.0)
    sizes = [file.number(f"the {what} of the luminous area", 0.0) for what in ("length", "width", *("height",) * 4)]
    downward = file.number("the downward flux fraction (DFF)", 0.0)
    efficiency = file.number("the light output ratio (LORL)", 0.0)
    conversion = file.number("the conversion factor")
    if not conversion > 0:
        raise SceneError(f"{file.where}: the conversion factor is {conversion:g}; it must be above zero")
    tilt = file.number("the tilt at measurement", 0.0)
    if tilt:
        notes.append(
            f"was measured at a tilt of {tilt:g} degrees; its intensities are taken as they are, gamma = 0 along its aim"
        )
    lumens, absolute, watts = _lamps(file, lamp_set, notes)
    file.numbers(RATIOS, "direct ratio")
    web = _web(file, symmetry, n_planes, n_gamma, conversion * lumens / 1000, notes)
    if len(lines) > file.at:
        notes.append(f"{len(lines) - file.at} lines follow the last intensity; they are left out")
    stated = lumens * efficiency / 100 if efficiency > 0 else (lumens if absolute else np.nan)
    _compare(web, stated, downward, notes)
    size, disc = _size(sizes)
    return Photometry(web, web.flux, stated, size, disc, name or path.stem, manufacturer, watts, source, tuple(notes))


def _lamps(file: _Lines, lamp_set: int | None, notes: list[str]) -> tuple[float, bool, float]:
    """Return the flux of all lamps of the set that counts, whether photometry is absolute, and its watts."""
    count = file.whole("the number of lamp sets", 1, MOST_SETS)
    sets = []
    for i in range(1, count + 1):
        lamps = file.number(f"the number of lamps of set {i}", 0.0)
        file.text(f"the lamps' type of set {i}")
        lumens = file.number(f"the flux of all lamps of set {i}")
        if not lumens > 0:
            raise SceneError(f"{file.where}: the flux of all lamps of set {i} is {lumens:g}; it must be above zero")
        file.text(f"the colour of set {i}")
        file.text(f"the colour rendering of set {i}")
        watts = _watts(file.text(f"the watts of set {i}"))
        sets.append((lumens, lamps < 0, watts))
    if lamp_set is not None and not 1 <= lamp_set <= count:
        raise SceneError(f"{file.source}: has {count} lamp sets; there is no set {lamp_set}")
    if count > 1 and lamp_set is None:
        fluxes = ", ".join(f"{lumens:g}" for lumens, _, _ in sets)
        notes.append(f"has {count} lamp sets, of {fluxes} lm; the first is taken (lamp_set = another one)")
    return sets[(lamp_set or 1) - 1]


def _watts(text: str) -> float:
    """Return watts, NaN where the line has none: light does not depend on them."""
    try:
        return float(text.replace(",", "."))
    except ValueError:
        return float("nan")


def _web(file: _Lines, symmetry: int, n_planes: int, n_gamma: int, factor: float, notes: list[str]) -> Web:
    """Read the angles and the intensities, per 1000 lm of the lamps, of those planes that the file gives."""
    planes = checked_angles(file.numbers(n_planes, "plane C"), "the planes C", 0, 360, file.source)
    gamma = checked_angles(file.numbers(n_gamma, "angle"), "the angles", 0, 180, file.source)
    given = _given(symmetry, planes, file.source)
    values = file.numbers(len(given) * n_gamma, "intensity")
    table = np.array(values, np.float64).reshape(len(given), n_gamma) * factor
    table = checked_intensities(table, (given, gamma), file.source, notes)
    if symmetry == 0 and given[-1] < 360 and len(given) > 1:
        given, table = np.append(given, 360.0), np.concatenate([table, table[:1]])  # the format leaves the plane 360 out
    elif symmetry == 3:  # from 270 on through 0 to 90: plane 180 - C is plane C
        given, table = 180 - given[::-1], table[::-1]
    return unfolded(given, gamma, table, file.source, notes)


def _given(symmetry: int, planes: np.ndarray, source: str) -> np.ndarray:
    """Return the planes whose intensities a file gives, degrees.

    Raises:
        SceneError: there are not as many planes as the symmetry needs.
    """
    n = len(planes)
    if symmetry == 1:
        return planes[:1]
    if symmetry == 0:
        return planes
    parts = 4 if symmetry in (3, 4) else 2
    if n % parts:
        raise SceneError(f"{source}: has {n} planes C; its symmetry (Isym {symmetry}) needs a multiple of {parts}")
    if symmetry == 3:
        return np.concatenate([planes[3 * n // 4 :] - 360, planes[: n // 4 + 1]])
    return planes[: n // parts + 1]


def _compare(web: Web, stated: float, downward: float, notes: list[str]) -> None:
    """Hold the flux of the intensities, and its downward part, against what the file says."""
    if differs(stated, web.flux):
        notes.append(f"states {stated:.5g} lm, and its intensities make {web.flux:.5g} lm, which are taken")
    below = 100 * web.flux_below(90.0) / web.flux
    if downward > 0 and abs(below - downward) > POINTS:
        notes.append(f"states that {downward:.4g} % of its light goes down, and its intensities send {below:.4g} % there")


def _size(sizes: list[float]) -> tuple[np.ndarray, bool]:
    """Return the luminous size in metres: the length is along C = 90. Without a width the area is round."""
    length, width, *heights = (abs(value) / 1000 for value in sizes)
    disc = width == 0 and length > 0
    return np.array([length if disc else width, length, max(heights)]), disc
