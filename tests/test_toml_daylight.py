"""The [sky], [sun] and [[opening]] of .toml scenes: what they give, and what is refused by name."""

import re
import warnings

import numpy as np
import pytest
from test_skies import epw

import radiosity as rd
from radiosity.scene.lights.axes import place_of, sky_axes, towards
from radiosity.scene.lights.told import daylight

BOX = "o wall\nv 0 0 0\nv 4 0 0\nv 4 0 3\nv 0 0 3\nf 1 2 3 4\no window\nv 1 4 1\nv 2 4 1\nv 2 4 2\nv 1 4 2\nf 5 6 7 8\n"
FLAT = "o floor\nv 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nf 1 2 3 4\n"  # z is up, clearly


LYING = FLAT.replace("v 4 3 0", "v 4 0 3").replace("v 0 3 0", "v 0 0 3")  # y is up
SKY, SUN = '[sky]\ntype = "uniform"\nhorizontal = 1\n', "[sun]\nilluminance = 1\ndirection = [0, 0, 1]\n"


def read(folder, text: str, head: str = "", shape: str = FLAT) -> rd.Scene:
    (folder / "a.obj").write_text(shape)
    (folder / "a.toml").write_text(f'geometry = "a.obj"\n{head}\n[[surface]]\nname = "*"\nreflectance = 0.5\n{text}\n')
    return rd.load_scene(folder / "a.toml")


@pytest.mark.parametrize(
    ("text", "horizontal", "zenith"),
    [
        ('type = "uniform"\nhorizontal = 1000', 1000, 1000 / np.pi),
        ('type = "cie-overcast"\nhorizontal = 1000', 1000, 9000 / 7 / np.pi),
        ('type = "cie-clear"\nhorizontal = 1000\naltitude = 40\nazimuth = 180', 1000, None),
        ('type = "cie-intermediate"\nhorizontal = 1000\naltitude = 40\nazimuth = 180', 1000, None),
        ('type = "cie-general"\ncie_type = 3\nhorizontal = 1000', 1000, None),
    ],
)
def test_skies_of_types(tmp_path, text, horizontal, zenith):
    scene = read(tmp_path, f"[sky]\n{text}")
    sky = scene.lights.sky
    assert sky is not None
    assert scene.photometric
    assert sky.horizontal[0] == pytest.approx(horizontal)
    assert zenith is None or sky.at([0, 0, 1])[0] == pytest.approx(zenith)
    assert sky.at([0, 0, -1])[0] == 0
    if "clear" in text:
        solution = rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=100_000)
        assert solution.irradiance[:, 0].max() == pytest.approx(horizontal, rel=0.02)


def test_a_sky_and_a_sun_above_their_ground(tmp_path):
    text = '[sky]\ntype = "cie-clear"\nhorizontal = 8000\nground = 0.2\n[sun]\nilluminance = 50_000\naltitude = 30\nazimuth = 120'
    scene = read(tmp_path, text)
    (sun,), sky = scene.lights.suns, scene.lights.sky
    assert sky is not None
    assert sun.irradiance.tolist() == [50_000]
    assert sun.direction == pytest.approx(towards(sky_axes(), 30, 120))
    assert sky.at([0, 0, -1])[0] == pytest.approx(0.2 * (8000 + 25_000) / np.pi)
    at_sun = sky.at(sun.direction)[0]
    assert at_sun > 3 * sky.at(towards(sky.axes, 30, 300))[0]
    told = list(daylight(scene))
    where = "sun at 30.0 degrees, azimuth 120.0"
    assert told[0] == f"sky       CIE clear, {where}, 8000 lm/m² on the horizontal; ground 6600 lm/m²; up is (0, 0, 1)"
    assert told[1] == "sun       5e+04 lm/m² across its light, altitude 30.0, azimuth 120.0 degrees"


def test_perez_by_place_and_date_in_watts(tmp_path):
    place = "latitude = 52.5\nlongitude = 13.4\ntimezone = 1\nmonth = 6\nday = 21\nhour = 10.5"
    scene = read(tmp_path, f'[sky]\ntype = "perez"\ndirect = 600\ndiffuse = 150\n{place}', head="photometric = false")
    (sun,), sky = scene.lights.suns, scene.lights.sky
    assert sky is not None
    assert not scene.photometric
    assert (sky.horizontal[0], sun.irradiance[0]) == pytest.approx((150, 600))
    assert place_of(sky.axes, sun.direction) == pytest.approx(rd.sun_position(52.5, 13.4, 1, 6, 21, 10.5))
    lux = read(tmp_path, f'[sky]\ntype = "perez"\ndirect = 600\ndiffuse = 150\n{place}')
    assert lux.photometric
    assert lux.lights.sky is not None
    assert 100 < lux.lights.sky.horizontal[0] / 150 < 150


def test_an_hour_of_a_weather_file_beside_the_scene(tmp_path):
    epw(tmp_path / "berlin.epw", {(6, 21, 12): (673, 600, 150, 14.0)})
    text = '[sky]\ntype = "epw"\nfile = "berlin.epw"\nmonth = 6\nday = 21\nhour = 12\nup = "y"\nnorth = [1, 0, 0]'
    scene = read(tmp_path, text, shape=LYING)
    (sun,), sky = scene.lights.suns, scene.lights.sky
    assert sky is not None
    assert sun.direction @ np.array([0, 1, 0]) == pytest.approx(np.sin(np.radians(place_of(sky.axes, sun.direction)[0])))
    assert place_of(sky.axes, sun.direction) == pytest.approx(rd.sun_position(52.5, 13.4, 1, 6, 21, 11.5), abs=0.01)


def test_openings_of_surfaces_and_corners(tmp_path):
    corners = "[[opening]]\ncorners = [[0, 0, 0], [200, 0, 0], [100, 0, 100], [0, 0, 100]]"
    text = f'[sky]\ntype = "uniform"\nhorizontal = 1\nopenings = ["win*"]\nup = "z"\n{corners}'
    scene = read(tmp_path, text, head='unit = "cm"', shape=BOX)
    openings = scene.lights.openings
    assert openings is not None
    assert openings[0] == pytest.approx(np.array([[1, 4, 1], [2, 4, 1], [2, 4, 2], [1, 4, 2]]) / 100)
    assert openings[1:] == pytest.approx(
        np.array([[[0, 0, 0], [2, 0, 0], [1, 0, 1], [1, 0, 1]], [[0, 0, 0], [1, 0, 1], [0, 0, 1], [0, 0, 1]]])
    )
    assert list(daylight(scene))[-1] == "openings  3, 1.5 m²"


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("[sky]\nhorizontal = 1", "sky, type is missing; write one of uniform, cie-overcast"),
        ('[sky]\ntype = "foggy"', "'uniform', 'cie-overcast'"),
        ('[sky]\ntype = "uniform"', "a sky of type uniform needs horizontal"),
        ('[sky]\ntype = "uniform"\nhorizontal = 1\ndirect = 4', "a sky of type uniform has no use for direct"),
        ('[sky]\ntype = "uniform"\nhorizontal = -1', "sky, horizontal"),
        ('[sky]\ntype = "uniform"\nhorizontal = 1\nalbedo = 1', "sky, albedo: unknown key; known are"),
        ('[sky]\ntype = "cie-clear"\nhorizontal = 1', "depends on the sun"),
        ('[sky]\ntype = "cie-clear"\nhorizontal = 1\nlatitude = 4', "to place the sun give altitude and azimuth, or latitude"),
        ('[sky]\ntype = "perez"\ndirect = 1\ndiffuse = 1', "needs the sun's altitude and azimuth"),
        ('[sky]\ntype = "epw"\nfile = "a.epw"\nmonth = 1\nday = 1\nhour = 1.5', "hour is the number of an hour of the file"),
        ('[sky]\ntype = "epw"\nfile = "a.epw"\nmonth = 1\nday = 1\nhour = 1', "weather file 'a.epw' does not exist"),
        ('[[sky]]\ntype = "uniform"', "sky: write [sky] with one bracket"),
        (
            '[sky]\ntype = "uniform"\nhorizontal = 1\nopenings = ["door"]',
            "openings: no surface is called 'door'; there are 'floor'",
        ),
        ("[sun]\naltitude = 3\nazimuth = 3", "give irradiance (W/m²) or illuminance (lm/m²)"),
        ("[sun]\nilluminance = 3", "give its direction, or its altitude"),
        ("[sun]\nilluminance = 3\ndirection = [0, 0, 1]\naltitude = 2\nazimuth = 2", "exclude each other"),
        ('[sky]\ntype = "uniform"\nhorizontal = 1\n[sun]\nirradiance = 3\ndirection = [0, 0, 1]', "sun: irradiance is in W/m²"),
        (
            f'[sky]\ntype = "perez"\ndirect = 1\ndiffuse = 1\naltitude = 4\nazimuth = 4\n{SUN}',
            "perez has a sun of its own",
        ),
        (
            f'{SKY}up = "y"\n{SUN}up = "z"',
            "different up: y and z",
        ),
        ("[[opening]]\ncorners = [[0, 0, 0], [1, 0, 0], [1, 0, 1]]", "openings are for the light of a sky"),
        (SKY + "[[opening]]\ncorners = [[0,0,0],[1,0,0],[2,0,0]]", "lie on a line"),
        (SKY + "[[opening]]\ncorners = [[0,0,0],[1,0,0],[1,0,1],[0,1,1]]", "off the plane"),
        (SKY + "[[opening]]\ncorners = [[0,0,0],[1,0,0],[0,0,1],[1,0,1]]", "convex polygon"),
        (
            '[[surface]]\nname = "floor"\nemission = 5\n[sky]\ntype = "uniform"\nhorizontal = 1',
            "surface 'floor' is in W, and sky in lm",
        ),
    ],
)
def test_what_makes_no_sense_is_named(tmp_path, text, fault):
    with pytest.raises(rd.SceneError, match=re.escape(fault)):
        read(tmp_path, text)


def test_up_is_told_where_the_scene_seems_to_have_another_one(tmp_path):
    with pytest.warns(rd.RadiosityWarning, match="seems to have y upwards"):
        read(
            tmp_path,
            '[sky]\ntype = "uniform"\nhorizontal = 1',
            shape=FLAT.replace("v 4 3 0", "v 4 0 3").replace("v 0 3 0", "v 0 0 3"),
        )


def test_a_sun_alone_in_watts_is_a_scene_in_watts(tmp_path):
    scene = read(tmp_path, "[sun]\nirradiance = 900\ndirection = [0, 1, 1]")
    assert not scene.photometric
    assert scene.lights.suns[0].irradiance.tolist() == [900]
    assert list(daylight(scene)) == ["sun       900 W/m² across its light, towards (0, 0.7071, 0.7071)"]


def test_colours_keep_the_lux(tmp_path):
    """Blue light of a sky and yellow light of a sun: red, green and blue by the colour, the photopic mean as without it."""
    weights = np.array([0.2126, 0.7152, 0.0722])
    text = '[sky]\ntype = "uniform"\nhorizontal = 1000\ncolor = [1, 2, 4]\n[sun]\nilluminance = 500\naltitude = 30\nazimuth = 0\n'
    scene = read(tmp_path, text + "color = [2, 1, 0]")
    sky, (sun,) = scene.lights.sky, scene.lights.suns
    assert sky is not None
    assert (sky.horizontal @ weights, sun.irradiance @ weights) == pytest.approx((1000, 500))
    assert sky.horizontal / sky.horizontal[0] == pytest.approx([1, 2, 4])
    assert sun.irradiance / sun.irradiance[1] == pytest.approx([2, 1, 0])
    perez = '[sky]\ntype = "perez"\ndirect = 600\ndiffuse = 150\naltitude = 40\nazimuth = 180\nsun_color = [3, 2, 1]'
    found = read(tmp_path, perez).lights
    assert found.suns[0].irradiance / found.suns[0].irradiance[2] == pytest.approx([3, 2, 1])
    assert found.sky is not None
    assert np.ptp(found.sky.horizontal) == pytest.approx(0)
    sun = "[sun]\ndirection = [0, 0, 1]\nilluminance = "
    for text, words in (
        (sun + "[1, 2, 3]\ncolor = [1, 1, 1]", "has a colour already"),
        (sun + "1\ncolor = [0, 0, 0]", "and one above zero"),
        (SKY + "sun_color = [1, 1, 1]", "has no use for sun_color"),
    ):
        with pytest.raises(rd.SceneError, match=words):
            read(tmp_path, text)


@pytest.mark.parametrize("up", ["", '[sky]\ntype = "uniform"\nhorizontal = 1\nup = "y"'])
def test_files_with_other_axes_up_in_one_scene_are_told(tmp_path, up):
    """A .rad file, in which z is up, and a .glb, in which y is: nothing turns them. What [sky] says holds for sensors, too."""
    grey = "void plastic grey 0 0 5 0.5 0.5 0.5 0 0\n"
    (tmp_path / "floor.rad").write_text(grey + "grey polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n")
    triangle = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.5, 1.0)
    rd.solve(rd.subdivide(triangle, cells=1), "gather", rays=2000).export(tmp_path / "b.glb")
    text = 'geometry = ["floor.rad", "b.glb"]\n[[sensors]]\npoints = [[1, 1, 1]]\n'
    (tmp_path / "a.toml").write_text(text + up)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        scene = rd.load_scene(tmp_path / "a.toml")
    words = "in 'floor.rad' z is up, and in 'b.glb' y; no file is turned, and "
    assert any(words + ("z" if not up else "y") in str(one.message) for one in told) == (not up)
    assert scene.sensors[0].normals == ((0, 1, 0) if up else (0, 0, 1),)
