"""The tilt of a luminaire: how much less light its lamp gives where it does not hang straight down (TILT of IES LM-63)."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import SceneError, printable
from .text import Words, lines_of, whole

MOST = 8000
BEYOND = 0.5  # degrees past the last angle of a table that nobody need be told of


@dataclass(frozen=True, eq=False)
class Tilt:
    """Factors of the lamp's light.

    Attributes:
        geometry: 1: the lamp is upright where the luminaire is aimed straight down. 2: it is level, and stays level where the
            luminaire turns about the axis of the zero-degree plane. 3: it is level, and leans with the luminaire.
        angles: (n,) degrees between straight down and where the luminaire is aimed, ascending.
        factors: (n,) of the light.
    """

    geometry: int
    angles: np.ndarray
    factors: np.ndarray

    @property
    def matters(self) -> bool:
        """True where some factor is not 1."""
        return bool((self.factors != 1).any())

    def at(self, angle: float) -> float:
        """Return the factor at an angle, degrees, linear between those of the table; beyond it that of its end."""
        return float(np.interp(angle, self.angles, self.factors))

    def reaches(self, angle: float) -> bool:
        """Return whether the table has an angle as large, and as small."""
        return bool(self.angles[0] - BEYOND <= angle <= self.angles[-1] + BEYOND)


def read_tilt(words: Words) -> Tilt:
    """Read the four entries of TILT=INCLUDE, or of a file of them.

    Raises:
        SceneError: they are damaged; the message names the line and the value.
    """
    geometry = whole(words.take("the lamp's place (TILT)"), words.where, "the lamp's place (TILT)", 1, 3)
    count = whole(words.take("the number of tilts"), words.where, "the number of tilts", 1, MOST)
    angles = np.array(words.several(count, "the angles of TILT"))
    if (np.diff(angles) <= 0).any():
        raise SceneError(f"{words.where}: the angles of TILT do not ascend ({', '.join(f'{x:g}' for x in angles[:8])})")
    factors = np.array(words.several(count, "the factors of TILT"))
    if (factors < 0).any():
        raise SceneError(f"{words.where}: a factor of TILT is {factors.min():g}; it must be 0 or more")
    return Tilt(geometry, angles, factors)


def tilt_of_file(luminaire: Path, name: str, notes: list[str]) -> Tilt | None:
    """Return the tilt of a file that a luminaire file names. It is read from the same folder alone; None: it is not there."""
    path = luminaire.parent / name
    beside = Path(name).name == name and path.is_file() and path.resolve().parent == luminaire.resolve().parent
    if not beside:
        text = f"the lamp's light at other tilts stands in '{printable(name)}', which is not a file of the same folder"
        notes.append(f"{text}: it is left out")
        return None
    return read_tilt(Words.of(lines_of(path), 1, str(path)))
