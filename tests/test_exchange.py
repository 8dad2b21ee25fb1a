"""Radiative exchange against closed forms: networks with exact form factors, convex bodies in one another, shields, cavities.

Bounds are 5 standard errors of 8 replicates (Student, 7 degrees of freedom: p = 0.0016) in about 60 comparisons: with random
seeds one in ten runs would fail by chance. Seeds are fixed, and the runs pass.
"""

import numpy as np
import pytest
from enclosures import sphere, sphere_in_box

import radiosity as rd
from radiosity.exchange.planck import SIGMA
from radiosity.scene.shapes import box, quad
from validation.closed_forms.enclosures import box_factors, net, two_spheres
from validation.closed_forms.rectangles import parallel, perpendicular

WALLS: tuple[str, ...] = ("x low", "x high", "y low", "y high", "z low", "z high")
ORDER = (2, 3, 0, 1, 4, 5)  # of these walls among the faces of `box`


def black(temperature):
    """What a black surface emits, W/m²."""
    return SIGMA * np.asarray(temperature, float) ** 4


def scene_of(parts, two_sided=()) -> rd.Scene:
    """A scene of (name, corners of quadrilaterals)."""
    names = list(dict.fromkeys(name for name, _ in parts))
    faces = [(names.index(name), name, corners) for name, quads in parts for corners in quads]
    return rd.Scene.from_arrays(
        np.concatenate([corners for *_, corners in faces]),
        np.arange(4 * len(faces)).reshape(-1, 4),
        0.5,
        0.0,
        surface=[i for i, *_ in faces],
        names=names,
        two_sided=[name in two_sided for _, name, _ in faces],
    )


def big_box() -> tuple[rd.Patches, np.ndarray, np.ndarray]:
    """A box 4 x 3 x 2.5 of six surfaces, one patch each, with exact areas and form factors."""
    quads = box((0, 0, 0), (4, 3, 2.5), inward=True)
    scene = scene_of([(name, [quads[i]]) for name, i in zip(WALLS, ORDER, strict=True)])
    return rd.subdivide(scene, cells=1), *box_factors((4.0, 3.0, 2.5), parallel, perpendicular)


def cubes(*edges: float) -> rd.Scene:
    """Cubes in one another; the first radiates to the outside, the last to the inside, those between to both."""
    parts = []
    for i, edge in enumerate(edges):
        inward = i == len(edges) - 1
        parts.append((f"cube {i}", box((-edge / 2,) * 3, (edge / 2,) * 3, inward=inward)))
    return scene_of(parts, two_sided=[f"cube {i}" for i in range(1, len(edges) - 1)])


def resistance(edges, emissivities) -> float:
    """Of cubes in one another, 1/m²: from each to the next the network of three resistances in series, A of both sides."""
    total = 0.0
    for (one, e), (other, f) in zip(
        zip(edges, emissivities, strict=True), list(zip(edges, emissivities, strict=True))[1:], strict=False
    ):
        total += (1 / e + one**2 / other**2 * (1 / f - 1)) / (6 * one**2)
    return total


def near(value, exact, error, *, of=0.0) -> bool:
    return bool(np.all(np.abs(np.asarray(value) - exact) <= 5 * np.asarray(error) + of * np.abs(exact)))


@pytest.mark.parametrize("emissivity", [0.02, 0.3, 0.9, 1.0])
def test_six_walls_of_a_box(emissivity):
    patches, area, factors = big_box()
    kelvin = np.array([300.0, 310, 320, 290, 400, 350])
    shine = np.where(np.arange(6) == 3, 0.8, emissivity)
    heat = rd.radiative_exchange(
        patches,
        dict(zip(WALLS, kelvin, strict=True)),
        emissivity=dict(zip(WALLS, shine, strict=True)),
        rays=200_000,
    )
    exact = net(area, factors, shine, black(kelvin))
    assert near(heat.net, exact, heat.net_standard_error)
    assert (heat.net_standard_error < 0.01 * np.abs(exact).max()).all()
    assert abs(heat.net.sum()) < 1e-9 * np.abs(heat.net).max()
    assert heat.exchange[:6, :6] == pytest.approx(-heat.exchange[:6, :6].T, abs=1e-9)
    assert heat.exchange.sum(axis=1)[:6] == pytest.approx(heat.net, rel=1e-9)


def test_conductors_of_gebharts_factors_say_the_same():
    """Net heat is the sum of e_i A_i G_ij (M_i - M_j): from the same lines, another way."""
    patches, *_ = big_box()
    kelvin = np.array([300.0, 310, 320, 290, 400, 350])
    lines = rd.trace_lines(patches, rays=200_000)
    heat = rd.radiative_exchange(lines, dict(zip(WALLS, kelvin, strict=True)), emissivity=0.4)
    conductors = rd.gebhart_factors(lines, emissivity=0.4).conductors
    watts = (conductors * (black(kelvin)[:, None] - black(kelvin))).sum(axis=1)
    assert (np.abs(heat.net - watts) < 2 * heat.net_standard_error).all()


def test_walls_that_float():
    """Two walls of given temperature, one of given flux, three adiabatic: J = H + q there, by the exact form factors."""
    patches, area, factors = big_box()
    shine = np.array([0.6, 0.9, 0.3, 0.5, 0.7, 0.2])
    watts = 500.0
    heat = rd.radiative_exchange(
        patches,
        {"z low": 350.0, "x high": 280.0},
        emissivity=dict(zip(WALLS, shine, strict=True)),
        flux={"y low": watts},
        adiabatic=["x low", "y high", "z high"],
        rays=200_000,
    )
    held = np.isin(WALLS, ("z low", "x high"))
    rho = np.where(held, 1 - shine, 1.0)
    q = np.where(np.array(WALLS) == "y low", watts / area, 0.0)
    sent = np.where(held, shine * black(np.where(np.array(WALLS) == "z low", 350.0, 280.0)), q)
    radiosity = np.linalg.solve(np.eye(6) - rho[:, None] * factors, sent)
    exact = area * (radiosity - factors @ radiosity)
    assert near(heat.net, exact, heat.net_standard_error, of=1e-9)
    kelvin = ((radiosity + q * (1 - shine) / shine) / SIGMA) ** 0.25
    assert near(heat.temperature[~held], kelvin[~held], heat.temperature_standard_error[~held])
    assert (heat.temperature_standard_error[~held] < 0.1).all()
    assert heat.net[2] == watts
    assert heat.net_standard_error[2] == 0
    assert heat["z high"]["condition"] == "adiabatic"


@pytest.mark.parametrize("emissivity", [(1.0, 1.0), (0.02, 0.02), (0.9, 0.02), (0.3, 1.0)])
def test_a_convex_body_in_another(emissivity):
    scene, _ = sphere_in_box()
    heat = rd.radiative_exchange(
        rd.subdivide(scene, cells=1),
        {"sphere": 400, "box": 300},
        emissivity=dict(zip(("sphere", "box"), emissivity, strict=True)),
        rays=100_000,
    )
    one, other = heat.area
    exact = (black(400) - black(300)) * one / (1 / emissivity[0] + one / other * (1 / emissivity[1] - 1))
    assert heat.net[0] == pytest.approx(exact, rel=2e-4)  # lines of the box see that its irradiance is not quite uniform
    assert near(heat.net[0], exact, heat.net_standard_error[0], of=1e-5)  # some lines slip through edges of the sphere


@pytest.mark.parametrize("shields", [1, 2, 4])
def test_radiation_shields(shields):
    """Sheets of low emissivity between two cubes: they float, with one temperature on both sides."""
    edges, shine = [1.0, 1.2, 1.5, 2.0, 2.2, 2.5][: shields + 2], [0.8, 0.05, 0.1, 0.02, 0.02][: shields + 1]
    shine = [*shine, 0.9]
    names = [f"cube {i}" for i in range(shields + 2)]
    heat = rd.radiative_exchange(
        rd.subdivide(cubes(*edges), cells=1),
        {names[0]: 800, names[-1]: 300},
        emissivity=dict(zip(names, shine, strict=True)),
        adiabatic=names[1:-1],
        rays=200_000,
    )
    exact = (black(800) - black(300)) / resistance(edges, shine)
    assert near(heat.net[0], exact, heat.net_standard_error[0], of=1e-4)
    assert heat.net_standard_error[0] < 0.01 * exact
    inner = black(800) - exact * resistance(edges[:2], shine[:2])
    assert heat.temperature[1] == pytest.approx((inner / SIGMA) ** 0.25, rel=1e-3)
    assert heat.exchange[0, 1] == pytest.approx(heat.net[0], rel=1e-6)


def test_concentric_spheres():
    """Polyhedra of 320 faces: their radiosity is nearly uniform."""
    ball = sphere(0.5, 0.0, 2)
    n = ball.n_faces
    triangles = ball.faces[:, :3]
    scene = rd.Scene.from_arrays(
        np.concatenate([0.4 * ball.vertices, ball.vertices]),
        np.concatenate([triangles[:, ::-1], triangles + len(ball.vertices)]),
        0.5,
        0.0,
        surface=np.repeat([0, 1], n),
        names=["inner", "outer"],
    )
    heat = rd.radiative_exchange(
        rd.subdivide(scene, cells=1), {"inner": 500, "outer": 300}, emissivity={"inner": 0.7, "outer": 0.2}, rays=200_000
    )
    radii = np.sqrt(heat.area / (4 * np.pi))  # of spheres of these areas
    exact = two_spheres(*radii, (0.7, 0.2), tuple(black([500, 300])))
    assert heat.net[0] == pytest.approx(exact, rel=1e-3)


def prism(radius: float, length: float, sides: int, *, inward: bool) -> list[np.ndarray]:
    """The mantle of a regular prism along z."""
    angle = 2 * np.pi * np.arange(sides + 1) / sides
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    quads = [quad((x[i], y[i], 0), (x[i + 1] - x[i], y[i + 1] - y[i], 0), (0, 0, length)) for i in range(sides)]
    return [corners[::-1] for corners in quads] if inward else quads


@pytest.mark.parametrize("emissivity", [(0.9, 0.3), (0.05, 0.05)])
def test_long_concentric_cylinders(emissivity):
    """Prisms of 12 sides, closed by adiabatic rings 400 gaps apart: as if they had no end, to one over that."""
    length, sides, one, other = 200.0, 12, 0.5, 1.0
    angle = 2 * np.pi * np.arange(sides + 1) / sides
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(sides + 1)])
    caps = []
    for i in range(sides):
        low = np.array([one * ring[i], other * ring[i], other * ring[i + 1], one * ring[i + 1]])
        caps += [low, (low + np.array([0, 0, length]))[::-1]]
    parts = [("inner", prism(one, length, sides, inward=False)), ("outer", prism(other, length, sides, inward=True))]
    patches = rd.subdivide(scene_of([*parts, ("ends", caps)]), cells=1)
    shine = dict(zip(("inner", "outer"), emissivity, strict=True)) | {"ends": 0.5}
    heat = rd.radiative_exchange(patches, {"inner": 400, "outer": 300}, adiabatic=["ends"], emissivity=shine, rays=200_000)
    area = heat.area[0]
    exact = (black(400) - black(300)) * area / (1 / emissivity[0] + one / other * (1 / emissivity[1] - 1))
    assert near(heat.net[0], exact, heat.net_standard_error[0], of=1 / 400)
    assert heat.net_standard_error[0] < 2e-3 * exact


@pytest.mark.parametrize("emissivity", [0.3, 1.0])
def test_re_radiating_walls_of_a_cube(emissivity):
    """The three-surface enclosure of textbooks: heat goes from floor to ceiling straight, or by way of adiabatic walls."""
    quads = box((0, 0, 0), (1, 1, 1), inward=True)
    scene = scene_of([("walls", quads[:4]), ("floor", [quads[4]]), ("ceiling", [quads[5]])])
    heat = rd.radiative_exchange(
        rd.subdivide(scene, cells=1), {"floor": 700, "ceiling": 400}, adiabatic=["walls"], emissivity=emissivity, rays=200_000
    )
    straight = float(parallel(1.0, 1.0))
    space = 1 / (straight + 1 / (2 / (1 - straight)))
    exact = (black(700) - black(400)) / (2 * (1 - emissivity) / emissivity + space)
    assert near(heat.net[1], exact, heat.net_standard_error[1])
    assert heat.net_standard_error[1] < 2e-3 * exact
    assert heat.temperature[0] == pytest.approx(((black(700) + black(400)) / 2 / SIGMA) ** 0.25, rel=1e-3)  # by symmetry


@pytest.mark.parametrize("emissivity", [0.02, 0.1])
def test_a_thin_cavity_is_parallel_plates(emissivity):
    """1 mm of gap round a cube of 1 m: two surfaces whose lines go to and fro hundreds of times."""
    edges = (1.0, 1.002)
    patches = rd.subdivide(cubes(*edges), cells=1)
    heat = rd.radiative_exchange(patches, {"cube 0": 300, "cube 1": 77}, emissivity=emissivity, rays=100_000)
    exact = (black(300) - black(77)) / resistance(edges, (emissivity, emissivity))
    assert heat.net[0] == pytest.approx(exact, rel=1e-3)
    plates = 6 * (black(300) - black(77)) / (2 / emissivity - 1)
    assert heat.net[0] == pytest.approx(plates, rel=5e-3)
    assert near(heat.net[0], exact, heat.net_standard_error[0], of=1e-4)


@pytest.mark.parametrize("gap", [1e-5, 1e-6])
def test_gaps_of_microns(gap):
    """Aspect ratios of 10^5 and 10^6: no line of such a run meets the rims, which is in the bars."""
    edges = (1.0, 1.0 + 2 * gap)
    heat = rd.radiative_exchange(
        rd.subdivide(cubes(*edges), cells=1), {"cube 0": 300, "cube 1": 77}, emissivity=0.9, rays=100_000
    )
    exact = (black(300) - black(77)) / resistance(edges, (0.9, 0.9))
    assert near(heat.net[0], exact, heat.net_standard_error[0])
    assert 0 < heat.net_standard_error[0] < 1e-4 * exact


def test_plates_in_the_open_give_heat_to_the_surroundings():
    """Two unit squares at distance one (C-11) below surroundings of 77 K: a network of three."""
    scene = scene_of([("hot", [quad((0, 0, 0), (1, 0, 0), (0, 1, 0))]), ("cold", [quad((0, 0, 1), (0, 1, 0), (1, 0, 0))])])
    patches, between = rd.subdivide(scene, cells=1), float(parallel(1.0, 1.0))
    shine, kelvin = np.array([0.7, 0.4]), np.array([500.0, 300.0])
    given = dict(zip(("hot", "cold"), kelvin, strict=True))
    emissivity = dict(zip(("hot", "cold"), shine, strict=True))
    heat = rd.radiative_exchange(patches, given, emissivity=emissivity, surroundings=77, rays=200_000)
    factors = np.array([[0, between, 1 - between], [between, 0, 1 - between], [0, 0, 0]])
    radiosity = np.linalg.solve(
        np.eye(3) - np.append(1 - shine, 0)[:, None] * factors, np.append(shine * black(kelvin), black(77))
    )
    exact = (radiosity - factors @ radiosity)[:2]
    assert near(heat.net, exact, heat.net_standard_error)
    assert abs(heat.net.sum() + heat.surroundings_net) < 1e-9 * heat.net[0]
    assert heat.surroundings_net < 0
    assert heat.table()[-1]["surface"] == "surroundings"
    with pytest.raises(rd.SceneError, match=r"leaves the scene; give surroundings"):
        rd.radiative_exchange(patches, given, emissivity=emissivity, rays=10_000)
    nothing_back = rd.radiative_exchange(patches, given, emissivity=emissivity, surroundings=0, rays=200_000)
    assert nothing_back.net[0] > heat.net[0]


def test_equal_temperatures_exchange_exactly_nothing():
    patches, *_ = big_box()
    heat = rd.radiative_exchange(patches, {"*": 321.7}, emissivity=0.3, surroundings=321.7, rays=20_000)
    assert (heat.net == 0).all()
    assert (heat.net_standard_error == 0).all()
    assert not heat.exchange.any()
    floating = rd.radiative_exchange(patches, {"x low": 321.7}, emissivity=0.3, adiabatic=["[yz]*", "x high"], rays=20_000)
    assert floating.temperature == pytest.approx(np.full(6, 321.7), rel=1e-14)


@pytest.mark.parametrize("emissivity", [0.05, 0.5, 1.0])
def test_small_differences_do_not_drown(emissivity):
    """300 K against 300.01 K: to a thousandth."""
    patches = rd.subdivide(cubes(1.0, 2.0), cells=1)
    heat = rd.radiative_exchange(patches, {"cube 0": 300.01, "cube 1": 300}, emissivity=emissivity, rays=100_000)
    exact = SIGMA * 0.01 * (300.01 + 300) * (300.01**2 + 300**2) / resistance((1.0, 2.0), (emissivity,) * 2)
    assert heat.net[0] == pytest.approx(exact, rel=1e-3)
    assert near(heat.net[0], exact, heat.net_standard_error[0], of=1e-5)


def test_a_surface_that_conducts_has_one_temperature():
    patches, *_ = big_box()
    fine = rd.subdivide(patches.scene, cells=3)
    options = {"emissivity": 0.5, "adiabatic": ["x low", "x high", "y *"], "rays": 100_000}
    given = {"z low": 600, "z high": 300}
    uneven = rd.radiative_exchange(fine, given, **options)
    even = rd.radiative_exchange(fine, given, isothermal=["y low"], **options)
    here = fine.surface == WALLS.index("y low")
    assert np.ptp(uneven.patch_temperature[here]) > 30
    assert np.ptp(even.patch_temperature[here]) < 1e-9
    assert even.net[2] == 0
    assert even.patch_net[here] @ fine.area[here] == pytest.approx(0, abs=1e-8)
    assert np.abs(even.patch_net[here]).max() > 10
    assert uneven.net[5] == pytest.approx(even.net[5], rel=0.05)
