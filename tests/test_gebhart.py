"""Gebhart factors against closed forms: two and three surfaces, boxes by the exact view factors, and what is refused.

About 60 comparisons at 6 standard errors (Student with 15 degrees of freedom: p = 2.4e-5), and seeds are fixed.
"""

import csv

import numpy as np
import pytest
from enclosures import parallel_squares, sphere_in_box

import radiosity as rd
from radiosity.factors.polygons import exchange
from radiosity.scene.shapes import box, quad
from validation.closed_forms.enclosures import box_factors
from validation.closed_forms.rectangles import parallel, perpendicular
from validation.shapes import scene


def exact(factors: np.ndarray, emissivity: np.ndarray) -> np.ndarray:
    """G = F e + F (1 - e) G, by which what arrives is absorbed or sent on; irradiance is the same all over a surface."""
    n = len(emissivity)
    return np.linalg.solve(np.eye(n) - factors * (1 - emissivity), factors * emissivity)


def check(found: rd.GebhartFactors, expected: np.ndarray, least: float = 1e-9) -> None:
    assert found.values.sum(axis=1) == pytest.approx(np.ones(len(found.names)), abs=1e-8)
    assert (np.abs(found.matrix - expected) <= 6 * found.standard_error + least).all()
    conductors = found.conductors
    assert np.abs(conductors - conductors.T).max() < 1e-4 * conductors.max()


@pytest.mark.parametrize("emissivity", [(0.9, 0.1), (0.02, 1.0), (0.05, 0.05)])
def test_a_sphere_in_a_box_is_two_surfaces(emissivity):
    """All six walls see the sphere alike, and one patch a wall has one irradiance: shares follow from two areas."""
    inside, view = sphere_in_box()
    lines = rd.trace_lines(rd.subdivide(inside, cells=1), rays=300_000, replicates=16)
    body, wall = lines.patches.scene.names
    found = rd.gebhart_factors(lines, emissivity={body: emissivity[0], wall: emissivity[1]})
    factors = np.array([[0.0, 1.0], [view, 1 - view]])
    check(found, exact(factors, np.array(emissivity)))
    assert found.names == (body, wall)
    assert found.emissivity == pytest.approx(emissivity)


def test_a_box_of_six_patches_is_a_network_of_six_surfaces_and_grouped_one_of_three():
    """Black walls absorb at once: the shares are view factors. Between grey walls of one patch each, irradiance is uniform."""
    sizes, names = (4.0, 3.0, 2.5), ("x0", "x1", "y0", "y1", "z0", "z1")
    areas, factors = box_factors(sizes, parallel, perpendicular)
    walls = box((0, 0, 0), sizes, inward=True)
    order = [2, 3, 0, 1, 4, 5]  # `box` begins with y
    room = scene(*((name, 0.5, 0.0, [walls[i]]) for name, i in zip(names, order, strict=True)))
    lines = rd.trace_lines(rd.subdivide(room, cells=1), rays=400_000, replicates=16)
    black = rd.gebhart_factors(lines, emissivity=1.0)
    assert black.area == pytest.approx(areas)
    check(black, factors)
    assert black.standard_error.max() < 2e-3
    grey = rd.gebhart_factors(lines, emissivity=0.8)
    check(grey, exact(factors, np.full(6, 0.8)))
    check(rd.gebhart_factors(lines, emissivity=0.05), exact(factors, np.full(6, 0.05)))
    together = rd.gebhart_factors(lines, emissivity=0.8, group={"ends": ["x0", "x1"], "sides": ["y*"], "flat": ["z*"]})
    power = grey.conductors.reshape(3, 2, 3, 2).sum(axis=(1, 3))
    assert together.conductors == pytest.approx(power, rel=1e-7)  # three surfaces


def test_what_escapes_is_a_conductor_to_the_surroundings(tmp_path):
    squares, view = parallel_squares()
    lines = rd.trace_lines(rd.subdivide(squares, cells=1), rays=200_000, replicates=16)
    found = rd.gebhart_factors(lines, emissivity={"emitter": 0.5, "*": 0.25})
    check(found, exact(np.array([[0, view], [view, 0]]), np.array([0.5, 0.25])))
    found.to_csv(tmp_path / "g.csv")
    with (tmp_path / "g.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    sums = {name: sum(float(r["conductor m²"]) for r in rows if r["from"] == name) for name in found.names}
    assert list(sums.values()) == pytest.approx([0.5, 0.25], rel=1e-8)  # e A
    assert {r["to"] for r in rows} == {*found.names, "(escaped)"}
    first = next(r for r in rows if (r["from"], r["to"]) == (found.names[0], found.names[1]))
    assert float(first["conductor standard error m²"]) == 0.5 * float(first["standard error"]) > 0


def test_a_pair_that_no_line_joined_is_not_known_to_exchange_nothing(tmp_path):
    """A square of a metre and one of 10 cm 6 m above it: 2 000 lines do not join them, and the error was zero."""
    low, far = quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, 6), (0, 0.1, 0), (0.1, 0, 0))
    patches = rd.subdivide(scene(("hot", 0.5, 1.0, [low]), ("far", 0.5, 0.0, [far])), cells=1)
    exact = exchange(patches.corners[:1], patches.corners[1:])[0]
    found = rd.gebhart_factors(rd.trace_lines(patches, rays=2_000, seed=1), emissivity=1.0)
    assert found.conductors[0, 1] == 0
    assert found.standard_error[0, 1] * found.area[0] == pytest.approx(found.standard_error[1, 0] * found.area[1])
    assert exact < 4 * found.standard_error[0, 1] * found.area[0]
    found.to_csv(tmp_path / "g.csv")
    assert "hot,far" in (tmp_path / "g.csv").read_text(encoding="utf-8")
    away = scene(("up", 0.5, 1.0, [low]), ("down", 0.5, 0.0, [quad((0, 0, -1), (0, 1, 0), (1, 0, 0))]))
    found = rd.gebhart_factors(rd.trace_lines(rd.subdivide(away, cells=1), rays=2_000), emissivity=0.5)
    assert not found.standard_error.any()  # they look away from each other


@pytest.mark.parametrize("both_ways", [True, False])
def test_one_factorisation_gives_what_iterations_do(monkeypatch, both_ways):
    """Values, and errors with the bias that lines have by carrying light back, where some escapes; with unlike emissivities."""
    from radiosity.exchange import gebhart

    walls = box((0, 0, 0), (3, 2, 1), inward=True)[:5]
    open_box = scene(*((f"wall {i}", 0.5, 0.0, [wall]) for i, wall in enumerate(walls)))
    lines = rd.trace_lines(rd.subdivide(open_box, cells=2), rays=20_000, replicates=4, both_ways=both_ways)
    emissivity, found = np.linspace(0.05, 1, 20), []
    for quicker in (True, False):
        monkeypatch.setattr(gebhart, "is_quicker", lambda *_, quicker=quicker: quicker)
        found.append(rd.gebhart_factors(lines, emissivity=emissivity))
    assert found[0].values == pytest.approx(found[1].values, abs=1e-9)
    assert found[0].errors == pytest.approx(found[1].errors, abs=1e-9)
    assert found[0].values[:, 5].min() > 0.01  # it escapes


def test_a_factorisation_is_taken_where_it_is_less_work():
    from radiosity.factors.direct import MOST, is_quicker

    dull, shiny = np.full(500, 0.1), np.full(500, 0.98)
    assert is_quicker(500, 40_000, 7, shiny)
    assert not is_quicker(500, 40_000, 7, dull)
    assert is_quicker(500, 40_000, 500, dull)
    assert not is_quicker(MOST + 1, 10**9, MOST, shiny)
    assert not is_quicker(500, 40_000, 7, 0 * dull)


def test_wrong_emissivities_are_refused():
    lines = rd.trace_lines(rd.subdivide(parallel_squares()[0], cells=1), rays=1000)
    for wrong in (0.0, 1.5, -0.1, float("nan"), "half", None, True):
        with pytest.raises(rd.SceneError, match=r"emissivity of .* must be above 0 and at most 1"):
            rd.gebhart_factors(lines, emissivity={"*": wrong})
        with pytest.raises(rd.SceneError, match="emissivity of all surfaces"):
            rd.gebhart_factors(lines, emissivity=wrong)
    with pytest.raises(rd.MethodError, match="none is given for 'receiver'"):
        rd.gebhart_factors(lines, emissivity={"emitter": 0.5})
    with pytest.raises(rd.MethodError, match="no surface is called 'lamp'"):
        rd.gebhart_factors(lines, emissivity={"lamp": 0.5, "*": 0.5})
    with pytest.raises(rd.MethodError, match=r"emissivity has shape \(3,\)"):
        rd.gebhart_factors(lines, emissivity=[0.5, 0.5, 0.5])
    with pytest.raises(rd.MethodError, match="takes a LineSet, not Patches"):
        rd.gebhart_factors(lines.patches, emissivity=0.5)  # pyright: ignore[reportArgumentType]
    one = rd.trace_lines(lines.patches, rays=1000, replicates=1)
    assert np.isnan(rd.gebhart_factors(one, emissivity=[0.5, 0.4]).errors).all()


def test_faces_too_narrow_for_lines_are_told():
    strips = [quad((0, 0, 0), (1, 0, 0), (0, 1e-5, 0)), quad((0, 0, 1e-5), (0, 1e-5, 0), (1, 0, 0))]
    both = scene(("low", 0.5, 1.0, strips[:1]), ("high", 0.5, 0.0, strips[1:]))
    lines = rd.trace_lines(rd.subdivide(both, cells=1), rays=2000)
    with pytest.warns(rd.RadiosityWarning, match="lines leave out a part"):
        rd.gebhart_factors(lines, emissivity=0.5)


def test_star_gives_the_rest_in_whatever_order_patterns_stand():
    lines = rd.trace_lines(rd.subdivide(parallel_squares()[0], cells=1), rays=1000)
    for given in ({"e*": 0.1, "*": 0.9}, {"*": 0.9, "e*": 0.1}):
        assert rd.gebhart_factors(lines, emissivity=given).emissivity == pytest.approx([0.1, 0.9])
    with pytest.raises(rd.SceneError, match="emissivity of surface 'emitter' is given by two patterns"):
        rd.gebhart_factors(lines, emissivity={"e*": 0.1, "em*": 0.9, "*": 0.5})
