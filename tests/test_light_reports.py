"""Public bug reports about programs that read luminaires and weather files or find lux, with inputs of our own. Each test names
the program and its report, and holds that the fault is not here."""

from dataclasses import replace

import numpy as np
import pytest
from light_samples import pebble

import radiosity as rd
from radiosity.scene.shapes import join, quad

FLOOR = ("floor", 0.0, 0.0, [quad((-4, -4, 0), (8, 0, 0), (0, 8, 0))])


def luminaire_file(folder, intensities: str, planes="0", multiplier=1.0, size="0.2 0.2 0"):
    """An IES file of absolute photometry with intensities at gamma 0, 45 and 90 of each plane."""
    path = folder / "lamp.ies"
    numbers = f"1 -1 {multiplier} 3 {len(planes.split())} 1 2 {size}\n1 1 10\n0 45 90\n{planes}\n{intensities}\n"
    path.write_text(f"IESNA:LM-63-2002\nTILT=NONE\n{numbers}")
    return path


def below(luminaire, points) -> np.ndarray:
    """Lux at points of a black floor, (n,)."""
    scene = join([FLOOR], source="floor").with_lights([luminaire])
    return rd.measure(rd.subdivide(scene, cells=1), rd.Sensors.of(points), rays=64 * 8 * len(points)).illuminance[:, 0]


AROUND = np.array([[2, 0, 0], [0, 2, 0], [-2, 0, 0], [0, -2, 0]])  # gamma = 45 of a lamp at 2 m, C = 0, 90, 180 and 270
FOUR = "600 600 0  600 100 0  600 300 0  600 200 0  600 600 0"  # 600, 100, 300 and 200 cd there


def test_intensities_are_not_squared(tmp_path):
    """three.js #34554: the loader of IES files multiplied each intensity by itself, so that beams became narrower."""
    lamp = rd.read_luminaire(luminaire_file(tmp_path, "600 300 0", multiplier=0.5), position=(0, 0, 2))
    exact = [300 / 4, 150 * np.cos(np.pi / 4) / 8]
    np.testing.assert_allclose(below(lamp, [[0, 0, 0], [2, 0, 0]]), exact, rtol=1e-4)


@pytest.mark.parametrize(("turn", "order"), [(0, [0, 1, 2, 3]), (90, [3, 0, 1, 2]), (180, [2, 3, 0, 1])])
def test_all_planes_count_and_turn_with_the_luminaire(tmp_path, turn, order):
    """three.js #34560: only the first plane of a file was used. LuxCore #248: a luminaire did not turn about its axis."""
    lamp = rd.read_luminaire(luminaire_file(tmp_path, FOUR, "0 90 180 270 360"), position=(0, 0, 2), rotate=turn)
    exact = np.array([600, 100, 300, 200])[order] * np.cos(np.pi / 4) / 8
    np.testing.assert_allclose(below(lamp, AROUND), exact, rtol=1e-4)


def test_one_negative_dimension_is_a_disc(tmp_path):
    """honeybee-legacy #601: 'neither rectangular nor circular, is not supported'."""
    lamp = rd.read_luminaire(luminaire_file(tmp_path, "600 300 0", size="-0.5 0 0"), position=(0, 0, 2), soft=True)
    assert (lamp.size.tolist(), lamp.disc) == ([0.5, 0.5, 0], True)


def shaded(height: float | None) -> np.ndarray:
    """Lux below a roof light of 2 x 2 m, half of which a shade covers at a height above it."""
    around = [((-9, -9), (18, 8)), ((-9, 1), (18, 8)), ((-9, -1), (8, 2)), ((1, -1), (8, 2))]
    roof = [quad((x, y, 2), (a, 0, 0), (0, b, 0)) for (x, y), (a, b) in around]
    parts = [pebble((9, 9, -0.5)), ("roof", 0.0, 0.0, [face[::-1] for face in roof])]
    if height is not None:
        parts.append(("shade", 0.0, 0.0, [quad((-1, -1, 2 + height), (0, 2, 0), (1, 0, 0))]))
    opening = quad((-1, -1, 2), (2, 0, 0), (0, 2, 0))
    scene = join(parts, source="roof light").with_lights(sky=rd.uniform_sky(1000), openings=[opening])
    sensors = rd.Sensors.of([[0, 0, 1], [0.5, 0.2, 1]])
    return rd.measure(rd.subdivide(scene, cells=1), sensors, rays=60_000).illuminance[:, 0]


def test_a_shade_in_the_plane_of_the_window_is_one_a_little_before_it():
    """EnergyPlus #4608: daylight fell by 23 % where a shade lay in the plane of its window, and not a millimetre from it."""
    free, there, before, behind = (shaded(height) for height in (None, 0.0, 1e-3, -1e-3))
    np.testing.assert_allclose(there, before, rtol=0.01)
    np.testing.assert_allclose(there, behind, rtol=0.01)
    assert (there < 0.8 * free).all()


def test_sensors_after_the_second_have_their_light():
    """EnergyPlus #6770: of several reference points, all but the first two had an illuminance of zero."""
    found = below(rd.point_light(position=(0, 0, 2), intensity=100), np.column_stack([np.arange(7) / 2, np.zeros((7, 2))]))
    np.testing.assert_allclose(found, 200 / (4 + (np.arange(7) / 2) ** 2) ** 1.5, rtol=1e-4)


def test_a_sun_in_the_zenith_has_a_sky():
    """Radiance #7: gensky keeps the sun three degrees from the zenith, since its formula has a tangent."""
    zenith = [float(rd.cie_sky("clear", 1e4, sun=(altitude, 180)).at([[0, 0, 1]])[0, 0]) for altitude in (89.0, 89.9, 90.0)]
    assert zenith[2] > zenith[1] > zenith[0]
    assert zenith[2] == pytest.approx(zenith[1], rel=0.01)


def test_weather_without_diffuse_light_is_refused_in_words():
    """honeybee-dynamo #74: a ZeroDivisionError for an hour with 629 W/m2 of direct and none of diffuse irradiance."""
    with pytest.raises(rd.SceneError, match="diffuse irradiance is 0"):
        rd.perez_sky(629, 0, sun=(6.3, 100))


def test_weather_without_direct_light_or_with_a_sun_that_has_set():
    """bifacial_radiance #41 and #318: gendaylit failed without direct irradiance, and made a sun below the horizon."""
    sky, suns = rd.perez_sky(0, 100, sun=(30, 100), photometric=False)
    assert (float(sky.horizontal[0]), suns) == (pytest.approx(100), ())
    with pytest.warns(rd.RadiosityWarning, match="7.0 degrees below the horizon"):
        sky, suns = rd.perez_sky(0, 12, sun=(-7, 100), photometric=False)
    assert (float(sky.horizontal[0]), suns) == (pytest.approx(12), ())


def weather(folder, rows, name="made.epw"):
    """A weather file of rows (year, month, day, hour, minute, diffuse); the global irradiance fits."""
    head = ["LOCATION,Made,-,-,-,1,52.5,13.4,1,40", *["COMMENTS"] * 6, "DATA PERIODS,1,1,Data,Sunday,1/ 1,12/31"]
    lines = [
        f"{y},{m},{d},{h},{minute},x,20,10,50,101325,0,0,300,9999,0,{diffuse},0,0,0,0,180,3,5,5,20,9,9,9,100,0.1,0,88,0.2,0,1"
        for y, m, d, h, minute, diffuse in rows
    ]
    path = folder / name
    path.write_text("\n".join([*head, *lines]) + "\n\n\n")
    return path


def diffuse_of(path, *hour) -> float:
    return float(rd.epw_sky(path, *hour, photometric=False)[0].horizontal[0])


def test_weather_of_one_day_and_of_leap_days(tmp_path):
    """ladybug-blender #31: files of less than 8760 rows, or with a 29 February, were refused. OpenStudio #3801: an error on that
    day. EnergyPlus #2680: blank lines at the end."""
    days = [(2020, 2, 28, h, 60, 100) for h in range(1, 25)] + [(2020, 2, 29, h, 60, 150) for h in range(1, 25)]
    assert diffuse_of(weather(tmp_path, days), 2, 29, 12) == pytest.approx(150)
    with pytest.raises(rd.SceneError, match="has no row for month 3, day 1, hour 12"):
        diffuse_of(weather(tmp_path, days), 3, 1, 12)


def test_a_day_of_two_years_is_told(tmp_path):
    """EnergyPlus #893: a file had two first days of November, of 1964 and 1953, and nothing said so."""
    rows = [(1964, 11, 1, 12, 60, 100), (1953, 11, 1, 12, 60, 150)]
    with pytest.warns(
        rd.RadiosityWarning, match="has 2 rows for month 11, day 1, hour 12, in lines '9', '10', of the years '1964', '1953'"
    ):
        assert diffuse_of(weather(tmp_path, rows), 11, 1, 12) == pytest.approx(100)


def test_several_rows_an_hour_are_refused(tmp_path):
    """eplusr #351 and EnergyPlus #6716: rows of parts of an hour were read as hours, and shifted by 50 minutes."""
    rows = [(2018, 6, 21, 12, minute, diffuse) for minute, diffuse in ((0, 100), (30, 150))]
    with pytest.raises(rd.SceneError, match="has 2 rows for month 6, day 21, hour 12, in lines '9', '10'; several rows an hour"):
        diffuse_of(weather(tmp_path, rows), 6, 21, 12)


def test_hours_from_0_to_23_are_refused(tmp_path):
    """EnergyPlus #6716: the hour of a row ends at its number; files that count from 0 would be an hour late."""
    rows = [(2018, 6, 21, hour, 0, 100) for hour in range(24)]
    with pytest.raises(rd.SceneError, match="line 9: hour is 0; hours of a weather file are 1 to 24"):
        diffuse_of(weather(tmp_path, rows), 6, 21, 12)


def test_observers_do_not_add_up():
    """EnergyPlus #11583: the glare of each reference point was added to that of those before it."""
    panel = quad((1, 1, 2.8), (0, 0.6, 0), (0.6, 0, 0))
    walls = [quad((0, 0, 0), (4, 0, 0), (0, 3, 0)), quad((4, 0, 0), (0, 0, 3), (0, 3, 0))[::-1]]
    room = join([("walls", 0.5, 0.0, walls), ("panel", 0.0, 9000.0, [panel])], source="room")
    solution = rd.solve(rd.subdivide(replace(room, photometric=True), cells=2), "gather", rays=40_000)
    one, two = [3.0, 1.3, 1.2], [3.5, 0.8, 1.2]
    both = rd.unified_glare_rating(solution, [one, two, one], [-1, 0, 0], rays=20_000).ugr
    alone = rd.unified_glare_rating(solution, [two], [-1, 0, 0], rays=20_000).ugr
    assert both[0] == pytest.approx(both[2], abs=0.3)
    assert both[1] == pytest.approx(alone[0], abs=0.3)
