"""A luminaire: a lamp at a point, or with a luminous size."""

from dataclasses import dataclass

import numpy as np

from .web import Web


@dataclass(frozen=True, eq=False)
class Luminaire:
    """A lamp whose light leaves from a point, as a web of intensities says. `read_luminaire` and `point_light` make one.

    Attributes:
        name: of the luminaire.
        position: (3,) float64, m.
        axes: (3, 3) float64, rows of unit length: the directions of C = 0, of C = 90, and of gamma = 0.
        web: how it shares its light among directions.
        power: (n_bands,) float64, lm or W that it sends in all directions together.
        size: (3,) float64, m: the luminous length along C = 0, width along C = 90, and height; zeros where it is not known.
        group: luminaires of a group are dimmed together.
        source: the file that the web is from, or "".
        soft: light leaves from all of the luminous area (length by width, perpendicular to gamma = 0), so that shadows are soft;
            False: from its middle.
        disc: the luminous area is an ellipse in that rectangle.
        photometric: its power is in lm, not W.

    Example:
        >>> lamp = rd.point_light(position=(1, 1, 2), lumens=800, name="globe")
        >>> lamp.name, lamp.position.tolist(), lamp.power.tolist()
        ('globe', [1.0, 1.0, 2.0], [800.0])
    """

    name: str
    position: np.ndarray
    axes: np.ndarray
    web: Web
    power: np.ndarray
    size: np.ndarray
    group: str = ""
    source: str = ""
    soft: bool = False
    disc: bool = False

    def towards(self, direction: np.ndarray) -> np.ndarray:
        """Return intensities, (n_bands,) cd or W/sr, in a direction from the luminaire, (3,) of unit length."""
        x, y, z = self.axes @ direction
        plane, gamma = (np.degrees([np.arctan2(*pair)]) for pair in ((y, x), (np.hypot(x, y), z)))
        return self.power * float(self.web.at(plane, gamma)[0] / self.web.flux)

    def projected(self, direction: np.ndarray) -> float:
        """Return the luminous area as seen from a direction, (3,) of unit length, m²: its face, and sides of its height."""
        x, y, z = np.abs(self.axes @ direction)
        length, width, height = self.size
        if self.disc:
            return float(np.pi / 4 * length * width * z + height * np.hypot(width * x, length * y))
        return float(length * width * z + height * (width * x + length * y))

    photometric: bool = True
