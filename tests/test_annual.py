"""Daylight of a year: sky patches, skies of the weather, coefficients, figures: against closed forms and runs of single hours.

Years have light in a few hours alone, so that they are short; weather files are made up.
"""

import csv
from dataclasses import replace
from datetime import date, timedelta

import drjit as dr
import numpy as np
import pytest
from light_samples import lit
from test_light_referees import corners, room
from test_sensors import ALPHA

import radiosity as rd
from radiosity.cli import main
from radiosity.device.backend import choose
from radiosity.patches.scatter import Scatter
from radiosity.scene.lights.axes import sky_axes, towards
from radiosity.scene.lights.model import Lights
from radiosity.scene.lights.perez import Weather
from radiosity.scene.lights.sky_patches import SkyPatches
from radiosity.scene.lights.weather_year import read_year
from radiosity.scene.lights.year_of_skies import YearOfSkies
from radiosity.sensors.annual.bins import Bins
from radiosity.sensors.annual.figures import Figures, of_set
from radiosity.sensors.annual.reflections import weights
from radiosity.sensors.annual.schedule import read_schedule
from radiosity.sensors.target import half_width

HEAD = "LOCATION,Made,-,DEU,made,0,52.5,13.4,1,35"
LIGHT = {(1, 15, 11): (300, 80), (3, 21, 13): (650, 120), (6, 21, 9): (500, 200), (9, 10, 17): (0, 150), (12, 5, 5): (0, 0)}


def epw(path, light=LIGHT, days: int = 365):
    """A weather file with light in some hours, (month, day, hour): direct and diffuse irradiance."""
    first, lines = date(2024 if days == 366 else 2025, 1, 1), [HEAD, "COMMENTS 1,none"]
    for number in range(days):
        day = first + timedelta(number)
        for hour in range(1, 25):
            direct, diffuse = light.get((day.month, day.day, hour), (0, 0))
            lines.append(f"2005,{day.month},{day.day},{hour},60,?,20,14,50,101000,0,0,300,9999,{direct},{diffuse}")
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture(scope="module")
def year(tmp_path_factory):
    return epw(tmp_path_factory.mktemp("weather") / "made.epw")


# ---- the sky ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("number", "low"), [(145, 12.0), (577, 90 / 14.5)])
def test_sky_patches_fill_the_sky(number, low):
    """Solid angles sum to 2 pi, and what patches of radiance 1 give the horizontal to pi. A row is as high as published."""
    sky = SkyPatches.of(number)
    assert len(sky) == number + 1
    assert sky.solid_angle[:-1].sum() == pytest.approx(2 * np.pi)
    assert sky.horizontal.sum() == pytest.approx(np.pi)
    assert np.degrees(sky.step) == pytest.approx(low)
    wanted = np.repeat(np.arange(number)[:, None], sky.samples[0].shape[1], axis=1)
    np.testing.assert_array_equal(sky.number(*sky.samples), wanted)
    assert sky.number(np.array([-0.1, 0.01, 0.01]), np.array([0.0, 0.0, -0.01])).tolist() == [number, 0, 0]
    with pytest.raises(rd.MethodError, match="sky_patches is 146; there are subdivisions of 145 and 577 patches"):
        SkyPatches.of(146)


@pytest.mark.parametrize("number", [145, 577])
def test_kernels_find_the_same_patches(number):
    sky, types, axes = SkyPatches.of(number), choose("auto").types, sky_axes("y", (0.6, 0, 0.8))
    bins = Bins(sky, axes, 1, types)
    ways = np.random.Generator(np.random.Philox(1)).normal(size=(4000, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    found = bins.number(types.Array3f(*(types.Float(column.astype(np.float32)) for column in ways.T)), True)
    dr.eval(found)
    north, east, up = axes @ ways.T
    wanted = sky.number(np.arcsin(up), np.arctan2(east, north))
    assert (np.array(found) != wanted).mean() < 2e-3  # at edges, in single precision


@pytest.mark.parametrize("number", [145, 577])
def test_skies_have_the_irradiance_of_the_weather(year, number):
    """The horizontal has the diffuse irradiance times the efficacy; the ground reflects it, with that of the sun; the sun is
    that of `epw_sky`, and patches are about the means of its sky."""
    sky, weather, axes = SkyPatches.of(number), read_year(year), sky_axes()
    skies = YearOfSkies.of(weather, sky, axes, 0.3)
    assert len(skies.hours) == 4
    for i, (month, day, hour) in enumerate([(1, 15, 11), (3, 21, 13)]):
        single, suns = rd.epw_sky(year, month, day, hour, ground=0.3)
        assert skies.radiance[i] @ sky.horizontal == pytest.approx(single.horizontal[0], rel=1e-9)
        assert skies.radiance[i, -1] == pytest.approx(single.at([0, 0, -1])[0], rel=1e-6)
        assert skies.direct[i] == pytest.approx(suns[0].irradiance[0], rel=1e-6)
        np.testing.assert_allclose(skies.towards[i], suns[0].direction, atol=1e-5)
        ways = np.array([towards(axes, *pair) for pair in np.degrees(np.stack(sky.samples, axis=-1)).reshape(-1, 2)])
        means = single.at(ways)[:, 0].reshape(len(sky) - 1, -1).mean(axis=1)
        np.testing.assert_allclose(skies.radiance[i, :-1], means, rtol=0.01)
        smeared = (skies.with_suns(sky)[i] - skies.radiance[i]) @ sky.solid_angle
        assert smeared == pytest.approx(suns[0].irradiance[0], rel=1e-6)


def test_hours_that_perez_has_no_answer_for_are_told(tmp_path):
    path = epw(tmp_path / "a.epw", {(6, 21, 2): (0, 5), (6, 21, 12): (0, 900), (6, 21, 13): (500, 0)})
    with pytest.warns(rd.RadiosityWarning) as told:
        skies = YearOfSkies.of(read_year(path), SkyPatches.of(145), sky_axes(), 0.2)
    text = " ".join(str(one.message) for one in told)
    for words in (
        "1 hours have light with the sun below",
        "1 hours have more diffuse light than any",
        "1 hours have direct light",
    ):
        assert words in text
    sun = (0.0, float(skies.sun[0, 1]))
    assert skies.radiance[0] @ SkyPatches.of(145).horizontal == pytest.approx(5 * Weather(0, 5, sun, 172, 14).lumens[1])


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda lines: lines[:-24], "has 8736 hours; a year has 8760"),
        (lambda lines: lines[:100] + lines[101:], "line 101: hour is 4, and 3 was expected"),
        (
            lambda lines: [line.replace(",9999,0,0", ",9999,9999,0") for line in lines],
            "line 3: direct normal irradiance is missing",
        ),
        (lambda lines: lines[:2] + lines[26:50] + lines[2:26] + lines[50:], "not in order at month 1, day 1"),
        (lambda lines: lines[1:], "is no weather file"),
        (lambda lines: [line.replace("2005,6,21,9,", "2005,6,x,9,") for line in lines], "must be whole numbers"),
    ],
)
def test_weather_that_is_no_year(tmp_path, year, edit, words):
    (tmp_path / "a.epw").write_text("\n".join(edit(year.read_text().splitlines())))
    with pytest.raises(rd.SceneError, match=words):
        read_year(tmp_path / "a.epw")


def test_a_year_in_another_time_zone_is_told(tmp_path, year):
    """The global irradiance belongs to the sun of the head's time zone; three hours away it does not."""
    weather, lines = read_year(year), year.read_text().splitlines()
    height = np.sin(np.radians(np.maximum(weather.sun[0], 0)))
    whole = np.append([9999, 9999], weather.diffuse + weather.direct * height)  # before it, the two lines of the head
    told = [line.replace(",300,9999,", f",300,{value:.0f},") for line, value in zip(lines, whole, strict=True)]
    (tmp_path / "right.epw").write_text("\n".join(told))
    read_year(tmp_path / "right.epw")
    (tmp_path / "wrong.epw").write_text("\n".join([told[0].replace(",13.4,1,", ",13.4,4,"), *told[1:]]))
    with pytest.warns(rd.RadiosityWarning, match=r"in 2 hours global .* hour 9: 520 and 312 .*check the time zone"):
        read_year(tmp_path / "wrong.epw")


def test_a_leap_year_goes_on_after_february(tmp_path):
    found = read_year(epw(tmp_path / "leap.epw", days=366))
    assert (len(found), found.day[-1]) == (8784, 366)
    assert found.sun[0].max() == pytest.approx(90 - 52.5 + 23.44, abs=0.5)


# ---- coefficients ----------------------------------------------------------------------------------------------------------


def test_reflections_solved_backwards_are_those_solved_forwards():
    """Patches 1 and 2 are the sides of a diffusing pane."""
    from scipy.sparse import csr_array

    rng = np.random.Generator(np.random.Philox(2))
    factors, seen, rho = rng.random((7, 7)), rng.random((3, 7)), rng.uniform(0.1, 0.6, 7)
    factors /= 1.1 * factors.sum(axis=1, keepdims=True)
    through, other = np.array([0, 0.3, 0.3, 0, 0, 0, 0]), np.array([0, 2, 1, 3, 4, 5, 6])
    sent = np.diag(rho) + np.diag(through)[:, other]
    exact = seen @ np.linalg.solve(np.eye(7) - sent @ factors, sent)
    found = weights(csr_array(seen), csr_array(factors), Scatter(rho, through, other))
    np.testing.assert_allclose(found, exact, rtol=1e-3)


def test_sensors_in_the_open_have_the_patches_of_their_half(year):
    """One that looks up has the horizontal's numbers, one that looks north half of the sky and of the ground; the year's lux are
    those of the sky and of the sun, in each hour, and of the ground."""
    sensors = rd.Sensors.of([[0, 0, 0], [0, 0, 0]], [[0, 0, 1], [0, 1, 0]])
    found = rd.annual(
        rd.subdivide(lit(), cells=1), year, sensors, rays=2_000_000, replicates=4, hourly=True, occupied=np.ones(8760)
    )
    upward, north = found.coefficients.whole.mean(axis=0)
    np.testing.assert_allclose(upward, found.sky.horizontal, atol=2e-3)
    assert (north[:-1].sum(), north[-1]) == pytest.approx((np.pi / 2, np.pi / 2), rel=0.01)
    skies = YearOfSkies.of(found.weather, found.sky, sky_axes(), 0.2)
    exact = skies.radiance @ found.sky.horizontal + skies.direct * skies.towards[:, 2]
    assert found.hourly is not None
    np.testing.assert_allclose(found.hourly[0][skies.hours], exact, rtol=0.01)
    assert (found.hourly[:, found.hourly[0] == 0]).max(initial=0.0) == 0
    assert found.values["sun hours"].tolist() == [((skies.direct * skies.towards[:, 2]) >= 1000).sum(), 0]
    assert found.values["mean"][0] == pytest.approx(exact.sum() / 8760, rel=0.01)


WINDOW = ((1.0, 0, 1.0), (4.0, 0, 2.2))
POINTS = np.array([[2.5, 0.5, 0.85], [1, 3, 0.85], [2.5, 5.5, 0.85]])


def office() -> rd.Scene:
    return lit(room((5, 6, 3), WINDOW, 0.6)).with_lights(sky=rd.cie_sky("overcast", 1.0), openings=[corners(WINDOW)])


def test_hours_of_a_room_are_those_of_single_runs(year):
    """A room with a window to the south, by 577 patches: the mean of three hours, sun included, to 1.5 % beyond both errors."""
    hours, sensors = [(1, 15, 11), (3, 21, 13), (9, 10, 17)], rd.Sensors.of(POINTS)
    there = (read_year(year).date[:, None] == hours).all(axis=-1).any(axis=1)
    patches = rd.subdivide(office(), size=0.5)
    with pytest.warns(rd.RadiosityWarning, match="the scene's own light is left out: 'sky'"):
        found = rd.annual(patches, year, sensors, sky_patches=577, rays=600_000, occupied=there)
    singles = []
    for hour in hours:
        sky, suns = rd.epw_sky(year, *hour, ground=0.2)
        scene = replace(office(), lights=replace(office().lights, sky=None)).with_lights(sky=sky, suns=suns)
        singles.append(rd.measure(rd.subdivide(scene, size=0.5), sensors, rays=300_000).values[..., 0])
    wanted = np.mean(singles, axis=0)
    errors = [half_width(values, 1 - ALPHA / len(sensors)) for values in (found.replicates["mean"], wanted)]
    wanted = wanted.mean(axis=0)
    assert (np.abs(found.values["mean"] - wanted) <= sum(errors) + 0.015 * wanted).all()
    assert (errors[0] < 0.12 * wanted).all()
    assert (errors[0] > 0).all()


@pytest.mark.slow
def test_coefficients_are_those_of_radiance(tmp_path):
    """Four cloudy hours of a room with a window, by the daylight coefficients of `rfluxmtx` and the same 145 sky patches.

    Two runs of Radiance with other numbers of rays differ by about 1 %, which stands for its error.
    """
    pytest.importorskip("pyradiance")
    from validation.radiance_file import text
    from validation.rtrace import program

    cloudy = {(1, 15, 11): (0, 80), (3, 21, 13): (0, 200), (6, 21, 9): (0, 150), (9, 10, 17): (0, 60)}
    weather, sky, sensors = read_year(epw(tmp_path / "a.epw", cloudy)), SkyPatches.of(145), rd.Sensors.of(POINTS)
    patches = rd.subdivide(office(), size=0.3)
    with pytest.warns(rd.RadiosityWarning, match="the scene's own light is left out"):
        found = rd.annual(patches, tmp_path / "a.epw", sensors, rays=3_000_000, occupied=weather.diffuse > 0)
    (tmp_path / "room.rad").write_text(text(replace(office(), lights=Lights())))
    far = "#@rfluxmtx h={0} u=Y\nvoid glow {1} 0 0 4 1 1 1 0\n{1} source {1}s 0 0 4 0 0 {2} 180\n"
    (tmp_path / "far.rad").write_text(far.format("u", "ground", -1) + far.format("r1", "sky", 1))
    rays = "".join(" ".join(map(str, (*point, 0, 0, 1))) + "\n" for point in POINTS).encode()
    runs = []
    for number in (60_000, 100_000):
        options = ["-I+", "-y", str(len(POINTS)), "-ab", "25", "-ad", str(number), "-lw", "1e-7", "-h", "-"]
        told = program("rfluxmtx", *options, str(tmp_path / "far.rad"), str(tmp_path / "room.rad"), given=rays)
        by_patch = np.array(told.split(), np.float64).reshape(len(POINTS), -1, 3)[:, :, 0]
        radiance = YearOfSkies.of(weather, sky, sky_axes(), 0.2).radiance  # the ground is last here, and first there
        runs.append((by_patch @ np.roll(radiance, 1, axis=1).T).mean(axis=1))
    wanted = np.mean(runs, axis=0)
    errors = half_width(found.replicates["mean"], 1 - ALPHA / len(sensors))
    assert (np.abs(found.values["mean"] - wanted) <= errors + 0.02 * wanted).all()


def test_sensors_that_no_light_was_found_for_are_told(year):
    """A tiny window that is not named: zero for all hours, without an error, was the answer."""
    small = ((2.0, 0, 1.0), (2.01, 0, 1.01))
    patches = rd.subdivide(lit(room((5, 6, 3), small, 0.5)), cells=1)
    with pytest.warns(rd.RadiosityWarning, match=r"no line found the sky for 3 of 3 sensors.*openings"):
        found = rd.annual(patches, year, rd.Sensors.of(POINTS), rays=2000)
    assert found.values["mean"].max() == 0


def test_equal_seeds_give_equal_bits(year):
    with pytest.warns(rd.RadiosityWarning):
        one, other, third = (
            rd.annual(rd.subdivide(office(), cells=1), year, rd.Sensors.of(POINTS), rays=20_000, replicates=2, seed=seed)
            for seed in (3, 3, 4)
        )
    assert one.values["mean"].tobytes() == other.values["mean"].tobytes()
    assert one.values["mean"].tobytes() != third.values["mean"].tobytes()


# ---- figures ---------------------------------------------------------------------------------------------------------------


def test_figures_of_hours():
    """Hours of 50, 150, 300, 3000 and 3001 lx, one that does not count, and two without light."""
    figures = Figures.nothing(1)
    lux = np.array([[50.0, 150, 300, 3000, 3001, 9000]])
    figures.add(lux, np.array([[0, 0, 999.0, 1000, 1001, 5000]]), np.array([True] * 5 + [False]))
    figures.dark(2)
    found = {name: round(7 * float(value[0]), 9) for name, value in figures.values().items()}
    assert found == {
        "DA": 3,
        "cDA": pytest.approx(3 + 0.5 + 1 / 6),
        "UDI below": 3,
        "UDI supplementary": 1,
        "UDI autonomous": 2,
        "UDI above": 1,
        "sun hours": 14,
        "mean": 6501,
    }
    of = of_set({name: np.array([0.4, 0.5, 0.6]) for name in figures.values()} | {"sun hours": np.array([250, 251, 3.0])})
    assert (of["sDA"], of["ASE"], of["DA"]) == pytest.approx((2 / 3, 1 / 3, 0.5))


def test_schedules(tmp_path):
    dates = read_year(epw(tmp_path / "a.epw")).date
    (tmp_path / "one.csv").write_text("occupied\n" + "\n".join("0.5" if hour == 12 else "0" for hour in dates[:, 2]))
    (tmp_path / "four.csv").write_text("# DAYSIM\n" + "\n".join(f"{m};{d};{h - 0.5};{int(h == 12)}" for m, d, h in dates))
    for name in ("one.csv", "four.csv"):
        assert (read_schedule(tmp_path / name, dates) == (dates[:, 2] == 12)).all()
    for text, words in (
        ("1\n" * 8759, "has 8759 hours"),
        ("0\n" * 8760, "nobody is there"),
        ("1\nx\n", "line 2: 'x' is no hour"),
    ):
        (tmp_path / "bad.csv").write_text(text)
        with pytest.raises(rd.SceneError, match=words):
            read_schedule(tmp_path / "bad.csv", dates)


def test_the_command_writes_a_table_and_all_numbers(tmp_path, year, capsys):
    table, numbers = tmp_path / "year.csv", tmp_path / "year.npz"
    (tmp_path / "points.csv").write_text("x,y,z\n3,2,2.9\n1,1,2.9\n")
    options = ["--epw", str(year), "--points", str(tmp_path / "points.csv"), "--cells", "1", "--rays", "20k", "--replicates", "2"]
    assert main(["annual", "room", *options, "--hourly", "-o", str(table), str(numbers)]) == 0
    told = capsys.readouterr()
    assert "3,650 occupied hours, 145 sky patches" in told.out
    assert "sDA 0.0%" in told.out
    assert "left out: 'light'" in told.err
    rows = list(csv.DictReader(table.read_text().splitlines()))
    with np.load(numbers) as arrays:
        assert arrays["hourly_illuminance_lx"].shape == (2, 8760)
        assert [float(row["mean_illuminance_lx"]) for row in rows] == pytest.approx(arrays["mean_illuminance_lx"].tolist())
    for more, words in (
        (["--hourly"], "in an .npz output"),
        (["--ground", "1.5"], "ground is 1.5"),
        (["-o", "a.png"], "a.png"),
        (["--north", "0,0,1"], "points up or down"),
    ):
        assert main(["annual", "room", *options, *more]) == 2
        assert words in capsys.readouterr().err
