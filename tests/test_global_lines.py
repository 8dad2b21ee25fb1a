"""Global lines and their spans: distribution, completeness against numpy, and exact form factors.

Random numbers and fixed seeds; ALPHA is the chance of a false alarm of each comparison that gives a p-value, SIGMAS bounds
the others (about 40 of them; Student with 15 degrees of freedom: p = 4e-4 each).
"""

import numpy as np
import pytest
from enclosures import cube
from scipy import stats

import radiosity as rd
from radiosity.device.backend import choose, upload
from radiosity.errors import MethodError
from radiosity.patches import cells
from radiosity.sampling import global_lines
from radiosity.scene.shapes import box, quad
from radiosity.tracing.bvh import REACH
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.global_lines.hull import nothing_beyond
from radiosity.tracing.global_lines.spans import CODES, ESCAPED, LOST, ONE_WAY, Spans

KINDS = ("global", "global-disc", "spans", "bundles")
ALPHA, SIGMAS = 1e-4, 4.5
RADIUS = 1.5


def spans_of(patches, kind, numbers="random", replicates=16, seed=0) -> Spans:
    return Spans(Geometry(patches, choose("cpu")), rd.Method(lines=kind, order="matrix", numbers=numbers), seed, replicates)


def ends_of(pairs, n):
    """Ends on each patch."""
    return sum(np.bincount(end[end < ONE_WAY], minlength=n) for end in (pairs.one, pairs.other))


def lines_of(kind, random, count=200_000):
    """Points and directions on the host, of the kinds that have whole lines; a bundle each, with one line."""
    types = choose("cpu").types
    numbers = [upload(types.Float, random.random(count).astype(np.float32)) for _ in range(4)]
    radius = types.Float(RADIUS)
    if kind == "bundles":
        cell = upload(types.UInt32, random.integers(0, 4**5, count).astype(np.uint32))
        line = global_lines.of_bundle(numbers, cell, 5, radius, types.Array3f)
    else:
        line = (global_lines.by_two_points if kind == "global" else global_lines.by_disc)(numbers, radius, types.Array3f)
    return tuple(np.array(x, np.float64).T for x in line)


def crossings_of_a_square(kind, random):
    """Where lines cross a square that hangs askew off the centre, and the cosines there: (m, 2), (m,), and how many lines."""
    point, direction = lines_of(kind, random)
    origin, first = np.array([-0.2, 0.1, -0.5]), np.array([0.6, 0.3, 0.1])
    second = np.cross(first, [0.2, -0.5, 0.7])
    second *= np.linalg.norm(first) / np.linalg.norm(second)
    normal = np.cross(first, second) / (first @ first)
    distance = (origin - point) @ normal / (direction @ normal)
    at = point + distance[:, None] * direction - origin
    uv = np.column_stack([at @ first, at @ second]) / (first @ first)
    inside = (uv > 0).all(axis=1) & (uv < 1).all(axis=1)
    return uv[inside], np.abs(direction @ normal)[inside], len(point), first @ first


def p_values(kind, random):
    """Of the number of crossings, their places, and their directions."""
    uv, cosine, lines, area = crossings_of_a_square(kind, random)
    share = area / (8 * RADIUS**2 if kind == "bundles" else 2 * np.pi * RADIUS**2)
    places = np.histogram2d(*uv.T, bins=6, range=[[0, 1], [0, 1]])[0].ravel()
    return (
        stats.binomtest(len(uv), lines, share).pvalue,
        stats.chisquare(places).pvalue,
        stats.kstest(cosine**2, "uniform").pvalue,
    )


@pytest.mark.parametrize("kind", ["global", "global-disc", "bundles"])
def test_lines_are_uniform_and_isotropic(kind, random):
    assert min(p_values(kind, random)) > ALPHA


@pytest.mark.parametrize("wrong", [lambda z: z**3, lambda z: np.nan], ids=["cubed heights", "uniform angles"])
@pytest.mark.parametrize("kind", ["global", "global-disc", "bundles"])
def test_points_that_are_not_uniform_on_the_sphere_are_rejected(kind, wrong, random, monkeypatch):
    import drjit as dr

    def on_sphere(first, second):
        z = dr.cos(first * np.pi) if np.isnan(wrong(1.0)) else wrong(1 - 2 * first)
        radius = dr.sqrt(1 - z * z)
        return dr.cos(2 * np.pi * second) * radius, dr.sin(2 * np.pi * second) * radius, z

    monkeypatch.setattr(global_lines, "on_sphere", on_sphere)
    assert min(p_values(kind, random)) < ALPHA


@pytest.mark.parametrize("kind", KINDS)
def test_ends_are_proportional_to_area(kind):
    patches = rd.subdivide(cube(), cells=5)
    spans = spans_of(patches, kind)
    count = 1 << 16
    pairs = spans.draw(0, 0, count)
    assert (pairs.one < len(patches)).all()  # convex and closed: nothing escapes, and a line has one span or none
    assert (np.diff(pairs.line.astype(int)) > 0).all()
    if kind != "bundles":  # whose lines are not independent
        for end in (pairs.one, pairs.other):
            assert stats.chisquare(np.bincount(end, minlength=len(patches))).pvalue > ALPHA
        share = spans.ends_per_line.sum() / 2
        assert share == pytest.approx({"spans": 1.0}.get(kind, 6 / (4 * np.pi * 0.75)), rel=1e-5)
        assert stats.binomtest(len(pairs.line), count, min(share, 1.0)).pvalue > ALPHA
    else:
        total = np.array([len(spans.draw(r, 0, count).line) for r in range(16)]) * 2
        assert abs(total.mean() / count - spans.ends_per_line.sum()) < SIGMAS * total.std(ddof=1) / 4 / count


@pytest.mark.parametrize(("kind", "name"), [*((kind, name) for kind in KINDS for name in ("room", "labyrinth")), ("spans", None)])
def test_expected_ends_of_real_scenes(kind, name):
    """Also where furniture has absorbing backs, and walls two sides; and in a jumble that is seen through backs."""
    patches = rd.subdivide(rd.load_scene(name) if name else jumble(True), cells=2)
    spans = spans_of(patches, kind, numbers="halton")
    count = 1 << 15
    ends = np.array([ends_of(spans.draw(r, 0, count), len(patches)) for r in range(16)]) / count
    error = ends.std(axis=0, ddof=1) / 4
    assert np.abs((ends.mean(axis=0) - spans.ends_per_line) / error)[patches.area > 0].max() < 7  # the largest of hundreds
    total = ends.sum(axis=1)
    assert abs(total.mean() - spans.ends_per_line.sum()) < SIGMAS * total.std(ddof=1) / 4 + 1e-5


def jumble(passing: bool) -> rd.Scene:
    """Two boxes seen from outside, a sheet of two triangles that radiates on both sides, and one whose back lets lines pass."""
    quads = [*box((-1, -1, -1), (-0.4, 0.2, 0.3), inward=False), *box((0.2, -0.3, 0.1), (1.0, 0.5, 0.9), inward=False)]
    vertices = np.concatenate(
        [
            *quads,
            quad((-0.9, 0.5, -0.8), (1.8, 0.1, 0.2), (0.3, 0.4, 1.5)),
            quad((-0.3, -0.9, -0.9), (0.1, 1.7, 0.2), (0.9, 0.1, 0.3)),
        ]
    )
    faces = np.full((len(quads) + 3, 4), -1)
    faces[: len(quads)] = np.arange(4 * len(quads)).reshape(-1, 4)
    at = 4 * len(quads)
    faces[-3, :3], faces[-2, :3], faces[-1] = (at, at + 1, at + 2), (at, at + 2, at + 3), np.arange(at + 4, at + 8)
    back = np.zeros(len(faces), int)
    back[-3:-1] = rd.Back.RADIATES
    if passing:
        back[[0, 3, 8, -1]] = rd.Back.PASSES
    return rd.Scene.from_arrays(vertices, faces, 0.5, 1.0, back=back)


def all_hits(patches, point, direction):
    """For each line its crossings in order: (patch in front or None, that behind, came from the front, kind of back)."""
    scene = patches.scene
    origin, first, second = scene.frames
    normal = np.cross(first, second)
    result = []
    for p, d in zip(point, direction, strict=True):
        t = np.einsum("ij,ij->i", origin - p, normal) / (normal @ d)
        at = p + t[:, None] * d - origin
        u, v, _ = np.linalg.solve(np.stack([first, second, normal], axis=2), at[:, :, None])[:, :, 0].T
        inside = (u > 0) & (v > 0) & (np.where(scene.is_quad, np.maximum(u, v), u + v) < 1)
        rows = np.flatnonzero(inside)
        crossed = []
        for f in rows[np.argsort(t[rows])]:
            columns = (u, v, patches.columns, patches.rows, scene.is_quad)
            cell = cells.number(*(x[f : f + 1] for x in columns))[0]
            back = rd.Back(scene.back[f])
            behind = patches.first[f] + cell + patches.cells_per_face[f] if back == rd.Back.RADIATES else back
            crossed.append((patches.first[f] + cell, behind, normal[f] @ d < 0))
        result.append(crossed)
    return result


def looks(sides):
    """(from, to) of all patches that look along a line, which meets these sides (near, far) one after the other."""
    found = []
    for at, (_, side) in enumerate(sides):
        if isinstance(side, rd.Back):
            continue
        ahead = next((near for near, _ in sides[at + 1 :] if near is not rd.Back.PASSES), ESCAPED)
        found.append((int(side), LOST if ahead is rd.Back.ABSORBS else int(ahead)))
    return found


@pytest.mark.parametrize("passing", [False, True])
@pytest.mark.parametrize("kind", ["global", "global-disc"])
def test_spans_are_those_that_numpy_finds(kind, passing):
    patches = rd.subdivide(jumble(passing), cells=2)
    spans, count = spans_of(patches, kind, replicates=2), 3000
    pairs = spans.draw(1, 77, count)
    types, tree = choose("cpu").types, spans.geometry.bvh
    words = [upload(types.UInt32, np.full(count, w, np.uint32)) for w in np.array(spans._words(0))[8:]]
    index = upload(types.UInt32, np.arange(78, 78 + count, dtype=np.uint32))
    numbers = spans._numbers.points(index, types.UInt32(0), words, 32)
    make = global_lines.by_two_points if kind == "global" else global_lines.by_disc
    point, direction = (np.array(x, np.float64).T for x in make(numbers, types.Float(spans.radius), types.Array3f))
    point = (point + spans.middle - 4 * 2.0**REACH * direction) / tree.scale + tree.centre  # well before the scene
    assert (np.diff(pairs.line.astype(int)) >= 0).all()
    wrong = 0
    for line, crossed in enumerate(all_hits(patches, point, direction)):
        rows = slice(*np.searchsorted(pairs.line, (line, line + 1)))
        forward = [(front, back) if first else (back, front) for front, back, first in crossed]
        backward = [(far, near) for near, far in forward[::-1]]
        expected = sorted(looks(forward) + looks(backward))
        found = []
        for one, other in zip(pairs.one[rows].tolist(), pairs.other[rows].tolist(), strict=True):
            if one < ONE_WAY:
                found.append((one, other & (ONE_WAY - 1) if other < CODES else other))
            if other < ONE_WAY:
                found.append((other, one))
        wrong += sorted(found) != expected
        if not passing and sorted(found) == expected:  # in order of depth: what a span ends on has the next begin behind it
            places = {patch: at for at, side in enumerate(forward) for patch in side if not isinstance(patch, rd.Back)}
            depth = [
                places[one] if one < ONE_WAY else places[other] - 1
                for one, other in zip(pairs.one[rows].tolist(), pairs.other[rows].tolist(), strict=True)
            ]
            assert depth == sorted(depth)
    assert wrong <= 3  # lines within single precision of an edge
    assert len(pairs.line) > 1000
    assert (pairs.other >= ONE_WAY).any()
    assert ((pairs.other >= ONE_WAY) & (pairs.other < CODES)).any() == passing


@pytest.mark.parametrize("kind", KINDS)
def test_place_and_size_do_not_matter(kind):
    scene, counts = rd.load_scene("room"), []
    for scale, move in ((1.0, 0.0), (1e4, -3e4), (1e-3, 2e-3)):
        moved = rd.Scene.from_arrays(scene.vertices * scale + move, scene.faces, 0.5, 1.0, back=scene.back)
        pairs = spans_of(rd.subdivide(moved, cells=2), kind, numbers="halton").draw(0, 0, 1 << 16)
        counts.append(
            (len(pairs.line), np.count_nonzero(pairs.other == LOST), np.count_nonzero(pairs.other == ESCAPED), pairs.line.max())
        )
    counts = np.array(counts, float)
    assert np.abs(counts - counts[0]).max(axis=0) == pytest.approx(0, abs=6)
    assert counts[:, 2].max() <= 2  # closed, up to lines within single precision of an edge


@pytest.mark.parametrize("kind", KINDS)
def test_lines_can_be_drawn_in_any_pieces(kind):
    spans = spans_of(rd.subdivide(rd.load_scene("room"), cells=2), kind, numbers="halton", replicates=2)
    whole = spans.draw(1, 10, 300_000)
    for first, count in ((10, 1), (11, 2), (13, 40_000), (299_900, 110)):
        piece = spans.draw(1, first, count)
        rows = slice(*np.searchsorted(whole.line, (first - 10, first - 10 + count)))
        assert np.array_equal(piece.line + (first - 10), whole.line[rows])
        if kind != "bundles":  # where packets settle ties
            assert np.array_equal(piece.one, whole.one[rows])
            assert np.array_equal(piece.other, whole.other[rows])
    assert len(spans.draw(0, 0, 0).line) == 0


def test_a_small_thing_before_a_side_lies_beyond_it():
    """Of a box that stands askew, with a triangle a millimetre above the middle of one side: no direction has it farthest."""
    turn, _ = np.linalg.qr(np.random.Generator(np.random.Philox(5)).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    corners = np.concatenate(box((-1, -1, -1), (1, 1, 1)))
    small = [(1.001, 0, 0), (1.001, 0.01, 0), (1.001, 0, 0.01)]
    faces = [*np.arange(24).reshape(6, 4).tolist(), [24, 25, 26, -1]]
    scene = rd.Scene.from_arrays(np.concatenate([corners, small]) @ turn.T, faces, 0.5, 1.0)
    before, behind = nothing_beyond(Geometry(rd.subdivide(scene, cells=1), choose("cpu"))).T
    under = (scene.normal @ turn)[:6, 0] > 0.9
    assert under.sum() == 1
    assert before.tolist() == [*~under, True]
    assert not behind.any()


def test_local_lines_have_no_spans():
    geometry = Geometry(rd.subdivide(cube(), cells=1), choose("cpu"))
    with pytest.raises(MethodError, match="local"):
        Spans(geometry, rd.Method(), 0, 1)
