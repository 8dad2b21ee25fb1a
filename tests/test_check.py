"""`check` finds what was broken on purpose, and finds nothing in sound scenes."""

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.diagnostics import leaks
from radiosity.diagnostics.check import check, check_file
from radiosity.scene import topology
from radiosity.scene.model import Back
from radiosity.scene.shapes import box, join, quad

SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]


def kinds(report, *severities):
    return {finding.kind for finding in report.findings if not severities or finding.severity in severities}


def message(report, kind):
    (found,) = [finding.message for finding in report.findings if finding.kind == kind]
    return found


def lamp_room(lamp, back=Back.ABSORBS, back_emission=0.0):
    """A closed room of 4 m with a lamp."""
    walls = [("walls", 0.5, 0.0, box((0, 0, 0), (4, 4, 4), inward=True))]
    scene = join([*walls, ("lamp", 0.0, 10.0, [lamp])], source="lamp room")
    is_lamp = scene.surface == 1
    emission = np.where(is_lamp, back_emission, 0.0)[:, None]
    return replace(scene, back=np.where(is_lamp, back, scene.back).astype(np.uint8), back_emission=emission)


def test_a_closed_cube_has_nothing_to_say(cube):
    report = check(cube)
    assert report.findings == ()
    assert not report.serious
    assert [s.name for s in report.surfaces] == list(cube.names)
    for surface in report.surfaces:
        assert (surface.faces, surface.sides) == (1, "one")
        assert surface.area == pytest.approx(1)
        assert surface.reflectance == pytest.approx((0.5,))
        assert surface.emission == surface.power == pytest.approx((1.0,))


@pytest.mark.parametrize("name", ["room", "labyrinth"])
def test_closed_scenes_do_not_leak(name):
    report = check_file(name)
    assert not kinds(report, "error", "warning")


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("face", [0, 1])
def test_lines_leave_from_the_side_that_emits(face, back):
    """Two sheets that radiate both ways, between two more: what the first generation meets tells the side it came from."""
    sheets = [
        [(-9 * w, -9 * w, z), (10 * w, -9 * w, z), (10 * w, 10 * w, z), (-9 * w, 10 * w, z)]
        for z, w in ((1.0, 1), (2.0, 1), (0.0, 99), (3.0, 99))
    ]
    scene = rd.Scene.from_arrays(np.concatenate(sheets), np.arange(16).reshape(4, 4), 0.0, 1.0, two_sided=True)
    power = np.zeros((2, 4))
    power[int(back), face] = 1.0
    fates = leaks.follow(scene, power, 500)
    assert (fates.face == face).all()
    met = {(0, False): 1, (0, True): 2, (1, False): 3, (1, True): 0}[face, back]
    assert (fates.hit == met).mean() > 0.8  # the rest passes by, or meets it at its rim


def test_power_and_area_count_both_sides():
    scene = rd.Scene.from_arrays(SQUARE, [(0, 1, 2, 3)], 0.2, 3.0, two_sided=True, back_reflectance=0.6, back_emission=5.0)
    (surface,) = check(scene).surfaces
    assert surface.area == pytest.approx(2)
    assert surface.power == pytest.approx((8.0,))
    assert surface.emission == pytest.approx((4.0,))
    assert surface.reflectance == pytest.approx((0.4,))
    assert surface.sides == "two"


def test_a_crack_is_found_and_placed(cube):
    gap = cube.vertices.copy()
    ceiling = cube.surface == cube.names.index("ceiling")
    gap[cube.faces[ceiling]] += [0, 0, 0.01]  # a slit of 1 cm all round, below the ceiling
    report = check(replace(cube, vertices=gap))
    text = message(report, "leaks")
    share = float(text.split(" %")[0])
    assert 0.1 < share < 3
    assert "leave the scene" in text
    assert "'z high'" not in text
    assert "4 of" not in message(report, "open edges")[:5]
    assert message(report, "open edges").startswith("8 of ")


def test_an_open_scene_says_where_it_is_open():
    text = message(check(rd.load_scene("cornell-box")), "open edges")
    assert "belong to one face only" in text
    leak = next(f.message for f in check(rd.load_scene("cornell-box")).findings if "leave the scene" in f.message)
    assert "out at the scene's lowest z 100 %" in leak


def test_tracing_is_repeatable(cube):
    opened = cube.take(np.arange(5))
    assert check(opened, seed=3).findings == check(opened, seed=3).findings
    assert check(opened, seed=3).findings != check(opened, seed=4).findings


def test_share_of_escaping_lines_is_the_form_factor():
    # from the bottom of a unit cube without its lid: F of two opposite squares at distance 1 is 0.199825 (Howell, C-11)
    scene = join(
        [
            ("floor", 0.0, 1.0, [quad((0, 0, 0), (1, 0, 0), (0, 1, 0))]),
            ("sides", 0.0, 0.0, box((0, 0, 0), (1, 1, 1), inward=True)[:4]),
        ],
        source="well",
    )
    power = np.zeros((2, scene.n_faces))
    power[0, 0] = 1
    fates = leaks.follow(scene, power, 40_000)
    assert len(fates.fate) == 40_000  # all sides are black: no line goes on
    # 5 standard deviations of a binomial share
    assert fates.escaped == pytest.approx(0.199825, abs=5 * np.sqrt(0.2 * 0.8 / 40_000))
    assert fates.lost == 0
    assert (fates.exit[fates.fate == leaks.ESCAPED] == 5).all()
    assert (fates.face == 0).all()


def test_backs_that_swallow_light_are_named(cube):
    wall = quad((0.5, 0.2, 0.2), (0, 0.6, 0), (0, 0, 0.6))
    scene = join([("shell", 0.5, 1.0, box((0, 0, 0), (1, 1, 1), inward=True)), ("screen", 0.5, 0.0, [wall])], source="s")
    report = check(scene)
    assert "hit absorbing backs (of 'screen' 100 %)" in message(report, "leaks")
    assert "leaks" in kinds(report, "warning")
    two_sided = replace(scene, back=np.where(scene.surface == 1, Back.RADIATES, Back.ABSORBS).astype(np.uint8))
    assert "leaks" not in kinds(check(two_sided))


@pytest.mark.parametrize("lamp", [False, True], ids=["walls shine", "a lamp within"])
def test_normals_all_turned_round(lamp):
    """Lines leave the scene, or land on the backs of the walls."""
    inside = [("lamp", 0.0, 10.0, [quad((0.4, 0.4, 0.3), (0.2, 0, 0), (0, 0.2, 0))])] if lamp else []
    scene = join([("walls", 0.5, 1.0 - lamp, box((0, 0, 0), (1, 1, 1))), *inside], source="inside out")
    report = check(scene)
    assert report.serious
    assert "are the normals turned round?" in message(report, "leaks")


@pytest.mark.parametrize("gap", [1e-3, 0.01, 2.0], ids=["ceiling lamp", "pendant", "mid-air"])
def test_a_flipped_light_is_found(gap):
    down = quad((1.5, 1.5, 4 - gap), (0, 1, 0), (1, 0, 0))
    assert "flipped light" not in kinds(check(lamp_room(down)))
    up = down[::-1].copy()
    flipped = check(lamp_room(up))
    if gap < 1:
        assert flipped.serious
        assert "'lamp' seems to face the wrong way" in message(flipped, "flipped light")
    else:  # up is as good as down in the middle of the room
        assert "flipped light" not in kinds(flipped)
    assert kinds(check(lamp_room(up, Back.RADIATES)), "error") == kinds(flipped, "error")
    assert "flipped light" not in kinds(check(lamp_room(up, Back.RADIATES, back_emission=10.0)))


def test_no_light(cube):
    report = check(replace(cube, emission=np.zeros_like(cube.emission), back_emission=np.zeros_like(cube.emission)))
    assert report.serious
    assert kinds(report) == {"no light"}


def test_reflectance_out_of_range(cube):
    reflectance = cube.reflectance.copy()
    reflectance[2] = 1.25
    report = check(replace(cube, reflectance=reflectance))
    assert report.serious
    assert "on 'west'" in message(report, "reflectance")


def test_a_surface_that_lost_its_faces():
    with pytest.warns(rd.RadiosityWarning, match=r"1 face without area .*'point light'; 1 of them should emit light"):
        scene = rd.Scene.from_arrays(
            [*SQUARE, (0, 0, 1)], [(0, 1, 2), (4, 4, 4)], 0.5, [1.0, 2.0], surface=[0, 1], names=["floor", "point light"]
        )
    report = check(scene)
    assert "'point light'" in message(report, "empty surface")
    assert [s.name for s in report.surfaces] == ["floor"]


@pytest.mark.parametrize(
    ("second", "two_sided", "severity"),
    [
        ([0, 1, 2, 3], False, "warning"),
        ([1, 2, 3, 0], False, "warning"),
        ([0, 3, 2, 1], False, "note"),
        ([0, 3, 2, 1], True, "warning"),
    ],
)
def test_faces_that_lie_on_each_other(second, two_sided, severity):
    vertices = np.array([*SQUARE, *SQUARE], float)
    vertices[4:] += 1e-8  # another copy of the corners, a hair away
    faces = [[0, 1, 2, 3], [4 + i for i in second]]
    scene = rd.Scene.from_arrays(vertices, faces, 0.5, 1.0, two_sided=two_sided, surface=[0, 1], names=["one", "two"])
    report = check(scene)
    assert kinds(report, severity) >= {"duplicates"}
    assert message(report, "duplicates").startswith("1 faces (first: face 1)")
    assert "'one', 'two'" in message(report, "duplicates")


def test_edges_of_triangles_and_parallelograms():
    vertices = [*SQUARE, (2, 0.5, 0)]
    scene = rd.Scene.from_arrays(vertices, [(0, 1, 2, 3), (1, 4, 2, -1)], 0.5, 1.0)
    edges = topology.open_edges(scene)
    assert edges.total == 6
    assert sorted(edges.face.tolist()) == [0, 0, 0, 1, 1]
    np.testing.assert_allclose(np.sort(edges.length), [1, 1, 1, np.hypot(1, 0.5), np.hypot(1, 0.5)])


def test_welding_joins_near_corners_wherever_they_lie(random):
    points = random.uniform(-5, 5, (500, 3))
    triangles = np.concatenate([points + random.uniform(-1e-7, 1e-7, (500, 3)) for _ in range(3)])
    far = points[::-1] * 1.01
    vertices = np.concatenate([triangles, far])
    scene = rd.Scene.from_arrays(vertices, [(0, 1500, 501, -1)], 0.5, 1.0)
    faces = np.column_stack([np.arange(500), np.arange(500) + 500, np.arange(500) + 1000, np.full(500, -1)])
    corners = topology.weld(replace(scene, faces=faces))
    assert (corners[:, :3] == corners[:, :1]).all()
    assert len(np.unique(corners[:, 0])) == 500
    assert (corners[:, 3] == -1).all()


def test_a_file_that_cannot_be_read_is_a_finding(tmp_path):
    report = check_file(tmp_path / "missing.obj")
    assert report.scene is None
    assert report.serious
    assert "missing.obj: no such file" in message(report, "file")


def test_what_the_reader_says_is_among_the_findings(tmp_path):
    (tmp_path / "white.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 1 1\n")
    report = check_file(tmp_path / "white.obj")
    texts = [finding.message for finding in report.findings if finding.kind == "file"]
    assert any("no material" in text for text in texts)
    assert any("without area" in text for text in texts)
    assert "no light" in kinds(report, "error")


def test_the_older_name_of_check_still_works():
    from radiosity.scene.check import check as older

    assert older is rd.check
