"""Exchange areas A_i F_ij of polygons that see each other whole, by two integrals along their rims.

    A_i F_ij = 1 / (2 pi) sum over edges e of i and f of j of cos(e, f) times the integral of ln r over e and f

(E. M. Sparrow, "A new and simpler formulation for radiative angle factors", J. Heat Transfer 85, 1963). P. Schröder and
P. Hanrahan, "On the form factor between two polygons", SIGGRAPH 1993, give a closed form in dilogarithms; here one of the two
integrals is numerical where edges are not parallel, see `edges`.
"""

import numpy as np

from .edges import Edges, logarithm
from .short_axes import lengths

SQUARE = 1e-14  # cosine: edges whose cosine is smaller add less than rounding


def around(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return A_i F_ij, (m,), in units of length squared.

    Args:
        one, other: (m, k, 3) corners counterclockwise seen from the radiating side, each polygon in front of the other; corners
            may be repeated. Lengths should be about 1.
    """
    m, k, n = len(one), one.shape[1], other.shape[1]
    pair, e, f = (x.ravel() for x in np.indices((m, k, n)))
    first, second = np.roll(one, -1, axis=1) - one, np.roll(other, -1, axis=1) - other
    dot = np.einsum("mex,mfx->mef", first, second).ravel()
    both = (lengths(first)[:, :, None] * lengths(second)[:, None, :]).ravel()
    count = np.flatnonzero((np.abs(dot) > SQUARE * both) & (both > 0))
    pair, e, f, cosine = pair[count], e[count], f[count], dot[count] / both[count]
    edges = [Edges.of(p[pair, i], p[pair, (i + 1) % p.shape[1]]) for p, i in ((one, e), (other, f))]
    return np.bincount(pair, weights=cosine * logarithm(*edges), minlength=m) / (2 * np.pi)
