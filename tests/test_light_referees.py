"""Referees of light at points: the test cases of CIE 171:2006 that need only diffuse surfaces and clear openings, by their
formulas (the tables of the report have errata), a disc lamp, and the daylight factor of a room.

Integrals over the sky are sums over a window's points, with the sky's formula (ISO 15469:2004) written out here.
"""

from dataclasses import replace

import numpy as np
import pytest
from light_samples import bulb, lit
from test_sensors import ALPHA, agrees, measured

import radiosity as rd
from radiosity.factors.polygons import from_points
from radiosity.scene.lights.web import Web
from radiosity.scene.shapes import box, quad
from radiosity.sensors.target import half_width

GENERAL = {  # gradation a, b and indicatrix c, d, e of ISO 15469:2004
    1: (4.0, -0.70, 0.0, -1.0, 0.0),
    5: (0.0, -1.0, 0.0, -1.0, 0.0),
    7: (0.0, -1.0, 5.0, -2.5, 0.30),
    12: (-1.0, -0.32, 10.0, -3.0, 0.45),
}
SUN = (50.0, 120.0)  # altitude and azimuth
LUX = 10_000.0


def relative(kind, ways: np.ndarray) -> np.ndarray:
    """Radiance of a sky by unit directions (..., 3), of any scale; 0 below the horizon. z is up, y north, x east."""
    height = ways[..., 2]
    if kind == "overcast":
        return np.where(height > 0, 1 + 2 * height, 0)
    a, b, c, d, e = GENERAL[kind]
    altitude, azimuth = np.radians(SUN)
    sun = np.array([np.cos(altitude) * np.sin(azimuth), np.cos(altitude) * np.cos(azimuth), np.sin(altitude)])
    cosine = np.clip(ways @ sun, -1, 1)
    away = np.arccos(cosine)
    around = 1 + c * (np.exp(d * away) - np.exp(d * np.pi / 2)) + e * cosine**2
    return np.where(height > 0, (1 + a * np.exp(b / np.maximum(height, 1e-9))) * around, 0)


def radiance_of(kind, ground: float = 0.0):
    """The sky's radiance by direction where it brings `LUX` to the horizontal, and that of the ground below."""
    z, turn = np.meshgrid((np.arange(1000) + 0.5) / 1000, (np.arange(720) + 0.5) / 720 * 2 * np.pi)
    side = np.sqrt(1 - z**2)
    ways = np.stack([side * np.cos(turn), side * np.sin(turn), z], axis=-1)
    scale = LUX / (relative(kind, ways) * z).mean() / (2 * np.pi)
    return lambda ways: np.where(ways[..., 2] > 0, scale * relative(kind, ways), ground * LUX / np.pi)


def through(window, points, normals, radiance, n: int = 60, hidden=None) -> np.ndarray:
    """What points receive through a parallelogram (4, 3): a sum of radiance x cosine x solid angle over its n x n parts.

    Args:
        hidden: (points, ways) -> bool, what a mask outside covers.
    """
    nodes, weights = np.polynomial.legendre.leggauss(n)
    if hidden is not None:  # light that breaks off wants equal steps
        nodes, weights = (np.arange(n) + 0.5) / n * 2 - 1, np.full(n, 2 / n)
    s, t = np.meshgrid((nodes + 1) / 2, (nodes + 1) / 2)
    first, second = window[1] - window[0], window[3] - window[0]
    spots = (window[0] + s[..., None] * first + t[..., None] * second).reshape(-1, 3)
    area = np.outer(weights, weights).ravel() / 4 * np.linalg.norm(np.cross(first, second))
    facing = np.cross(first, second) / np.linalg.norm(np.cross(first, second))
    found = []
    for point, normal in zip(points, np.broadcast_to(normals, np.shape(points)), strict=True):
        way = spots - point
        distance = np.linalg.norm(way, axis=1)
        way /= distance[:, None]
        light = radiance(way) if hidden is None else np.where(hidden(point, way), 0, radiance(way))
        found.append((light * np.maximum(way @ normal, 0) * np.abs(way @ facing) / distance**2 * area).sum())
    return np.array(found)


def room(size, window, reflectance: float = 0.0) -> tuple:
    """The walls of a closed room without its ``window``, a rectangle (low, high) in the wall y = 0 or in the ceiling."""
    low, high = (np.asarray(corner, float) for corner in window)
    (axis,) = np.flatnonzero(low == high)
    one, other = (i for i in range(3) if i != axis)
    faces = []
    for face in box((0, 0, 0), size, inward=True):
        if not (face[:, axis] == low[axis]).all():
            faces.append(face)
    cuts = [sorted({0.0, low[i], high[i], float(size[i])}) for i in (one, other)]
    for a, b in zip(cuts[0], cuts[0][1:], strict=False):
        for c, d in zip(cuts[1], cuts[1][1:], strict=False):
            if a >= low[one] and b <= high[one] and c >= low[other] and d <= high[other]:
                continue
            corner, first, second = np.zeros(3), np.zeros(3), np.zeros(3)
            corner[[axis, one, other]], first[one], second[other] = (low[axis], a, c), b - a, d - c
            face = quad(corner, first, second)
            inward = np.asarray(size) / 2 - corner
            faces.append(face if np.cross(first, second) @ inward > 0 else face[::-1])
    return "walls", reflectance, 0.0, faces


def corners(window) -> np.ndarray:
    """The corners of a rectangle (low, high), (4, 3)."""
    low, high = (np.asarray(corner, float) for corner in window)
    one, other = (np.eye(3)[i] * (high - low)[i] for i in np.flatnonzero(low != high))
    return quad(low, one, other)


def cie(kind, ground: float = 0.0) -> rd.Scene:
    return rd.cie_sky(kind, LUX, sun=None if kind == "overcast" else SUN, ground=ground)


# ---- 5.2 to 5.5: lamps, flux, glass --------------------------------------------------------------------------------------


def test_5_2_a_point_luminaire_by_its_table():
    """I(C, gamma) cos / d^2 of an asymmetric luminaire that leans, on planes of all kinds: without lines that scatter."""
    planes, gammas = np.array([0.0, 90, 180, 270]), np.array([0.0, 30, 60, 90])
    table = np.array([[900.0, 800, 300, 0], [900, 500, 100, 0], [900, 400, 50, 0], [900, 700, 200, 0]])
    axes = np.linalg.qr(np.random.Generator(np.random.Philox(5)).normal(size=(3, 3)))[0]
    axes *= np.sign(np.linalg.det(axes))
    web = Web(planes, gammas, table)
    lamp = bulb((0.2, -0.1, 2.5), power=web.flux, web=web)
    lamp = rd.Luminaire(lamp.name, lamp.position, axes, lamp.web, lamp.power, lamp.size)
    points = lamp.position + np.random.Generator(np.random.Philox(6)).normal(size=(40, 3))
    way = points - lamp.position
    distance = np.linalg.norm(way, axis=1)
    way /= distance[:, None]
    local = way @ axes.T
    gamma = np.degrees(np.arccos(local[:, 2]))
    turn = np.degrees(np.arctan2(local[:, 1], local[:, 0])) % 360
    before = (turn // 90).astype(int)
    part = turn / 90 - before
    rows = [
        np.array([np.interp(g, gammas, table[i % 4], right=0) for g, i in zip(gamma, before + k, strict=True)]) for k in (0, 1)
    ]
    exact = ((1 - part) * rows[0] + part * rows[1]) / distance**2 * np.maximum(-way[:, 2], 0)
    found = measured(lit(luminaires=(lamp,)), rd.Sensors.of(points, [0, 0, 1]), each=64)
    np.testing.assert_allclose(found.illuminance[:, 0], exact, rtol=2e-3, atol=1e-3 * exact.max())


def test_5_3_a_disc_lamp():
    """Parallel and perpendicular planes: M/2 (1 - (d^2 + h^2 - r^2) / s), and M h / (2 d) ((d^2 + h^2 + r^2) / s - 1)."""
    n, radius, h = 128, 0.6, 1.5
    around = 2 * np.pi * np.arange(n) / n
    rim = radius * np.sqrt(2 * np.pi / n / np.sin(2 * np.pi / n))  # the area of the disc
    ring = np.column_stack([rim * np.cos(around), -rim * np.sin(around), np.full(n, h)])
    parts = [np.stack([[0, 0, h], ring[i], ring[i + 1], ring[(i + 2) % n]]) for i in range(0, n, 2)]
    scene = rd.Scene.from_arrays(np.concatenate(parts), np.arange(2 * n).reshape(-1, 4), 0.0, 300.0, photometric=True)
    d = np.array([0.3, 0.6, 1.0, 2.5, 0.3, 0.6, 1.0, 2.5])
    up, side = np.tile([0, 0, 1.0], (4, 1)), np.tile([-1.0, 0, 0], (4, 1))
    s = np.sqrt((d**2 + h**2 + radius**2) ** 2 - 4 * radius**2 * d**2)
    level = 150 * (1 - (d**2 + h**2 - radius**2) / s)
    upright = 150 * h / d * ((d**2 + h**2 + radius**2) / s - 1)
    exact = np.where(np.arange(8) < 4, level, upright)
    points = np.column_stack([d, 0 * d, 0 * d])
    far = d > radius  # nearer, part of the disc lies behind an upright plane
    keep = (np.arange(8) < 4) | far
    found = measured(scene, rd.Sensors.of(points[keep], np.concatenate([up, side])[keep]))
    assert agrees(found, exact[keep], 0.02)


@pytest.mark.parametrize("kind", ["overcast", 12])
def test_5_4_the_flux_of_an_opening_arrives(kind):
    """Black walls absorb what a hole of 1 m2 in the roof lets in: the lux of the horizontal outside."""
    window = ((1.5, 1.0, 3), (2.5, 2.0, 3))
    scene = lit(room((4, 3, 3), window)).with_lights(sky=cie(kind), openings=[corners(window)])
    inside = rd.solve(rd.subdivide(scene, cells=2), "gather", rays=400_000)
    flux = inside.irradiance[:, 0] @ inside.patches.area
    outside = inside.irradiance[0, 0] * inside.patches.area[0]  # of the pebble: it faces up beside the room
    assert inside.patches.scene.names[inside.patches.scene.surface[inside.patches.face[0]]] == "pebble"
    assert flux - 4 * outside == pytest.approx(LUX, rel=0.01)


@pytest.mark.parametrize("light", ["lamp", "parallel"])
def test_5_5_panes_have_one_transmittance(light):
    """CIE's clear glass lets less through at oblique angles; panes here let the same share through at all. All rays from a sensor
    to a point lamp, or to a sun without a disc, are one line: each has a fate of its own."""
    pane = rd.Scene.from_arrays(
        quad((-20, -20, 1), (40, 0, 0), (0, 40, 0)), [[0, 1, 2, 3]], 0.0, 0.0, names=["pane"], transmittance=0.8, two_sided=True
    )
    d = np.array([0.0, 1, 3, 8])
    if light == "lamp":
        exact = 0.8 * 100 * 2 / (4 + d**2) ** 1.5
        scene = pane.with_lights([rd.point_light(position=(0, 0, 2), intensity=100)])
    else:
        exact = np.full(4, 0.8 * 600.0)
        scene = pane.with_lights(suns=[rd.sun(1000, direction=(0.8, 0, 0.6), diameter=0)])
    found = measured(scene, rd.Sensors.of(np.column_stack([d, 0 * d, 0 * d])), each=1 << 13)
    assert agrees(found, exact, 0.05)
    assert (found.standard_error > 1e-4 * found.illuminance).all()
    np.testing.assert_allclose(found.illuminance[:, 0], exact, rtol=0.02)


# ---- 5.6 to 5.8: reflections ----------------------------------------------------------------------------------------------


def test_5_6_and_5_7_light_reflected_by_a_floor_with_and_without_an_obstacle():
    """A floor in parallel light is a lamp of rho E cos: its exact factor, and that of the part which a wall does not hide. The
    light is parallel to the wall, so that it has no shadow."""
    floor, wall = quad((0, 0, 0), (4, 0, 0), (0, 4, 0)), quad((1.5, -50, 0), (0, 100, 0), (0, 0, 1))
    sun = rd.sun(1000, direction=(0, -0.6, 0.8), diameter=0)
    points = np.array([[0.5, 2, 2.5], [0.8, 1, 2], [0, 2, 1.5], [0, 1, 2.9], [1.0, 2, 1.5], [0, 2, 0.5]])
    normals = np.array([[0, 0, -1], [0, 0, -1], [1, 0, 0], [1, 0, 0], [0, 0, -1], [1, 0, 0]], float)
    rest = np.where(points[:, 2] > 1, points[:, 0] + (1.5 - points[:, 0]) * points[:, 2] / (points[:, 2] - 1 + 1e-30), 9)
    part = np.where(points[:, 2] > 1, np.minimum(rest, 4), 4)  # the floor is seen again from here on
    open_floor = 0.7 * 800 * from_points(points, normals, floor[None])
    seen = [
        from_points(p[None], m[None], quad((0, 0, 0), (1.5, 0, 0), (0, 4, 0))[None])[0]
        + (from_points(p[None], m[None], quad((x, 0, 0), (4 - x, 0, 0), (0, 4, 0))[None])[0] if x < 4 else 0)
        for p, m, x in zip(points, normals, part, strict=True)
    ]
    sensors = rd.Sensors.of(points, normals)
    parts = ("floor", 0.7, 0.0, [floor])
    assert agrees(measured(lit(parts, suns=(sun,)), sensors, each=1 << 13), open_floor, 0.02)
    obstacle = ("obstacle", 0.0, 0.0, [wall, wall[::-1]])
    found = measured(lit(parts, obstacle, suns=(sun,)), sensors, each=1 << 13)
    assert agrees(found, 560 * np.array(seen), 0.02)
    assert not agrees(found, open_floor, 0.02)


@pytest.mark.parametrize("reflectance", [0.2, 0.8])
def test_5_8_a_point_lamp_in_a_cube(reflectance):
    """The mean is Phi / (A (1 - rho))."""
    cube = rd.subdivide(
        lit(("walls", reflectance, 0.0, box((0, 0, 0), (4, 4, 4), inward=True)), luminaires=(bulb((1, 2, 2.5), power=1000.0),)),
        cells=3,
    )
    solution = rd.solve(cube, "gather", rays=300_000)
    inside = cube.scene.surface[cube.face] == cube.scene.names.index("walls")
    mean = (solution.irradiance[:, 0] * cube.area)[inside].sum() / cube.area[inside].sum()
    assert mean == pytest.approx(1000 / (96 * (1 - reflectance)), rel=3e-3)


@pytest.mark.parametrize("reflectance", [0.3, 0.8])
def test_5_8_a_point_lamp_in_a_sphere(reflectance):
    """On the wall of a sphere what is reflected is the same everywhere, wherever the lamp is: rho Phi / (A (1 - rho)). The sphere
    has 32 x 16 facets, which err by a few thousandths."""
    height, turn = np.linspace(-np.pi / 2, np.pi / 2, 17), np.linspace(0, 2 * np.pi, 33)
    ways = np.stack(
        [np.outer(np.cos(height), np.cos(turn)), np.outer(np.cos(height), np.sin(turn)), np.outer(np.sin(height), turn**0)]
    )
    grid = np.moveaxis(2 * ways, 0, -1)
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    corners_of = np.concatenate(
        [np.stack(x, axis=2).reshape(-1, 3, 3)[keep] for x, keep in (((a, c, b), slice(32, None)), ((a, d, c), slice(None, -32)))]
    )
    scene = rd.Scene.from_arrays(corners_of.reshape(-1, 3), np.arange(corners_of.size // 3).reshape(-1, 3), reflectance, 0.0)
    lamp = bulb((0.5, -0.3, 0.8), power=1000.0)
    facets = np.arange(0, len(corners_of), 97)
    points, normals = corners_of[facets].mean(axis=1), scene.normal[facets]
    assert ((normals * points).sum(axis=1) < 0).all()
    points = points + 0.01 * normals
    way = lamp.position - points
    distance = np.linalg.norm(way, axis=1)
    direct = 1000 / (4 * np.pi) * (way * normals).sum(axis=1) / distance**3
    exact = direct + reflectance * 1000 / (scene.area.sum() * (1 - reflectance))
    found = measured(replace(scene, photometric=True).with_lights([lamp]), rd.Sensors.of(points, normals), each=512)
    np.testing.assert_allclose(found.illuminance[:, 0], exact, rtol=0.015)


# ---- 5.9 to 5.14: the sky through openings ----------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [1, 7, 12, "overcast"])
def test_5_9_the_sky_through_a_hole_in_the_roof(kind):
    window = ((1.5, 1.5, 3), (2.5, 2.5, 3))
    scene = lit(room((4, 4, 3), window)).with_lights(sky=cie(kind), openings=[corners(window)])
    points = np.array([[2, 2, 0], [0.5, 0.5, 0], [3.5, 2, 0], [0, 2, 1.5], [2, 4, 2.5]])
    normals = np.array([[0, 0, 1]] * 3 + [[1, 0, 0], [0, -1, 0]], float)
    exact = through(corners(window), points, normals, radiance_of(kind))
    found = measured(scene, rd.Sensors.of(points, normals), each=1024)
    assert agrees(found, exact, 0.02)
    assert not agrees(found, through(corners(window), points, normals, radiance_of(5)), 0.02)


def test_5_11_sky_and_ground_through_a_window():
    """Sensors below see the sky, those above the ground, which reflects 0.3 of the horizontal."""
    window = ((1, 0, 1), (3, 0, 2))
    scene = lit(room((4, 3, 3), window)).with_lights(sky=cie(12, ground=0.3), openings=[corners(window)])
    points = np.array([[2, 0.5, 0], [2, 2.5, 0], [0.5, 1.5, 0.8], [2, 1, 3], [3.5, 2.5, 3], [2, 3, 1.4]])
    normals = np.array([[0, 0, 1]] * 3 + [[0, 0, -1]] * 2 + [[0, -1, 0]], float)
    exact = through(corners(window), points, normals, radiance_of(12, ground=0.3), n=200)
    assert agrees(measured(scene, rd.Sensors.of(points, normals), each=2048), exact, 0.02)


@pytest.mark.parametrize("case", ["5.13 horizontal", "5.14 vertical"])
def test_masks_before_a_window(case):
    """A shelf above the window, black; a wall opposite, whose luminance is known."""
    window = ((1, 0, 1), (3, 0, 2))
    luminance = 0.0 if "horizontal" in case else 200.0
    mask = quad((-20, -1.5, 2), (0, 1.5, 0), (44, 0, 0)) if not luminance else quad((-4, -5, -1), (0, 0, 4), (12, 0, 0))
    assert (np.cross(mask[1] - mask[0], mask[3] - mask[0]) @ [0, 1, -1]) > 0  # its front looks at the window
    scene = lit(room((4, 3, 3), window), ("mask", 0.0, np.pi * luminance, [mask]))
    scene = scene.with_lights(sky=cie("overcast"), openings=[corners(window)])
    points = np.array([[2, 0.5, 0], [2, 1.5, 0.8], [2, 2.5, 0.8], [0.5, 2, 0.8], [2, 3, 1.4]])
    normals = np.array([[0, 0, 1]] * 4 + [[0, -1, 0]], float)

    def covered(point, way):
        normal = np.cross(mask[1] - mask[0], mask[3] - mask[0])
        hit = point + ((mask[0] - point) @ normal / (way @ normal))[:, None] * way
        return ((hit >= mask.min(axis=0) - 1e-9) & (hit <= mask.max(axis=0) + 1e-9)).all(axis=1)

    sky = through(corners(window), points, normals, radiance_of("overcast"), n=150, hidden=covered)
    bright = through(corners(window), points, normals, lambda ways: luminance + 0 * ways[:, 2])
    bright -= through(corners(window), points, normals, lambda ways: luminance + 0 * ways[:, 2], n=150, hidden=covered)
    found = measured(scene, rd.Sensors.of(points, normals), each=1 << 13)
    np.testing.assert_allclose(
        found.illuminance[:, 0], sky + bright, rtol=0.01, atol=1
    )  # the sum's own error is 1/150 of a shadow
    assert (found.standard_error <= 0.003 * found.illuminance + 0.5).all()
    assert not agrees(found, through(corners(window), points, normals, radiance_of("overcast")), 0.03)


def test_5_13_a_shelf_that_reflects_the_ground():
    """A shelf of reflectance 0.6 above the window sees the ground, but for what the black facade hides: its luminance follows
    from the factor of the facade, and sensors see it beside the sky and the ground."""
    window, ground = ((1, 0, 1), (3, 0, 2)), 0.3
    shelf, facade = quad((0, -1.5, 2), (0, 1.5, 0), (4, 0, 0)), quad((0, 0, 0), (4, 0, 0), (0, 0, 2))
    sun_free = rd.cie_sky("overcast", LUX, ground=ground)
    scene = lit(room((4, 3, 3), window), ("shelf", 0.6, 0.0, [shelf])).with_lights(sky=sun_free, openings=[corners(window)])
    points = np.array([[2, 0.5, 0], [2, 1.5, 0.8], [0.5, 2, 0.8], [2, 3, 1.4]])
    normals = np.array([[0, 0, 1]] * 3 + [[0, -1, 0]], float)
    outside = radiance_of("overcast", ground=ground)

    def seen_from(point):
        def radiance(ways):
            hit = point + ((2 - point[2]) / np.where(ways[:, 2] == 0, 1e-12, ways[:, 2]))[:, None] * ways
            on = (ways[:, 2] > 0) & (hit[:, 0] >= 0) & (hit[:, 0] <= 4) & (hit[:, 1] >= -1.5) & (hit[:, 1] <= 0)
            light, spots = outside(ways), np.where(on[:, None], hit, [2, -1, 2])
            hidden = from_points(spots, np.tile([0, 0, -1.0], (len(spots), 1)), facade[None])
            return np.where(on, 0.6 * (1 - hidden) * ground * LUX / np.pi, light)

        return radiance

    pairs = zip(points, normals, strict=True)
    exact = np.array([through(corners(window), p[None], m, seen_from(p), n=150, hidden=lambda *_: False)[0] for p, m in pairs])
    found = measured(scene, rd.Sensors.of(points, normals), each=1 << 13, cells=8)
    width = half_width(found.values, 1 - ALPHA / len(points))[:, 0]
    assert (width < 0.15 * exact).all()
    assert (np.abs(found.illuminance[:, 0] - exact) < width + 0.01 * exact).all()  # a shelf of 64 patches
    black = through(corners(window), points, normals, outside, n=60, hidden=lambda point, way: way[:, 2] > 0)
    assert (np.abs(found.illuminance[:, 0] - black) > width + 0.01 * exact).all()


def test_the_daylight_factor_of_a_room_to_2_percent():
    """5 x 4 x 3 m, a window of 1 m2, 80 sensors at 0.85 m: the sky component, mean to 2 % and the worst to 5 %."""
    window = ((2.0, 0, 1.0), (3.0, 0, 2.0))
    scene = lit(room((5, 4, 3), window)).with_lights(sky=cie("overcast"), openings=[corners(window)])
    x, y = np.meshgrid(np.arange(10) * 0.5 + 0.25, np.arange(8) * 0.5 + 0.25)
    points = np.column_stack([x.ravel(), y.ravel(), np.full(80, 0.85)])
    exact = through(corners(window), points, (0, 0, 1), radiance_of("overcast"))
    found = measured(scene, rd.Sensors.of(points), each=2048)
    assert found.illuminance.mean() == pytest.approx(exact.mean(), rel=2e-3)
    np.testing.assert_allclose(found.illuminance[:, 0], exact, rtol=0.02)
    assert agrees(found, exact, 0.05)
