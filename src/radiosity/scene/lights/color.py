"""The colour of a light: its lumens stay, shared among red, green and blue."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...errors import SceneError
from ..photopic import PHOTOPIC
from .frames import point
from .sky import Sky
from .sun import Sun


def bands_of(color: ArrayLike | None, what: str) -> np.ndarray:
    """Return what a flux is multiplied by in each band: 1, or three numbers whose photopic mean is 1.

    Raises:
        SceneError: the colour is none.
    """
    if color is None:
        return np.ones(1)
    values = point(color, "color", what)
    if values.min() < 0 or not values.any():
        raise SceneError(f"{what}: color is {values.tolist()}; expected three numbers, not negative, and one above zero")
    return values / (PHOTOPIC @ values)


def colored(light: Any, color: ArrayLike | None) -> Any:
    """Return a sky or a sun of a colour; None: as it is.

    Raises:
        SceneError: the colour is none, or the light has bands of its own.
    """
    if color is None:
        return light
    key = {Sky: "radiance", Sun: "irradiance"}[type(light)]
    values = getattr(light, key)
    if values.shape[-1] != 1:
        raise SceneError(f"{light.name}: has a colour already, a number for each band; leave color out, or give one number")
    return replace(light, **{key: values * bands_of(color, light.name)})
