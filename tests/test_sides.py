"""Two-sided walls: tables, intervals and `check` tell the lit side of a room from the outside that no line reaches."""

import csv

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli.app import run
from radiosity.diagnostics.check import check
from radiosity.scene.dark_parts import dark_parts
from radiosity.scene.reached import Lit

WALLS = {
    "floor": (1, 2, 3, 4),
    "ceiling": (5, 8, 7, 6),
    "south": (1, 5, 6, 2),
    "north": (4, 3, 7, 8),
    "west": (1, 4, 8, 5),
    "east": (2, 6, 7, 3),
}
AREAS = {"floor": 20, "ceiling": 20, "south": 15, "north": 15, "west": 12, "east": 12}


def room_text(kind: str, *, outward=(), one=False) -> str:
    """A room of 5 x 4 x 3 m as OBJ: walls that look inward but for those named, as a surface each or as one."""
    corners = [(x, y, z) for z in (0, 3) for x, y in ((0, 0), (5, 0), (5, 4), (0, 4))]
    lines = ["mtllib room.mtl", *("v {} {} {}".format(*corner) for corner in corners)]
    lines += ["v 2 1.5 2.9", "v 2 2.5 2.9", "v 3 2.5 2.9", "v 3 1.5 2.9", "o room", "usemtl paint"]
    for name, wall in WALLS.items():
        lines += [] if one else [f"o {name}"]
        lines.append("f " + " ".join(str(i) for i in (wall[::-1] if name in outward else wall)))
    return "\n".join([*lines, "o lamp", "usemtl lamp", "f 9 10 11 12"]) + "\n"


@pytest.fixture
def room(tmp_path):
    """The patches of such a room; its lamp alone has one side."""
    (tmp_path / "room.mtl").write_text("newmtl paint\nKd 0.6 0.6 0.6\nnewmtl lamp\nKd 0 0 0\nKe 20 20 20\n")

    def made(extra="", cells=2, **options) -> rd.Patches:
        (tmp_path / "room.obj").write_text(room_text("obj", **options))
        text = 'geometry = "room.obj"\n[[surface]]\nname = "lamp"\nsides = 1\n'
        (tmp_path / "room.toml").write_text(text + extra)
        return rd.subdivide(rd.load_scene(tmp_path / "room.toml"), cells=cells)

    return made


ONE_SIDED = '[[surface]]\nname = "*/paint"\nsides = 1\n'


def rows_of(solution) -> dict[str, dict]:
    rows = solution.surface_table()
    assert len({(row["surface"], row["side"]) for row in rows}) == len(rows)
    return {row["surface"].removesuffix("/paint"): row for row in rows}


def test_a_two_sided_room_has_the_table_of_a_one_sided_one(room):
    """Of all lines none reaches the outside, so means, powers, areas and intervals are those of a room without one."""
    two, one = rd.solve(room(), "random-walk", rays=60_000), rd.solve(room(ONE_SIDED), "random-walk", rays=60_000)
    inside, usual = rows_of(two), rows_of(one)
    assert len(two.patches) == 2 * len(one.patches) - 4
    for name, area in AREAS.items():
        row, other = inside[name], usual[name]
        assert (row["side"], row["area"], row["dark"], row["patches"]) == ("front", area, area, 4)
        assert (other["side"], other["area"], other["dark"]) == ("front", area, 0)
        for key in ("irradiance", "radiosity", "net"):
            assert row[key] == pytest.approx(other[key], rel=0.05)  # other points, since patches have other numbers
        assert row["few"] == row["unvisited"] == 0
        assert row["interval"] < 0.05
    books = two.books[0]  # what the lamp sends is what all sides absorb, and its own back
    assert sum(row["absorbed"] for row in inside.values()) + books["lost"] == pytest.approx(20 * np.pi, rel=1e-3)
    assert "few " not in two.report()
    assert "their other sides (94 m²), which no line reached, are left out" in two.report()
    assert "other sides" not in one.report()
    low, high = two.surface_interval()
    middle = [inside[name]["irradiance"] for name in AREAS]
    assert ((low[:6, 0] < middle) & (middle < high[:6, 0])).all()
    mean = sum(inside[name]["received"] for name in inside) / 95
    assert two.scene_interval()[0][0] < mean < two.scene_interval()[1][0]


def test_walls_that_look_outward_show_their_backs(room):
    rows = rows_of(rd.solve(room(outward=("floor", "east")), "random-walk", rays=60_000))
    assert [rows[name]["side"] for name in AREAS] == ["back", "front", "front", "front", "front", "back"]
    assert rows["floor"]["irradiance"] == pytest.approx(
        rows_of(rd.solve(room(), "random-walk", rays=60_000))["floor"]["irradiance"], rel=0.05
    )


def test_a_surface_wound_both_ways_shows_the_lit_side_of_each_face(room):
    solution = rd.solve(room(outward=("floor", "east"), one=True), "random-walk", rays=60_000)
    rows = rows_of(solution)
    assert (rows["room"]["side"], rows["room"]["area"], rows["room"]["dark"]) == ("lit", 94, 94)
    mean = (
        sum(row["received"] for row in rows_of(rd.solve(room(), "random-walk", rays=60_000)).values() if row["surface"] != "lamp")
        / 94
    )
    assert rows["room"]["irradiance"] == pytest.approx(mean, rel=0.02)
    assert solution.sides.left_out.sum() == 24


def test_a_sheet_lit_from_both_sides_has_two_rows(room, tmp_path):
    """A table top under the lamp: its sides have their own means, areas and intervals, which a saved file keeps."""
    patches = room()
    scene = patches.scene
    sheet = [(1, 1, 0.8), (2, 1, 0.8), (2, 2, 0.8), (1, 2, 0.8)]
    both = rd.Scene.from_arrays(
        [*scene.vertices, *sheet],
        [*scene.faces, np.arange(4) + len(scene.vertices)],
        [*scene.reflectance[:, 0], 0.5],
        [*scene.emission[:, 0], 0],
        surface=[*scene.surface, 7],
        names=[*scene.names, "top"],
        back=[*scene.back, 1],
    )
    solution = rd.solve(rd.subdivide(both, cells=2), "random-walk", rays=100_000)
    top, under = (row for row in solution.surface_table() if row["surface"] == "top")
    assert (top["side"], under["side"]) == ("front", "back")
    assert top["area"] == under["area"] == 1
    assert top["dark"] == under["dark"] == 0
    assert top["irradiance"] > 2 * under["irradiance"] > 0
    assert 0 < top["interval"] < under["interval"] < 0.1
    power = solution.side_power[0, :, 14:, 0]  # of one square metre each
    assert power.mean(axis=0) == pytest.approx([top["irradiance"], under["irradiance"]])
    assert under["net error"] == pytest.approx(0.5 * power[:, 1].std(ddof=1) / 8**0.5)
    assert "top (front)" in solution.report()
    assert "top (back)" in solution.report()
    solution.save(tmp_path / "a.npz")
    again = rd.load_solution(tmp_path / "a.npz")
    assert str(again.surface_table()) == str(solution.surface_table())
    assert again.surface_interval()[0][7] < (top["irradiance"] + under["irradiance"]) / 2 < again.surface_interval()[1][7]


def with_sheet(room, cells, corners, faces, **options) -> rd.Patches:
    """A room of one surface that holds a sheet, too: all of it is the surface ``room/paint``."""
    scene = room(one=True, **options).scene
    paint = scene.names.index("room/paint")
    faces, n = np.array(faces) + len(scene.vertices), len(faces)
    every = rd.Scene.from_arrays(
        [*scene.vertices, *corners],
        [*scene.faces, *faces],
        [*scene.reflectance[:, 0], *[0.6] * n],
        [*scene.emission[:, 0], *[0] * n],
        surface=[*scene.surface, *[paint] * n],
        names=scene.names,
        back=[*scene.back, *[1] * n],
    )
    return rd.subdivide(every, cells=cells)


SHEET = [(1, 1, 1), (4, 1, 1), (4, 3, 1), (1, 3, 1)]  # its front looks up


@pytest.mark.parametrize("outward", [(), tuple(WALLS), ("floor", "east")])
@pytest.mark.parametrize("joined", [False, True])
def test_dark_parts_of_a_surface_that_is_lit_on_both_sides(room, outward, joined):
    """An STL of a whole room is one surface. A table top in it, or a wall that stands on its floor, does not bring the outside of
    the room into the table: what lines received is the same whichever way its walls are wound."""
    sheet = [(0, 0, 0), (5, 4, 0), (5, 4, 3), (0, 0, 3)] if joined else SHEET
    solution = rd.solve(with_sheet(room, 2, sheet, [(0, 1, 2, 3)], outward=outward), "random-walk", rays=60_000)
    front, back = (row for row in solution.surface_table() if row["surface"] == "room/paint")
    size = 3 * 41**0.5 if joined else 6
    turned = sum(AREAS[name] for name in outward)
    assert (front["side"], back["side"]) == ("front", "back")
    assert front["area"] == pytest.approx(94 - turned + size)
    assert back["area"] == pytest.approx(turned + size)
    assert front["dark"] == pytest.approx(turned)
    assert back["dark"] == pytest.approx(94 - turned)
    assert "their other sides (94 m²)" in solution.report()
    received = solution.irradiance[:, 0] * solution.patches.area
    on_paint = solution.patches.surface == solution.patches.scene.names.index("room/paint")
    assert front["received"] + back["received"] == pytest.approx(received[on_paint].sum())
    assert 0 < front["interval"] < 0.1
    assert 0 < back["interval"] < 0.1
    mean = received.sum() / solution.patches.area[~solution.sides.left_out].sum()
    assert solution.scene_interval()[0][0] < mean < solution.scene_interval()[1][0]


def test_dim_faces_that_few_lines_reach_are_not_dark(room):
    """Of a sheet of many faces close above the floor many lower faces have no line by chance, and keep their part in the mean."""
    k = 16
    corners = [(1 + 3 * i / k, 1 + 2 * j / k, 0.1) for i in range(k + 1) for j in range(k + 1)]
    first = [i * (k + 1) + j for i in range(k) for j in range(k)]
    scene = with_sheet(room, 1, corners, [(at, at + k + 1, at + k + 2, at + 1) for at in first]).scene
    sheet = np.isclose(scene.vertices[scene.faces[:, :3], 2], 0.1).all(axis=1)
    walls = (scene.back == 1) & ~sheet
    assert (sheet.sum(), walls.sum()) == (256, 6)
    reached = np.zeros((scene.n_faces, 2))
    reached[walls, 0], reached[sheet, 0] = 2000, 40
    reached[sheet, 1] = np.random.Generator(np.random.Philox(1)).poisson(2, 256)
    assert (reached[sheet, 1] == 0).sum() > 20
    dark = dark_parts(scene, reached, np.full(len(scene.names), Lit.BOTH))
    assert dark.any(axis=1).tolist() == walls.tolist()
    assert dark[walls].tolist() == [[False, True]] * 6


def test_a_surface_that_no_line_reached_has_one_row(room):
    """Where few lines reached one side, none on the other one says nothing: both have a row."""
    solution = rd.solve(room(), "random-walk", quanta=1, replicates=2)
    rows = solution.surface_table()
    unmet = [row for row in rows if row["side"] == "both"]
    assert unmet
    for row in unmet:
        assert row["area"] == 2 * AREAS[row["surface"].removesuffix("/paint")]
        assert (row["arrivals"], row["dark"], row["unvisited"]) == (0, 0, 8)
        assert row["net low"] < 0
    fronts, backs = ([row for row in rows if row["side"] == side and row["surface"] != "lamp"] for side in ("front", "back"))
    assert [row["surface"] for row in fronts] == [row["surface"] for row in backs]
    assert fronts
    for front, back in zip(fronts, backs, strict=True):
        assert 0 < front["arrivals"] < 30
        assert (back["arrivals"], back["dark"]) == (0, 0)
        assert front["area"] == back["area"]
        assert np.isnan(back["interval"])


def test_a_dark_side_that_emits_keeps_its_row(room):
    rows = rd.solve(room('[[surface]]\nname = "floor/paint"\nemission = 3\n'), "random-walk", rays=60_000).surface_table()
    floor = [row for row in rows if row["surface"] == "floor/paint"]
    assert [(row["side"], row["emitted"]) for row in floor] == [("front", pytest.approx(60)), ("back", pytest.approx(60))]
    assert floor[1]["net"] == pytest.approx(60)
    assert floor[1]["net high"] == pytest.approx(60)


def test_net_power_has_an_error_and_an_interval(room):
    solution = rd.solve(room(ONE_SIDED), "random-walk", rays=60_000)
    rows = rows_of(solution)
    absorbed = (solution.surface_power[0] - solution.surface_power[1])[:, :, 0]
    for i, name in enumerate([*AREAS, "lamp"]):
        row, values = rows[name], absorbed[:, i]
        assert row["net"] == pytest.approx(row["emitted"] - row["received"] + row["reflected"])
        assert row["net"] == pytest.approx(row["left"] - row["received"])
        error = values.std(ddof=1) / 8**0.5
        assert row["net error"] == pytest.approx(error)
        ends = row["net"] - 2.365 * error, row["net"] + 2.365 * error
        assert (row["net low"], row["net high"]) == pytest.approx(ends, rel=1e-3)
    assert rows["lamp"]["net"] > 0 > rows["floor"]["net"]  # a lamp gives, a wall gets


def test_net_power_covers_the_truth(room):
    """The intervals of 20 runs hold the value of a long one: 17 or fewer of 20 have a probability of 8 %, twice that is rare."""
    patches = room(ONE_SIDED, cells=1)
    truth = rows_of(rd.solve(patches, "random-walk", rays=4_000_000, seed=99))["floor"]["net"]
    held = [
        row["net low"] < truth < row["net high"]
        for row in (rows_of(rd.solve(patches, "random-walk", rays=5_000, seed=seed))["floor"] for seed in range(20))
    ]
    assert sum(held) >= 17


def test_tables_on_disk_and_the_methods_that_count_no_lines(room, tmp_path):
    with pytest.warns(rd.RadiosityWarning, match="out of balance"):
        solution = rd.solve(room(cells=1), "full-matrix", factors="polygons")
    solution.export(tmp_path / "a.csv")
    with (tmp_path / "a.surfaces.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [(row["surface"], row["side"], float(row["area [m²]"])) for row in rows[:2]] == [
        ("floor/paint", "front", 20),
        ("ceiling/paint", "front", 20),
    ]
    assert {"dark [m²]", "net [W]", "net error [W]", "net low [W]", "net high [W]"} <= set(rows[0])
    lined = rd.solve(room(cells=1), "random-walk", rays=60_000)
    lined.export(tmp_path / "b.csv")
    with (tmp_path / "b.csv").open(encoding="utf-8") as file:
        patches = list(csv.DictReader(file))
    assert [row["few arrivals"] for row in patches if row["side"] == "back"] == ["0"] * 6
    assert rows_of(lined)["floor"]["irradiance"] == pytest.approx(float(rows[0]["irradiance [W/m²]"]), rel=0.05)


def test_check_tells_of_walls_of_two_sides_and_how_to_make_them_one_sided(room, capsys, tmp_path):
    def told(**options):
        return [f.message for f in check(room(**options).scene).findings if f.kind == "two-sided faces"]

    (note,) = told()
    assert "'floor/paint', 'ceiling/paint'" in note
    assert "no line reaches their other side (49.7 % of all area that radiates)" in note
    assert "write sides = 1" in note
    front, back = told(outward=("floor",))
    assert "(39.2 %" in front
    assert "'floor/paint' are two-sided" in back
    assert "flip = true and sides = 1" in back
    assert "look inward in the modelling program" in told(outward=("floor",), one=True)[0]
    heated = '[[surface]]\nname = "*/paint"\nemission = 3\n'
    (heat,) = told(extra=heated)
    assert "emits 45 % of all power" in heat  # 282 W from 94 m² into the void, as much to the inside, and 63 W of the lamp
    leaks = [f.message for f in check(room(extra=heated).scene).findings if f.kind == "leaks"]
    assert not any("leave the scene" in text for text in leaks)  # what begins outside is no leak
    advised = '[[surface]]\nname = "floor/paint"\nflip = true\n' + ONE_SIDED
    assert not told(extra=advised, outward=("floor",))  # what it says helps
    solution = rd.solve(room(advised, outward=("floor",)), "random-walk", rays=60_000)
    assert solution.books[0]["lost"] < 0.02 * solution.books[0]["emitted"]  # on the lamp's back alone
    assert rows_of(solution)["floor"]["irradiance"] > 0
    assert run(["check", str(tmp_path / "room.toml")]) == 0
    assert "two-sided faces" not in capsys.readouterr().out


def test_flipped_faces_keep_their_corners_and_colours(tmp_path):
    """Triangles and quadrilaterals of a PLY with colours, flipped: normals turn round, and the reflectance of a place stays."""
    (tmp_path / "a.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nproperty float red\n"
        "property float green\nproperty float blue\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 .1 .1 .1\n1 0 0 .3 .3 .3\n1 1 0 .5 .5 .5\n0 1 0 .3 .3 .3\n.5 2 0 .9 .9 .9\n4 0 1 2 3\n3 3 2 4\n"
    )
    for flip in (False, True):
        (tmp_path / "a.toml").write_text(f'geometry = "a.ply"\n[[surface]]\nname = "*"\nsides = 1\nflip = {str(flip).lower()}\n')
        scene = rd.load_scene(tmp_path / "a.toml")
        assert scene.normal[:, 2].tolist() == [-1, -1] if flip else [1, 1]
        patches = rd.subdivide(scene, cells=2)
        at = {tuple(np.round(p, 3)): r for p, r in zip(patches.centroid, patches.reflectance[:, 0], strict=True)}
        assert at[0.25, 0.25, 0.0] == pytest.approx(0.2, abs=1e-6)
        assert at[0.75, 0.75, 0.0] == pytest.approx(0.4, abs=1e-6)
