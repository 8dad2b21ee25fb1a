"""Light of clusters by direction: against sums over their sides."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.hierarchical.directed import Directed, products, terms
from radiosity.algorithms.hierarchical.exchange import Exchange
from radiosity.algorithms.hierarchical.levels import Levels
from radiosity.algorithms.hierarchical.links import Links
from radiosity.patches import Hierarchy
from radiosity.patches.clusters import grow
from radiosity.scene.shapes import quad


def turned(random, count: int) -> np.ndarray:
    """Small squares in all directions within a ball about the origin, (count, 4, 3)."""
    found = []
    for centre in random.uniform(-0.5, 0.5, (count, 3)):
        first, second = 0.05 * np.linalg.qr(random.normal(size=(3, 3)))[0][:2]
        found.append(quad(centre, first, second))
    return np.stack(found)


def scattered(count: int = 300, far: float = 40.0):
    """Levels of two balls of squares, far apart, and the numbers of the clusters that hold all of each."""
    random = np.random.default_rng(5)
    corners = np.concatenate([turned(random, count), turned(random, count) + np.array([far, 0, 0])]).reshape(-1, 3)
    faces = np.arange(len(corners)).reshape(-1, 4)
    scene = rd.Scene.from_arrays(corners, faces, np.full(2 * count, 0.5), random.uniform(0, 9, (2 * count, 1)))
    hierarchy = Hierarchy(rd.subdivide(scene, cells=1, powers_of_two=True))
    levels = Levels(hierarchy, grow(hierarchy))
    ends = [1, 2]
    assert [int(levels.clusters.end[n] - levels.clusters.begin[n]) for n in ends] == [count, count]
    return levels, [len(hierarchy) + n for n in ends]


def link(receiver: int, source: int, factor: float = 1e-3) -> Links:
    return Links(np.array([receiver]), np.array([source]), np.array([factor]), np.array([0.0]))


def sides_of(levels, number):
    clusters = levels.clusters
    at = number - len(levels.hierarchy)
    return clusters.order[clusters.begin[at] : clusters.end[at]]


def test_the_terms_are_the_clamped_cosine_to_a_tenth():
    angle = np.linspace(0, np.pi, 181)
    normals = np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=1)
    found = products(normals) @ terms(np.array([[0.0, 0.0, 1.0]]))[0]
    assert np.abs(found - np.maximum(np.cos(angle), 0)).max() < 0.1
    assert np.average(found, weights=np.sin(angle)) == pytest.approx(0.25, abs=1e-3)  # the mean over the sphere


def test_a_cluster_sends_what_its_sides_show():
    """The radiosity that a receiver sees is the mean over sides, weighted by the area that each shows."""
    levels, (one, other) = scattered()
    mean, sides = levels.pull(levels.hierarchy.patches.emission), sides_of(levels, other)
    way = levels.clusters.spheres[0][1] - levels.clusters.spheres[0][2]
    shown = levels.clusters.side_area[sides] * np.maximum(levels.clusters.normal[sides] @ (way / np.linalg.norm(way)), 0)
    own = mean[levels.hierarchy.first[:-1]][sides, 0]
    seen = Directed.of(levels, link(one, other)).sent(link(one, other), mean)[0, 0]
    assert seen == pytest.approx(shown @ own / shown.sum(), rel=0.05)
    # without directions it would be the mean of all sides
    bright = np.where(levels.clusters.normal @ way > 0, 8.0, 1.0)[:, None]  # what faces the receiver is bright
    bright = levels.pull(bright[np.searchsorted(levels.hierarchy.first[:-1], levels.leaf, side="right") - 1])
    assert bright[other, 0] == pytest.approx(4.5, abs=0.6)
    assert Directed.of(levels, link(one, other)).sent(link(one, other), bright)[0, 0] > 7


def test_a_cluster_answers_by_the_direction_of_its_sides():
    """The power is that of the link; sides that face the source get it, and those that face away next to nothing."""
    levels, (one, other) = scattered()
    links = link(one, other)
    received = Exchange(levels, links).gather(np.ones((len(levels.leaf), 1)))[:, 0]
    sides = sides_of(levels, one)
    area, cosine = levels.clusters.side_area, levels.clusters.normal[:, 0]  # the source lies along x
    assert area[sides] @ received[sides] == pytest.approx(links.factor[0] * levels.area[one], rel=0.05)
    outside = np.setdiff1d(np.arange(len(area)), sides)
    assert not received[outside].any()
    facing, away = sides[cosine[sides] > 0.7], sides[cosine[sides] < -0.7]
    assert received[facing].mean() > 10 * received[away].mean()
