"""View factors with closed forms (J. R. Howell, "A catalog of radiation heat transfer configuration factors")."""

import numpy as np
from scipy.integrate import quad as integral


def parallel(a: float, b: float) -> float:
    """A F of equal opposed rectangles a x b at unit distance (C-11)."""
    x, y = 1 + a * a, 1 + b * b
    total = np.log(np.sqrt(x * y / (1 + a * a + b * b))) - a * np.arctan(a) - b * np.arctan(b)
    total += a * np.sqrt(y) * np.arctan(a / np.sqrt(y)) + b * np.sqrt(x) * np.arctan(b / np.sqrt(x))
    return 2 / np.pi * total


def perpendicular(width: float, height: float) -> float:
    """A F between rectangles that stand square on each other, with a common edge of length one (C-14)."""
    w, h = width, height
    s = h * h + w * w
    total = w * np.arctan(1 / w) + h * np.arctan(1 / h) - np.sqrt(s) * np.arctan(1 / np.sqrt(s))
    logs = np.log((1 + w * w) * (1 + h * h) / (1 + s))
    logs += w * w * np.log(w * w * (1 + s) / ((1 + w * w) * s)) + h * h * np.log(h * h * (1 + s) / ((1 + h * h) * s))
    return (total + logs / 4) / np.pi


def inclined(a: float, b: float, angle: float) -> float:
    """A F between rectangles of widths a and b with a common edge of length one, at an angle in radians (C-16)."""
    sine, cosine, double = np.sin(angle), np.cos(angle), np.sin(2 * angle)
    c = a * a + b * b - 2 * a * b * cosine
    turn = a * b * sine + (np.pi / 2 - angle) * (a * a + b * b)
    turn += b * b * np.arctan((a - b * cosine) / (b * sine)) + a * a * np.arctan((b - a * cosine) / (a * sine))
    logs = (2 / sine**2 - 1) * np.log((1 + a * a) * (1 + b * b) / (1 + c))
    logs += b * b * np.log(b * b * (1 + c) / (c * (1 + b * b)))
    logs += a * a * np.log(a * a * (1 + a * a) ** np.cos(2 * angle) / (c * (1 + c) ** np.cos(2 * angle)))

    def along(x: float, other: float) -> float:
        root = np.sqrt(1 + x * x * sine * sine)
        return root * (np.arctan(x * cosine / root) + np.arctan((other - x * cosine) / root))

    total = -double / 4 * turn + sine**2 / 4 * logs
    total += b * np.arctan(1 / b) + a * np.arctan(1 / a) - np.sqrt(c) * np.arctan(1 / np.sqrt(c))
    total += sine * double / 2 * a * along(a, b)
    total += cosine * integral(along, 0, b, args=(a,), epsabs=1e-13, epsrel=1e-12)[0]
    return total / np.pi


def discs(first: float, second: float, distance: float) -> float:
    """A F between coaxial parallel discs (C-41)."""
    r1, r2 = first / distance, second / distance
    x = 1 + (1 + r2 * r2) / (r1 * r1)
    return np.pi * first**2 * (x - np.sqrt(x * x - 4 * (r2 / r1) ** 2)) / 2
