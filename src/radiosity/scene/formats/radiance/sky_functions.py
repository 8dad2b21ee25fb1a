"""The skies that Radiance's programs gensky and gendaylit write, as tables: their formulas are those of the library's .cal files.

Sky and ground run into each other near the horizon, as there.
"""

from collections.abc import Callable

import numpy as np

from ...lights.axes import sky_axes
from ...lights.sky import row_sines
from .primitives import Primitive

ROWS, COLUMNS = 182, 180  # of a table: a degree of elevation, two of azimuth


def factors(pattern: Primitive) -> np.ndarray | None:
    """The factors by which a pattern multiplies the light of directions, (ROWS, COLUMNS); None where it is no sky known here.

    Azimuths begin in the north, y, and turn to the east, x; z is up.
    """
    if pattern.kind != "brightfunc" or len(pattern.words) != 2:
        return None
    numbers = np.array(pattern.numbers)
    name, file = pattern.words
    if file == "skybright.cal" and name in ("skybr", "skybright"):
        function = _of_the_cie(numbers)
    elif file == "perezlum.cal" and name == "skybright" and len(numbers) == 10:
        function = _of_perez(numbers)
    else:
        return None
    if function is None:
        return None
    z = row_sines(ROWS)[:, None]
    angle = 2 * np.pi * np.arange(COLUMNS) / COLUMNS
    level = np.sqrt(1 - z**2)
    directions = np.stack(np.broadcast_arrays(level * np.cos(angle), level * np.sin(angle), z), axis=-1) @ sky_axes()
    return np.maximum(function(directions), 0)


Function = Callable[[np.ndarray], np.ndarray]


def _of_the_cie(numbers: np.ndarray) -> Function | None:
    kind = int(numbers[0]) if len(numbers) else 0
    if kind not in KINDS or len(numbers) < (7 if kind in (1, 4) else 3):
        return None
    return lambda directions: _blended(directions[..., 2], KINDS[kind](directions, numbers), numbers[2])


def _blended(z: np.ndarray, sky: np.ndarray, ground: float) -> np.ndarray:
    """The sky above the horizon and the ground below, with a soft step between them."""
    one, other = (z + 1.01) ** 10, (z + 1.01) ** -10
    return (one * sky + other * ground) / (one + other)


def _clear(directions: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    cosine, angle = _to_sun(directions, numbers[4:7])
    z = directions[..., 2]
    haze = np.where(z > 0.01, 1 - np.exp(-0.32 / np.maximum(z, 0.01)), 1.0)
    return numbers[1] * (0.91 + 10 * np.exp(-3 * angle) + 0.45 * cosine**2) * haze / numbers[3]


def _overcast(directions: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    return numbers[1] * (1 + 2 * directions[..., 2]) / 3


def _uniform(directions: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    return np.full(directions.shape[:-1], numbers[1])


def _intermediate(directions: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    _, angle = _to_sun(directions, numbers[4:7])
    zenith, eta = np.arccos(np.clip(numbers[6], -1, 1)), np.arccos(np.clip(directions[..., 2], -1, 1))
    level = ((1.35 * np.sin(5.631 - 3.59 * eta) + 3.12) * np.sin(4.396 - 2.6 * zenith) + 6.37 - eta) / 2.326
    return numbers[1] * level * np.exp(-0.563 * angle * ((2.629 - eta) * (1.562 - zenith) + 0.812)) / numbers[3]


KINDS = {1: _clear, 2: _overcast, 3: _uniform, 4: _intermediate}


def _of_perez(numbers: np.ndarray) -> Function:
    diffuse, ground, a, b, c, d, e = numbers[:7]

    def function(directions: np.ndarray) -> np.ndarray:
        z = directions[..., 2]
        cosine, angle = _to_sun(directions, numbers[7:])
        gradation = 1 + a * np.exp(b / np.maximum(z, 0.01))
        return _blended(z, diffuse * gradation * (1 + c * np.exp(d * angle) + e * cosine**2), ground)

    return function


def _to_sun(directions: np.ndarray, sun: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The cosine of the angle to the sun, and the angle in radians."""
    cosine = directions @ sun
    return cosine, np.arccos(np.clip(cosine, -1, 1))
