"""What sensors measure: closed forms, coverage of intervals, bits, targets. Wrong values must be refused."""

from dataclasses import replace

import numpy as np
import pytest
from light_samples import bulb, lit, overcast, uniform

import radiosity as rd
from radiosity.factors.polygons import from_points
from radiosity.scene.shapes import box, join, quad
from radiosity.sensors import run
from radiosity.sensors.target import half_width

ALPHA = 1e-4  # of a test, all its sensors together


def measured(scene: rd.Scene, sensors: rd.Sensors, each: int = 2048, seed: int = 0, cells: int = 1, replicates: int = 8):
    """Solve, then measure with about ``each`` of both kinds together a sensor and replicate."""
    patches = rd.subdivide(scene, cells=cells)
    few = len(patches) * replicates * 1024
    solution = rd.solve(patches, method="gather", rays=few, replicates=replicates, seed=seed)
    return rd.measure(solution, sensors, rays=each * replicates * len(sensors), seed=seed)


def agrees(found: rd.Measurement, wanted, within: float) -> bool:
    """True where all sensors' means lie within Student's intervals of ``wanted``, at `ALPHA` in all; their errors must be small
    enough for that to mean something: ``within`` of what is wanted, for the largest half width."""
    wanted = np.broadcast_to(np.asarray(wanted, float).reshape(-1, 1), found.illuminance.shape)
    width = half_width(found.values, 1 - ALPHA / found.illuminance.size)
    assert (width <= within * wanted.max()).all(), (width, wanted)
    return bool((np.abs(found.illuminance - wanted) <= width + 2e-6 * np.abs(wanted)).all())


LAMP = quad((-0.5, -0.5, 1), (0, 1, 0), (1, 0, 0))  # looks down


def test_points_about_a_square_lamp():
    """Near, far, beside, turned, and partly below the sensor's horizon: the exact factor of a point and a polygon."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0.3, -0.2, 0.9], [-3, 2, -1], [0.2, 0.1, 0.5], [1, 0, 0.6]])
    normals = np.array([[0, 0, 1], [0, 0, 1], [0, 0, 1], [1, 1, 3], [1, 0, 0], [-1, 0, 0.2]], float)
    exact = 100 * from_points(points, normals / np.linalg.norm(normals, axis=1)[:, None], LAMP[None])
    found = measured(join([("lamp", 0.0, 100.0, [LAMP])], source="lamp"), rd.Sensors.of(points, normals))
    assert agrees(found, exact, 0.03)
    assert not agrees(found, exact / np.maximum(normals[:, 2], 0.3), 0.05)  # no formula would do


def test_a_point_lamp_by_distance_and_angle():
    """The inverse square and the cosine law: without lines that scatter, exactly."""
    points = np.array([[0, 0, 0], [0, 0, 1.5], [2, 0, 0], [1, 1, 1], [0, 0, 3]])
    normals = np.array([[0, 0, 1], [0, 0, 1], [0, 0, 1], [0.6, 0, 0.8], [0, 0, 1]])
    way = np.array([0, 0, 2]) - points
    distance = np.linalg.norm(way, axis=1)
    cosine = np.maximum((way * normals).sum(axis=1) / distance, 0)
    found = measured(lit(luminaires=(bulb((0, 0, 2), power=400 * np.pi),)), rd.Sensors.of(points, normals))
    np.testing.assert_allclose(
        found.illuminance[:, 0], 100 * cosine / distance**2, rtol=1e-4
    )  # single precision: a lamp stands 8 ulps in front
    assert found.unit == "lx"
    assert not np.allclose(found.illuminance[:4, 0], 100 / distance[:4] ** 2, rtol=0.02)  # a cosine left out


def test_cylindrical_light_of_a_point_lamp():
    """I sin theta / (pi d^2), theta from the axis; the axis may lean."""
    points, axes = np.array([[1, 0, 0], [2, 1, 1], [0, 0.5, 1.0]]), np.array([[0, 0, 1], [0, 0, 1], [1.0, 0, 1]])
    way = np.array([0, 0, 2]) - points
    distance = np.linalg.norm(way, axis=1)
    sine = np.linalg.norm(np.cross(way, axes), axis=1) / distance / np.linalg.norm(axes, axis=1)
    scene = lit(luminaires=(bulb((0, 0, 2), power=400 * np.pi),))
    found = measured(scene, rd.Sensors.of(points, axes, kind="cylindrical"))
    assert agrees(found, 100 * sine / (np.pi * distance**2), 0.03)
    assert not agrees(found, 100 * sine / (4 * distance**2), 0.03)


def test_skies_without_obstacles():
    """Uniform: pi L from above, half of it on a wall; CIE's overcast sky: 7/9 pi of the zenith's radiance."""
    sensors = rd.Sensors.of([[0, 0, 0]] * 3, [[0, 0, 1], [1, 0, 0], [0, 0, -1]])
    assert agrees(measured(lit(sky=uniform(100.0)), sensors), [100 * np.pi, 50 * np.pi, 0], 0.03)
    assert agrees(measured(lit(sky=overcast(100.0)), sensors), [700 / 9 * np.pi, 100 * (np.pi / 6 + 4 / 9), 0], 0.03)


@pytest.mark.parametrize("angle", [15, 40, 70])
def test_a_round_hole_in_a_roof(angle):
    """3/7 (sin^2 t + 4/3 (1 - cos^3 t)) of the unobstructed horizontal, under an overcast sky."""
    n, t = 96, np.radians(angle)
    around = 2 * np.pi * np.arange(n + 1) / n
    inner = np.tan(t) * np.sqrt(np.sin(2 * np.pi / n) ** -1 * 2 * np.pi / n)  # the polygon's area is the circle's
    ring = np.column_stack([np.cos(around), np.sin(around)])
    rings = [np.column_stack([radius * ring, np.ones(n + 1)]) for radius in (inner, 1e3)]
    roof = [np.stack([rings[0][i], rings[0][i + 1], rings[1][i + 1], rings[1][i]]) for i in range(n)]
    corners = np.concatenate(roof)
    scene = rd.Scene.from_arrays(corners, np.arange(4 * n).reshape(n, 4), 0.0, 0.0, names=["roof"], two_sided=True)
    scene = replace(scene, lights=lit(sky=overcast(9000 / (7 * np.pi))).lights)
    found = measured(scene, rd.Sensors.of([[0, 0, 0]]), each=1 << 14)
    share = 3 / 7 * (np.sin(t) ** 2 + 4 / 3 * (1 - np.cos(t) ** 3))
    assert agrees(found, 1000 * share, 0.03)
    assert found.daylight_factor[0] == pytest.approx(share, rel=0.02)
    assert "daylight factor, sensors: mean" in found.report()
    assert not agrees(found, 1000 * np.sin(t) ** 2, 0.03)  # a uniform sky


def test_a_furnace_is_the_same_everywhere():
    """All walls emit 1 and reflect rho: 1 / (1 - rho) on any plane, upright cylinders too."""
    room = join([("walls", 0.6, 1.0, box((0, 0, 0), (2, 1, 3), inward=True))], source="furnace")
    sensors = rd.Sensors.of([[1, 0.5, 1], [0.1, 0.9, 2.9], [1, 0.5, 0]], [[0, 0, 1], [1, -2, 0.3], [0, 0, 1]])
    found = measured(room, sensors + rd.Sensors.of([[1.5, 0.5, 2]], name="round", kind="cylindrical"), 1 << 15, cells=2)
    assert agrees(found, np.full(4, 2.5), 0.02)
    assert not agrees(found, np.full(4, 2.4), 0.02)


def test_intervals_hold_the_truth_in_95_percent_of_runs():
    """Sensors far from each other, many seeds: 95 % of intervals, within the bounds of a binomial number at alpha 1e-4."""
    points = np.array([[0, 0, 0], [1, 0, 0.5], [0.4, 0.4, 0.8], [2, 2, 0]])
    exact = 100 * from_points(points, np.tile([0, 0, 1.0], (4, 1)), LAMP[None])
    patches = rd.subdivide(join([("lamp", 0.0, 100.0, [LAMP])], source="lamp"), cells=1)
    solution = rd.solve(patches, method="gather", rays=8192, replicates=8)
    held = []
    for seed in range(60):
        low, high = rd.measure(solution, rd.Sensors.of(points), rays=64 * 8 * 4, seed=seed).interval(0.95)
        held.append((low[:, 0] <= exact) & (exact <= high[:, 0]))
    from scipy.stats import binom

    assert binom.cdf(np.sum(held), 240, 0.95) > ALPHA / 2
    assert binom.sf(np.sum(held) - 1, 240, 0.95) > ALPHA / 2


def test_equal_seeds_give_equal_bits(shaded):
    scene, _ = shaded
    above = rd.Sensors.grid(scene, "floor", 1.2, 1.0) + rd.Sensors.of([[0, 0, 1.5]], kind="cylindrical")
    one, other, third = (measured(scene, above, 256, seed) for seed in (3, 3, 4))
    assert np.array_equal(one.values, other.values)
    assert not np.array_equal(one.values, third.values)


@pytest.fixture(scope="module")
def shaded() -> tuple[rd.Scene, rd.Sensors]:
    """A lamp over a grey floor with a box on it; the grid lies at the height of the box's middle."""
    floor = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))
    lamp = quad((-0.5, -0.5, 2), (0, 1, 0), (1, 0, 0))
    scene = join(
        [("floor", 0.5, 0.0, [floor]), ("lamp", 0.0, 10.0, [lamp]), ("box", 0.3, 0, box((1, 1, 0), (1.6, 1.6, 1)))], source="x"
    )
    return scene, rd.Sensors.grid(scene, "floor", 0.5, 0.5)


def test_sensors_inside_of_a_box_are_told_and_left_out(shaded):
    scene, sensors = shaded
    with pytest.warns(rd.RadiosityWarning, match=r"1 of 64 sensors see mostly backs.*floor at \[1.25, 1.25, 0.5\]"):
        found = measured(scene, sensors, 64)
    row = found.table()[0]
    assert found.inside.sum() == 1
    assert row["sensors"] == 63
    assert row["min"] > 0


def test_error_targets(shaded):
    """Both are reached, and mean what they say: the half width of the mean, or of every sensor, which takes more lines."""
    scene, _ = shaded
    sensors, patches = rd.Sensors.grid(scene, "floor", 1.2, 1.0), rd.subdivide(scene, cells=4)
    solution = rd.solve(patches, method="gather", rays=500_000, replicates=8)
    mean, worst = (rd.measure(solution, sensors, error=0.01, error_of=of) for of in ("mean", "worst"))
    assert (mean.status, worst.status) == ("complete", "complete")
    assert half_width(mean.values.mean(axis=(1, 2))) <= 0.01 * mean.values.mean()
    assert (half_width(worst.values) <= 0.01 * worst.illuminance).all()
    assert (half_width(mean.values) > 0.01 * mean.illuminance).any()
    assert mean.rays < worst.rays


def test_what_cannot_be_reached_is_told(shaded):
    """The error of the solution stays, whatever the lines of sensors."""
    scene, _ = shaded
    solution = rd.solve(rd.subdivide(scene, cells=2), rays=20_000, replicates=8)
    with pytest.warns(rd.RadiosityWarning, match="solve longer"):
        found = rd.measure(solution, rd.Sensors.of([[0, 0, 1.9]], [[0, 0, -1]]), error=1e-4)
    assert found.status == "not reached"


@pytest.mark.filterwarnings("ignore:.*lamps shine on a face near:radiosity.RadiosityWarning")
def test_sensors_on_a_large_tilted_floor_are_not_below_it():
    """Near the centre of coordinates the floor's plane is rounded by more than a point there."""
    turned = np.linalg.qr(np.random.Generator(np.random.Philox(1)).normal(size=(3, 3)))[0]
    turned[2] *= np.linalg.det(turned)
    floor, lamp = quad((-7, -7, 0), (14, 0, 0), (0, 14, 0)) @ turned.T, quad((-0.5, -0.5, 2), (0, 1, 0), (1, 0, 0)) @ turned.T
    points = np.random.Generator(np.random.Philox(2)).uniform(-0.1, 0.1, (300, 3)) * [1, 1, 0] @ turned.T
    scene = join([("floor", 0.5, 0.0, [floor]), ("lamp", 0.0, 100.0, [lamp])], source="tilted")
    found = measured(scene, rd.Sensors.of(points, turned[:, 2]), 256)
    exact = 100 * from_points(points, np.tile(turned[:, 2], (300, 1)), lamp[None])
    assert agrees(found, exact, 0.05)


def test_a_rough_solution_goes_on_until_the_sensors_are_reached(monkeypatch):
    """Near a wall that lights most of what the sensor sees, the first solution errs too much."""
    walls = box((0, 0, 0), (2, 2, 2), inward=True)
    room = join([("walls", 0.9, 0.0, walls[:5]), ("lamp", 0.0, 1.0, [walls[5]])], source="bright")
    asked = []
    monkeypatch.setattr(run, "solve", lambda *given, **options: asked.append(options["error"]) or rd.solve(*given, **options))
    found = rd.measure(rd.subdivide(room, cells=3), rd.Sensors.of([[1, 1, 0.5]], [[0, 0, -1]]), error=0.0005)
    assert found.status == "complete"
    assert asked[:2] == [0.005, 0.00125]
    assert half_width(found.values)[0, 0] <= 0.0005 * found.illuminance[0, 0]


def test_errors_without_replicates(shaded):
    scene, _ = shaded
    patches = rd.subdivide(scene, cells=1)
    point = rd.Sensors.of([[0, 0, 1.0]])
    alone = rd.solve(patches, "gather", rays=20_000, replicates=1)
    with pytest.raises(rd.MethodError, match="give 2 or more"):
        rd.measure(alone, point, error=0.01, replicates=1)
    with pytest.warns(rd.RadiosityWarning, match="the solution has one replicate"):
        found = rd.measure(alone, point, rays=20_000)
    assert len(found.values) == 8
    with pytest.raises(rd.MethodError, match="leave replicates out"):
        rd.measure(rd.solve(patches, "gather", rays=20_000, replicates=4), point, rays=20_000, replicates=8)


def test_light_through_a_pane():
    """Of a lamp, a surface and the sky: the share that the pane lets through."""
    pane = rd.Scene.from_arrays(
        quad((-5, -5, 0.5), (10, 0, 0), (0, 10, 0)), [[0, 1, 2, 3]], 0.0, 0.0, transmittance=0.6, photometric=True, names=["pane"]
    )
    scene = replace(pane, lights=lit(luminaires=(bulb((0, 0, 2), power=400 * np.pi),)).lights)
    assert agrees(measured(scene, rd.Sensors.of([[0, 0, 0]]), 1 << 14), 0.6 * 100 / 4, 0.05)
    under = replace(pane, lights=lit(sky=uniform(100.0)).lights)
    seen = from_points(np.zeros((1, 3)), np.array([[0, 0, 1.0]]), pane.vertices[None, ::-1])[0]
    assert agrees(measured(under, rd.Sensors.of([[0, 0, 0]]), 1 << 14), 100 * np.pi * (1 - 0.4 * seen), 0.03)
    assert not agrees(measured(under, rd.Sensors.of([[0, 0, 0]]), 1 << 14), 100 * np.pi * 0.9 * (1 - 0.4 * seen), 0.03)


def test_sensors_in_the_coordinates_of_a_map():
    """Eastings and northings of some 1e6 m, in which a building keeps its lux, to the bit; they were refused above 1e6 m."""
    found = []
    for away in (np.zeros(3), np.array([400_000, 5_000_000, 100.0])):
        walls = ("walls", 0.5, 0.0, [face + away for face in box((0, 0, 0), (4, 4, 3), inward=True)])
        scene = join([walls], source="map").with_lights([rd.point_light(position=np.add(away, [2, 2, 2.5]), lumens=1000)])
        found.append(measured(scene, rd.Sensors.of(np.add(away, [[2, 2, 1], [1, 3, 0]])), 256).illuminance)
    assert np.array_equal(*found)


def test_an_error_of_dark_sensors_is_not_reached():
    """Beside a lit room stands a closed one, in which no line finds light: a relative error of nothing cannot be judged."""
    rooms = [
        ("lit", 0.5, 1.0, box((0, 0, 0), (1, 1, 1), inward=True)),
        ("dark", 0.5, 0.0, box((2, 0, 0), (3, 1, 1), inward=True)),
    ]
    solution = rd.solve(rd.subdivide(join(rooms, source="rooms"), cells=1), "random-walk", rays=2000, seed=1)
    point = rd.Sensors.of([[2.5, 0.5, 0.5]])
    with pytest.warns(rd.RadiosityWarning, match="no line found light at the sensors"):
        assert rd.measure(solution, point, error=0.1).status == "not reached"
