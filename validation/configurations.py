"""View factors that are known exactly, and scenes to measure them in: black surfaces, of which one emits."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import radiosity as rd

from .closed_forms import obstructed, offset_rectangles, rectangles, round, strings
from .shapes import Facets, ball, disc, moved, quad, ring, scene, tube, turned

LONG = 400.0  # over the width: how long "infinitely long" bodies are; the emitter is a piece of length one in the middle


@dataclass(frozen=True)
class Configuration:
    """Attributes:
    name: what is where.
    exact: the view factor from the emitter to the receiver.
    build: its scene for a number of facets (ignored by flat ones); surface 0 emits, ``receiver`` receives.
    facets: of the coarser of two meshes, of which the finer has twice as many along an edge; None: the scene is the thing itself.
    receiver: surface.
    bound: of what else the scene differs from the thing, in F.
    flat: the emitter is one patch.
    """

    name: str
    exact: float
    build: Callable[[int], rd.Scene]
    facets: int | None = None
    receiver: int = 1
    bound: float = 0.0
    flat: bool = False


def _facing(emitter: Facets, receiver: Facets) -> rd.Scene:
    return scene(("emitter", 0.0, 1.0, emitter), ("receiver", 0.0, 0.0, receiver))


def _flat(name: str, exchange: float, emitter: np.ndarray, receiver: np.ndarray) -> Configuration:
    area = np.linalg.norm(np.cross(emitter[1] - emitter[0], emitter[-1] - emitter[0]))
    return Configuration(name, float(exchange / area), lambda _: _facing([emitter], [receiver]), flat=True)


def _hinged(angle: float, one: float, other: float) -> tuple[np.ndarray, np.ndarray]:
    """Rectangles with a common edge of length one along y, and an angle between them."""
    up = np.array([np.cos(angle), 0, np.sin(angle)])
    return quad((0, 0, 0), (one, 0, 0), (0, 1, 0)), quad((0, 0, 0), (0, 1, 0), other * up)


def _long(bottom: tuple, top: tuple, *others) -> rd.Scene:
    """Segments ((x, z), (x, z)) extruded along y; of the first a piece in the middle emits. Fronts are on the left of their
    direction."""

    def wall(ends, length):
        (a, b), (c, d) = ends
        return quad((a, -length / 2, b), (c - a, 0, d - b), (0, length, 0))

    parts = [("emitter", 0.0, 1.0, [wall(bottom, 1.0)]), ("receiver", 0.0, 0.0, [wall(top, LONG)])]
    return scene(*parts, *((f"other {i}", 0.0, 0.0, [wall(o, LONG)]) for i, o in enumerate(others)))


def _ends(reach: float) -> float:
    """Largest share of cosine lines that leave a long body's middle and go farther along it than its half length before they
    have gone ``reach`` across: of a line's direction cosine along y, 1 - sin is at most half the square of the ratio."""
    return (reach / (LONG / 2 - 0.5)) ** 2 / 2


def flat() -> list[Configuration]:
    """Rectangles, exactly as they are."""
    hinge_60, hinge_135 = _hinged(np.pi / 3, 1.0, 0.8), _hinged(3 * np.pi / 4, 0.7, 1.2)
    spans = ((0, 1), (0, 1), (0.6, 2.0), (0.5, 1.3))
    apart = ((0.2, 1.0), (0, 1), (0.1, 0.9), (0.3, 1.6))
    return [
        _flat(
            "opposed rectangles 2 x 1 at 0.7 (C-11)",
            0.49 * rectangles.parallel(2 / 0.7, 1 / 0.7),
            quad((0, 0, 0), (2, 0, 0), (0, 1, 0)),
            quad((0, 0, 0.7), (0, 1, 0), (2, 0, 0)),
        ),
        _flat(
            "opposed squares of a cube (C-11)",
            rectangles.parallel(1, 1),
            quad((0, 0, 0), (1, 0, 0), (0, 1, 0)),
            quad((0, 0, 1), (0, 1, 0), (1, 0, 0)),
        ),
        _flat(
            "rectangles square on each other, common edge (C-14)",
            rectangles.perpendicular(0.8, 1.5),
            *_hinged(np.pi / 2, 0.8, 1.5),
        ),
        _flat("rectangles at 60°, common edge (C-16)", rectangles.inclined(1.0, 0.8, np.pi / 3), *hinge_60),
        _flat("rectangles at 135°, common edge (C-16)", rectangles.inclined(0.7, 1.2, 3 * np.pi / 4), *hinge_135),
        _flat(
            "parallel rectangles, offset",
            offset_rectangles.parallel(*spans, 0.8),
            quad((0, 0, 0), (1, 0, 0), (0, 1, 0)),
            quad((0.6, 0.5, 0.8), (0, 0.8, 0), (1.4, 0, 0)),
        ),
        _flat(
            "rectangles square on each other, apart and offset",
            offset_rectangles.perpendicular(*apart),
            quad((0.2, 0, 0), (0.8, 0, 0), (0, 1, 0)),
            quad((0, 0.3, 0.1), (0, 1.3, 0), (0, 0, 0.8)),
        ),
    ]


def convex() -> list[Configuration]:
    """A convex body in another, or on its own base: ratios of areas, exact also of the facets."""
    corners = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], float)
    faces = [corners[[1, 3, 2]], corners[[0, 2, 3]], corners[[0, 3, 1]], corners[[0, 1, 2]]]
    inward = [f if np.linalg.det(f) < 0 else f[::-1] for f in faces]
    inner, outer = ball(1.0, 3), turned(ball(2.0, 3))
    cone = [(f + np.array([(0, 0, 1.5), (0, 0, 0), (0, 0, 0)]))[::-1] for f in disc(1.0, 0.0, 24)]
    box = [
        quad((-2, -2, -2), (4, 0, 0), (0, 4, 0)),
        quad((-2, -2, 2), (0, 4, 0), (4, 0, 0)),
        quad((-2, -2, -2), (0, 0, 4), (4, 0, 0)),
        quad((-2, 2, -2), (4, 0, 0), (0, 0, 4)),
        quad((-2, -2, -2), (0, 4, 0), (0, 0, 4)),
        quad((2, -2, -2), (0, 0, 4), (0, 4, 0)),
    ]

    def ratio(one: Facets, other: Facets) -> float:
        return _area(one) / _area(other)

    return [
        Configuration(
            "regular tetrahedron, a side to another",
            1 / 3,
            lambda _: scene(
                ("emitter", 0.0, 1.0, inward[:1]), ("receiver", 0.0, 0.0, inward[1:2]), ("rest", 0.0, 0.0, inward[2:])
            ),
            flat=True,
        ),
        Configuration("concentric spheres, inner to outer", 1.0, lambda _: _facing(inner, outer)),
        Configuration("concentric spheres, outer to inner", ratio(inner, outer), lambda _: _facing(outer, inner)),
        Configuration(
            "concentric spheres, outer to itself", 1 - ratio(inner, outer), lambda _: _facing(outer, inner), receiver=0
        ),
        Configuration("cube to a sphere in it", ratio(inner, box), lambda _: _facing(box, inner)),
        Configuration("cone's inside to its base", ratio(disc(1.0, 0.0, 24), cone), lambda _: _facing(cone, disc(1.0, 0.0, 24))),
    ]


def _area(facets: Facets) -> float:
    """All have the same number of corners."""
    corners = np.array(facets)
    return float(np.linalg.norm(np.cross(corners, np.roll(corners, -1, axis=1)).sum(axis=1), axis=1).sum() / 2)


def long() -> list[Configuration]:
    """Ducts and strips, 400 widths long, by crossed strings."""
    a, b, c = (0.0, 0.0), (1.0, 0.0), (0.3, 0.9)
    sides = [float(np.hypot(p[0] - q[0], p[1] - q[1])) for p, q in ((a, b), (b, c), (c, a))]
    return [
        Configuration(
            "long triangular duct, a side to another",
            strings.triangle(*sides),
            lambda _: _long((a, b), (b, c), (c, a)),
            bound=_ends(1.0),
            flat=True,
        ),
        Configuration(
            "long opposed strips, offset",
            strings.crossed(((0, 0), (1, 0)), ((0.5, 0.8), (1.8, 0.8))),
            lambda _: _long(((0, 0), (1, 0)), ((1.8, 0.8), (0.5, 0.8))),
            bound=_ends(2.0),
            flat=True,
        ),
        Configuration(
            "long opposed strips past a plate between them",
            strings.past_a_plate(1.0, 1.0, 0.4),
            lambda _: _long(((0, 0), (1, 0)), ((1, 1), (0, 1)), ((0.7, 0.5), (0.3, 0.5))),
            bound=_ends(1.5),
            flat=True,
        ),
    ]


def curved() -> list[Configuration]:
    """Discs, cylinders and spheres of facets, extrapolated over two meshes."""

    def strip(n: int) -> rd.Scene:
        pipe = [f[:, [0, 2, 1]][::-1] + np.array([0, 0, 1.5]) for f in tube(0.5, -LONG / 2, LONG / 2, n)]
        return _facing([quad((0.2, -0.5, 0), (1.5, 0, 0), (0, 1, 0))], pipe)

    def pipes(n: int) -> rd.Scene:
        one, other = tube(1.0, -0.5, 0.5, n), moved(tube(1.0, -LONG, LONG, n), (3.0, 0, 0))
        return _facing(one, other)

    return [
        Configuration(
            "coaxial discs (C-41)",
            round.disc_to_disc(1.0, 0.7, 0.9),
            lambda n: _facing(disc(1.0, 0.0, n), turned(disc(0.7, 0.9, n))),
            48,
        ),
        Configuration(
            "disc to coaxial ring",
            round.disc_to_ring(0.8, 0.5, 1.2, 0.6),
            lambda n: _facing(disc(0.8, 0.0, n), turned(ring(0.5, 1.2, 0.6, n))),
            48,
        ),
        Configuration(
            "ring to coaxial ring",
            round.ring_to_ring((0.4, 1.0), (0.6, 1.4), 0.5),
            lambda n: _facing(ring(0.4, 1.0, 0.0, n), turned(ring(0.6, 1.4, 0.5, n))),
            48,
        ),
        Configuration(
            "cylinder, base to inside",
            round.base_to_wall(1.0, 1.5),
            lambda n: _facing(disc(1.0, 0.0, n), turned(tube(1.0, 0.0, 1.5, n))),
            48,
        ),
        Configuration(
            "cylinder, inside to itself",
            round.wall_to_itself(1.0, 1.5),
            lambda n: _facing(turned(tube(1.0, 0.0, 1.5, n)), turned(disc(1.0, 1.5, n))),
            48,
            receiver=0,
        ),
        Configuration(
            "coaxial cylinders, outer to inner",
            round.outer_to_inner(0.5, 1.2, 2.0),
            lambda n: _facing(turned(tube(1.2, 0.0, 2.0, n)), tube(0.5, 0.0, 2.0, n)),
            48,
        ),
        Configuration("long parallel cylinders", round.cylinder_to_cylinder(1.0), pipes, 48, bound=_ends(3.0) / 4),
        Configuration(
            "long strip to a parallel cylinder",
            round.strip_to_cylinder(0.2, 1.7, 1.5, 0.5),
            strip,
            48,
            bound=_ends(2.5),
            flat=True,
        ),
        Configuration(
            "sphere to coaxial disc",
            round.sphere_to_disc(1.2, 1.0),
            lambda n: _facing(ball(0.5, n, (0, 0, 1.0)), disc(1.2, 0.0, 96 * 2 ** (n - 3))),
            3,
        ),
        Configuration(
            "sphere to rectangle below its centre at a corner",
            round.sphere_to_rectangle(2.0, 1.0, 0.8),
            lambda n: _facing(ball(0.5, n, (0, 0, 0.8)), [quad((0, 0, 0), (2, 0, 0), (0, 1, 0))]),
            3,
        ),
    ]


def two_dimensional() -> list[Configuration]:
    """Plates 400 widths long, in the catalogue's order."""
    half, wedge = 0.4, (float(np.cos(0.8)), float(np.sin(0.8)))
    ends = ((0.5 - half / 2, 0.6), (0.5 + half / 2, 0.6))
    return [
        Configuration(
            "long opposed strips of one width (C-1)",
            float(np.hypot(1, 0.7) - 0.7),
            lambda _: _long(((0, 0), (1, 0)), ((1, 0.7), (0, 0.7))),
            bound=_ends(1.5),
            flat=True,
        ),
        Configuration(
            "long opposed strips of other widths (C-2a)",
            strings.crossed(((0, 0), (1, 0)), ends),
            lambda _: _long(((0, 0), (1, 0)), (ends[1], ends[0])),
            bound=_ends(1.5),
            flat=True,
        ),
        Configuration(
            "long strips square on each other (C-3)",
            strings.triangle(1.0, 0.6, float(np.hypot(1, 0.6))),
            lambda _: _long(((0, 0), (1, 0)), ((0, 0.6), (0, 0))),
            bound=_ends(1.5),
            flat=True,
        ),
        Configuration(
            "long wedge of equal sides (C-5)",
            float(1 - np.sin(0.4)),
            lambda _: _long(((0, 0), (1, 0)), (wedge, (0, 0))),
            bound=_ends(1.5),
            flat=True,
        ),
    ]


def hindered() -> list[Configuration]:
    """Bodies with something between them."""

    def long_tube(radius: float, x: float, z: float, n: int) -> Facets:
        return [f[:, [0, 2, 1]][::-1] + np.array([x, 0, z]) for f in tube(radius, -LONG / 2, LONG / 2, n)]

    def past_a_cylinder(n: int) -> rd.Scene:
        strips = [quad((-0.5, -0.5, -0.5), (1, 0, 0), (0, 1, 0)), quad((-0.5, -LONG / 2, 0.5), (0, LONG, 0), (1, 0, 0))]
        return scene(
            ("emitter", 0.0, 1.0, strips[:1]), ("receiver", 0.0, 0.0, strips[1:]), ("cylinder", 0.0, 0.0, long_tube(0.2, 0, 0, n))
        )

    def through_a_slit(_: int) -> rd.Scene:
        screens = [((-0.15, 0.5), (-LONG / 2, 0.5)), ((LONG / 2, 0.5), (0.15, 0.5))]
        both = [*screens, *(((b, c) for c, b in screens))]  # seen from below and from above
        return _long(((-0.5, 0), (0.5, 0)), ((0.5, 1), (-0.5, 1)), *both)

    def tubes(n: int) -> rd.Scene:
        row = [facet for k in range(-30, 31) for facet in long_tube(0.25, k, 1.0, n)]
        return _facing([quad((-0.5, -0.5, 0), (1, 0, 0), (0, 1, 0))], row)

    def coaxial(n: int) -> rd.Scene:
        return _facing(turned(tube(1.2, 0.0, 2.0, n)), tube(0.5, 0.0, 2.0, n))

    def between_ends(n: int) -> rd.Scene:
        parts = ("emitter", 0.0, 1.0, ring(0.5, 1.2, 0.0, n)), ("receiver", 0.0, 0.0, turned(ring(0.5, 1.2, 2.0, n)))
        return scene(*parts, ("body", 0.0, 0.0, tube(0.5, 0.0, 2.0, n)))

    def cube(size: float, *, inward: bool) -> Facets:
        h = size / 2
        corners = quad((-h, -h, -h), (size, 0, 0), (0, size, 0))
        faces = [corners, *(_rolled(corners, times) for times in (1, 2))]
        faces += [-face[::-1] for face in faces]
        return faces if inward else turned(faces)

    inner = ball(1.0, 2)
    return [
        Configuration(
            "long opposed strips past a cylinder",
            obstructed.past_a_cylinder(1.0, 1.0, 0.2),
            past_a_cylinder,
            24,
            bound=_ends(1.5),
        ),
        Configuration(
            "long opposed strips through a slit",
            obstructed.through_a_slit(1.0, 1.0, 0.3),
            through_a_slit,
            bound=_ends(1.5),
            flat=True,
        ),
        Configuration(
            "plane to a row of tubes",
            obstructed.plane_to_tubes(1.0, 0.5),
            tubes,
            12,
            bound=1 / (2 * 30**2) + _ends(1.5),
            flat=True,
        ),
        Configuration("coaxial cylinders, outer to itself", obstructed.outer_to_itself(0.5, 1.2, 2.0), coaxial, 48, receiver=0),
        Configuration("coaxial cylinders, an end to the other", obstructed.end_to_end(0.5, 1.2, 2.0), between_ends, 48),
        Configuration(
            "cube to itself round a cube",
            1 - 1 / 9,
            lambda _: _facing(cube(3.0, inward=True), cube(1.0, inward=False)),
            receiver=0,
        ),
        Configuration(
            "cube to itself round a sphere",
            1 - _area(inner) / (6 * 16),
            lambda _: _facing(cube(4.0, inward=True), inner),
            receiver=0,
        ),
        Configuration(
            "sphere to a tube about it",
            obstructed.sphere_to_tube(1.0, 1.5),
            lambda n: _facing(ball(0.5, n), turned(tube(1.0, -0.75, 0.75, 96 * 2 ** (n - 3)))),
            3,
        ),
    ]


def _rolled(corners: np.ndarray, times: int) -> np.ndarray:
    """The same corners with their axes exchanged in turn."""
    return np.roll(corners, times, axis=1)


def every() -> list[Configuration]:
    return [*flat(), *convex(), *long(), *curved(), *two_dimensional(), *hindered()]
