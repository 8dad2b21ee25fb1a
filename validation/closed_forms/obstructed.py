"""View factors F of bodies that something stands between, or that stand in each other's way.

Derived from H. C. Hottel's crossed strings, drawn tight round what is between, from closure, and from the sphere being seen as a
point source; see J. R. Howell's catalogue for those of coaxial cylinders and of rows of tubes. `tests/test_catalogue.py` checks
each by numerical integration.
"""

import numpy as np

from .round import outer_to_inner


def tight(one: tuple, other: tuple, radius: float) -> float:
    """The length of a string from one point to another that passes a circle about the origin on its left (x below zero)."""
    p, q = (np.asarray(x, float) for x in (one, other))
    along = (q - p) / np.linalg.norm(q - p)
    across = p[0] * along[1] - p[1] * along[0]  # of the line from the origin: below zero where it passes on the left
    foot = -float(p @ along)
    if across <= -radius or not 0 < foot < np.linalg.norm(q - p):
        return float(np.linalg.norm(q - p))
    ends = [np.sqrt(x @ x - radius**2) for x in (p, q)]
    turns = [np.arccos(radius / np.linalg.norm(x)) for x in (p, q)]  # from each end to where its tangent touches
    start, end = (np.arctan2(-x[1], -x[0]) for x in (p, q))  # angles about the side on the left
    return float(sum(ends) + radius * (abs(start - end) - sum(turns)))


def past_a_cylinder(width: float, distance: float, radius: float) -> float:
    """Infinitely long opposed strips of one width, a cylinder half way between, parallel to them and in their middle."""
    half, rise = width / 2, distance / 2
    corners = {name: (x, y) for name, x, y in (("a", -half, -rise), ("b", half, -rise), ("c", -half, rise), ("d", half, rise))}

    def string(one: str, other: str) -> float:
        return tight(corners[one], corners[other], radius)

    left = string("a", "d") + string("b", "c") - string("a", "c") - string("b", "d")
    return left / width  # as much goes by on the right: twice left / (2 width)


def through_a_slit(width: float, distance: float, slit: float) -> float:
    """Infinitely long opposed strips of one width, with a screen half way between that has a slit in the middle, no wider."""
    return float((np.hypot(width, distance) - np.hypot(width - slit, distance)) / width)


def plane_to_tubes(pitch: float, diameter: float) -> float:
    """An infinite plane to a row of infinitely long parallel tubes, whatever their distance from it."""
    share = diameter / pitch
    return float(1 - np.sqrt(1 - share**2) + share * np.arctan(np.sqrt(1 / share**2 - 1)))


def outer_to_itself(inner: float, outer: float, height: float) -> float:
    """Coaxial cylinders of equal height, the inside of the outer one to itself, past the inner one."""
    r, h = outer / inner, height / inner
    root, more = np.sqrt(4 * r * r + h * h), 4 * (r * r - 1)
    first = root / h * np.arcsin((more + h * h / (r * r) * (r * r - 2)) / (h * h + more))
    turn = first - np.arcsin((r * r - 2) / (r * r)) + np.pi / 2 * (root / h - 1)
    return float(1 - 1 / r + 2 / (np.pi * r) * np.arctan(2 * np.sqrt(r * r - 1) / h) - h / (2 * np.pi * r) * turn)


def end_to_end(inner: float, outer: float, height: float) -> float:
    """Coaxial cylinders of equal height, one annular end to the other, past the inner cylinder: by closure of all four."""
    wall, body, end = 2 * outer * height, 2 * inner * height, outer**2 - inner**2  # areas over pi
    to_body = outer_to_inner(inner, outer, height)
    of_wall = wall * (1 - to_body - outer_to_itself(inner, outer, height)) / 2  # to each end
    of_body = (body - wall * to_body) / 2
    return float(1 - (of_wall + of_body) / end)


def sphere_to_tube(radius: float, height: float) -> float:
    """A sphere of any size to the inside of a cylinder about it, centred on it: the share of the solid angle."""
    return float(height / np.hypot(height, 2 * radius))
