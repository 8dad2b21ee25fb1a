"""Walks are functions of seed, replicate, patch and index: sums do not depend on order; books; and the two equations are told
apart."""

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.walks.particles import SEGMENTS, PathSegments
from radiosity.device.backend import choose
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.line_tracer import LineTracer

QUANTA = 30_000
KINDS = {
    "continuous": rd.Method(equation="continuous"),
    "discrete": rd.Method(absorption="drawn"),
    "survival": rd.Method(equation="continuous", estimator="survival"),
    "gathering": rd.Method(estimator="gathering"),
    "fractional": rd.Method(equation="continuous", absorption="fractional"),
}


@pytest.fixture(scope="module")
def colours():
    """Bands that differ, an opening, and two-sided blocks."""
    return rd.subdivide(rd.load_scene("cornell-box"), cells=3)


def sums(solution):
    return {name: value for name, value in solution.state.items() if name != "quanta"}


def equal(one, two):
    return sums(one).keys() == sums(two).keys() and all(np.array_equal(sums(one)[k], sums(two)[k]) for k in sums(one))


@pytest.mark.parametrize("kind", ["continuous", "discrete", "survival"])
def test_orders_end_in_equal_sums(colours, kind):
    solutions = [
        rd.solve(colours, replace(KINDS[kind], order=order), quanta=QUANTA, replicates=3)
        for order in ("breadth-first", "depth-first", "staged")
    ]
    assert equal(solutions[0], solutions[1])
    assert equal(solutions[0], solutions[2])


def test_books_of_collisions_close_in_whole_numbers(colours):
    for kind in ("continuous", "discrete", "fractional"):
        solution = rd.solve(colours, KINDS[kind], quanta=QUANTA, replicates=2)
        assert all(book["closes"] is True for book in solution.books)
        assert solution.books[0]["escaped"] > 0


def test_books_of_other_estimators_say_that_they_balance_on_average_only(colours):
    for kind in ("survival", "gathering"):
        solution = rd.solve(colours, KINDS[kind], rays=4e6, replicates=2)
        for book in solution.books:
            assert book["closes"] is None
            assert abs(book["rounding"]) < 0.05 * book["emitted"]


def test_a_continuous_walk_leaves_from_where_it_landed():
    """On undivided walls the discrete walk forgets where on them light landed; the continuous one agrees with fine patches."""
    scene = rd.load_scene("room")
    patches = rd.subdivide(scene, cells=1)
    one = rd.solve(patches, KINDS["continuous"], rays=2_000_000, replicates=8)
    two = rd.solve(patches, KINDS["discrete"], rays=2_000_000, replicates=8)
    error = np.hypot(one.irradiance_standard_error, two.irradiance_standard_error)
    assert np.abs((one.irradiance - two.irradiance) / error).max() > 20
    fine = rd.subdivide(scene, cells=8)
    parents = np.repeat(np.arange(len(patches)), 64)
    exact = rd.solve(fine, "random-walk", rays=20_000_000, replicates=8).irradiance[:, 0]
    mean = np.bincount(parents, exact * fine.area) / patches.area
    assert np.average(np.abs(one.irradiance[:, 0] / mean - 1), weights=patches.area) < 0.02
    assert np.average(np.abs(two.irradiance[:, 0] / mean - 1), weights=patches.area) > 0.03


def test_later_segments_are_drawn_anew_in_each_replicate_and_block(colours):
    geometry = Geometry(colours, choose("cpu"))
    segments = PathSegments(LineTracer.of(geometry, "halton", "by-patch", 1, 3), KINDS["continuous"])
    words = np.concatenate([np.array(of_block.randomisations).reshape(-1, 8) for of_block in (segments, segments.in_block(1))])
    assert len(np.unique(words, axis=0)) == 2 * 3 * SEGMENTS
