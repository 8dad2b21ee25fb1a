"""Public reports about other programs of heat and view factors, rebuilt with scenes of our own.

Right values are closed forms. Bounds are 5 standard errors (8 replicates: p = 0.0016 each) with fixed seeds.
"""

import numpy as np
import pytest
from samples import stl_text
from test_exchange import WALLS, big_box, black, near, scene_of

import radiosity as rd
from radiosity.exchange.planck import SIGMA
from radiosity.scene.shapes import box, quad
from validation.closed_forms.enclosures import net
from validation.closed_forms.rectangles import parallel, perpendicular


def turned(angle: float) -> np.ndarray:
    """A rotation about (1, 2, 3)."""
    x, y, z = np.array([1.0, 2.0, 3.0]) / np.sqrt(14)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def cut(parts, two_sided=()) -> rd.Patches:
    """A patch for each face of (name, corners of quadrilaterals)."""
    return rd.subdivide(scene_of(parts, two_sided), cells=1)


def facing(a: float, b: float, distance: float) -> float:
    """The factor between equal rectangles that face each other."""
    return parallel(a / distance, b / distance) * distance**2 / (a * b)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.1])
def test_a_body_of_nearly_half_the_area_at_any_angle(angle):
    """EnergyPlus #8700: cooling loads jumped as a building with a large internal mass was turned."""
    body = box((0.05, 0.05, 0.05), (2.95, 2.95, 2.95))
    parts = [("room", box((0, 0, 0), (3, 3, 3), inward=True)), ("body", body)]
    patches = cut([(name, [corners @ turned(angle).T for corners in quads]) for name, quads in parts])
    heat = rd.radiative_exchange(patches, {"room": 300, "body": 310}, emissivity={"room": 1, "body": 0.8}, rays=30_000)
    assert near(heat["body"]["net"], 6 * 2.9**2 * 0.8 * (black(310) - black(300)), heat["body"]["net error"], of=1e-9)
    factors = rd.view_factors(patches, rays=20_000).restored()
    np.testing.assert_allclose(factors.matrix[0, 1] * factors.area[0], factors.area[1], rtol=1e-4)


def test_three_surfaces_of_very_unlike_areas():
    """EnergyPlus #5772: rows of zones of three surfaces summed up to 3 or 4. Modelica Buildings #26 and #4182: heat was shared
    out wrongly where areas differ much, and flat surfaces saw themselves."""
    quads = box((0, 0, 0), (20, 0.2, 3), inward=True)
    patches = cut([("floor", quads[4:5]), ("ceiling", quads[5:]), ("walls", quads[:4])])
    factors = rd.view_factors(patches, rays=100_000, method="lines").restored()
    exact = facing(20.0, 0.2, 3.0)
    assert near(factors.matrix[0, :2], [0, exact], factors.standard_error[0, :2])
    np.testing.assert_allclose(factors.matrix.sum(axis=1), 1, rtol=0, atol=1e-12)
    assert factors.matrix[0, 0] == factors.matrix[1, 1] == 0


def test_a_floor_that_lies_upside_down_is_told():
    """EnergyPlus #463: windows were hot, since the floor's vertices were in the wrong order."""
    quads = box((0, 0, 0), (4, 3, 2.5), inward=True)
    patches = cut([("floor", [quads[4][::-1]]), ("rest", [*quads[:4], quads[5]])])
    with pytest.raises(rd.SceneError, match=r"100\.00% of what leaves floor leaves the scene"):
        rd.radiative_exchange(patches, {"floor": 310, "rest": 300}, emissivity=0.9, rays=5_000)
    factors = rd.view_factors(patches, rays=5_000)
    assert factors.escaped[factors.names.index("floor")] == 1
    assert factors.lost[factors.names.index("rest")] > 0.2


def test_emissivities_of_a_ten_millionth():
    """EnergyPlus #181: the run ended, since emissivities summed to zero; #7698: an emissivity of zero ended it, too."""
    patches, area, factors = big_box()
    kelvin = np.array([300.0, 310, 320, 290, 400, 350])
    heat = rd.radiative_exchange(patches, dict(zip(WALLS, kelvin, strict=True)), emissivity=1e-7, rays=20_000)
    exact = net(area, factors, np.full(6, 1e-7), black(kelvin))
    assert near(heat.net, exact, heat.net_standard_error, of=1e-7)
    with pytest.raises(rd.SceneError, match="emissivity of surface 'x low' is 0; it must be above 0"):
        rd.radiative_exchange(patches, {"*": 300}, emissivity=0)


def test_a_shallow_attic():
    """EnergyPlus #1868: rows of shallow zones did not sum to one."""
    quads = box((0, 0, 0), (20, 20, 0.05), inward=True)
    patches = cut([("floor", quads[4:5]), ("ceiling", quads[5:]), ("edges", quads[:4])])
    exact = facing(20.0, 20.0, 0.05)
    for method in ("lines", "polygons"):
        factors = rd.view_factors(patches, rays=20_000, method=method).restored()
        assert near(factors.matrix[0, 1], exact, factors.standard_error[0, 1], of=1e-7)
        np.testing.assert_allclose(factors.matrix.sum(axis=1), 1, rtol=0, atol=1e-9)


def test_temperatures_of_a_surface_are_averaged_as_heat():
    """OpenFOAM #2649: faces that were taken together had the mean of their temperatures, not of its fourth power."""
    parts = []
    for i, x in enumerate((0, 3)):
        quads = box((x, 0, 0), (x + 1, 1, 1), inward=True)
        parts += [(f"room {i}", quads[:5]), ("lids", quads[5:])]
    heat = rd.radiative_exchange(cut(parts), {"room 0": 300, "room 1": 200}, adiabatic=["lids"], emissivity=0.5, rays=20_000)
    np.testing.assert_allclose(heat["lids"]["temperature"], ((300**4 + 200**4) / 2) ** 0.25, rtol=1e-9)


@pytest.mark.parametrize("method", ["lines", "polygons"])
def test_faces_that_touch(method):
    """OpenFOAM merge request 551: integrals over areas were off where faces are near each other."""
    patches = cut([("floor", [quad((0, 0, 0), (1, 0, 0), (0, 1, 0))]), ("wall", [quad((0, 0, 0), (0, 1, 0), (0, 0, 0.01))])])
    factors = rd.view_factors(patches, rays=60_000, method=method)
    floor, wall = factors.names.index("floor"), factors.names.index("wall")
    exact = perpendicular(0.01, 1.0) / 0.01
    assert near(factors.matrix[wall, floor], exact, factors.standard_error[wall, floor], of=1e-6)


@pytest.mark.parametrize("method", ["lines", "polygons"])
def test_an_obstacle_that_touches_takes_away_and_adds_nothing(method):
    """uDALES #359: View3D found 1.31 past an obstacle at a surface; #363: rows of open scenes summed to more than one.

    A fin between two squares, which touches both in the middle: each half sees the half in front of it alone.
    """
    quads = [quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, 1), (0, 1, 0), (1, 0, 0))]
    fin = quad((0.5, 0, 0), (0, 1, 0), (0, 0, 1))
    patches = cut([("low", quads[:1]), ("high", quads[1:]), ("fin", [fin])], two_sided=["fin"])
    factors = rd.view_factors(rd.subdivide(patches.scene, cells=2), rays=100_000, method=method)
    low, high = factors.names.index("low"), factors.names.index("high")
    assert near(factors.matrix[low, high], facing(0.5, 1.0, 1.0), factors.standard_error[low, high], of=1e-6)
    assert factors.matrix[low, high] < facing(1.0, 1.0, 1.0)
    np.testing.assert_allclose(factors.row_sums, 1, rtol=0, atol=1e-9)
    assert (factors.escaped > 0.1).all()


@pytest.mark.parametrize("tilt", [20, 90, 150])
def test_what_a_tilted_plate_sees_of_ground_and_sky(tilt):
    """pvlib #1665 and IDEAS #623: the sky's factor is (1 + cos tilt) / 2."""
    slope = np.radians(tilt)
    plate = quad((-0.5, 0, 1), (1, 0, 0), (0, np.cos(slope), np.sin(slope)))
    ground = quad((-1e5, -1e5, 0), (2e5, 0, 0), (0, 2e5, 0))
    factors = rd.view_factors(cut([("plate", [plate]), ("ground", [ground])]), rays=2_000, method="polygons")
    here = factors.names.index("plate")
    np.testing.assert_allclose(factors.escaped[here], (1 + np.cos(slope)) / 2, rtol=0, atol=1.5e-5)
    lines = rd.view_factors(cut([("plate", [plate]), ("ground", [ground])]), rays=20_000, method="lines", sources=["plate"])
    assert near(lines.escaped[here], (1 + np.cos(slope)) / 2, lines.escaped_standard_error[here], of=1e-4)


def test_heat_that_leaves_one_side_of_a_gap_arrives_at_the_other():
    """MOOSE #18585 and #26627: the gap between cylinders made heat, and emissivities were taken wrongly."""
    parts = [("inner", box((1, 1, 1), (2, 2, 2))), ("outer", box((0, 0, 0), (3, 3, 3), inward=True))]
    heat = rd.radiative_exchange(cut(parts), {"inner": 900, "outer": 300}, emissivity={"inner": 0.3, "outer": 1}, rays=30_000)
    assert near(heat["inner"]["net"], 6 * 0.3 * (black(900) - black(300)), heat["inner"]["net error"], of=1e-9)
    assert abs(heat.net.sum()) < 1e-12 * heat.net[0]


def test_an_enclosure_that_is_not_closed_is_told():
    """MOOSE #25919: results of cavities that are not closed were wrong without a word."""
    patches = cut([("walls", box((0, 0, 0), (1, 1, 1), inward=True)[:5])])
    with pytest.raises(rd.SceneError, match=r"of what leaves walls leaves the scene; give surroundings"):
        rd.radiative_exchange(patches, {"walls": 400}, emissivity=0.9, rays=5_000)
    heat = rd.radiative_exchange(patches, {"walls": 400}, emissivity=1, rays=50_000, surroundings=0)
    assert near(heat["walls"]["net"], black(400), heat["walls"]["net error"])  # what an opening of 1 m² lets out of a black body


@pytest.mark.parametrize("inside", ["front", "back"])
def test_a_shield_whose_sides_are_unlike(inside):
    """FDS #3512 and #6581: the emissivity of a shield's back was that of its front."""
    size, gap = 1.0, 1e-4
    parts = []
    for i, edge in enumerate((size, size + gap, size + 2 * gap)):
        quads = box((-edge / 2,) * 3, (edge / 2,) * 3, inward=i == 2)
        parts.append((("hot", "shield", "cold")[i], [q[::-1] for q in quads] if i == 1 and inside == "front" else quads))
    outside = "back" if inside == "front" else "front"
    heat = rd.radiative_exchange(
        cut(parts, two_sided=["shield"]),
        {"hot": 400, "cold": 300},
        adiabatic=["shield"],
        emissivity={"hot": 0.8, "cold": 0.6, "shield": {inside: 0.05, outside: 0.9}},
        rays=20_000,
    )
    first, second = 1 / 0.8 + 1 / 0.05 - 1, 1 / 0.9 + 1 / 0.6 - 1
    flux = (black(400) - black(300)) / (first + second)
    np.testing.assert_allclose(heat["hot"]["net"], 6 * flux, rtol=2e-3)  # the areas differ by as much
    np.testing.assert_allclose(heat["shield"]["temperature"], ((black(300) + flux * second) / SIGMA) ** 0.25, rtol=1e-3)


def test_nothing_happens_at_equal_temperatures():
    """FDS #543 and #1704: bodies as warm as all else gave off heat."""
    patches, *_ = big_box()
    heat = rd.radiative_exchange(patches, {"*": 278.15}, adiabatic=["x low"], emissivity=0.5, surroundings=278.15, rays=2_000)
    assert not heat.net.any()
    assert not heat.exchange.any()
    assert heat["x low"]["temperature"] == pytest.approx(278.15, abs=1e-10)


@pytest.mark.parametrize("unit", ["mm", "ft"])
def test_units_change_areas_and_no_factor(tmp_path, unit):
    """honeybee-radiance #726: view factors of models that are not in metres were wrong."""
    solids = {}
    for name, corners in zip(WALLS, box((0, 0, 0), (400, 300, 250), inward=True), strict=True):
        solids[name] = np.array([corners[[0, 1, 2]], corners[[0, 2, 3]]])
    (tmp_path / "room.stl").write_text(stl_text(solids).replace("normal 0 0 1", "normal 0 0 0"))
    (tmp_path / "room.toml").write_text(
        f'geometry = "room.stl"\nunit = "{unit}"\nsurface = [{{ name = "*", sides = 1, reflectance = 0.5 }}]\n'
    )
    factors = rd.view_factors(rd.load_scene(tmp_path / "room.toml"), rays=2_000, method="polygons")
    np.testing.assert_allclose(factors.matrix[4, 5], facing(4.0, 3.0, 2.5), rtol=1e-6)
    np.testing.assert_allclose(factors.area[4], 120_000 * {"mm": 1e-6, "ft": 0.3048**2}[unit], rtol=1e-6)
