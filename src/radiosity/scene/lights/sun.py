"""A sun: light from one direction."""

from dataclasses import dataclass

import numpy as np

DIAMETER = 0.533  # degrees, of the sun as seen from the Earth


@dataclass(frozen=True, eq=False)
class Sun:
    """Light from a small disc of equal radiance, as far away as the stars.

    Attributes:
        name: of the light.
        direction: (3,) float64, of unit length, towards the sun.
        irradiance: (n_bands,) float64, W/m² or lm/m², on a plane that is perpendicular to the direction.
        diameter: degrees, of the disc; 0: parallel light.
        photometric: its irradiance is in lm/m², not W/m².
    """

    name: str
    direction: np.ndarray
    irradiance: np.ndarray
    diameter: float = DIAMETER
    photometric: bool = True
