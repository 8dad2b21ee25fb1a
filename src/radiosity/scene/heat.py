"""What a scene says about heat: temperatures, heat flows and emissivities of surfaces, and the surroundings."""

from dataclasses import dataclass, field

import numpy as np

MOST_EDGES = 100  # between bands of wavelength
SIDES = ("front", "back")
Emissivity = tuple[float, ...] | dict[str, tuple[float, ...]]  # one number, or one for each band; or so for each side
HOTTEST = 1e6  # K; a larger number is an error of units, or of typing


@dataclass(frozen=True, eq=False)
class Heat:
    """Conditions of the surfaces of a scene. Light does not depend on them.

    Attributes:
        temperature: (n_surfaces,) K, NaN where the scene gives none.
        flux: (n_surfaces,) W that a whole surface gets from elsewhere and gives off, 0 where it is adiabatic, NaN where the scene
            gives none.
        emissivity: for each surface one number, or one for each band, or a dictionary of them by side ("front", "back"); None
            where the scene gives none.
        isothermal: (n_surfaces,) bool, surfaces that are one temperature where it is not given.
        surroundings: K, of the black surroundings of what escapes; None where the scene gives none.
        wavelengths: edges between the bands, µm, ascending; none: one band.
    """

    temperature: np.ndarray
    flux: np.ndarray
    emissivity: tuple[Emissivity | None, ...]
    isothermal: np.ndarray
    surroundings: float | None = None
    wavelengths: tuple[float, ...] = field(default=())

    @staticmethod
    def none(n: int) -> "Heat":
        """Make what a scene of n surfaces says that says nothing."""
        return Heat(np.full(n, np.nan), np.full(n, np.nan), (None,) * n, np.zeros(n, bool))

    def facts(self) -> dict:
        """Return the conditions as text of files can hold them; unknown numbers are None."""
        return {
            "temperature": [None if np.isnan(value) else float(value) for value in self.temperature],
            "flux": [None if np.isnan(value) else float(value) for value in self.flux],
            "emissivity": self.emissivity,
            "isothermal": self.isothermal.tolist(),
            "surroundings": self.surroundings,
            "wavelengths": self.wavelengths,
        }

    @staticmethod
    def of(facts: dict) -> "Heat":
        """Make the conditions that `facts` gave."""
        one, other = (np.array([np.nan if v is None else v for v in facts[key]], float) for key in ("temperature", "flux"))
        emissivity = tuple(_emissivity(value) for value in facts["emissivity"])
        isothermal = np.array(facts["isothermal"], bool)
        return Heat(one, other, emissivity, isothermal, facts["surroundings"], tuple(facts["wavelengths"]))


def _emissivity(value) -> Emissivity | None:
    if isinstance(value, dict):
        return {side: tuple(values) for side, values in value.items()}
    return None if value is None else tuple(value)
