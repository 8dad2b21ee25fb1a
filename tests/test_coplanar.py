"""Faces in one plane: which of them a line meets, how pairs are found, and what is said of them."""

import warnings
from dataclasses import replace
from itertools import permutations, product

import numpy as np
import pytest

import radiosity as rd
from radiosity.device.backend import choose, upload
from radiosity.diagnostics.check import check
from radiosity.scene import coplanar
from radiosity.scene.coplanar import contacts
from radiosity.scene.model import Back
from radiosity.scene.overlap import common, overlapping
from radiosity.scene.shapes import quad
from radiosity.tracing.first_hits import first_hits
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.global_lines.spans import CODES, LOST, Spans
from radiosity.tracing.hits import first_hit
from validation.closed_forms.rectangles import parallel

SIDES = ("floor", "ceiling", "west", "east", "south", "north")


def box(low: float, high: float) -> list[np.ndarray]:
    """The sides of a room from x = low to high, 1 m wide and high, fronts inwards."""
    length = (high - low, 0, 0)
    return [
        quad((low, 0, 0), length, (0, 1, 0)),
        quad((low, 0, 1), (0, 1, 0), length),
        quad((low, 0, 0), (0, 1, 0), (0, 0, 1)),
        quad((high, 0, 0), (0, 0, 1), (0, 1, 0)),
        quad((low, 0, 0), (0, 0, 1), length),
        quad((low, 1, 0), length, (0, 0, 1)),
    ]


def two_rooms(*, swap=False, cut=(0, 0), turn=None, move=(0.0, 0.0, 0.0)) -> rd.Scene:
    """Two black rooms of 1 m with a wall between them, given as its two sides; the walls across from it emit.

    Args:
        swap: the right room first. cut: how each room's faces are cut: 0 not at all, 1 along one diagonal, 2 along the other.
    """
    rooms = [("L", box(0, 1), "west", cut[0]), ("R", box(1, 2), "east", cut[1])]
    names, faces, surface, emission = [], [], [], []
    for room, sides, light, how in reversed(rooms) if swap else rooms:
        for side, (a, b, c, d) in zip(SIDES, sides, strict=True):
            for corners in ([[a, b, c, d]], [[a, b, c, c], [a, c, d, d]], [[a, b, d, d], [b, c, d, d]])[how]:
                faces.append(corners)
                surface.append(len(names))
                emission.append(float(side == light))
            names.append(f"{room}/{side}")
    vertices = np.array(faces).reshape(-1, 3) @ (np.eye(3) if turn is None else turn).T + move
    index = np.arange(4 * len(faces)).reshape(-1, 4)
    triangle = np.array([(np.asarray(f[2]) == f[3]).all() for f in faces])
    index[triangle, 3] = -1
    return rd.Scene.from_arrays(vertices, index, 0.0, emission, surface=surface, names=names)


def rotation(seed: int) -> np.ndarray:
    q, _ = np.linalg.qr(np.random.Generator(np.random.Philox(seed)).normal(size=(3, 3)))
    return q * np.linalg.det(q)


VARIANTS = {
    "plain": {},
    "swapped": {"swap": True},
    "cut alike": {"cut": (1, 1)},
    "cut otherwise": {"cut": (1, 2), "swap": True},
    "cut on one side": {"cut": (0, 2)},
    "turned": {"turn": rotation(1), "cut": (0, 2)},
    "turned and far": {"turn": rotation(2), "cut": (2, 1), "move": (500000.3, 5400000.7, 100.1)},
    "turned and swapped": {"turn": rotation(3), "swap": True},
}


def received(solution) -> dict[str, float]:
    return {row["surface"]: row["received"] for row in solution.surface_table()}


@pytest.mark.parametrize("name", VARIANTS)
def test_both_sides_of_a_wall_get_their_light(name):
    """Of the light of the wall across: two parallel squares at their width (Howell C-11). Nothing is lost on backs."""
    solution = rd.solve(rd.subdivide(two_rooms(**VARIANTS[name]), cells=1), "random-walk", rays=60_000)
    taken = received(solution)
    for side in ("L/east", "R/west"):
        assert taken[side] == pytest.approx(parallel(1, 1), abs=0.005)
    assert solution.books[0]["lost"] == pytest.approx(0, abs=1e-4)


METHODS = (
    "particle-tracing",
    "stochastic-jacobi",
    "global-multipath-first-shot",
    "transillumination",
    "full-matrix",
    "hierarchical",
)


@pytest.mark.parametrize("method", METHODS)
def test_all_kinds_of_methods_light_both_sides(method):
    scene = two_rooms(cut=(2, 1), turn=rotation(4))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        solution = rd.solve(rd.subdivide(scene, cells=1), method, **({} if method in rd.BASELINES else {"rays": 100_000}))
    taken = received(solution)
    assert [taken["L/east"], taken["R/west"]] == pytest.approx([parallel(1, 1)] * 2, abs=0.01)


@pytest.mark.parametrize("kind", ["global", "global-disc", "bundles", "spans"])
def test_no_span_ends_on_a_back_of_a_wall(kind):
    """And each side has as many ends as its area promises: of the wall as of the others."""
    patches = rd.subdivide(two_rooms(cut=(0, 2), turn=rotation(5)), cells=1)
    spans = Spans(Geometry(patches, choose("cpu")), rd.Method(lines=kind, order="matrix", numbers="random"), 0, 1)
    count = 60_000
    pairs = spans.draw(0, 0, count)
    ends = np.bincount(
        np.concatenate([pairs.one, pairs.other])[np.concatenate([pairs.one, pairs.other]) < CODES], minlength=len(patches)
    )
    expected = pairs.ends_per_line * count
    assert np.abs(ends / expected - 1).max() < 0.06  # 5 standard deviations of a few thousand
    assert (pairs.other == LOST).sum() + (pairs.one == LOST).sum() <= 1e-4 * len(pairs.one)
    inside, outside = (np.isin(patches.scene.names, [f"{r}/{s}" for s in SIDES]) for r in "LR")
    rooms = np.where(inside, 0, 1)[patches.surface]
    real = (pairs.one < CODES) & (pairs.other < CODES)
    assert (rooms[pairs.one[real]] != rooms[pairs.other[real]]).sum() <= 1e-4 * real.sum()
    assert outside.sum() == inside.sum() == 6


def stacked(*kinds, sizes=None) -> rd.Scene:
    """Squares in the plane z = 0, fronts up (+) or down (-), with a kind of back each, about the same middle."""
    sizes = sizes or [1.0] * len(kinds)
    up = [quad((-s / 2, -s / 2, 0), (s, 0, 0), (0, s, 0)) for s in sizes]
    quads = [q if way > 0 else q[::-1] for q, (way, _) in zip(up, kinds, strict=True)]
    return rd.Scene.from_arrays(
        np.concatenate(quads),
        np.arange(4 * len(quads)).reshape(-1, 4),
        0.5,
        0.0,
        back=[back for _, back in kinds],
        surface=np.arange(len(quads)),
        names=[str(i) for i in range(len(quads))],
    )


def met(scene: rd.Scene, above: bool) -> np.ndarray:
    """Faces that lines from above or below meet, slanted, in and out of the middle."""
    generator = np.random.Generator(np.random.Philox(3))
    aims = np.column_stack([generator.uniform(-0.49, 0.49, (500, 2)), np.zeros(500)])
    origins = np.column_stack([generator.uniform(-3, 3, (500, 2)), np.full(500, 1.0 if above else -1.0)])
    return first_hits(scene, origins, aims - origins, device="cpu").face


A, R, P = Back.ABSORBS, Back.RADIATES, Back.PASSES
ORDERS = [  # faces; what a line from above meets first, and from below (-1: nothing)
    ([(+1, A), (-1, A)], 0, 1),
    ([(-1, A), (+1, A)], 1, 0),
    ([(-1, A), (+1, R)], 1, 0),
    ([(-1, P), (-1, A)], 1, 0),
    ([(-1, P), (-1, P)], -1, 0),
    ([(-1, A), (-1, R)], 1, 0),
    ([(+1, A), (+1, A), (+1, R)], 0, 2),
    ([(+1, P), (-1, P)], 0, 1),
]


@pytest.mark.parametrize(("kinds", "above", "below"), ORDERS)
def test_radiating_sides_come_first_then_backs_that_absorb_then_those_that_pass(kinds, above, below):
    scene = stacked(*kinds)
    assert set(met(scene, True)) == {above}
    assert set(met(scene, False)) == {below}


def test_the_smaller_face_lies_on_the_larger_in_any_order():
    """A mat, a rug below it, and the floor: what is met depends on the place alone."""
    sizes = {"floor": 1.0, "rug": 0.6, "mat": 0.3}
    generator = np.random.Generator(np.random.Philox(3))
    aims = generator.uniform(-0.5, 0.5, (500, 2))
    far = np.abs(aims).max(axis=1)
    expected = np.where(far < 0.15, "mat", np.where(far < 0.3, "rug", "floor"))
    for order in permutations(sizes):
        scene = replace(stacked(*[(+1, A)] * 3, sizes=[sizes[n] for n in order]), names=order)
        origins = np.column_stack([generator.uniform(-3, 3, (500, 2)), np.ones(500)])
        hits = first_hits(scene, origins, np.column_stack([aims, np.zeros(500)]) - origins, device="cpu")
        assert (np.array(order)[hits.face] == expected).all()
        assert hits.front.all()
        place = hits.u * sizes[order[0]]  # coordinates are those of the face that is met
        size = np.array([sizes[n] for n in order])[hits.face]
        np.testing.assert_allclose(hits.u * size - size / 2, aims[:, 0], atol=1e-5)
        assert place.shape == hits.distance.shape


def tiled(count: int) -> rd.Scene:
    """A wall of a metre with count x count tiles of half a pitch on it."""
    at = (np.stack(np.meshgrid(*[np.arange(count)] * 2, indexing="ij"), axis=-1).reshape(-1, 2) + 0.25) / count
    size = 0.5 / count
    quads = [quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), *(quad((x, y, 0), (size, 0, 0), (0, size, 0)) for x, y in at)]
    scene = rd.Scene.from_arrays(np.concatenate(quads), np.arange(4 * len(quads)).reshape(-1, 4), 0.5, 0.0)
    return replace(scene, vertices=scene.vertices @ rotation(6).T)


def test_many_tiles_on_a_wall():
    scene, n = tiled(24), 24
    random = np.random.Generator(np.random.Philox(4))
    u, v = random.random((2, 4000))
    depth = np.minimum(0.25 - np.abs(u * n % 1 - 0.5), 0.25 - np.abs(v * n % 1 - 0.5)) / n
    u, v, depth = (x[np.abs(depth) > 1e-5] for x in (u, v, depth))
    inside = depth > 0
    tile = 1 + (u * n).astype(int) * n + (v * n).astype(int)
    origin, first, second = (part[0] for part in scene.frames)
    aims = origin + u[:, None] * first + v[:, None] * second
    starts = aims + scene.normal[0] + random.uniform(-1, 1, (len(u), 3)) @ np.stack([first, second, 0 * first])
    assert (first_hits(scene, starts, aims - starts, device="cpu").face == np.where(inside, tile, 0)).all()


@pytest.mark.parametrize("swap", [False, True])
def test_what_a_line_meets_does_not_depend_on_its_packet(swap):
    """The same lines, in order and shuffled, one by one and in packets."""
    import drjit as dr

    scene = two_rooms(swap=swap, cut=(0, 2), turn=rotation(7))
    geometry = Geometry(rd.subdivide(scene, cells=1), choose("cpu"))
    geometry.prepare()
    types, tree = geometry.device.types, geometry.bvh
    random = np.random.Generator(np.random.Philox(8))
    middle = (np.array([[0.5, 0.5, 0.5]]) @ rotation(7).T - tree.centre) * tree.scale
    directions = random.normal(size=(20_000, 3))
    order = random.permutation(len(directions))
    found = []
    for rows, coherent in ((slice(None), False), (order, False), (slice(None), True)):
        ray = [
            types.Array3f(*(upload(types.Float, x.astype(np.float32)) for x in part.T))
            for part in (np.broadcast_to(middle, directions.shape)[rows], directions[rows])
        ]
        hit = first_hit(geometry, *ray, coherent=coherent)
        dr.eval(hit.primitive, hit.u, hit.front)
        found.append([np.array(x) for x in (hit.primitive, hit.u, hit.front)])
    for one, other in zip(found[0], found[1], strict=True):
        assert (one[order] == other).all()
    assert (found[0][0] == found[2][0]).mean() > 0.9998  # at edges the caster itself may choose otherwise in packets
    assert found[0][2].all()


def scattered(seed: int, count: int = 150) -> rd.Scene:
    """Triangles and squares of all sizes in few planes, turned: many lie on each other, some a few ulps apart."""
    random = np.random.Generator(np.random.Philox(seed))
    turn, quads = rotation(seed), []
    for _ in range(count):
        size, angle = 10 ** random.uniform(-2, 0), random.uniform(0, 2 * np.pi)
        first = size * np.array([np.cos(angle), np.sin(angle), 0])
        second = size * np.array([-np.sin(angle), np.cos(angle), 0])
        height = random.integers(3) * 0.5 + random.choice([0, 0, 1e-6])
        quads.append(quad((*random.uniform(-1, 1, 2), height), first, second if random.random() < 0.5 else -second))
    faces = np.arange(4 * count).reshape(-1, 4)
    faces[random.random(count) < 0.5, 3] = -1
    return rd.Scene.from_arrays(np.concatenate(quads) @ turn.T, faces, 0.5, 1.0)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_pairs_are_those_that_a_comparison_of_all_finds(seed, monkeypatch):
    scene = scattered(seed)
    found = contacts(scene)

    def every(plates, some):
        one, two = np.triu_indices(scene.n_faces, 1)
        yield one, two

    monkeypatch.setattr(coplanar, "pairs", every)
    expected = coplanar._find(scene)
    assert len(expected.one) > 20
    assert (found.one == expected.one).all()
    assert (found.two == expected.two).all()
    assert (found.coplanar == expected.coplanar).all()
    assert 0 < found.coplanar.sum() < len(found.one)
    # in the plane, by counting points: a share of either face
    random = np.random.Generator(np.random.Philox(9))
    for one, two, share in zip(found.one[:10], found.two[:10], found.share[:10], strict=True):
        small, large = (one, two) if scene.area[one] < scene.area[two] else (two, one)
        a, b = random.random((2, 20_000))
        if not scene.is_quad[small]:
            a, b = np.where(a + b > 1, 1 - a, a), np.where(a + b > 1, 1 - b, b)
        origin, first, second = (part[small] for part in scene.frames)
        points = origin + a[:, None] * first + b[:, None] * second
        origin, first, second = (part[large] for part in scene.frames)
        u, v = np.linalg.lstsq(np.stack([first, second], axis=1), (points - origin).T, rcond=None)[0]
        inside = (u > 0) & (v > 0) & ((np.maximum(u, v) if scene.is_quad[large] else u + v) < 1)
        assert inside.mean() == pytest.approx(share, abs=5 * np.sqrt(share * max(1 - share, 0) / 20_000) + 1e-4)


def test_faces_of_a_flat_mesh_are_beside_each_other_and_a_plate_on_it_is_found():
    n = 20
    at = np.stack(np.meshgrid(*[np.linspace(0, 1, n + 1)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    a, b, c, d = corner, corner + n + 1, corner + n + 2, corner + 1
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    vertices = np.column_stack([at, 0 * at[:, 0]]) @ rotation(9).T
    mesh = rd.Scene.from_arrays(vertices, triangles, 0.5, 1.0)
    assert len(contacts(mesh).one) == 0
    plate = quad((0.42, 0.42, 0), (0.1, 0, 0), (0, 0.1, 0)) @ rotation(9).T
    both = rd.Scene.from_arrays(
        np.concatenate([vertices, plate]), np.concatenate([triangles, len(vertices) + np.array([[0, 1, 2], [0, 2, 3]])]), 0.5, 1.0
    )
    found = contacts(both)
    area = (found.share * np.minimum(both.area[found.one], both.area[found.two])).sum()
    assert area == pytest.approx(0.01, rel=1e-6)
    assert (found.one < len(triangles)).all()
    assert (found.two >= len(triangles)).all()


def test_polygons_in_common():
    square, right = np.array([[(0, 0), (1, 0), (1, 1), (0, 1)]], float), np.array([1.0, 0])
    for other, area in (
        (square + right / 2 + right[::-1] / 4, 0.375),
        (square[:, ::-1] * 0.5 + 0.1, 0.25),
        (square + right, 0.0),
        (square + 3 * right, 0.0),
        (np.array([[(0, 0), (2, 0), (0, 2), (0, 2)]], float) - 0.5, 0.5),
        (square * 3 - 1, 1.0),
    ):
        assert common(square, other)[1][0] == pytest.approx(area, abs=1e-15)
        assert overlapping(square, other, np.array([1e-6]))[0] == (area > 0)


def plates(gap: float, size: float = 1.0) -> rd.Scene:
    below, above = quad((0, 0, 0), (size, 0, 0), (0, size, 0)), quad((0, 0, gap), (0, size, 0), (size, 0, 0))
    return rd.Scene.from_arrays(
        np.concatenate([below, above]), np.arange(8).reshape(2, 4), 0.0, [1.0, 0.0], surface=[0, 1], names=["hot", "cold"]
    )


@pytest.mark.parametrize("gap", [1e-7, 2e-7, 4e-7])
def test_plates_too_near_to_see_each_other_are_told_by_name(gap):
    message = f"1 pair of faces do not see each other .*'hot' and 'cold' are {gap:.0e}".replace("e-07", "e-07 m apart")
    with pytest.warns(rd.RadiosityWarning, match=message):
        rd.solve(rd.subdivide(plates(gap), cells=1), "random-walk", rays=2000)
    (text,) = [f.message for f in check(plates(gap)).findings if f.kind == "too near"]
    assert "'cold', 'hot'" in text


def test_plates_that_single_precision_holds_apart_see_each_other():
    for gap in (1e-6, 1e-5):
        solution = rd.solve(rd.subdivide(plates(gap), cells=1), "random-walk", rays=20_000)  # warnings are errors here
        assert solution.irradiance[1, 0] > 0.999
        assert not [f for f in check(plates(gap)).findings if f.kind in ("too near", "duplicates")]


def lamp_on_floor(emission: float) -> rd.Scene:
    floor, mat = quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0.2, 0.2, 0), (0.6, 0, 0), (0, 0.6, 0))
    ceiling = quad((0, 0, 1), (0, 1, 0), (1, 0, 0))
    return rd.Scene.from_arrays(
        np.concatenate([floor, mat, ceiling]),
        np.arange(12).reshape(3, 4),
        0.0,
        [0.0, emission, 1.0],
        surface=[0, 1, 2],
        names=["floor", "mat", "ceiling"],
    )


def test_a_mat_in_the_floor_is_reported_and_a_lamp_there_is_told_of():
    (finding,) = [f for f in check(lamp_on_floor(0)).findings if f.kind == "duplicates"]
    assert finding.severity == "warning"
    assert "lie on another face and radiate to the same side" in finding.message
    assert "'floor', 'mat'" in finding.message
    solution = rd.solve(rd.subdivide(lamp_on_floor(0), cells=1), "random-walk", rays=100_000)  # warnings are errors here
    raised = lamp_on_floor(0)
    raised.vertices[4:8, 2] = 1e-5
    above = rd.solve(rd.subdivide(raised, cells=1), "random-walk", rays=100_000)
    assert received(solution)["mat"] == pytest.approx(received(above)["mat"], rel=1e-3)
    assert received(solution)["floor"] == pytest.approx(received(above)["floor"], rel=1e-3)
    with pytest.warns(rd.RadiosityWarning, match="1 faces .first: face 1. lie on another face .*'floor', 'mat'"):
        rd.solve(rd.subdivide(lamp_on_floor(1.0), cells=1), "random-walk", rays=2000)


def test_a_doubled_lamp_is_told_of():
    room = rd.load_scene("room")
    lamp = (room.emission > 0).any(axis=1)
    doubled = room.take(np.concatenate([np.arange(room.n_faces), np.flatnonzero(lamp)]))
    with pytest.warns(rd.RadiosityWarning, match=f"{lamp.sum()} faces .* lie on another face and radiate to the same side"):
        rd.solve(rd.subdivide(doubled, cells=1), "random-walk", rays=20_000)


def test_a_doubled_lamp_that_shines_from_its_back_is_told_of():
    floor, lamp = (
        quad((0, 0, 0), (1, 0, 0), (0, 1, 0)),
        quad((0.2, 0.2, 0), (0, 0.6, 0), (0.6, 0, 0)),
    )  # the lamp's front is below
    scene = rd.Scene.from_arrays(
        np.concatenate([floor, lamp]),
        np.arange(8).reshape(2, 4),
        0.0,
        0.0,
        back=[A, R],
        back_emission=[0.0, 1.0],
        surface=[0, 1],
        names=["floor", "lamp"],
    )
    with pytest.warns(rd.RadiosityWarning, match="1 faces .first: face 1. lie on another face .*'floor', 'lamp'"):
        rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=2000)


@pytest.mark.parametrize(("below", "above"), [(0, 0), (0, 1), (1, 0), (1, 1)], ids=str)
@pytest.mark.parametrize("backs", list(product((A, R, P), repeat=2)), ids=str)
def test_faces_are_unseen_where_light_goes_from_one_side_to_another_that_stops_it(below, above, backs):
    """Fronts look up (1) or down (0); the gap is nearer than where lines begin, and yet no plane is shared."""
    gap = 6 * 2.0**-23 * 0.5
    first, second = (quad((0, 0, z), (1, 0, 0), (0, 1, 0)) for z in (0, gap))
    scene = rd.Scene.from_arrays(
        np.concatenate([first if below else first[::-1], second if above else second[::-1]]),
        np.arange(8).reshape(2, 4),
        0.0,
        1.0,
        back=backs,
    )
    found = contacts(scene)
    assert found.coplanar.tolist() == [False]
    one, two = R if below else backs[0], backs[1] if above else R  # of the sides that look into the gap
    assert found.unseen(scene).tolist() == [(one == R and two != P) or (two == R and one != P)]
