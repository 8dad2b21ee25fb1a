"""View factors F from the first to the second of two bodies of which one is a disc, a cylinder or a sphere.

Derived from the disc's point factor, from reciprocity and closure, from H. C. Hottel's crossed strings, and from the sphere being
seen from everywhere as a point source; most are also in J. R. Howell's catalogue, whose numbers are given where we know them.
"""

import numpy as np

from .rectangles import discs


def disc_to_disc(first: float, second: float, distance: float) -> float:
    """Coaxial parallel discs (C-41)."""
    return float(discs(first, second, distance) / (np.pi * first**2))


def disc_to_ring(first: float, inner: float, outer: float, distance: float) -> float:
    """A disc to a coaxial parallel ring: the difference of two discs."""
    return disc_to_disc(first, outer, distance) - disc_to_disc(first, inner, distance)


def ring_to_ring(first: tuple[float, float], second: tuple[float, float], distance: float) -> float:
    """Coaxial parallel rings (inner and outer radius): four discs."""
    (a, b), (c, d) = first, second
    total = discs(b, d, distance) - discs(b, c, distance) - (discs(a, d, distance) - discs(a, c, distance))
    return float(total / (np.pi * (b * b - a * a)))


def base_to_wall(radius: float, height: float) -> float:
    """A cylinder's base to its inside: what does not reach the other base."""
    return 1 - disc_to_disc(radius, radius, height)


def wall_to_itself(radius: float, height: float) -> float:
    """The inside of a cylinder, open at both ends, to itself: by closure with both bases."""
    return 1 - base_to_wall(radius, height) * radius / height


def outer_to_inner(inner: float, outer: float, height: float) -> float:
    """Coaxial cylinders of equal height, the inside of the outer one to the outside of the inner one."""
    r, h = outer / inner, height / inner
    a, b = h * h + r * r - 1, h * h - r * r + 1
    turn = np.arccos(b / a)
    turn -= (np.sqrt((a + 2) ** 2 - 4 * r * r) * np.arccos(b / (r * a)) + b * np.arcsin(1 / r) - np.pi * a / 2) / (2 * h)
    return float((1 - turn / np.pi) / r)


def cylinder_to_cylinder(gap: float, radius: float = 1.0) -> float:
    """Infinitely long parallel cylinders of one radius, ``gap`` apart: crossed strings."""
    x = 1 + gap / (2 * radius)
    return float((np.sqrt(x * x - 1) + np.arcsin(1 / x) - x) / np.pi)


def strip_to_cylinder(left: float, right: float, height: float, radius: float) -> float:
    """An infinitely long strip from x = left to right to a parallel cylinder whose axis is at x = 0, ``height`` above it."""
    return float(radius / (right - left) * (np.arctan(right / height) - np.arctan(left / height)))


def sphere_to_disc(radius: float, distance: float) -> float:
    """A sphere of any size to a disc of this radius whose axis goes through its centre, ``distance`` away: the share of the
    solid angle, since a sphere is seen as a point source."""
    return float((1 - 1 / np.sqrt(1 + (radius / distance) ** 2)) / 2)


def sphere_to_rectangle(width: float, height: float, distance: float) -> float:
    """A sphere of any size to a rectangle, one corner of which is the foot of the perpendicular from the centre."""
    return float(np.arctan(width * height / (distance * np.sqrt(width**2 + height**2 + distance**2))) / (4 * np.pi))
