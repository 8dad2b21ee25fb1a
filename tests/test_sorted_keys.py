"""Sorted keys find what slower searches find: equal vertices, shared edges, the best pairs, medians by weight."""

from collections import defaultdict

import numpy as np
import pytest

from radiosity.pieces import PIECE
from radiosity.scene import edges_together, twins
from radiosity.scene.matching import matched
from radiosity.scene.measures import measured
from radiosity.scene.precision import FEW, TIE, weighted_median
from radiosity.scene.shared_edges import shared_edges
from radiosity.scene.triangle_edges import ENDS, Triangles
from radiosity.scene.twins import Cells, mostly_alike, perhaps_twins
from radiosity.scene.welded import welded


def grid(cells: int, seed: int, shuffled: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a grid, with copies of triangles that make edges of three and more."""
    random = np.random.Generator(np.random.Philox(seed))
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.arange(cells + 1.0)] * 2, indexing="ij"))
    i, j = (axis.ravel() for axis in np.meshgrid(*[np.arange(cells)] * 2, indexing="ij"))
    a = i * (cells + 1) + j
    b, c, d = a + cells + 1, a + cells + 2, a + 1
    faces = np.stack([a, b, c, a, c, d], 1).reshape(-1, 3)
    if shuffled:
        faces = faces[random.permutation(len(faces))]
    copies = [faces[:5], faces[5:9, ::-1], faces[9:12, [1, 2, 0]]]
    return np.stack([x, 0.7 * y, np.sin(0.1 * x)], axis=1), np.concatenate([faces, *copies])


def cells_of(vertices, faces) -> Cells:
    """The cells of triangles, (n, 3)."""
    cells = Cells.empty(len(faces), 2e-6)
    measured(vertices, with_fourth(faces), cells.put)
    return cells


def with_fourth(faces) -> np.ndarray:
    """Triangles, (n, 3), as faces, (n, 4)."""
    return np.column_stack([faces, np.full(len(faces), -1)])


def users(faces, surface) -> dict:
    """Edges, where they start and the corner across, by their ends and surface."""
    of = defaultdict(list)
    for row, face in enumerate(faces):
        for corner in range(3):
            start, end = face[corner], face[ENDS[corner]]
            of[(min(start, end), max(start, end), surface[row])].append((4 * row + corner, start, face[(corner + 2) % 3]))
    return of


def pairs_by_counting(vertices, faces, surface) -> set:
    """Pairs of edges that only two triangles of a surface have, in opposite directions, whose triangles are a parallelogram."""
    found = set()
    for (low, high, _), two in users(faces, surface).items():
        if len(two) == 2 and two[0][1] != two[1][1]:
            off = vertices[low] + vertices[high] - vertices[two[0][2]] - vertices[two[1][2]]
            if np.linalg.norm(off) < 1e-9:
                found.add(frozenset(user[0] for user in two))
    return found


MANY = {"shared_edges.perhaps_twins": lambda triangles, cells: None}  # twins: edges of all triangles are looked at
WAYS = {
    "some": {},
    "blocks": {**MANY, "shared_edges.BLOCK": 64},
    "all at once": {**MANY, "shared_edges.MOSTLY": -1.0},
    "blocks with vertices too far apart": {**MANY, "shared_edges.PLACE": np.uint64(3)},
    "rows decide": {"edges_together.LEAST_BITS": 64},  # beside both numbers, which no key has
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("order", ["any", "of the mesh"])
def test_edges_of_parallelograms(way, order, monkeypatch):
    for name, value in WAYS[way].items():
        monkeypatch.setattr(f"radiosity.scene.{name}", value)
    vertices, faces = grid(12, 1, order == "any")
    surface = (np.arange(len(faces)) % 7 == 0).astype(np.int32)
    measures = measured(vertices, with_fourth(faces))
    one, two = shared_edges(vertices, faces, surface, measures, 2e-6, cells=cells_of(vertices, faces))
    found = {frozenset(pair) for pair in zip(one.tolist(), two.tolist(), strict=True)}
    wanted = pairs_by_counting(vertices, faces, surface)
    assert len(wanted) > 100
    assert wanted <= found
    assert len(found) == len(one)
    assert found <= {frozenset(user[0] for user in some) for some in users(faces, surface).values() if len(some) == 2}
    assert len(found - wanted) < 0.1 * len(wanted)  # no more than the tolerance lets pass


def test_edges_whose_bits_are_equal_by_chance(monkeypatch):
    """Upper vertices and surfaces leave no trace in keys: edges of one lower vertex have equal bits, and rows decide."""
    monkeypatch.setattr(edges_together, "MIX", np.uint64(0))
    vertices, faces = grid(8, 2)
    surface = np.zeros(len(faces), np.int32)
    measures = measured(vertices, with_fourth(faces))
    one, two = shared_edges(vertices, faces, surface, measures, 2e-6, cells=cells_of(vertices, faces))
    assert pairs_by_counting(vertices, faces, surface) <= {frozenset(p) for p in zip(one.tolist(), two.tolist(), strict=True)}
    assert (faces[one >> 2, one & 3] == faces[two >> 2, np.take(ENDS, two & 3)]).all()


def test_equal_vertices_have_equal_numbers(random, monkeypatch):
    points = random.integers(-2, 2, (3000, 3)) * 0.5
    points[random.random(points.shape) < 0.1] *= -1  # zeros of both signs
    wanted = np.unique(points + 0.0, axis=0, return_inverse=True)[1].ravel()

    def check():
        number = welded(points)
        assert number is not None
        assert len(set(zip(number, wanted, strict=True))) == len(set(wanted)) == len(set(number))

    assert welded(np.arange(300.0).reshape(-1, 3)) is None
    check()
    monkeypatch.setattr("radiosity.scene.welded.mixed", lambda values: values * np.uint64(0))  # all keys are equal
    check()


def matched_one_by_one(one, two, cost) -> set[int]:
    taken, chosen = set(), set()
    for pair in np.lexsort((np.maximum(one, two), np.minimum(one, two), np.round(cost, 6))):
        if not {one[pair], two[pair]} & taken:
            taken |= {one[pair], two[pair]}
            chosen.add(int(pair))
    return chosen


def test_the_best_pairs_are_taken(random):
    """Costs have ties. Each triangle has up to three pairs, as in a mesh."""
    n, slots = 400, defaultdict(list)
    pairs = []
    for one, two in random.integers(0, n, (900, 2)):
        if one != two and len(slots[one]) < 3 and len(slots[two]) < 3 and two not in slots[one]:
            pairs.append((one, two, len(slots[one]), len(slots[two])))
            slots[one].append(two)
            slots[two].append(one)
    one, two, first, second = np.array(pairs).T
    cost = -random.integers(0, 40, len(one)) / 8
    assert set(matched(one, two, (first, second), cost, n).tolist()) == matched_one_by_one(one, two, cost)


@pytest.mark.parametrize("shape", ["even", "few values", "far away", "one"])
def test_medians(shape, random):
    n = FEW + PIECE + 17
    values = {
        "even": random.random(n),
        "few values": random.integers(0, 5, n) / 3,
        "far away": np.where(np.arange(n) < 3, 1e9, random.normal(size=n)),
        "one": np.full(n, 0.25),
    }[shape]
    weights = random.random(n) ** 4
    order = np.argsort(values, kind="stable")
    sums = np.cumsum(weights[order])
    assert weighted_median(values, weights) == values[order[np.searchsorted(sums, sums[-1] / 2 * (1 - TIE))]]


def test_triangles_without_a_twin_are_left_out(random):
    """Halves of parallelograms are kept, wherever they lie and however large; of other triangles nearly all are left out."""
    n = 4000
    origin, along, up = random.normal(size=(n, 3)) * 100, *random.normal(size=(2, n, 3)) * 10.0 ** random.uniform(-3, 3, (n, 1))
    corners = np.stack([origin, origin + along, origin + up, origin + along + up], axis=1)
    corners[n // 2 :, 3] += 0.01 * along[n // 2 :]  # of no parallelogram
    corners[: n // 2, 3] += 1.3e-6 * along[: n // 2] * random.choice([-1, 1], (n // 2, 1))  # within the tolerance
    first = 4 * np.arange(n)
    faces = np.concatenate([first[:, None] + [0, 1, 2], first[:, None] + [3, 2, 1]])
    points = corners.reshape(-1, 3)
    axes = [np.ascontiguousarray(axis) for axis in points.T]
    kept = perhaps_twins(Triangles(faces, None, np.zeros(2 * n, np.int32), axes, 2e-6), cells_of(points, faces))
    assert kept is not None
    is_half = np.tile(np.arange(n) < n // 2, 2)
    assert np.isin(np.flatnonzero(is_half), kept).all()
    assert np.isin(np.flatnonzero(~is_half), kept).mean() < 0.15


@pytest.mark.parametrize(("shape", "taken"), [("flat", False), ("half flat", False), ("slivers", True), ("round", True)])
def test_where_few_alike_triangles_have_a_twin_only_those_are_looked_at(shape, taken, monkeypatch):
    """Slivers are alike, but halves of nothing; their edges alone are looked at. A grid's halves are most of all its edges."""
    monkeypatch.setattr(twins, "SIZE", 128)
    monkeypatch.setattr(twins, "SAMPLE", 8)
    rows, columns = 32, 64
    u, v = (x.ravel() for x in np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij"))
    slivers = (u < 0.5) if shape == "slivers" else np.zeros(len(u), bool)  # half of the rows are far longer than wide
    wide = np.where(slivers, 1e-5, 1.0)
    bent = 0.5 * {"flat": u < 0, "half flat": u > 0.5}.get(shape, u >= 0)
    points = np.stack([u + bent * u**2 * v, wide * (v + bent * v**2 * (1 + u)), bent * np.sin(2 * u + wide * v) * v], axis=1)
    at = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = at[:-1, :-1], at[:-1, 1:], at[1:, :-1], at[1:, 1:]
    faces = np.stack([np.stack([a, c, b], axis=-1), np.stack([b, c, d], axis=-1)], axis=2).reshape(-1, 3)
    axes = [np.ascontiguousarray(axis) for axis in points.T]
    kept = perhaps_twins(Triangles(faces, None, np.zeros(len(faces), np.int32), axes, 2e-6), cells_of(points, faces))
    assert (kept is not None) == taken
    assert mostly_alike(points, with_fourth(faces), 2e-6) == (shape == "flat")
    if shape == "slivers":
        assert kept is not None
        assert twins.MOSTLY < len(kept) / len(faces) < twins.ALIKE
