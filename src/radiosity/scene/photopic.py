"""Red, green and blue as one value: what the eye sees of them."""

import numpy as np

RGB = ("red", "green", "blue")
PHOTOPIC = np.array([0.2126, 0.7152, 0.0722])  # of linear red, green and blue (ITU-R BT.709)


def photopic(scene, values: np.ndarray) -> np.ndarray | None:
    """Return illuminance (or another quantity of light) from values of three bands, (..., 3), as (...).

    It is None where the scene's bands are not red, green and blue, or where it is not photometric.
    """
    return values @ PHOTOPIC if scene.photometric and tuple(scene.bands) == RGB else None
