"""What a luminaire file says: the web of intensities, the flux that it states, and the luminous size."""

from dataclasses import dataclass

import numpy as np

from .tilt import Tilt
from .web import Web

AGREE = 0.02  # share by which a file's stated flux may differ from that of its intensities without a word


@dataclass(frozen=True, eq=False)
class Photometry:
    """The measured light of a luminaire. `load_photometry` reads it, and `read_luminaire` places it in a scene.

    Attributes:
        web: intensities in cd, with everything applied that the file multiplies them by.
        flux: lm, the integral of the intensities over all directions. This is what the luminaire sends.
        stated: lm that the file says the luminaire sends; NaN where it does not.
        size: (3,) m, the luminous size along C = 0, along C = 90, and in height; zeros where the file gives none.
        disc: the luminous area is round.
        name, manufacturer: as in the file, or "".
        watts: electric power, or NaN.
        source: the file.
        notes: what was found that differs from what the file says, or is left out.
        tilt: factors of the lamp's light where the luminaire is not aimed straight down; None: it is the same.

    Example:
        >>> import pathlib
        >>> web = ["TILT=NONE", "1 -1 1 3 1 1 2 0.2 0.2 0", "1 1 15", "0 45 90", "0", "600 300 0"]
        >>> _ = pathlib.Path("downlight.ies").write_text("\\n".join(["IESNA:LM-63-2002", *web]))
        >>> photometry = rd.load_photometry("downlight.ies")
        >>> photometry.watts, photometry.size.tolist(), photometry.notes
        (15.0, [0.2, 0.2, 0.0], ())
    """

    web: Web
    flux: float
    stated: float
    size: np.ndarray
    disc: bool
    name: str
    manufacturer: str
    watts: float
    source: str
    notes: tuple[str, ...] = ()
    tilt: Tilt | None = None


def differs(stated: float, found: float) -> bool:
    """Return whether two fluxes are more than 2 % apart."""
    return bool(abs(found - stated) > AGREE * abs(stated))
