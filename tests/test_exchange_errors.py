"""Stated errors of radiative exchange are true, and hold what few lines cannot show."""

import numpy as np
import pytest
from scipy.stats import chi2
from test_exchange import WALLS, big_box, black, net, scene_of

import radiosity as rd
from radiosity.exchange.estimate import Estimator
from radiosity.exchange.jackknife import Jackknife
from radiosity.factors.polygons import exchange
from radiosity.scene.shapes import box, quad

KELVIN = np.array([300.0, 310, 320, 290, 400, 350])


def test_the_jackknife_of_a_square_of_means():
    """The square of a mean of R values is too large by s²/R, which a jackknife takes away to the last bit."""
    values = np.array([1.0, 2.5, 3.0, 7.0, 4.0])
    found = Jackknife(np.array([values.mean() ** 2]))
    for i in range(5):
        found.add(np.array([np.delete(values, i).mean() ** 2]))
    assert found.value[0] == pytest.approx(values.mean() ** 2 - values.var(ddof=1) / 5, rel=1e-12)
    linear = Jackknife(np.array([values.mean()]))
    for i in range(5):
        linear.add(np.array([np.delete(values, i).mean()]))
    assert linear.value[0] == pytest.approx(values.mean(), rel=1e-14)
    assert linear.error[0] == pytest.approx(values.std(ddof=1) / np.sqrt(5), rel=1e-12)


def test_errors_are_true_where_walls_reflect_nearly_all():
    """40 runs of few lines at emissivity 0.05 to 0.3, against exact factors.

    (mean - exact) / error follows Student's t with 7 degrees of freedom, of variance 7/5. The mean square of the 40 values of a
    wall, over 7/5, must lie below the 99.9 % point for normal values, widened by the fourth moment of t (5 where it is 3).
    """
    patches, area, factors = big_box()
    shine = np.array([0.05, 0.1, 0.3, 0.05, 0.2, 0.1])
    exact = net(area, factors, shine, black(KELVIN))
    given, runs = dict(zip(WALLS, KELVIN, strict=True)), 40
    found = []
    for seed in range(runs):
        lines = rd.trace_lines(patches, rays=3_000, seed=seed, numbers="random")
        heat = rd.radiative_exchange(lines, given, emissivity=dict(zip(WALLS, shine, strict=True)))
        found.append((heat.net - exact) / heat.net_standard_error)
    z = np.array(found)
    most = 1 + 2.2 * (chi2.ppf(0.999, runs) / runs - 1)
    assert ((z**2).mean(axis=0) / 1.4 < most).all()
    assert ((z**2).mean(axis=0) / 1.4 > 0.3).all()
    assert (np.abs(z.mean(axis=0)) < 4 * np.sqrt(1.4 / runs)).all()  # no bias


def far_apart() -> rd.Patches:
    """A hot plate, and a small one 60 m away that few lines find, in the open."""
    parts = [("hot", [quad((0, 0, 0), (1, 0, 0), (0, 1, 0))]), ("far", [quad((0, 0, 60), (0, 0.01, 0), (0.01, 0, 0))])]
    return rd.subdivide(scene_of(parts), cells=1)


@pytest.mark.filterwarnings("ignore:.*so narrow")  # 1 cm, 60 m away
def test_a_pair_that_no_line_joined_is_not_known_to_exchange_nothing():
    patches = far_apart()
    heat = rd.radiative_exchange(patches, {"hot": 1000, "far": 300}, emissivity=1, surroundings=300, rays=2_000)
    exact = 1e-4 / (np.pi * 60**2) * (black(1000) - black(300))
    assert heat.exchange[0, 1] == 0
    assert heat.exchange_standard_error[0, 1] > exact
    assert heat.net_standard_error[1] > exact
    low, high = heat.net_interval()
    assert low[1] < -exact < high[1]


def test_what_the_lines_of_a_small_plate_find_counts_where_a_large_one_missed_it():
    """A heater of a square metre, and a load of 1 dm² 2 m above its middle, in the open: in a third of these runs no line of the
    heater meets the load, and 37 lines of the load meet the heater. Heat then was 0 W. Student's 7 degrees of freedom, six runs:
    p = 1e-3."""
    load = np.array(quad((0.45, 0.45, 2), (0, 0.1, 0), (0.1, 0, 0)))
    patches = rd.subdivide(scene_of([("hot", [quad((0, 0, 0), (1, 0, 0), (0, 1, 0))]), ("load", [load])]), cells=1)
    exact = exchange(patches.corners[:1], patches.corners[1:])[0] * (black(1000) - black(300))
    for seed in range(6):
        heat = rd.radiative_exchange(patches, {"hot": 1000, "load": 300}, emissivity=1, surroundings=300, rays=2_000, seed=seed)
        assert abs(heat.exchange[0, 1] - exact) < 7 * heat.exchange_standard_error[0, 1]
        assert heat.exchange_standard_error[0, 1] < 0.2 * exact


def test_planes_that_look_away_from_each_other_exchange_nothing_for_certain():
    parts = [("up", [quad((0, 0, 0), (1, 0, 0), (0, 1, 0))]), ("down", [quad((0, 0, -1), (0, 1, 0), (1, 0, 0))])]
    patches = rd.subdivide(scene_of(parts), cells=1)
    heat = rd.radiative_exchange(patches, {"up": 1000, "down": 300}, emissivity=1, surroundings=0, rays=2_000)
    assert heat.exchange_standard_error[0, 1] == 0
    assert heat.net == pytest.approx(black(np.array([1000, 300])), rel=1e-12)


def test_one_replicate_tells_no_error():
    patches, *_ = big_box()
    heat = rd.radiative_exchange(patches, {"*": 300, "z low": 400}, emissivity=0.5, rays=5_000, replicates=1)
    assert np.isnan(heat.net_standard_error).all()
    assert "± unknown" in str(heat)
    assert "one replicate" in str(heat)


@pytest.mark.parametrize("error_of", ["net:z low", "temperature:y *", None])
def test_an_error_is_reached(error_of):
    patches, *_ = big_box()
    options = {"adiabatic": ["y *"], "emissivity": 0.5, "error": 0.002 if error_of != "net:z low" else 0.004}
    heat = rd.radiative_exchange(patches, {"z *": 300, "x *": 310, "z low": 400}, error_of=error_of, **options)
    assert heat.status == "complete"
    low, high = heat.net_interval()
    if error_of == "net:z low":
        assert (high - low)[4] / 2 <= 0.004 * heat.net[4]
    elif error_of is None:
        assert (high - low).max() / 2 <= 0.002 * heat.net[4]
    else:
        assert ((heat.temperature_interval()[1] - heat.temperature)[2:4] <= 0.002 * heat.temperature[2:4]).all()
    lines = rd.trace_lines(patches, quanta=heat.quanta)
    again = rd.radiative_exchange(lines, {"z *": 300, "x *": 310, "z low": 400}, adiabatic=["y *"], emissivity=0.5)
    assert np.array_equal(again.net, heat.net)  # in any stages


def test_an_interrupted_run_returns_the_last_stage(monkeypatch):
    patches, *_ = big_box()
    stages, estimate = [], Estimator.estimate

    def interrupted(self, pairs, **options):
        stages.append(int(pairs.counts.sum()))
        if len(stages) > 2:
            raise KeyboardInterrupt
        return estimate(self, pairs, **options)

    monkeypatch.setattr(Estimator, "estimate", interrupted)
    heat = rd.radiative_exchange(patches, {"*": 300, "z low": 400}, emissivity=0.5, error=1e-6)
    assert heat.status == "interrupted"
    assert heat.rays == stages[1]
    assert heat.net[4] > 0
    with pytest.raises(KeyboardInterrupt):
        rd.radiative_exchange(patches, {"*": 300, "z low": 400}, emissivity=0.5, rays=1_000)


@pytest.mark.filterwarnings("ignore:.*so narrow")  # 1 cm, 60 m away
def test_an_error_that_is_not_reached_is_told():
    patches = far_apart()
    options = {"emissivity": 1, "surroundings": 0, "error": 0.01, "rays": 20_000}
    with pytest.warns(rd.RadiosityWarning, match=r"was not reached with .* cannot be judged|was not reached with"):
        heat = rd.radiative_exchange(patches, {"hot": 1000}, flux={"far": 0}, error_of="temperature:far", **options)
    assert heat.status == "not reached"


def test_lines_of_small_heaters_are_not_few():
    """A heater of a hundredth of the area gets a share of a quarter of the lines."""
    parts = [("walls", box((0, 0, 0), (1, 1, 1), inward=True)), ("heater", box((0.48, 0.48, 0.48), (0.52, 0.52, 0.52)))]
    patches = rd.subdivide(scene_of(parts), cells=1)
    heat = rd.radiative_exchange(patches, {"walls": 300, "heater": 1200}, emissivity=0.8, rays=20_000)
    exact = (black(1200) - black(300)) * heat.area[1] / (1 / 0.8 + heat.area[1] / heat.area[0] * (1 / 0.8 - 1))
    assert heat.net[1] == pytest.approx(exact, rel=1e-3)


def test_faces_too_narrow_for_lines_are_told():
    strips = np.array(
        [[[0, 0, 0], [1, 0, 0], [1, 1e-5, 0], [0, 1e-5, 0]], [[0, 0, 1e-5], [0, 1e-5, 1e-5], [1, 1e-5, 1e-5], [1, 0, 1e-5]]]
    )
    faces = np.arange(8).reshape(-1, 4)
    scene = rd.Scene.from_arrays(strips.reshape(-1, 3), faces, 0.5, 0.0, surface=[0, 1], names=["low", "high"])
    with pytest.warns(rd.RadiosityWarning, match="faces are so narrow"):
        rd.radiative_exchange(rd.subdivide(scene, cells=1), {"*": 300}, emissivity=0.5, surroundings=300, rays=20_000)


def test_the_report_tells_what_the_bars_leave_out():
    scene = rd.subdivide(rd.load_scene("labyrinth"), cells=1)
    assert "not the size of patches" in str(rd.radiative_exchange(scene, {"floor": 310, "*": 290}, emissivity=0.9, rays=100_000))
