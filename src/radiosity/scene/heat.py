"""What a scene says about heat: temperatures, heat flows and emissivities of surfaces, and the surroundings."""

from dataclasses import dataclass, field

import numpy as np

HOTTEST = 1e6  # K; a larger number is an error of units, or of typing


@dataclass(frozen=True, eq=False)
class Heat:
    """Conditions of the surfaces of a scene. Light does not depend on them.

    Attributes:
        temperature: (n_surfaces,) K, NaN where the scene gives none.
        flux: (n_surfaces,) W that a whole surface gets from elsewhere and gives off, 0 where it is adiabatic, NaN where the scene
            gives none.
        emissivity: for each surface one number, or one for each band; None where the scene gives none.
        isothermal: (n_surfaces,) bool, surfaces that are one temperature where it is not given.
        surroundings: K, of the black surroundings of what escapes; None where the scene gives none.
        wavelengths: edges between the bands, µm, ascending; none: one band.
    """

    temperature: np.ndarray
    flux: np.ndarray
    emissivity: tuple[tuple[float, ...] | None, ...]
    isothermal: np.ndarray
    surroundings: float | None = None
    wavelengths: tuple[float, ...] = field(default=())

    @staticmethod
    def none(n: int) -> "Heat":
        """Make what a scene of n surfaces says that says nothing."""
        return Heat(np.full(n, np.nan), np.full(n, np.nan), (None,) * n, np.zeros(n, bool))
