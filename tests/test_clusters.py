"""Clusters of sides: the tree, factors of balls, pairs covered once, and random walks on the same patches."""

import math

import enclosures
import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.hierarchical import REFINEMENTS, Hierarchical, parameters, solve_hierarchical, values
from radiosity.algorithms.hierarchical.answers import replaced
from radiosity.algorithms.hierarchical.bounds import bounded
from radiosity.algorithms.hierarchical.levels import Levels
from radiosity.algorithms.hierarchical.links import Links
from radiosity.algorithms.hierarchical.rounds import Rounds
from radiosity.algorithms.hierarchical.values import valued
from radiosity.algorithms.hierarchical.volumes import volumetric
from radiosity.patches import Hierarchy
from radiosity.patches.clusters import Clusters, grow
from radiosity.scene.shapes import box, quad


def litter(random, count: int) -> rd.Scene:
    """A room of 4 x 4 x 4 m with a lamp, and small squares that hang in it, bright on some."""
    walls, lamp = box((0, 0, 0), (4, 4, 4), inward=True), quad((1.5, 1.5, 3.9), (0, 1, 0), (1, 0, 0))
    squares = []
    for centre in random.uniform(0.5, 3.5, (count, 3)):
        first, second = 0.15 * np.linalg.qr(random.normal(size=(3, 3)))[0][:2]
        squares.append(quad(centre, first, second))
    corners = np.concatenate([*walls, lamp, *squares])
    faces = np.arange(len(corners)).reshape(-1, 4)
    emission = np.zeros((len(faces), 1))
    emission[6] = 10.0
    reflectance = np.concatenate([np.full(7, 0.6), random.uniform(0.2, 0.8, count)])
    return rd.Scene.from_arrays(corners, faces, reflectance, emission, two_sided=[False] * 7 + [True] * count)


def rounds(patches, geometry=None, **parameters) -> Rounds:
    found = Rounds(patches, geometry, Hierarchical(clusters=True, **parameters), lambda rays: None)
    while not found.done:
        found.advance()
    return found


@pytest.fixture(scope="module")
def patches():
    return rd.subdivide(litter(np.random.default_rng(3), 50), cells=2, powers_of_two=True)


def test_each_cluster_holds_the_sides_of_its_children(patches):
    clusters = grow(Hierarchy(patches))
    assert np.array_equal(np.sort(clusters.order), np.arange(len(clusters.order)))
    children, start = clusters.children
    sides = len(clusters.hierarchy)
    root = {int(element): side for side, element in enumerate(clusters.hierarchy.first[:-1])}
    dark = (patches.emission == 0).all(axis=1)[clusters.hierarchy.side_patch]
    for begin, end in zip(clusters.begin[1:], clusters.end[1:], strict=True):  # lamps are apart from all else
        assert len(np.unique(dark[clusters.order[begin:end]])) == 1
    assert len(children) == len(clusters) - 1 + len(clusters.order)
    for cluster, (begin, end) in enumerate(zip(clusters.begin, clusters.end, strict=True)):
        held = []
        for child in children[start[cluster] : start[cluster + 1]]:
            held += (
                [root[child]]
                if child < sides
                else list(clusters.order[clusters.begin[child - sides] : clusters.end[child - sides]])
            )
        assert sorted(held) == sorted(clusters.order[begin:end])
        assert clusters.area[cluster] == pytest.approx(clusters.side_area[held].sum())
        centre, radius = (x[cluster] for x in clusters.spheres)
        assert np.linalg.norm(clusters.corners[held] - centre, axis=2).max() <= radius * (1 + 1e-12)


def test_sides_are_drawn_in_proportion_to_area(patches):
    clusters = grow(Hierarchy(patches))
    drawn = clusters.drawn(np.zeros(100_000, np.int64), (np.arange(100_000) + 0.5) / 100_000)
    share = np.bincount(drawn, minlength=len(clusters.order)) / 100_000
    np.testing.assert_allclose(share, clusters.side_area / clusters.area[0], atol=2e-5)


def test_push_and_pull_conserve_power_over_clusters(patches, random):
    levels = Levels(Hierarchy(patches), grow(Hierarchy(patches)))
    radiosity = random.uniform(size=(len(patches), 2))
    pulled = levels.pull(radiosity)
    whole = len(levels.hierarchy)
    np.testing.assert_allclose(pulled[whole] * levels.area[whole], patches.area @ radiosity, rtol=1e-12)
    alone = np.zeros((len(levels.area), 1))
    alone[whole] = 3.0
    np.testing.assert_allclose(levels.push(alone), 3.0)
    low, high = levels.extremes(radiosity)
    assert (low[whole] == radiosity.min(axis=0)).all()
    assert (high[whole] == radiosity.max(axis=0)).all()


def covered(found: Rounds) -> np.ndarray:
    """How often links cover each pair of patches, (n_patches, n_patches)."""
    count = len(found.levels.leaf)
    inside = np.zeros((len(found.levels.area), count), bool)
    inside[found.levels.leaf, np.arange(count)] = True
    for element in reversed(found.levels.below):
        np.logical_or.at(inside, found.levels.parent[element], inside[element])
    times = np.zeros((count, count), np.int64)
    for receiver, source in zip(found.links.receiver, found.links.source, strict=True):
        times[np.ix_(inside[receiver], inside[source])] += 1
    return times


def test_links_cover_each_pair_that_faces_once(patches):
    """Coarse links and fine ones, those within a cluster among them."""
    middle, normal = patches.centroid, patches.normal
    way = middle[None] - middle[:, None]
    ahead = np.einsum("ijk,ik->ij", way, normal) > 1e-6
    facing = ahead & ahead.T
    for epsilon in (1.0, 0.01):
        found = rounds(patches, epsilon=epsilon, refinement="error-power")
        times = covered(found)
        assert times.max() == 1
        assert times[facing].min() == 1
    assert (found.links.receiver >= len(found.hierarchy)).any()
    assert (found.links.receiver < len(found.hierarchy)).any()


def ball_and_square(turned: float) -> Clusters:
    """A ball of radius 1, whose sides are cluster 1, and a small square 4 m below its middle, turned from it by degrees."""
    ball = enclosures.sphere(0.0, 0.0, 2)
    angle = math.radians(turned)
    square = 0.01 * quad((0, 0, 0), (0, 1, 0), (-math.cos(angle), 0, math.sin(angle)))
    triangles = np.column_stack([ball.faces[:, [0, 2, 1]], np.full(ball.n_faces, -1)])
    corners = np.concatenate([ball.vertices, square - (0, 0, 4)])
    n = ball.n_faces
    scene = rd.Scene.from_arrays(corners, np.concatenate([triangles, np.arange(4)[None] + len(ball.vertices)]), 0.0, 1.0)
    assert scene.normal[n, 2] == pytest.approx(math.cos(angle))
    side_parent = np.append(np.ones(n, int), 0)  # all sides, and the ball among them
    ranges = np.zeros(2, int), np.array([n + 1, n])
    tree = Hierarchy(rd.subdivide(scene, cells=1))
    return Clusters(tree, np.arange(n + 1), *ranges, np.array([-1, 0]), np.arange(2), side_parent)


@pytest.mark.parametrize("turned", [0.0, 60.0])
def test_a_ball_is_seen_as_a_cluster_by_its_closed_form(turned):
    """F from a small square to a ball of radius R at distance d is cos R² / d², and reciprocity gives the way back."""
    clusters = ball_and_square(turned)
    tree, n = clusters.hierarchy, len(clusters.order) - 1
    here, there = np.array([n]), np.array([len(tree) + 1])
    seen, back = (
        volumetric(clusters, None, Hierarchical(refinement="error-power", rays=0), *ends)[0]
        for ends in ((here, there), (there, here))
    )
    cosine = math.cos(math.radians(turned))
    assert seen.factor[0] == pytest.approx(cosine / 16, rel=0.02)  # the polyhedron's area is 1.5 % below the ball's
    assert back.factor[0] * clusters.area[1] == pytest.approx(seen.factor[0] * clusters.side_area[n])
    assert 0 < seen.spread[0] < 0.5 * seen.factor[0]  # how much it may vary over the square, by directions to the ball's rim
    assert back.spread[0] > back.factor[0]  # half of the ball sees nothing, and its pole four times the mean


@pytest.mark.parametrize("far", [2.5, 10.0])
def test_lines_find_a_ball_as_it_shines(monkeypatch, far, geometry_of):
    """The irradiance is cos / 16 where the near half shines, too, and 0 where the far half does; with and without cosine lines.

    Of 2^14 lines about one in eight counts: 2 % is five standard errors.
    """
    monkeypatch.setattr(values, "FAR", far)
    clusters = ball_and_square(60.0)
    tree, n = clusters.hierarchy, len(clusters.order) - 1
    links = Links(np.array([n, len(tree) + 1]), np.array([len(tree) + 1, n]), np.zeros(2), np.zeros(2))
    near = 1.0 * (clusters.corners.mean(axis=1)[:, 2] < 0)
    for shine, bright in ((np.ones(n + 1), 1), (near, 1), (1 - near, 0)):
        found = valued(clusters, geometry_of(tree.patches), (1 << 14, 0), links, shine)
        assert found.rays == (2 << 14 if far < 4 else 4 << 14)
        assert set(found.links.receiver[found.row == 0]) <= {n}
        received = np.bincount(found.row, weights=found.links.factor * shine[found.links.source], minlength=2)
        assert received[0] == pytest.approx(bright * 0.5 / 16, rel=0.035)  # 1.5 % as the polyhedron is less than the ball
        factor = found.links.factor[found.row == 1].sum()
        assert factor * clusters.area[1] == pytest.approx(0.5 / 16 * clusters.side_area[n], rel=0.035)


def test_no_line_to_a_near_side_counts_for_more_than_its_share(geometry_of):
    """Two squares that touch: cos cos' / r² has no bound there, and lines of both kinds together bring the closed form."""
    corners = np.concatenate([quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, 0), (0, 1, 0), (0, 0, 1))])
    scene = rd.Scene.from_arrays(corners, np.arange(8).reshape(2, 4), 0.0, 1.0)
    tree = Hierarchy(rd.subdivide(scene, cells=1))
    clusters = Clusters(tree, np.arange(2), np.array([0, 1]), np.array([2, 2]), np.array([-1, 0]), np.arange(2), np.array([0, 1]))
    links = Links(np.array([0]), np.array([3]), np.zeros(1), np.zeros(1))
    found = valued(clusters, geometry_of(tree.patches), (1 << 12, 0), links, np.ones(2))
    assert found.links.factor.sum() == pytest.approx(0.2000438, rel=0.02)
    few = [valued(clusters, geometry_of(tree.patches), (1, seed), links, np.ones(2)).links.factor.sum() for seed in range(20)]
    assert max(few) <= 2


def test_factors_that_lines_find_let_light_fade(patches):
    """Where light would last, sums of factors times the reflectance are at most 0.98, and only what lines found is scaled."""
    levels = Levels(Hierarchy(patches), grow(Hierarchy(patches)))
    random, count = np.random.default_rng(1), len(levels.area)
    receiver = np.append(random.integers(0, count, 4 * count), len(levels.hierarchy))  # at last the whole scene
    source = random.integers(0, len(levels.hierarchy), len(receiver))
    links = Links(receiver, source, np.append(random.uniform(0, 0.2, 4 * count), 0.5), np.zeros(len(receiver)))
    lines = np.arange(len(receiver)) < 4 * count
    found = bounded(levels, links, lines)
    assert found.factor[-1] == 0.5
    assert (found.factor <= links.factor).all()
    before, after = (
        levels.push(np.bincount(receiver, weights=some.factor, minlength=count)[:, None])[:, 0] * patches.reflectance[:, 0]
        for some in (links, found)
    )
    assert (before > 1.1).any()
    assert after.max() <= 0.98 + 1e-12
    few = Links(receiver, source, links.factor / 100, links.spread)
    assert bounded(levels, few, lines) is few


def test_sides_answer_for_the_clusters_that_receive_most(patches):
    """Links are replaced by those of all sides below, the best by squared error for a link first, no more than are wanted."""
    levels = Levels(Hierarchy(patches), grow(Hierarchy(patches)))
    clusters = levels.clusters
    assert clusters is not None
    count, n = len(levels.hierarchy), len(clusters)
    receiver, lamp, brought = count + np.arange(n), levels.hierarchy.first[6], np.linspace(1, 2, n)
    links = Links(receiver, np.full(n, lamp), np.zeros(n), np.zeros(n))
    chosen, sides, sources = replaced(levels, links, brought, n)
    held = clusters.end - clusters.begin
    gain = clusters.area * brought**2 / held
    assert held[chosen].sum() == len(sides) <= n < held.sum()
    assert gain[chosen].min() >= gain[~chosen & (held <= n - len(sides))].max()
    wanted = [clusters.order[clusters.begin[k] : clusters.end[k]] for k in np.flatnonzero(chosen)]
    assert np.array_equal(np.sort(sides), np.sort(levels.hierarchy.first[np.concatenate(wanted)]))
    assert (sources == lamp).all()


@pytest.mark.parametrize(
    "refinement", [REFINEMENTS[0], *(pytest.param(other, marks=pytest.mark.slow) for other in REFINEMENTS[1:])]
)
def test_random_walks_agree_the_better_the_smaller_epsilon(patches, refinement, geometry_of):
    """On 100 sides of squares that turn any way: 1.2 to 4.5 %, and 0.2 to 0.9 %, with the walk's variance taken off.

    Links have 256 rays: with 16 the second error is 1.0 to 1.5 %, which their rays alone make, whatever epsilon is.
    """
    walk = rd.solve(patches, "random-walk", rays=2_000_000, replicates=4, seed=5)
    area, errors, geometry = patches.area, [], geometry_of(patches)
    for epsilon in (1e-2, 3e-4):
        result = solve_hierarchical(patches, geometry, Hierarchical(epsilon, refinement, rays=256, clusters=True))
        off, light = result.radiosity - walk.radiosity, walk.radiosity - patches.emission
        square = off[:, 0] ** 2 - walk.standard_error[:, 0] ** 2
        errors.append(math.sqrt(max(area @ square, 0) / (area @ light[:, 0] ** 2)))
    assert errors[0] < 0.055
    assert errors[1] < 0.012
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.filterwarnings("ignore:.*out of balance")
def test_rounds_go_on_from_a_file_to_the_same_bits(tmp_path, monkeypatch):
    """With clusters; the links lie in the file, and their indicated errors once all rounds are complete."""
    monkeypatch.setattr(parameters, "MOST_SIDES", 20)
    patches = rd.subdivide(litter(np.random.default_rng(3), 20), cells=1, powers_of_two=True)
    method = rd.Baseline("hierarchical", refinement="error-power", epsilon=0.01, samples=4)
    whole, begun = (rd.solve(patches, method, quanta=rounds, seed=2) for rounds in (4, 2))
    assert begun.indicated is None
    begun.save(tmp_path / "begun.npz")
    after = rd.solve(patches, method, quanta=4, seed=2, resume=rd.load_solution(tmp_path / "begun.npz"))
    assert np.array_equal(after.radiosity, whole.radiosity)
    assert np.array_equal(after.history, whole.history)
    assert np.array_equal(after.state["link_factor"], whole.state["link_factor"])
    assert (whole.state["link_receiver"] >= len(Hierarchy(patches))).any()
    assert np.array_equal(after.indicated, whole.indicated)
    assert (whole.indicated > 0).all()


@pytest.mark.filterwarnings("ignore:.*out of balance")
def test_links_of_another_scene_are_refused():
    patches = rd.subdivide(rd.load_scene("room"), cells=1, powers_of_two=True)
    method = rd.Baseline("hierarchical", epsilon=0.01, samples=4)
    begun = rd.solve(patches, method, quanta=2)
    begun.state["link_source"][0] = 10**6
    with pytest.raises(rd.MethodError, match="links are not between"):
        rd.solve(patches, method, quanta=4, resume=begun)
