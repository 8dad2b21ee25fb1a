"""Grids of sensors: spacing, outline, margin, turned and downward floors, names, and tables that are read and written."""

import csv

import numpy as np
import pytest
from light_samples import bulb, lit

import radiosity as rd
from radiosity.scene.shapes import box, join, quad
from radiosity.sensors.grid import spacing_of


def floor(*corners, two_sided: bool = False, extra=()) -> rd.Scene:
    """A floor of quads, and a wall."""
    parts = [("floor", 0.2, 0.0, list(corners)), ("wall", 0.5, 1.0, [quad((0, 0, 0), (0, 0, 3), (3, 0, 0))]), *extra]
    return join(parts, source="hall", backs={"floor": 0.2} if two_sided else None)


def rectangle(length, width, z=0.0):
    return quad((0, 0, z), (length, 0, 0), (0, width, 0))


@pytest.mark.parametrize(
    ("longer", "shorter", "spacing"),
    [
        (1, 1, 0.2),
        (5, 4, 0.6160),
        (10, 6, 1.0),
        (25, 20, 1.8974),
        (100, 60, 5.0),
        (1e4, 9e3, 10.0),
        (10, 5, 0.6160),
        (9.9, 5, 0.9930),
    ],
)
def test_spacing_is_that_of_en_12464(longer, shorter, spacing):
    """p = 0.2 * 5^(log10 d), 10 m at most; d is the longer side, the shorter one from a ratio of 2 on."""
    assert spacing_of(longer, shorter) == pytest.approx(spacing, abs=1e-4)


def test_a_grid_lies_evenly_within_its_floor():
    scene = floor(rectangle(6, 4))
    grid = rd.Sensors.grid(scene, "floor", 0.8, spacing=1.0)
    wanted = {(x, y, 0.8) for x in np.arange(6) + 0.5 for y in np.arange(4) + 0.5}
    assert {tuple(point) for point in grid.points.round(9).tolist()} == wanted
    assert (grid.normals == [0, 0, 1]).all()
    assert np.allclose(grid.spacings, 1.0)
    fine = rd.Sensors.grid(scene, "floor", 0.8)  # d = 6: p = 0.6997, so 9 x 6 points
    assert len(fine) == 54
    assert (fine.spacings <= 0.6998).all()


def test_an_l_shaped_floor_is_followed():
    """And the margin is held to the inner corner, too."""
    scene = floor(rectangle(6, 2), quad((0, 2, 0), (2, 0, 0), (0, 4, 0)))
    grid = rd.Sensors.grid(scene, "floor", 0.0, spacing=0.5)
    x, y, _ = grid.points.T
    assert len(grid) == (6 * 2 + 2 * 4) * 4
    assert not ((x > 2) & (y > 2)).any()
    inner = rd.Sensors.grid(scene, "floor", 0.0, spacing=0.25, margin=0.5)
    x, y, _ = inner.points.T
    assert min(x.min(), y.min(), (6 - x).min(), (6 - y).min()) >= 0.5
    assert (2 - y[x > 2]).min() >= 0.5
    assert (2 - x[y > 2]).min() >= 0.5
    assert np.hypot(x - 2, y - 2).min() >= 0.5


@pytest.mark.parametrize("angle", [0, 17, 45, 83])
def test_grids_turn_with_their_floor(angle):
    a = np.radians(angle)
    turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    first = rd.Sensors.grid(floor(rectangle(6, 4)), "floor", 0.8, spacing=1.0)
    other = rd.Sensors.grid(floor(rectangle(6, 4) @ turn.T + [5, 6, 7]), "floor", 0.8, spacing=1.0)
    back = (other.points - [5, 6, 7]) @ turn
    distance = np.linalg.norm(back[:, None] - first.points, axis=2)
    assert len(first) == len(other) == 24
    assert distance.min(axis=1).max() < 1e-9
    assert distance.min(axis=0).max() < 1e-9


def test_floors_drawn_with_normals_down_count_from_above():
    down = rectangle(6, 4)[::-1]
    grid = rd.Sensors.grid(floor(down, two_sided=True), "floor", 0.8, spacing=1.0)
    assert np.allclose(grid.points[:, 2], 0.8)
    assert (grid.normals == [0, 0, 1]).all()
    below = rd.Sensors.grid(floor(down), "floor", 0.8, spacing=1.0)  # one-sided: its front looks down
    assert np.allclose(below.points[:, 2], -0.8)
    assert (below.normals == [0, 0, -1]).all()


@pytest.mark.parametrize("two_sided", [False, True])
def test_the_top_of_a_slab_is_taken(two_sided):
    """A floor that is a box: not its sides, nor what is below."""
    grid = rd.Sensors.grid(floor(*box((0, 0, -0.3), (6, 4, 0)), two_sided=two_sided), "floor", 0.8, spacing=1.0)
    assert len(grid) == 24
    assert np.allclose(grid.points[:, 2], 0.8)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"surface": "flor"}, "no surface is called 'flor'; there are .*floor"),
        ({"surface": "floor", "height": np.nan}, "height is nan m"),
        ({"surface": "floor", "spacing": 0.0}, "spacing is 0 m"),
        ({"surface": "floor", "spacing": 1e-4}, "the most are 1,000,000"),
        ({"surface": "floor", "margin": 2.0}, "a margin of 2 m leaves nothing"),
        ({"surface": "floor", "kind": "round"}, "kind 'round' does not exist"),
    ],
)
def test_grids_that_make_no_sense(options, words):
    with pytest.raises(rd.SceneError, match=words):
        rd.Sensors.grid(floor(rectangle(6, 4)), **options)


@pytest.mark.parametrize(
    ("text", "names", "points"),
    [
        ("x,y,z\n1,2,3\n4,5,6\n", ["desk"], [[1, 2, 3], [4, 5, 6]]),
        ("1 2 3 0 0 -1\n", ["desk"], [[1, 2, 3]]),
        ("# points\n1;2;3\n\n", ["desk"], [[1, 2, 3]]),
        ("name,z,y,x\na,3,2,1\nb,6,5,4\na,3,2,0\n", ["a", "b"], [[1, 2, 3], [0, 2, 3], [4, 5, 6]]),
    ],
)
def test_tables_of_sensors(tmp_path, text, names, points):
    (tmp_path / "desk.csv").write_text(text)
    found = rd.Sensors.from_csv(tmp_path / "desk.csv")
    assert list(found.names) == names
    assert found.points.tolist() == points
    assert found.normals[0].tolist() == ([0, 0, -1] if "-1" in text else [0, 0, 1])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x,y\n1,2\n", "has no column z"),
        ("x,y,z\n1,2\n", "line 2: has 2 values"),
        ("x,y,z\n1,2,up\n", "line 2: z is 'up'"),
        ("x,y,z\n1,2,nan\n", r"sensor 0: \[1.0, 2.0, nan\]"),
        ("x,y,z,nx,ny,nz\n1,2,3,0,0,0\n", "its normal has no direction"),
        ("x,y,z,nx,ny\n1,2,3,0,0\n", "has the columns nx, ny, and not nz"),
        ("1,2,3,4\n", "has 4 values"),
        ("x,y,z\n", "no sensors"),
        ("", "has no sensors"),
    ],
)
def test_tables_that_make_no_sense(tmp_path, text, words):
    (tmp_path / "desk.csv").write_text(text)
    with pytest.raises(rd.SceneError, match=words):
        rd.Sensors.from_csv(tmp_path / "desk.csv")


def test_columns_that_are_left_out_are_told(tmp_path):
    (tmp_path / "desk.csv").write_text("x,y,z,colour,lux\n1,2,3,red,500\n")
    with pytest.warns(rd.RadiosityWarning, match="colour.*lux.* are not read"):
        assert rd.Sensors.from_csv(tmp_path / "desk.csv").points.tolist() == [[1, 2, 3]]


def test_results_are_written_and_say_lux(tmp_path):
    """A table of all sensors that can be read again as sensors, and isolines of grids."""
    scene = lit(("floor", 0.0, 0.0, [rectangle(3, 2)]), luminaires=(bulb((1, 1, 2)),))
    sensors = rd.Sensors.grid(scene, "floor", 0.0, spacing=0.5) + rd.Sensors.of([[1, 1, 1]], name="desk", kind="cylindrical")
    solution = rd.solve(rd.subdivide(scene, cells=1), method="gather", rays=20_000, replicates=2)
    found = rd.measure(solution, sensors, rays=20_000)
    found.save(tmp_path / "lux.csv")
    found.save(tmp_path / "lux.png")
    rows = list(csv.DictReader((tmp_path / "lux.csv").read_text().splitlines()))
    assert len(rows) == 25
    assert rows[-1]["kind"] == "cylindrical"
    assert rows[-1]["set"] == "desk"
    np.testing.assert_allclose([float(row["illuminance_lx"]) for row in rows], found.illuminance[:, 0], rtol=1e-7)
    assert (tmp_path / "lux.png").read_bytes()[:4] == b"\x89PNG"
    assert "lx" in found.report()
    assert "W/m" not in found.report()
    with pytest.raises(rd.OutputError, match=r"\.txt"):
        found.save(tmp_path / "lux.txt")
