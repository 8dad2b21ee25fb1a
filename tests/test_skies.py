"""Skies of standards and of the weather: integrals, ratios of published formulas, the sun's place, weather files."""

import os
import re
import subprocess
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import radiosity as rd
from radiosity.scene.lights.axes import place_of, sky_axes, towards
from radiosity.scene.lights.cie import GENERAL
from radiosity.scene.lights.perez import Weather, air_mass, nearness
from radiosity.scene.lights.sky_table import sky_of
from radiosity.scene.lights.sun_position import _place, day_of_year, days_after_2000

AXES = sky_axes()


def seen(sky: rd.Sky, altitude: float, azimuth: float = 0.0) -> float:
    return float(sky.at(towards(sky.axes, altitude, azimuth))[0])


def vertical(sky: rd.Sky, azimuth: float) -> float:
    """Irradiance of a facade that looks to an azimuth, by a sum over the table's look-up, above the horizon alone."""
    z, turn = (np.arange(180) + 0.5) / 180, np.radians(np.arange(720) / 2)
    level = np.sqrt(1 - z**2)[:, None]
    way = level[..., None] * (np.cos(turn)[:, None] * sky.axes[0] + np.sin(turn)[:, None] * sky.axes[1])
    cosine = np.maximum(level * np.cos(turn - np.radians(azimuth)), 0)
    return float((sky.at(way + z[:, None, None] * sky.axes[2])[..., 0] * cosine).sum() * 2 * np.pi / 720 / 180)


EVERY = [rd.uniform_sky, lambda e, **k: rd.cie_sky("overcast", e, **k)] + [
    lambda e, kind=kind, **k: rd.cie_sky(kind, e, sun=(35.0, 150.0), **k) for kind in ("clear", "intermediate", *GENERAL)
]


@pytest.mark.parametrize("sky", EVERY)
def test_tables_have_exactly_the_horizontal_irradiance_that_is_asked_for(sky):
    made = sky(12_345.0)
    assert made.horizontal[0] == pytest.approx(12_345, rel=1e-13)
    assert (made.radiance[: len(made.radiance) // 2] == 0).all()
    assert (made.radiance >= 0).all()


def test_the_overcast_sky_is_three_times_as_bright_above_and_lights_a_facade_by_two_fifths():
    """The zenith is 9 / (7 pi) of the horizontal, and a facade has 3 / 14 + 4 / (7 pi) of it."""
    sky = rd.cie_sky("overcast", 1.0)
    assert seen(sky, 90) == pytest.approx(9 / (7 * np.pi))
    assert [seen(sky, h) / seen(sky, 90) for h in (0, 30)] == pytest.approx([1 / 3, 2 / 3])
    assert vertical(sky, 77) == pytest.approx(3 / 14 + 4 / (7 * np.pi), rel=1e-4)


def test_the_clear_sky_is_the_formula_of_cie_22():
    sky, sun = rd.cie_sky("clear", 1.0, sun=(40.0, 200.0)), towards(AXES, 40, 200)

    def formula(altitude, azimuth):
        angle = np.arccos(np.clip(towards(AXES, altitude, azimuth) @ sun, -1, 1))
        return (0.91 + 10 * np.exp(-3 * angle) + 0.45 * np.cos(angle) ** 2) * (1 - np.exp(-0.32 / np.sin(np.radians(altitude))))

    for place in ((10, 200), (40, 200), (40, 20), (75, 100)):
        assert seen(sky, *place) / seen(sky, 90) == pytest.approx(formula(*place) / formula(90, 0), rel=2e-3)


def test_general_skies_have_the_ratios_of_iso_15469():
    """Zenith over horizon where the sun does not count: 1 + a exp(b), since the gradation is 1 at the horizon."""
    for kind, ratio in ((1, 1 + 4 * np.exp(-0.7)), (3, 1 + 1.1 * np.exp(-0.8)), (5, 1.0)):
        sky = rd.cie_sky(kind, 1.0)
        assert seen(sky, 90) / seen(sky, 0) == pytest.approx(ratio)
    sky = rd.cie_sky(15, 1.0, sun=(30.0, 0.0))  # at the sun over 90 degrees from it, at equal altitudes
    angle = np.arccos(0.25)
    far = 1 + 24 * (np.exp(-2.8 * angle) - np.exp(-1.4 * np.pi)) + 0.15 / 16
    assert seen(sky, 30, 0) / seen(sky, 30, 90) == pytest.approx((1 + 24 * (1 - np.exp(-1.4 * np.pi)) + 0.15) / far, rel=0.01)


def test_tables_of_a_degree_light_facades_to_a_thousandth():
    """Against tables of a third of a degree, of skies with narrow bright surroundings of the sun; docs/daylight.md has more."""
    for direct, diffuse, height in ((900, 60, 85.0), (300, 150, 10.0)):
        weather = Weather(direct, diffuse, (np.radians(height), 1.234), 100)
        rough, fine = (sky_of("", weather.relative(), AXES, 1.0, 0, (), "", True, *n) for n in ((91, 360), (271, 1080)))
        for azimuth in (0, 70, 180, 250):
            assert vertical(rough, azimuth) == pytest.approx(vertical(fine, azimuth), rel=1e-3)


def test_the_sky_of_perez_has_its_paper_s_classes_and_the_irradiance_asked_for():
    """By hand: zenith angle 60 degrees, 100 W/m² diffuse and none direct, on a day when the sun is at its mean distance."""
    weather = Weather(0, 100, (np.radians(30), 0.0), 93.5)
    assert nearness(93.5) == pytest.approx(1, abs=1e-3)
    assert nearness(3) == pytest.approx(1.035, abs=5e-4)
    assert air_mass(np.radians(60)) == pytest.approx(1 / (0.5 + 0.15 * 0.012097), rel=1e-5)  # 33.885^-1.253
    assert (weather.clearness, weather.kind) == (1.0, 0)
    assert weather.brightness == pytest.approx(100 * 1.9928 / 1367, rel=2e-3)
    assert weather.lumens[1] == pytest.approx(97.24 - 0.46 * 2.004 + 6 - 8.91 * np.log(0.1458), rel=2e-3)
    clear = Weather(800, 100, (np.radians(30), 0.0), 93.5)
    turned = 1.041 * (np.pi / 3) ** 3
    assert clear.clearness == pytest.approx((9 + turned) / (1 + turned))
    assert clear.kind == 6
    sky, suns = rd.perez_sky(800, 100, sun=(30, 140), day=93, ground=0.3)
    assert sky.horizontal[0] == pytest.approx(100 * clear.lumens[1], rel=2e-3)
    assert suns[0].irradiance[0] == pytest.approx(800 * clear.lumens[0], rel=2e-3)
    assert 90 < clear.lumens[0] < 110 < clear.lumens[1] < 150
    assert seen(sky, -30) == pytest.approx(0.3 / np.pi * (sky.horizontal[0] + suns[0].irradiance[0] / 2))
    assert seen(sky, 30, 140) > 5 * seen(sky, 30, 320)


def test_the_sky_of_perez_is_that_of_radiance():
    """Parameters of gendaylit, and the ratios of patches of gendaymtx, in four weathers."""
    found = find_spec("pyradiance")
    if found is None or found.origin is None:
        pytest.skip("pyradiance is not installed: pip install pyradiance")
    folder = Path(found.origin).parent
    environment = dict(os.environ, RAYPATH=str(folder / "lib"))
    for month, day, hour, direct, diffuse in (
        (6, 21, 10.5, 600, 150),
        (12, 21, 9.5, 20, 30),
        (9, 1, 16.5, 300, 80),
        (3, 3, 11, 0, 9),
    ):
        date = [str(x) for x in (month, day, hour)]
        place = ["-a", "50", "-o", "-10", "-m", "-15", "-O", "1"]
        told = subprocess.run(
            [folder / "bin" / "gendaylit", *date, "-W", str(direct), str(diffuse), *place],
            capture_output=True,
            text=True,
            check=True,
            env=environment,
        ).stdout
        found = re.search(r"perezlum.cal\s+0\s+10 (.*)", told)
        assert found is not None
        numbers = np.array(found[1].split(), np.float64)
        sun = place_of(AXES, numbers[7:10] / np.linalg.norm(numbers[7:10]))
        number = day_of_year(month, day)
        weather = Weather(direct, diffuse, (np.radians(sun[0]), np.radians(sun[1])), number)
        assert weather.parameters == pytest.approx(numbers[2:7], rel=2e-3, abs=2e-5)
        wea = f"place p\nlatitude 50\nlongitude -10\ntime_zone -15\nsite_elevation 0\nweather_data_file_units 1\n{' '.join(date)}"
        patches = subprocess.run(
            [folder / "bin" / "gendaymtx", "-O1", "-s", "-c", "1", "1", "1", "-of", "-h", "-m", "1"],
            input=f"{wea} {direct} {diffuse}\n".encode(),
            capture_output=True,
            check=True,
            env=environment,
        ).stdout
        theirs = np.frombuffer(patches, np.float32).reshape(-1, 3)[1:, 0]
        sky, _ = rd.perez_sky(direct, diffuse, sun=sun, day=number, photometric=False)
        ours = np.array([seen(sky, *one) for one in tregenza()])
        assert theirs / ours == pytest.approx(np.full(145, np.median(theirs / ours)), rel=3e-3)
        assert np.median(theirs / ours) == pytest.approx(1, rel=0.02)  # it sums over patches where we integrate


def tregenza() -> list[tuple[float, float]]:
    """Altitudes and azimuths of the centres of the 145 patches, as gendaymtx -m 1 has them."""
    rows = zip(range(7), (30, 30, 24, 24, 18, 12, 6), strict=True)
    return [(12 * row + 6, 360 * i / n) for row, n in rows for i in range(n)] + [(90.0, 0.0)]


def test_implausible_weather_is_told_or_refused():
    with pytest.warns(rd.RadiosityWarning, match="more than any measured"):
        sky, _ = rd.perez_sky(100, 800, sun=(2, 90), photometric=False)
    assert np.isfinite(sky.radiance).all()
    assert sky.horizontal[0] == pytest.approx(800)
    with pytest.warns(rd.RadiosityWarning, match="2.0 degrees below the horizon.*5 W/m² are left out"):
        sky, suns = rd.perez_sky(5, 3, sun=(-2, 90), photometric=False)
    assert sky.horizontal[0] == pytest.approx(3)
    assert suns == ()
    with pytest.raises(rd.SceneError, match="gives no light from anywhere"):
        rd.perez_sky(50, 20, sun=(90, 0))


@pytest.mark.parametrize(
    ("make", "fault"),
    [
        (lambda: rd.cie_sky("foggy", 1), "there is no CIE sky 'foggy'; known are overcast, clear, intermediate, and 1 to 15"),
        (lambda: rd.cie_sky(16, 1), "there is no CIE sky 16"),
        (lambda: rd.cie_sky("clear", 1), "depends on the sun"),
        (lambda: rd.cie_sky("clear", 1, sun=(100, 0)), "altitude must lie in -90 to 90"),
        (lambda: rd.uniform_sky(-1), "horizontal must be 0 or more"),
        (lambda: rd.uniform_sky(1, ground=20), "0 to 1"),
        (lambda: rd.uniform_sky(1, up="x"), "up: it is 'x'"),
        (lambda: rd.uniform_sky(1, up=(0, 1, 0)), "north is missing"),
        (lambda: rd.uniform_sky(1, north=(0, 0, 2)), "points up or down"),
        (lambda: rd.perez_sky(1, 0, sun=(1, 1)), "diffuse irradiance is 0"),
        (lambda: rd.perez_sky(-1, 1, sun=(1, 1)), "direct irradiance must be 0 or more"),
        (lambda: rd.perez_sky(1, 1, sun=(1, 1), day=367), "day is 367"),
        (lambda: rd.sun(5), "give its direction, or its altitude"),
        (lambda: rd.sun(5, direction=(0, 0, 0)), "not all 0"),
        (lambda: rd.sun(-5, direction=(0, 0, 1)), "irradiance must be 0 or more"),
        (lambda: rd.sun(5, direction=(0, 0, 1), azimuth=3), "exclude each other"),
        (lambda: rd.sun(5, direction=(0, 0, 1), diameter=180), "below 180"),
        (lambda: rd.sun_position(52, 13, 1, 2, 30, 12), "there is no day 30 in month 2"),
        (lambda: rd.sun_position(520, 13, 1, 2, 3, 12), "latitude: it is 520"),
    ],
)
def test_values_out_of_range_are_named(make, fault):
    with pytest.raises(rd.SceneError, match=re.escape(fault)):
        make()


def test_the_ground_reflects_the_sky_and_the_sun():
    sun = rd.sun(700, altitude=30, azimuth=90)
    sky = rd.uniform_sky(300, ground=0.2, suns=[sun])
    assert seen(sky, -1) == seen(sky, -89) == pytest.approx(0.2 * (300 + 350) / np.pi)
    assert sky.horizontal[0] == pytest.approx(300)


def test_north_east_and_up_of_both_conventions():
    assert sky_axes("z").tolist() == [[0, 1, 0], [1, 0, 0], [0, 0, 1]]
    assert sky_axes("y").tolist() == [[0, 0, -1], [1, 0, 0], [0, 1, 0]]
    assert sky_axes("z", (1, 0, 0.5)) == pytest.approx(np.array([[1, 0, 0], [0, -1, 0], [0, 0, 1]]))
    assert rd.sun(1, altitude=0, azimuth=90, up="y", north=(1, 0, 0)).direction == pytest.approx([0, 0, 1])
    assert place_of(AXES, towards(AXES, 20, 300)) == pytest.approx((20, 300))


def test_the_sun_stands_where_published_values_say():
    """I. Reda and A. Andreas, NREL/TP-560-34302 (2008), A.5; J. Meeus, "Astronomical Algorithms" (1998), example 25.a."""
    altitude, azimuth = rd.sun_position(39.742476, -105.1786, -7, 10, 17, 12 + 30.5 / 60, 2003)
    assert 90 - altitude == pytest.approx(50.11162, abs=0.01)
    assert azimuth == pytest.approx(194.34024, abs=0.01)
    right_ascension, declination, _ = np.degrees(_place(days_after_2000(1992, 10, 13)))
    assert right_ascension % 360 == pytest.approx(198.38083, abs=0.01)
    assert declination == pytest.approx(-7.78507, abs=0.01)
    assert rd.sun_position(-33.9, 151.2, 10, 6, 21, 12)[1] == pytest.approx(359, abs=1)  # Sydney: in the north at noon
    assert rd.sun_position(52.5, 13.4, 1, 6, 21, 0)[0] < -10


HEADER = "LOCATION,Testville,-,DEU,Synthetic,000000,52.50,13.40,1.0,35.0"


def epw(path: Path, rows: dict[tuple[int, int, int], tuple], header: str = HEADER) -> Path:
    """Write a weather file; rows give global, direct normal, diffuse, and the dew point."""
    lines = [header] + [f"{word}," for word in ("DESIGN CONDITIONS", "GROUND TEMPERATURES", "DATA PERIODS")]
    for (month, day, hour), (whole, direct, diffuse, dew) in rows.items():
        values = [0.0] * 35
        values[7], values[13], values[14], values[15] = dew, whole, direct, diffuse
        lines.append(",".join(["2005", str(month), str(day), str(hour), "60", "?9", *(str(x) for x in values[6:])]))
    path.write_text("\r\n".join(lines) + "\r\n", "latin-1")
    return path


def test_an_hour_of_a_weather_file(tmp_path):
    path = epw(tmp_path / "a.epw", {(6, 21, 11): (0, 0, 0, 0), (6, 21, 12): (673, 600, 150, 14.0), (6, 21, 13): (0, 0, 0, 0)})
    sky, suns = rd.epw_sky(path, 6, 21, 12, photometric=False)
    assert sky.horizontal[0] == pytest.approx(150)
    assert suns[0].irradiance[0] == 600
    place = place_of(AXES, suns[0].direction)
    assert place == pytest.approx(rd.sun_position(52.5, 13.4, 1, 6, 21, 11.5), abs=0.01)
    lux, _ = rd.epw_sky(path, 6, 21, 12)
    weather = Weather(600, 150, (np.radians(place[0]), 0.0), 172, 14.0)
    assert lux.horizontal[0] == pytest.approx(150 * weather.lumens[1])
    with pytest.raises(rd.SceneError, match="the sky gives no light"):
        rd.epw_sky(path, 6, 21, 11)


def test_at_sunrise_the_sun_stands_in_the_middle_of_what_is_left_of_the_hour(tmp_path):
    """At 3:30 the sun is down, and rises at 3:45: at the middle of the hour other programs find no sun, and a black sky."""
    path = epw(tmp_path / "a.epw", {(6, 21, 4): (6, 20, 5, 9.0)})
    assert rd.sun_position(52.5, 13.4, 1, 6, 21, 3.5)[0] < 0
    sky, suns = rd.epw_sky(path, 6, 21, 4, photometric=False)
    assert 0 < place_of(AXES, suns[0].direction)[0] < 1.5
    assert sky.horizontal[0] == pytest.approx(5)


@pytest.mark.parametrize(
    ("row", "header", "fault"),
    [
        ((600, 9999, 100, 9), HEADER, "line 5: direct normal irradiance is missing (it is 9999)"),
        ((600, 500, -1, 9), HEADER, "line 5: diffuse horizontal irradiance is missing"),
        ((600, 500, "n/a", 9), HEADER, "line 5: diffuse horizontal is no number (it is 'n/a')"),
        ((600, 500, 100, 9), "LOCATION,x", "is cut short"),
        ((600, 500, 100, 9), HEADER.replace("52.50", "north"), "line 1: latitude is no number"),
        ((600, 500, 100, 9), "Date,Time", "is no weather file"),
    ],
)
def test_damaged_weather_files_are_refused_by_line(tmp_path, row, header, fault):
    with pytest.raises(rd.SceneError, match=re.escape(fault)):
        rd.epw_sky(epw(tmp_path / "a.epw", {(6, 21, 12): row}, header), 6, 21, 12)


def test_hours_that_a_weather_file_lacks_and_parts_that_do_not_fit(tmp_path):
    path = epw(tmp_path / "a.epw", {(6, 21, 12): (100, 800, 100, 99.9)})
    with pytest.raises(rd.SceneError, match="has no row for month 6, day 22, hour 12"):
        rd.epw_sky(path, 6, 22, 12)
    with pytest.warns(rd.RadiosityWarning, match="global horizontal irradiance is 100 W/m², but direct normal and diffuse make"):
        rd.epw_sky(path, 6, 21, 12)
    with pytest.raises(rd.SceneError, match="cannot be read"):
        rd.epw_sky(tmp_path / "b.epw", 6, 21, 12)


def test_a_sun_below_the_horizon_is_told():
    with pytest.warns(rd.RadiosityWarning, match="sun 'sun': it is 5.0 degrees below the horizon"):
        rd.sun(1000, altitude=-5, azimuth=180)
    with pytest.warns(rd.RadiosityWarning, match="sky 'sky': the sun is 5.0 degrees below the horizon"):
        rd.cie_sky("clear", 1000, sun=(-5, 180))
