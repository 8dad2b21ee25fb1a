"""``radiosity measure``, and the [[sensors]] of .toml scenes."""

import csv
import json
import re

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli import main
from radiosity.cli.places import grid_of
from radiosity.scene.sensor_request import SensorRequest

PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 {z}
{x} 0 {z}
{x} {y} {z}
0 {y} {z}
4 {order}
"""
TOML = """
geometry = ["floor.ply", "lamp.ply"]
unit = "cm"
photometric = true

[[surface]]
name = "lamp"
reflectance = 0
emission = 1000

[[surface]]
name = "floor"
reflectance = 0.5
"""


@pytest.fixture
def folder(tmp_path):
    """A floor of 4 x 3 m under a lamp as large, 2 m above it; lengths are in cm."""
    for name, z, order in (("floor", 0, "0 1 2 3"), ("lamp", 200, "3 2 1 0")):
        (tmp_path / f"{name}.ply").write_text(PLY.format(x=400, y=300, z=z, order=order))
    (tmp_path / "room.toml").write_text(TOML)
    return tmp_path


def scene(folder, text: str) -> rd.Scene:
    (folder / "room.toml").write_text(TOML + text)
    return rd.load_scene(folder / "room.toml")


SENSORS = """
[[sensors]]
surface = "fl*r"
height = 80
spacing = 100
name = "work plane"

[[sensors]]
points = [[200, 150, 100], [100, 100, 0]]
direction = [1, 0, 0]

[[sensors]]
file = "desk.csv"
kind = "cylindrical"
"""


def test_sensors_of_a_file_follow_its_unit_and_are_kept(folder, tmp_path):
    (folder / "desk.csv").write_text("x,y,z\n100,100,120\n")
    loaded = scene(folder, SENSORS)
    assert loaded.hash == scene(folder, "").hash
    sensors = rd.Sensors.of_scene(loaded)
    assert sensors.names == ("work plane", "sensors 2", "desk")
    assert np.allclose(sensors.points[:12, 2], 0.8)
    assert sensors.points[12:].tolist() == [[2, 1.5, 1], [1, 1, 0], [1, 1, 1.2]]
    assert sensors.normals[12:].tolist() == [[1, 0, 0], [1, 0, 0], [0, 0, 1]]
    assert sensors.cylindrical.tolist() == [False] * 14 + [True]
    rd.solve(rd.subdivide(loaded, cells=1), "gather", rays=20_000).save(tmp_path / "room.npz")
    again = rd.load_solution(tmp_path / "room.npz")
    assert again.patches.scene.sensors == loaded.sensors
    found = rd.measure(again, rays=10_000)
    assert [row["name"] for row in found.table()] == ["work plane", "sensors 2", "desk"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[[sensors]]\nheight = 1", "sensors 1: give one of surface, points, file"),
        ('[[sensors]]\nsurface = "floor"\npoints = [[0, 0, 0]]', "give one of surface, points, file, not surface and points"),
        ('[[sensors]]\nsurface = "flor"', "sensors 1: no surface is called 'flor'; there are .*floor"),
        ("[[sensors]]\npoints = [[0, 0, 0]]\nspacing = 1", "spacing do not go with points"),
        ("[[sensors]]\npoints = [[0, 0, 0]]\nnormals = [[0, 0, 1], [0, 0, 1]]", "normals has 2 entries"),
        ("[[sensors]]\npoints = [[0, 0, 0]]\ndirection = [0, 0, 0]", "expected a direction"),
        ('[[sensors]]\nfile = "none.csv"', "none.csv' does not exist"),
        ('[[sensors]]\nsurface = "floor"\n[[sensors]]\nsurface = "floor"\nheight = 1', "sensors 2: an entry before it is called"),
        ('[sensors]\nsurface = "floor"', r"write \[\[sensors\]\] with two brackets"),
        ('[[sensors]]\nsurfaces = "floor"', "unknown key; known are .*surface"),
    ],
)
def test_sensors_that_make_no_sense(folder, text, words):
    with pytest.raises(rd.SceneError, match=words):
        scene(folder, text)


@pytest.mark.parametrize(
    "change",
    [{"name": 5}, {"surface": 3}, {"points": [[1, 2]]}, {"points": 1}, {"height": "z"}, {"direction": [1]}, {"evil": 1}],
    ids=str,
)
def test_damaged_requests_are_told_from_whole_ones(change):
    """Readers of files turn these into one error of a damaged file."""
    whole = SensorRequest("a", points=((1.0, 2.0, 3.0),), normals=((0.0, 0.0, 1.0),), direction=(0.0, 1.0, 0.0))
    assert SensorRequest.of(json.loads(json.dumps(whole.facts()))) == whole
    with pytest.raises((ValueError, TypeError)):
        SensorRequest.of(whole.facts() | change)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("floor", ("floor", 0.0, None)),
        ("surface:floor,0.8", ("floor", 0.8, None)),
        ("floor,80cm,500mm", ("floor", 0.8, 0.5)),
        ("hall, west,-0.1,0.5", ("hall, west", -0.1, 0.5)),
        ("a,1,2,3", ("a,1", 2.0, 3.0)),
    ],
)
def test_grids_in_words(text, wanted):
    assert grid_of(text) == pytest.approx(wanted)


def test_the_command_measures_a_scene_and_a_solution(folder, capsys):
    """On the floor the lamp's light is known: the factor of a point and a rectangle, plus nothing: the floor sees no other."""
    out = folder / "lux.csv"
    (folder / "points.csv").write_text("x,y,z\n2,1.5,0\n")
    options = ["--points", str(folder / "points.csv"), "--rays", "40k", "--cells", "1", "-o", str(out)]
    assert main(["measure", str(folder / "room.toml"), *options]) == 0
    x, y = 2 / 2, 1.5 / 2
    exact = 1000 * 2 / np.pi * sum(a / np.hypot(1, a) * np.arctan(b / np.hypot(1, a)) for a, b in ((x, y), (y, x)))
    row = next(csv.DictReader(out.read_text().splitlines()))
    assert float(row["illuminance_lx"]) == pytest.approx(exact, rel=0.01)
    told = capsys.readouterr().out
    assert "mean lx" in told
    assert "W/m" not in told
    assert (
        main(
            [
                "solve",
                str(folder / "room.toml"),
                "--cells",
                "1",
                "--method",
                "gather",
                "--rays",
                "40k",
                "-o",
                str(folder / "room.npz"),
            ]
        )
        == 0
    )
    picture = str(folder / "lux.png")
    grid = ["measure", str(folder / "room.npz"), "--grid", "floor,0,1", "--error", "2%", "-o", picture]
    assert main(grid) == 0
    assert main(["measure", str(folder / "room.npz"), "--points", options[1], "--error", "0.0001%"]) == 3


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], "asks for no sensors"),
        (["--grid", "roof"], "no surface is called 'roof'"),
        (["--margin", "1"], "--margin and --kind need sensors"),
        (["--grid", "floor", "--rays", "1k", "--error", "1%"], "one of --rays and --error"),
        (["--grid", ",1,2"], "write NAME,HEIGHT,SPACING"),
        (["--grid", "floor", "-o", "lux.txt"], "lux.txt"),
        (["--points", "none.csv"], "none.csv"),
        (["--grid", "floor", "--dim", "roof=1", "--rays", "20k", "--cells", "1"], "no group of lights is called 'roof'"),
        (["--grid", "floor", "--dim", "lamp"], "write NAME=VALUE"),
        (["--ugr", "1,2,3"], "write X,Y,Z,DX,DY,DZ"),
        (["--ugr", "1,1,1,1,0,0", "-o", "lux.csv"], "files need sensors"),
    ],
)
def test_what_the_command_refuses(folder, capsys, options, words):
    assert main(["measure", str(folder / "room.toml"), *options]) == 2
    assert words in capsys.readouterr().err


def test_the_command_rates_glare(folder, capsys):
    """The lamp covers the ceiling, so that it is far larger than the formula is made for."""
    assert main(["measure", str(folder / "room.toml"), "--ugr", "0.1,1.5,1.2,1,0,0", "--cells", "2", "--rays", "40k"]) == 0
    told = capsys.readouterr()
    assert re.search(r"UGR \d+\.\d ± .* most by lamp 100%", told.out)
    assert "'lamp' look above 0.1 sr" in told.err


def test_the_command_dims_lights(folder, capsys):
    out = folder / "lux.csv"
    options = ["--grid", "floor,0,2", "--cells", "1", "--rays", "40k", "-o", str(out)]
    means = []
    for dim in (["--dim", "lamp=1"], ["--dim", "lamp=0.25"]):
        assert main(["measure", str(folder / "room.toml"), *options, *dim]) == 0
        rows = list(csv.DictReader(out.read_text().splitlines()))
        means.append(np.mean([float(row["illuminance_lx"]) for row in rows]))
        assert all(row["illuminance_lx"] == row["illuminance_by_lamp_lx"] for row in rows)
    assert means[1] == pytest.approx(0.25 * means[0])
    assert "by group of lights, floor: lamp" in capsys.readouterr().out


def test_up_is_that_of_the_scene(tmp_path):
    """Points of a scene whose y is up look along y, and a floor of two sides that is drawn upside down counts from above."""
    corners = "v 0 0 0\nv 4 0 0\nv 4 0 3\nv 0 0 3\n"
    (tmp_path / "floor.obj").write_text(corners + "o floor\nf 1 2 3 4\n")
    text = 'geometry = "floor.obj"\n[[surface]]\nname = "floor"\nreflectance = 0.5\nsides = 2\nemission = 1\n'
    text += '[[sensors]]\nsurface = "floor"\nheight = 0.8\nspacing = 1\n[[sensors]]\npoints = [[1, 1, 1]]\n'
    (tmp_path / "a.toml").write_text(text)
    loaded = rd.load_scene(tmp_path / "a.toml")
    assert loaded.normal.round(6).tolist() == [[0, -1, 0]]
    sensors = rd.Sensors.of_scene(loaded)
    assert np.allclose(sensors.points[:-1, 1], 0.8)
    assert np.allclose(sensors.normals, [0, 1, 0])
