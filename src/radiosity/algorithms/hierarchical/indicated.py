"""The errors that links may add up to, as the refinement judges them."""

import numpy as np

from .exchange import Exchange
from .levels import Levels
from .links import Links
from .oracle import Radiosity
from .rounds import ROUGH, Rounds


def indicated(rounds: Rounds) -> np.ndarray:
    """Return the indicated errors of irradiance of the patches, (n_patches, n_bands) W/m² or lm/m².

    The errors of all links are summed without their signs and sent on as light is (equation 6 of the paper): far above the true
    error. NaN for brightness-factor, which gives no error.
    """
    levels, links, reflectance = rounds.levels, rounds.links, rounds.reflectance
    if not rounds.oracle.by_error:
        return np.full_like(rounds.irradiance, np.nan)
    radiosity = Radiosity.of(levels, rounds.emission + reflectance * rounds.irradiance)
    here, there = rounds.oracle.parts(links, radiosity)
    own = _reaching(levels, links, here + there)
    return own + Exchange(levels, links).solve(reflectance * own, reflectance, np.zeros_like(own), ROUGH, rounds.told)


def _reaching(levels: Levels, links: Links, errors: np.ndarray) -> np.ndarray:
    """Return the sum of the errors of all links that reach a patch, (n_patches, n_bands)."""
    columns = [np.bincount(links.receiver, weights=band, minlength=len(levels.area)) for band in errors.T]
    return levels.push(np.stack(columns, axis=1))
