"""Luminaires in scenes: how they are turned, what they send in which unit, and the light that a solution finds."""

from dataclasses import replace

import numpy as np
import pytest
from luminaire_files import GAMMA, LAMBERTIAN, ies, ldt

import radiosity as rd
from radiosity.scene.lights.frames import frame
from radiosity.scene.shapes import box, join

FLOOR = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]


def floor(emission=0.0, reflectance: object = 0.0, photometric=False) -> rd.Scene:
    return rd.Scene.from_arrays(FLOOR, [[0, 1, 2, 3]], reflectance, emission, names=["floor"], photometric=photometric)


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "down.ies").write_text(ies(np.array(LAMBERTIAN) * 1000 / np.pi, size=(0.3, 1.2, 0)))
    (tmp_path / "globe.ldt").write_text(ldt(1000 / (4 * np.pi), range(0, 360, 90), symmetry=1))
    return tmp_path


@pytest.mark.parametrize(
    ("direction", "rotate", "along", "wanted"),
    [
        ((0, 0, -1), 0, None, [(1, 0, 0), (0, 1, 0), (0, 0, -1)]),
        ((0, 0, -5), 90, None, [(0, 1, 0), (-1, 0, 0), (0, 0, -1)]),
        ((0, 0, 1), 0, None, [(1, 0, 0), (0, -1, 0), (0, 0, 1)]),
        ((1, 0, 0), 0, None, [(0, 0, 1), (0, 1, 0), (1, 0, 0)]),
        ((0, 1, 0), 0, None, [(1, 0, 0), (0, 0, 1), (0, 1, 0)]),
        ((0, 0, -1), 0, (1, 1, 3), [(np.sqrt(0.5), np.sqrt(0.5), 0), (-np.sqrt(0.5), np.sqrt(0.5), 0), (0, 0, -1)]),
        ((0, -1, 0), 0, (1, 0, 0), [(1, 0, 0), (0, 0, -1), (0, -1, 0)]),
    ],
)
def test_how_a_luminaire_is_turned(direction, rotate, along, wanted):
    axes = frame(direction, rotate, along, "lamp")
    assert axes == pytest.approx(np.array(wanted, float), abs=1e-12)
    assert np.cross(axes[0], axes[2]) == pytest.approx(axes[1], abs=1e-12)


def test_tilting_a_luminaire_a_little_turns_it_a_little():
    for way in ((0.01, 0, -1), (0, 0.01, -1), (-0.01, -0.01, -1)):
        assert frame(way, 0, None, "lamp") == pytest.approx(frame((0, 0, -1), 0, None, "lamp"), abs=0.02)


def test_a_luminaire_of_a_file(files):
    lamp = rd.read_luminaire("down.ies", position=(1, 1, 2), aim=(1, 3, 2), maintenance=0.8, group="row 1", soft=True)
    assert (lamp.name, lamp.group, lamp.source, lamp.soft) == ("Globe", "row 1", "down.ies", True)
    assert lamp.power == pytest.approx([800], rel=1e-3)
    assert lamp.axes[2] == pytest.approx((0, 1, 0))
    assert lamp.size == pytest.approx((1.2, 0.3, 0))
    photometry = rd.load_photometry("globe.ldt")
    given = rd.read_luminaire(photometry, position=(0, 0, 1), lumens=500, color=(1, 0.5, 0.25), name="a")
    assert given.web is photometry.web
    assert given.power @ (0.2126, 0.7152, 0.0722) == pytest.approx(500)
    assert given.power / given.power[0] == pytest.approx((1, 0.5, 0.25))


def test_notes_of_a_file_are_warnings(files):
    (files / "two.ldt").write_text(ldt(80, range(0, 360, 90), symmetry=1, sets=((1, 1000), (1, 2000))))
    with pytest.warns(rd.RadiosityWarning, match="two.ldt: has 2 lamp sets"):
        rd.read_luminaire("two.ldt", position=(0, 0, 1))
    assert rd.read_luminaire("two.ldt", position=(0, 0, 1), lamp_set=2).power[0] == pytest.approx(80 * 4 * np.pi * 2, rel=1e-6)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"position": (1, 2)}, "position is (1, 2)"),
        ({"aim": (0, 0, 1)}, "is aimed at its own place"),
        ({"aim": (0, 0, 0), "direction": (1, 0, 0)}, "exclude each other"),
        ({"direction": (0, 0, 0)}, "is no direction"),
        ({"along": (0, 0, 2)}, "parallel to its direction"),
        ({"maintenance": 1.2}, "maintenance is 1.2"),
        ({"lumens": -5}, "sends -5"),
        ({"lumens": np.nan}, "sends nan"),
        ({"color": (0, 0, 0)}, "color is"),
        ({"rotate": np.inf}, "rotate is inf"),
    ],
)
def test_values_that_make_no_sense_are_named(files, values, says):
    with pytest.raises(rd.SceneError, match="luminaire 'Globe'") as error:
        rd.read_luminaire("down.ies", **({"position": (0, 0, 1)} | values))
    assert says in str(error.value)


def test_no_file_and_other_files():
    for name, says in (("none.ies", "no such file"), ("lamp.xml", "known are .ies, .ldt")):
        with pytest.raises(rd.SceneError, match=says):
            rd.read_luminaire(name, position=(0, 0, 1))


def test_soft_needs_a_size(files):
    with pytest.raises(rd.SceneError, match="no luminous size"):
        rd.read_luminaire("globe.ldt", position=(0, 0, 1), soft=True)


def test_spots_have_half_and_a_tenth_of_their_intensity_at_beam_and_field():
    for field in (None, 30.0):
        lamp = rd.point_light(position=(0, 0, 1), intensity=100, beam=20, field=field)
        web = lamp.web
        at_beam, at_field = np.interp([10, (field or 20 * np.sqrt(np.log2(10))) / 2], web.gamma, web.intensity[0])
        assert at_beam == pytest.approx(0.5, abs=1e-3)
        assert at_field == pytest.approx(0.1, abs=1e-3)
        assert lamp.power[0] == pytest.approx(100 * web.flux)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({}, "give one of lumens, watts and intensity"),
        ({"lumens": 1, "watts": 1}, "lumens, watts given"),
        ({"lumens": 1, "field": 20}, "no beam"),
        ({"lumens": 1, "beam": 20, "field": 10}, "must be wider"),
        ({"lumens": 1, "beam": 400}, "beam is 400"),
    ],
)
def test_point_lights_that_make_no_sense_are_named(values, says):
    with pytest.raises(rd.SceneError, match=says):
        rd.point_light(position=(0, 0, 1), **values)


def test_watts_and_lumens_in_one_scene_are_an_error_that_names_both():
    lamp, watts = (
        rd.point_light(position=(1, 1, 1), lumens=5, name="lamp"),
        rd.point_light(position=(1, 1, 1), watts=5, name="hot"),
    )
    with pytest.raises(rd.SceneError, match=r"surface 'floor' is in W, and luminaire 'lamp' in lm"):
        floor(emission=1).with_lights([lamp])
    with pytest.raises(rd.SceneError, match=r"luminaire 'lamp' is in lm, and luminaire 'hot' in W"):
        floor().with_lights([lamp, watts])
    with pytest.raises(rd.SceneError, match=r"surface 'floor' is in lm, and luminaire 'hot' in W"):
        floor(emission=1, photometric=True).with_lights([watts])
    assert floor().with_lights([lamp]).photometric
    assert floor(emission=1, photometric=True).with_lights([lamp]).unit == "lm/m²"
    assert not floor().with_lights([watts]).photometric
    assert floor(emission=1).with_lights([watts]).unit == "W/m²"
    assert not floor().with_lights([]).photometric


def test_bands_of_lights_become_those_of_the_scene():
    white, red = rd.point_light(position=(1, 1, 1), lumens=10), rd.point_light(position=(1, 1, 1), lumens=10, color=(1, 0, 0))
    colored = floor(reflectance=[[0.5, 0.4, 0.3]]).with_lights([white, red])
    assert colored.lights.luminaires[0].power.tolist() == [10, 10, 10]
    assert colored.lights.luminaires[1].power == pytest.approx([10 / 0.2126, 0, 0])
    widened = floor(reflectance=0.5).with_lights([white]).with_lights([red])
    assert widened.bands == ("red", "green", "blue")
    assert widened.reflectance.tolist() == [[0.5] * 3]
    assert [lamp.power.tolist() for lamp in widened.lights.luminaires] == [[10, 10, 10], pytest.approx([10 / 0.2126, 0, 0])]
    three = floor().with_lights([white]).with_lights([red])
    assert [lamp.name for lamp in three.lights.luminaires] == ["point", "point"]


def test_the_floor_below_a_point_light_by_the_inverse_square_and_cosine_law():
    """E = I cos / d^2, which is exact at the middle of small patches."""
    scene = floor().with_lights([rd.point_light(position=(0.7, 0.9, 1.5), lumens=4 * np.pi * 100)])
    solution = rd.solve(rd.subdivide(scene, cells=9), rays=200_000, replicates=4, seed=1)
    way = solution.patches.centroid - (0.7, 0.9, 1.5)
    wanted = 100 * 1.5 / (way**2).sum(axis=1) ** 1.5
    assert solution.irradiance[:, 0] == pytest.approx(wanted, rel=0.01)


@pytest.mark.parametrize("name", ["random-walk", "gather"])
def test_a_luminaire_of_a_file_lights_the_floor(files, name):
    """A diffuse disc of 1000 lm: E = 1000 / pi cos^2 / d^2."""
    scene = floor().with_lights([rd.read_luminaire("down.ies", position=(1, 1, 1.5))])
    solution = rd.solve(rd.subdivide(scene, cells=8), name, rays=200_000, replicates=4, seed=1)
    square = ((solution.patches.centroid - (1, 1, 1.5)) ** 2).sum(axis=1)
    wanted = 1000 / np.pi * 1.5**2 / square**2
    assert np.abs(solution.irradiance[:, 0] / wanted - 1).max() < 0.03
    assert solution.patches.scene.power_unit == "lm"


@pytest.mark.parametrize(("name", "bound"), [("random-walk", 0.1), ("gather", 0.02)])
def test_soft_shadows(name, bound):
    """A strip of light 0.8 m long over the edge of a screen halfway down: each of its points lights what it sees of the floor."""
    corners = [*FLOOR, [1, 0, 1], [2, 0, 1], [2, 2, 1], [1, 2, 1]]
    scene = rd.Scene.from_arrays(corners, [[0, 1, 2, 3], [4, 5, 6, 7]], 0.0, 0.0, surface=[0, 1], names=["floor", "screen"])
    lamp = replace(rd.point_light(position=(1, 1, 2), lumens=4 * np.pi * 100), size=np.array([0.8, 0.0, 0.0]))
    for soft in (False, True):
        patches = rd.subdivide(scene.with_lights([replace(lamp, soft=soft)]), cells=20)
        solution = rd.solve(patches, name, rays=400_000, replicates=4, seed=1)
        along = np.linspace(0.6, 1.4, 801) if soft else np.ones(1)
        for at in (0.55, 0.75, 1.25, 1.65):
            here = (patches.centroid[:, 2] == 0) & (np.abs(patches.centroid[:, 0] - at) < 0.01)
            way = patches.centroid[here][:, None] - np.stack([along, along * 0 + 1, along * 0 + 2], axis=1)
            seen = (at + along) / 2 < 1  # where the line meets the height of the screen
            wanted = (200 / np.linalg.norm(way, axis=2) ** 3 * seen).mean()
            assert solution.irradiance[here, 0].mean() == pytest.approx(wanted, rel=bound, abs=1e-9)


def test_lux_at_points_below_turned_and_asymmetric_luminaires(files, random):
    """The sum of I cos / d^2 of three that are aimed and rotated, at sensors: within 4 of their standard errors."""
    planes = tuple(range(0, 361, 30))
    rows = random.uniform(50, 300, (len(planes), 1)) * np.array(LAMBERTIAN)
    rows[-1] = rows[0]
    (files / "asymmetric.ies").write_text(ies(rows, horizontal=planes))
    places = ((-1, 0, 2, 0), (1, 0.5, 2, 30), (0, -1, 2, 200))
    lamps = [rd.read_luminaire("asymmetric.ies", position=(x, y, z), rotate=r, aim=(x + 0.5, y, 0)) for x, y, z, r in places]
    points = np.column_stack([random.uniform(-1.5, 1.5, (6, 2)), np.full(6, 0.5)])
    found = rd.measure(floor().with_lights(lamps), rd.Sensors.of(points), rays=60_000)
    wanted = np.zeros(6)
    for lamp in lamps:
        way = points - lamp.position
        distance = np.linalg.norm(way, axis=1)
        x, y, z = (way / distance[:, None] @ lamp.axes.T).T
        plane, gamma = np.degrees(np.arctan2(y, x)) % 360, np.degrees(np.arccos(z))
        table = [[np.interp(angle, lamp.web.gamma, row) for row in lamp.web.intensity] for angle in gamma]
        wanted += [np.interp(c, lamp.web.planes, row) * 1.5 for c, row in zip(plane, table, strict=True)] / distance**3
    assert (np.abs(found.illuminance[:, 0] - wanted) < 4 * found.standard_error[:, 0] + 1e-4 * wanted).all()
    assert found.standard_error[:, 0].max() < 0.01 * wanted.max()


def test_a_saved_solution_has_its_luminaires(files, tmp_path):
    lamps = [rd.read_luminaire("down.ies", position=(x, 1, 1.5), soft=True, group="a") for x in (0.5, 1.5)]
    solution = rd.solve(rd.subdivide(floor().with_lights(lamps), cells=2), rays=2000, seed=1)
    solution.save(tmp_path / "lit.npz")
    again = rd.load_solution(tmp_path / "lit.npz")
    assert again.patches.scene.hash == solution.patches.scene.hash
    assert [lamp.photometric for lamp in again.patches.scene.lights.luminaires] == [True, True]


def test_line_sets_leave_lights_out_and_say_so(cube):
    dark = replace(cube, emission=cube.emission * 0, photometric=True)
    lines = rd.trace_lines(
        rd.subdivide(dark.with_lights([rd.point_light(position=(0.5, 0.5, 0.5), lumens=9)]), cells=1), rays=5000
    )
    with pytest.warns(rd.RadiosityWarning, match="lights without area are left out .*'point'"):
        solution = lines.solve(emission={"floor": 2.0})
    assert solution.radiosity.sum() == pytest.approx(4)  # of one side of six, reflectance 1/2: twice what it emits
    assert not solution.patches.scene.lights


def test_the_hash_of_a_scene_does_not_depend_on_where_its_files_lie(files):
    one, other = (floor().with_lights([rd.read_luminaire(path, position=(1, 1, 1))]) for path in ("down.ies", files / "down.ies"))
    assert one.hash == other.hash
    dimmed = floor().with_lights([rd.read_luminaire("down.ies", position=(1, 1, 1), maintenance=0.9)])
    ball = floor().with_lights([rd.read_luminaire("globe.ldt", position=(1, 1, 1), lumens=one.lights.luminaires[0].power[0])])
    assert len({one.hash, dimmed.hash, ball.hash, floor().hash}) == 4


def test_choosing_faces_keeps_the_lights():
    lit = floor().with_lights([rd.point_light(position=(1, 1, 1), lumens=5)])
    assert lit.take(np.array([0])).lights is lit.lights


def test_every_angle_of_a_file_is_in_the_web(files):
    assert rd.load_photometry("down.ies").web.gamma.tolist() == list(GAMMA)


ROOM = """
v 0 0 0
v 4 0 0
v 4 4 0
v 0 4 0
f 1 2 3 4
"""


def scene_of(folder, text: str, **options) -> rd.Scene:
    (folder / "room.obj").write_text(ROOM)
    (folder / "room.toml").write_text('geometry = "room.obj"\n' + text)
    return rd.load_scene(folder / "room.toml", **options)


DOWN = '[[luminaire]]\nfile = "down.ies"\nposition = [1, 2, 3]\n'


@pytest.mark.filterwarnings("ignore:.*no material")
class TestToml:
    """Of a .toml scene."""

    def test_luminaires_of_files_and_types(self, files):
        text = DOWN + 'maintenance = 0.5\ngroup = "a"\n' + DOWN + "direction = [0, 1, 0]\nrotate = 90\nsoft = true\n"
        text += '[[luminaire]]\ntype = "spot"\nposition = [1, 1, 1]\nlumens = 300\nbeam = 20\naim = [1, 1, 0]\nname = "spot"\n'
        scene = scene_of(files, text)
        one, two, spot = scene.lights.luminaires
        assert [lamp.name for lamp in scene.lights.luminaires] == ["Globe", "Globe#2", "spot"]
        assert one.web is two.web
        assert (one.power[0], two.power[0], spot.power[0]) == pytest.approx((500, 1000, 300), rel=1e-3)
        assert one.position.tolist() == [1, 2, 3]
        assert two.axes == pytest.approx(np.array([[0, 0, 1], [-1, 0, 0], [0, 1, 0]]), abs=1e-12)
        assert (one.group, two.soft) == ("a", True)
        assert scene.unit == "lm/m²"

    def test_one_entry_for_several(self, files):
        rows = "positions = [[1, 1, 3], [2, 1, 3], [3, 1, 3]]\n"
        scene = scene_of(files, '[[luminaire]]\nfile = "down.ies"\nname = "row"\n' + rows)
        assert [lamp.name for lamp in scene.lights.luminaires] == ["row", "row#2", "row#3"]
        assert [lamp.position[0] for lamp in scene.lights.luminaires] == [1, 2, 3]
        assert len({id(lamp.web) for lamp in scene.lights.luminaires}) == 1

    def test_lengths_follow_the_unit(self, files):
        scene = scene_of(files, 'unit = "cm"\nscale = 2\n' + DOWN)
        assert scene.lights.luminaires[0].position == pytest.approx((0.02, 0.04, 0.06))
        assert scene.bounds[1, 0] == pytest.approx(0.08)

    @pytest.mark.parametrize(
        ("entry", "says"),
        [
            ("position = [1, 1, 1]", "luminaire 1: give file ="),
            ('file = "down.ies"', "luminaire 1: give position = [x, y, z]"),
            (DOWN.split("\n", 1)[1] + 'type = "point"', "luminaire 1: give file ="),
            ('type = "spot"\nposition = [0, 0, 0]\nlumens = 5', "needs beam"),
            ('type = "point"\nposition = [0, 0, 0]\nlumens = 5\nbeam = 20', "beam do not go with type point"),
            ('type = "point"\nposition = [0, 0, 0]', "luminaire 1: point light: no light given"),
            ('file = "down.ies"\nposition = [0, 0, 0]\npower = 5', "power do not go with a file"),
            ('file = "down.ies"\nposition = [0, 0, 0]\naim = [0, 0, 0]', "luminaire 1: luminaire 'Globe': is aimed at its own"),
            ('file = "down.ies"\nposition = [0, 0, 0]\nlumen = 5', "luminaire 1, lumen: unknown key; known are 'file'"),
            ('file = "none.ies"\nposition = [0, 0, 0]', "luminaire file 'none.ies' does not exist"),
            ('file = "../down.ies"\nposition = [0, 0, 0]', "lies outside the scene's folder"),
            ('file = "room.obj"\nposition = [0, 0, 0]', "known are .ies, .ldt"),
        ],
    )
    def test_faults_name_the_entry(self, files, entry, says):
        with pytest.raises(rd.SceneError, match=r"room\.toml") as error:
            scene_of(files, "[[luminaire]]\n" + entry)
        assert says in str(error.value)

    def test_watts_of_surfaces_and_lumens(self, files):
        lamp = '[[surface]]\nname = "*"\npower = 40\n'
        with pytest.raises(rd.SceneError, match="surface 'room' is in W, and luminaire 'Globe' in lm"):
            scene_of(files, lamp + DOWN)
        assert scene_of(files, "photometric = true\n" + lamp + DOWN).photometric
        with pytest.raises(rd.SceneError, match="photometric is false"):
            scene_of(files, "photometric = false\n" + DOWN)
        watts = '[[luminaire]]\ntype = "point"\nposition = [0, 0, 1]\npower = 5\n'
        assert not scene_of(files, lamp + watts).photometric

    def test_a_scene_with_y_upwards_wants_a_direction(self, files, monkeypatch):
        monkeypatch.setattr("test_luminaire_scenes.ROOM", ROOM.replace("v 4 4 0", "v 4 0 4").replace("v 0 4 0", "v 0 0 4"))
        with pytest.warns(rd.RadiosityWarning, match="seems to have y upwards"):
            scene_of(files, DOWN)
        scene_of(files, DOWN + "direction = [0, -1, 0]\n")

    def test_check_lists_them(self, files, capsys):
        from radiosity.cli.check import check

        lamp = DOWN.replace("[1, 2, 3]", "[3, 2, 1]") + "direction = [0, 0, 1]\n"
        scene_of(files, DOWN + 'group = "row"\n' + lamp)
        check(str(files / "room.toml"))
        text = capsys.readouterr().out
        assert "luminaires  2, 1999 lm in all" in text
        assert "Globe#2" in text
        assert "(1, 2, 3)" in text
        assert "most of the light of 'Globe#2' leaves the scene (100 %)" in text
        assert "no light" not in text

    def test_check_names_luminaires_behind_a_ceiling(self, files):
        sides = box((0, 0, 0), (2, 2, 2), inward=True)
        scene = join([("walls", 0.5, 0.0, sides)], source="box")
        lamps = [rd.read_luminaire("down.ies", position=(1, 1, z), name=f"at {z}") for z in (1.9, 2.0, 2.01)]
        lamps.append(rd.read_luminaire("down.ies", position=(1, 1, 0.02), name="at the floor"))
        finding, close = [one for one in rd.check(scene.with_lights(lamps)).findings if one.kind == "luminaires"]
        assert close.message.startswith("most of the light of 'at the floor' meets a surface within 5 cm")
        assert finding.message.startswith("most of the light of 'at 2.01' meets absorbing backs (100 %)")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"luminaires": ["lamp"]}, "one of the luminaires is a str; make it with read_luminaire or point_light"),
        ({"luminaires": rd.point_light(position=(0, 0, 1), lumens=1)}, "luminaires are a Luminaire; give a list"),
        ({"suns": rd.sun(1, altitude=30, azimuth=0)}, "suns are a Sun; give a list"),
        ({"suns": [rd.uniform_sky(1)]}, "one of the suns is a Sky; make it with sun"),
        ({"sky": "overcast"}, "sky is a str; make one with cie_sky"),
        ({"openings": 3}, "openings are a int"),
        ({"openings": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}, r"opening 1: has the shape \(3,\)"),
        ({"openings": [[[0, 0, np.nan], [1, 0, 0], [0, 1, 0]]]}, r"opening 1: \[0.0, 0.0, nan\] is no corner"),
        ({"openings": [[[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]]}, "opening 1: its corners lie on a line"),
        ({"openings": [[[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0]]]}, "opening 1: its fourth corner lies off the plane"),
        (
            {"luminaires": [replace(rd.point_light(position=(0, 0, 1), lumens=1), power=np.array([np.nan]))]},
            "its power cannot be",
        ),
    ],
)
def test_lights_that_make_no_sense_are_named(arguments, says):
    """They were another program's errors before, or a total power of nan."""
    with pytest.raises(rd.SceneError, match=says):
        rd.load_scene("room").with_lights(**arguments)


def test_openings_that_are_no_parallelogram_become_triangles():
    scene = _wall().with_lights(sky=rd.uniform_sky(1), openings=[[[0, 0, 1], [3, 0, 1], [2, 1, 1], [1, 1, 1]]])
    assert scene.lights.openings.shape == (2, 4, 3)


@pytest.mark.parametrize("key", ["web_0_planes", "web_0_gamma", "web_0_intensity", "sky_radiance", "openings"])
@pytest.mark.parametrize("damage", ["nan", "short", "missing"])
def test_damaged_lights_of_a_file_are_refused(tmp_path, key, damage):
    sky = rd.uniform_sky(1)
    scene = _wall().with_lights(
        [rd.point_light(position=(0, 0, 1), lumens=1)], sky=sky, openings=[[[0, 0, 1], [1, 0, 1], [0, 1, 1]]]
    )
    file = tmp_path / "lit.npz"
    rd.solve(rd.subdivide(scene, cells=1), "gather", quanta=10, replicates=1).save(file)
    assert len(rd.load_solution(file).patches.scene.lights.all) == 2
    with np.load(file) as arrays:
        kept = dict(arrays)
    value = kept.pop(f"lights_{key}")
    if damage != "missing":
        kept[f"lights_{key}"] = value[:-1] if damage == "short" else np.full_like(value, np.nan)
    np.savez(file, **kept)
    with pytest.raises(rd.RadiosityError, match="no solution of this program, or damaged"):
        rd.load_solution(file)


def _wall() -> rd.Scene:
    """A square that faces up, and one that faces it."""
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 2], [0, 1, 2], [1, 1, 2], [1, 0, 2]]
    return rd.Scene.from_arrays(corners, [[0, 1, 2, 3], [4, 5, 6, 7]], 0.5, 0.0)
