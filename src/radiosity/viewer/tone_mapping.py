"""The colours of meshes in the browser: the inverse of the tone mapping that viser's pages do.

viser's pages draw all meshes through the ACES curve of three.js (a fit by S. Hill), unlit ones too: a colour c comes out as
``M_out fit(M_in c / 0.6)``. So meshes are given the colours that come out right. These may be negative or above 1, which vertex
colours in single precision can hold.
"""

import numpy as np

INTO = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
OUT = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])
UP, DOWN = (1.0, 0.0245786, -0.000090537), (0.983729, 0.4329510, 0.238081)  # of the fit: a quotient of two parabolas
EXPOSURE = 0.6


def before(linear: np.ndarray) -> np.ndarray:
    """Return the colours that come out as ``linear``, both (..., 3); those to come out lie in [0, 1]."""
    fitted = np.clip(linear, 0.0, 1.0) @ np.linalg.inv(OUT).T
    a, b, c = (up - down * fitted for up, down in zip(UP, DOWN, strict=True))
    return EXPOSURE * (np.sqrt(b * b - 4 * a * c) - b) / (2 * a) @ np.linalg.inv(INTO).T


def after(given: np.ndarray) -> np.ndarray:
    """Return the linear colours that a page shows where a mesh has the colours ``given``, both (..., 3)."""
    x = given @ INTO.T / EXPOSURE
    top, bottom = (p * x * x + q * x + r for p, q, r in (UP, DOWN))
    return np.clip(top / bottom @ OUT.T, 0.0, 1.0)
