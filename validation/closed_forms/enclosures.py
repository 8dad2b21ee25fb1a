"""Exact exchange in closed rooms: a matrix of form factors, or a radiosity that is the same everywhere."""

import numpy as np


def net(areas, factors, emissivity, blackbody) -> np.ndarray:
    """(n,) W that each of n diffuse grey surfaces of uniform radiosity loses: A (B - H).

    Args:
        areas: (n,) m². factors: (n, n), rows sum to one.
        emissivity, blackbody: (n,), what a black surface would emit there, W/m².
    """
    areas, factors, emissivity, blackbody = (np.asarray(x, float) for x in (areas, factors, emissivity, blackbody))
    radiosity = np.linalg.solve(np.eye(len(areas)) - (1 - emissivity)[:, None] * factors, emissivity * blackbody)
    return areas * (radiosity - factors @ radiosity)


def two_spheres(inner: float, outer: float, emissivity: tuple[float, float], blackbody: tuple[float, float]) -> float:
    """W from the inner to the outer of two concentric grey spheres: the network of three resistances in series."""
    one, other = 4 * np.pi * inner**2, 4 * np.pi * outer**2
    resistance = (1 - emissivity[0]) / (emissivity[0] * one) + 1 / one + (1 - emissivity[1]) / (emissivity[1] * other)
    return float((blackbody[0] - blackbody[1]) / resistance)


def parallel_plates(emissivity: tuple[float, float], blackbody: tuple[float, float]) -> float:
    """W/m² between infinite parallel grey plates."""
    return (blackbody[0] - blackbody[1]) / (1 / emissivity[0] + 1 / emissivity[1] - 1)


def spherical_cavity(wall: float, reflectance: float, emission: float) -> float:
    """W that leave through the opening of a cavity that is a sphere of radius one but for a cap: ``wall`` is the wall's share of
    the sphere's area. From everywhere on the wall to an area the form factor is the area over the sphere's, so that the
    irradiance is the same everywhere."""
    radiosity = emission / (1 - reflectance * wall)
    return float(4 * np.pi * wall * radiosity * (1 - wall))


def box_factors(sides: tuple[float, float, float], parallel, perpendicular) -> tuple[np.ndarray, np.ndarray]:
    """Areas (6,) and form factors (6, 6) of a box's walls: x low, x high, y low, y high, z low, z high.

    Args:
        parallel, perpendicular: A F of opposed rectangles a x b at unit distance, and of rectangles of widths a and b with a
            common edge of length one.
    """
    areas = np.repeat([np.prod(sides) / s for s in sides], 2)
    exchange = np.zeros((6, 6))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        d = sides[i]
        exchange[2 * i, 2 * i + 1] = exchange[2 * i + 1, 2 * i] = d * d * parallel(sides[j] / d, sides[k] / d)
        edge = sides[k]  # common to walls across i and across j
        value = edge * edge * perpendicular(sides[j] / edge, sides[i] / edge)
        for one in (2 * i, 2 * i + 1):
            for other in (2 * j, 2 * j + 1):
                exchange[one, other] = exchange[other, one] = value
    return areas, exchange / areas[:, None]


def prism_factors(angle: float, sides: tuple[float, float], length: float, inclined) -> tuple[np.ndarray, np.ndarray]:
    """Areas (5,) and form factors (5, 5) of a triangular prism: walls a, b with ``angle`` between them, the third wall, two ends.

    The two ends are alike, so that what walls do not give each other is halved between them, and the rest is closure.
    """
    a, b = sides
    c = np.sqrt(a * a + b * b - 2 * a * b * np.cos(angle))
    widths = np.array([a, b, c])
    angles = {(0, 1): angle, (0, 2): _angle(a, c, b), (1, 2): _angle(b, c, a)}
    end = a * b * np.sin(angle) / 2
    areas = np.array([*(widths * length), end, end])
    exchange = np.zeros((5, 5))
    for (i, j), between in angles.items():
        exchange[i, j] = exchange[j, i] = length**2 * inclined(widths[i] / length, widths[j] / length, between)
    for i in range(3):
        exchange[i, 3:] = exchange[3:, i] = (areas[i] - exchange[i, :3].sum()) / 2
    exchange[3, 4] = exchange[4, 3] = end - exchange[3, :3].sum()
    return areas, exchange / areas[:, None]


def _angle(one: float, other: float, opposite: float) -> float:
    """Between two sides of a triangle."""
    return float(np.arccos((one**2 + other**2 - opposite**2) / (2 * one * other)))
