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
    photometric: bool = True
