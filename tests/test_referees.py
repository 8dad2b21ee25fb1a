"""Exact solutions, Mitsuba's path tracer and Radiance agree with us: a selection with few lines, and all of it when asked for.

Each comparison may fail by chance with the probability that `ALPHA` says, for our seeds, which are fixed; Radiance's random
numbers are not, so that its tests ask for 1e-4.
"""

import warnings

import numpy as np
import pytest
from test_panes import two_rooms

import radiosity as rd
from validation import enclosures, path_tracer, rtrace, view_factors
from validation.comparison import ALPHA, patchwise, together
from validation.configurations import every
from validation.discretisation import halved, parents
from validation.equations import both
from validation.radiance_file import text
from validation.runs import SEEDS, solved
from validation.scenes import court, radiance_scenes, with_black_lamps

CASES = {case.name: case for case in every()}
FEW = (
    "opposed rectangles 2 x 1 at 0.7 (C-11)",
    "rectangles at 60°, common edge (C-16)",
    "rectangles square on each other, apart and offset",
    "long opposed strips past a plate between them",
    "concentric spheres, outer to inner",
    "coaxial discs (C-41)",
)


def test_a_dozen_configurations_and_more():
    assert len(CASES) == len(every()) >= 20
    assert all(0 < case.exact <= 1 for case in every())


@pytest.mark.parametrize("name", FEW)
def test_view_factors(name):
    found = view_factors.measured(CASES[name], 20_000 * SEEDS)
    assert found.p > ALPHA
    assert found.error < 0.01 * found.exact


def test_grey_rooms():
    rows = [*enclosures.box(50_000 * SEEDS), *enclosures.duct(50_000 * SEEDS), enclosures.deep_box(100_000 * SEEDS)]
    assert min(row.p for row in rows) > ALPHA
    assert together([row.p for row in rows]) > ALPHA
    assert enclosures.concentric_spheres(50_000 * SEEDS).p > ALPHA


def test_a_furnace_patch_by_patch():
    found = enclosures.labyrinth(50_000 * SEEDS)
    assert found.agrees
    assert found.rms[0] < 0.01


def test_mitsuba_and_both_equations():
    patches = rd.subdivide(court(), cells=3)
    theirs = path_tracer.irradiance(patches, 64)
    tracing, walks = both("court", patches, 50_000 * SEEDS, theirs)
    assert tracing.agrees
    assert walks.agrees
    assert tracing.rms[0] < 0.03
    wrong = patchwise("", solved(patches, 50_000 * SEEDS, method="random-walk", replicates=4), theirs)
    assert not wrong.agrees  # patches of a metre are too large for discrete walks, and it is seen


@pytest.mark.slow
def test_mitsuba_sees_through_panes():
    """The lamp stands in one room, and what falls on the other room came through the pane."""
    patches = rd.subdivide(two_rooms(np.arange(11) == 0), cells=1)
    theirs = path_tracer.irradiance(patches, 4096)[:, 1:10].mean(axis=0)
    ours = rd.solve(patches, "random-walk", equation="continuous", rays=400_000).irradiance[1:10]
    np.testing.assert_allclose(theirs, ours, rtol=0.03)
    with pytest.raises(ValueError, match="surface 'pane', face 10"):
        path_tracer.irradiance(rd.subdivide(two_rooms(np.arange(11) == 10), cells=1), 1)


def test_radiance():
    pytest.importorskip("pyradiance")
    patches = rd.subdivide(with_black_lamps(rd.load_scene("room")), cells=2)
    theirs = rtrace.irradiance(patches, 64)
    found = patchwise("room", solved(patches, 50_000 * SEEDS, method="particle-tracing", replicates=4), theirs)
    assert found.p > 1e-4
    assert found.worst[1] > 1e-4
    assert found.rms[0] < 0.05


def test_radiance_in_a_furnace_with_two_sided_walls():
    pytest.importorskip("pyradiance")
    theirs = rtrace.irradiance(patches := rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1), 64)
    z = (theirs.mean(axis=0) - 1) / (theirs.std(axis=0, ddof=1) / np.sqrt(SEEDS))
    assert np.abs(z).max() < 8  # 3 x 70 values of Student, 15 degrees of freedom: p = 210 x 8e-7
    assert abs(np.average(theirs.mean(axis=0)[:, 0], weights=patches.area) - 1) < 0.01


def test_what_radiance_cannot_have_is_refused():
    lamp = rd.load_scene("room")
    assert "void light" in text(with_black_lamps(lamp))
    assert "m1s polygon" in text(lamp) or "mixfunc" in text(lamp)
    passes = rd.Scene.from_arrays([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], 0.5, 1.0, back=[rd.Back.PASSES])
    with pytest.raises(ValueError, match="lets light pass"):
        text(passes)


def test_children_lie_in_their_parents():
    for _, coarse in radiance_scenes():
        fine = halved(coarse)
        parent = parents(fine, coarse)
        assert (np.bincount(parent) == 4).all()
        assert np.bincount(parent, fine.area) == pytest.approx(coarse.area, rel=1e-12)
        assert np.array_equal(coarse.is_back[parent], fine.is_back)
        centre = np.stack([np.bincount(parent, c) for c in fine.centroid.T], axis=1) / 4
        assert centre == pytest.approx(coarse.centroid, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("referee", [enclosures, view_factors, path_tracer, rtrace], ids=lambda r: r.__name__.split(".")[-1])
def test_every_comparison(referee):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        rows = list(referee.run(quick=True))
    exact = [row for row in rows if not getattr(row, "discrete", False)]
    assert [row.name for row in rows if not row.p > 1e-4] == []
    assert together([row.p for row in exact]) > 1e-4
