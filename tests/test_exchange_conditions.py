"""Conditions of surfaces: from arguments and .toml files; what is missing, doubled or out of range is refused by name."""

import warnings

import numpy as np
import pytest
from test_exchange import big_box, cubes, scene_of

import radiosity as rd
from radiosity.exchange.conditions import Conditions
from radiosity.exchange.planck import SIGMA
from radiosity.scene.shapes import box, quad

SHEET = [quad((0.3, 0.3, 0.5), (0.4, 0, 0), (0, 0.4, 0))]
FEW = {"rays": 2_000, "replicates": 2}


@pytest.fixture(scope="module")
def patches():
    return big_box()[0]


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"temperature": {"z low": 300}}, r"no temperature, flux or adiabatic is given for 'x low', .*'z high'"),
        ({"temperature": {"zz": 300}}, r"no surface is called 'zz'; there are 6"),
        ({"temperature": {"*": 300, "x low": 1}, "flux": {"x low": 3}}, "surface 'x low' has both temperature and flux"),
        ({"temperature": {"? *": 300}, "adiabatic": ["x*"]}, "surface 'x low' has both temperature and adiabatic"),
        ({"temperature": {"x*": 1, "*low": 2}}, "temperature of surface 'x low' is given by two patterns, as 1 and 2"),
        ({"temperature": {"*": -1}}, "temperature of surface 'x low' is -1; it must be in K"),
        ({"temperature": {"*": float("nan")}}, "temperature of surface 'x low' is nan"),
        ({"temperature": {"*": 1e7}}, "is 10000000.0; it must be in K, from 0 to 1e\\+06"),
        ({"temperature": {"*": "hot"}}, "temperature of surface 'x low' is 'hot'"),
        ({"temperature": {"*": True}}, "temperature of surface 'x low' is True"),
        ({"temperature": 300}, "temperature is 300; give values by names"),
        ({"temperature": {"*": 300}, "flux": {"x low": np.inf}}, "flux of surface 'x low' is inf; it must be in W"),
        ({"temperature": {"*": 300}, "flux": {"x*": 3}}, "flux of 'x\\*' is W of one whole surface; give 'x low', 'x high'"),
        ({"temperature": {"*": 300}, "adiabatic": "x low"}, "adiabatic is 'x low'; give a list"),
        ({"temperature": {"*": 300}, "surroundings": -1}, "temperature of the surroundings is -1"),
        ({"temperature": {"*": 300}, "emissivity": 0}, "emissivity of surface 'x low' is 0; it must be above 0, and 1 at most"),
        ({"temperature": {"*": 300}, "emissivity": {"*": 1.01}}, "emissivity of surface 'x low' is 1.01"),
        ({"temperature": {"*": 300}, "emissivity": [0.1, 0.2]}, "give one number, or one for each of 1 bands"),
        ({"temperature": {"*": 300}, "wavelengths": [3, 3]}, "wavelengths are \\[3, 3\\]; give the edges"),
        ({"temperature": {"*": 300}, "wavelengths": range(1, 200)}, "wavelengths are 199 edges between bands; 100 are the most"),
        ({"temperature": {"*": 300}, "wavelengths": [3], "emissivity": {"x*": 0.1}}, "no emissivity is given for 'y low'"),
        ({"temperature": {"*": 300}, "emissivity": {"*": {"top": 0.1}}}, "emissivity of 'x low' has a side 'top'"),
        ({"temperature": {"*": 300}, "emissivity": {"*": {"back": 0.1}}}, "emissivity of 'x low': its back does not radiate"),
        ({"temperature": {"*": {"front": 300, "back": 310}}}, "both sides of a sheet have one; make the sides two surfaces"),
        ({"adiabatic": ["*"]}, "no surface has a temperature, and there are no surroundings"),
        ({"adiabatic": ["*"], "surroundings": 300}, "the temperature of 'x low', .* is not determined"),
        (
            {"temperature": {"*": 300}, "flux": {"x low": -1e5}},
            "surface 'x low' would be below 0 K somewhere: a flux of -100000 W",
        ),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(patches, given, text):
    with pytest.raises((rd.SceneError, rd.MethodError), match=text):
        rd.radiative_exchange(patches, **({"emissivity": 0.5} | given), **FEW)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"error": 0.01, "error_of": "net:q"}, "no surface is called 'q'"),
        (
            {"error": 0.01, "error_of": "temperature:x low"},
            "the temperature of 'x low' is given, and has no error; take net:NAME",
        ),
        ({"error": 0.01, "error_of": "net:z high"}, "the net heat of 'z high' is given"),
        ({"error": 0.01, "error_of": "x low"}, "error_of is 'x low'; write net:NAME or temperature:NAME"),
        ({"error": 1.5}, "error is 1.5; it must be above 0 and below 1"),
        ({"error_of": "net:x low"}, "give the error, too"),
        ({"error": 0.01, "replicates": 1}, "2 replicates or more"),
        ({"error": 0.01, "rays": float("nan")}, "rays is nan; it must be a positive number"),
        ({"error": 0.01, "rays": "5"}, "rays is '5'; it must be a positive number"),
    ],
)
def test_targets_that_make_no_sense_are_refused(patches, given, text):
    with pytest.raises(rd.MethodError, match=text):
        rd.radiative_exchange(patches, {"*": 300}, adiabatic=["z high"], emissivity=0.5, **given)


def test_names_go_before_patterns_and_arguments_before_the_scene(patches):
    found = Conditions.of(
        patches, temperature={"x low": 310, "*": 300}, adiabatic=["z h*"], emissivity={"*": 0.5, "y l*": 0.8, "y low": 0.9}
    )
    assert found.temperature.tolist()[:5] == [310, 300, 300, 300, 300]
    assert np.isnan(found.temperature[5])
    assert found.flux[5] == 0
    insulated = Conditions.of(patches, temperature={"x low": 310}, adiabatic=["*"], emissivity=0.5)
    assert np.isnan(insulated.temperature).tolist() == [False, True, True, True, True, True]
    assert found.emissivity[0].tolist() == [0.5, 0.5, 0.9, 0.5, 0.5, 0.5]


def test_emissivities_of_two_patterns_may_be_arrays(patches):
    given = {"x*": np.array([0.2, 0.8]), "*low": [0.2, 0.8], "*": 0.5}
    found = Conditions.of(patches, temperature={"*": 300}, emissivity=given, wavelengths=[3])
    assert found.emissivity[:, 0].tolist() == [0.2, 0.8]
    with pytest.raises(rd.SceneError, match="emissivity of surface 'x low' is given by two patterns"):
        Conditions.of(patches, temperature={"*": 300}, emissivity=given | {"*low": np.array([0.2, 0.7])}, wavelengths=[3])


def test_a_copy_of_a_face_is_told_without_any_light(patches):
    scene = patches.scene
    faces, surface = (np.concatenate([array, array[:1]]) for array in (scene.faces, scene.surface))
    back = np.append(scene.back, scene.back[0])
    twice = rd.Scene.from_arrays(scene.vertices, faces, 0.5, 0.0, surface=surface, names=scene.names, back=back)
    with pytest.warns(rd.RadiosityWarning, match="lie on another face and radiate to the same side.*'x low'"):
        rd.radiative_exchange(rd.subdivide(twice, cells=1), {"*": 300}, emissivity=0.5, **FEW)
    with pytest.warns(rd.RadiosityWarning, match="lie on another face and radiate to the same side.*'x low'"):
        rd.view_factors(twice, rays=2_000, replicates=2, method="polygons")


def test_a_reflectance_of_the_file_is_taken_and_told(patches):
    with pytest.warns(rd.RadiosityWarning, match=r"no emissivity is given for 'x low', .*1 - reflectance is taken"):
        found = Conditions.of(patches, temperature={"*": 300})
    assert (found.emissivity == 0.5).all()
    coloured = rd.Scene.from_arrays(patches.scene.vertices, patches.scene.faces, [[0.1, 0.2, 0.3]], 0.0)
    with pytest.raises(rd.SceneError, match="colours of visible light do not tell"):
        Conditions.of(rd.subdivide(coloured, cells=1), temperature={"*": 300})


def test_a_name_without_faces_takes_no_part(patches):
    scene = patches.scene
    more = rd.Scene.from_arrays(
        scene.vertices, scene.faces, 0.5, 0.0, surface=scene.surface, names=[*scene.names, "nothing"], back=scene.back
    )
    heat = rd.radiative_exchange(rd.subdivide(more, cells=1), {"z*": 300, "x*": 400, "y*": 300}, emissivity=0.5, **FEW)
    assert heat.conditions[6] == "none"
    assert len(heat.table()) == 6
    assert abs(heat.net.sum()) < 1e-9 * heat.net[0]


def obj(path, **boxes):
    """An .obj file of boxes, (corners, inward) by name."""
    lines, n = [], 0
    for name, quads in boxes.items():
        lines.append(f"o {name}")
        for corners in quads:
            lines += [f"v {x} {y} {z}" for x, y, z in corners]
            lines.append(f"f {n + 1} {n + 2} {n + 3} {n + 4}")
            n += 4
    path.write_text("\n".join(lines) + "\n")


TOML = """
geometry = "oven.obj"
{more}
[[surface]]
name = "*"
sides = 1
temperature = 290
emissivity = 0.8
[[surface]]
name = "walls*"
temperature = 300
[[surface]]
name = "load*"
{load}
"""


def oven(tmp_path, load, more=""):
    obj(
        tmp_path / "oven.obj",
        walls=box((0, 0, 0), (3, 3, 3), inward=True),
        load=box((1, 1, 1), (2, 2, 2)),
    )
    (tmp_path / "oven.toml").write_text(TOML.format(load=load, more=more))
    return tmp_path / "oven.toml"


def test_a_toml_scene_holds_conditions(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # an emissivity is a reflectance, too
        scene = rd.load_scene(oven(tmp_path, "flux = 500\nemissivity = 0.4\nisothermal = true"))
    assert scene.reflectance[scene.surface == 0] == pytest.approx(0.2)
    heat = rd.radiative_exchange(rd.subdivide(scene, cells=1), rays=20_000)
    assert heat.conditions == ("temperature", "flux")
    assert heat.net.tolist() == pytest.approx([-500, 500], rel=1e-9)
    assert heat.emissivity[:, 0].tolist() == pytest.approx([0.8, 0.4])
    hotter = rd.radiative_exchange(rd.subdivide(scene, cells=1), {"load*": 700}, rays=20_000)
    assert hotter.conditions == ("temperature", "temperature")
    assert hotter.net[1] > 1e4
    lines = rd.trace_lines(rd.subdivide(scene, cells=1), rays=20_000)
    assert rd.radiative_exchange(lines).conditions == heat.conditions


@pytest.mark.parametrize(
    ("load", "more", "text"),
    [
        ("temperature = 300\nflux = 3", "", "temperature and flux exclude each other"),
        ("flux = 3\nadiabatic = true", "", "flux and adiabatic exclude each other"),
        ("temperature = -3", "", "temperature"),
        ("emissivity = 0", "", "emissivity"),
        ("emissivity = [0.1, 0.2, 0.3]", "wavelengths = [3]", "emissivity has 3 numbers; .* makes 2 bands"),
        ("adiabatic = true", "wavelengths = [8, 3]", "ascending"),
        ("adiabatic = true", "surroundings = -4", "surroundings"),
        ("adiabatic = true", f"wavelengths = {list(range(1, 200))}", "wavelengths.*at most 100"),
        ('adiabatic = true\n[[surface]]\nname = "*"\nflux = 3', "", "flux is W of one whole surface; give 'walls.*', 'load.*'"),
    ],
)
def test_a_toml_scene_with_faults_is_refused(tmp_path, load, more, text):
    with pytest.raises(rd.SceneError, match=text):
        rd.load_scene(oven(tmp_path, load, more))


def test_a_default_reflectance_is_no_emissivity(tmp_path):
    obj(tmp_path / "plain.obj", walls=box((0, 0, 0), (1, 1, 1), inward=True))
    with pytest.warns(rd.RadiosityWarning, match="no material"):
        scene = rd.load_scene(tmp_path / "plain.obj")
    with pytest.raises(rd.SceneError, match=r"no emissivity is given for 'walls.*', and no file gives a reflectance"):
        rd.radiative_exchange(scene, {"*": 300}, surroundings=300)


@pytest.mark.parametrize("gap", [0.0005, 0.05])
def test_what_slips_through_seams_is_told_and_more_is_refused(gap):
    """A box whose lid is a little small; no surroundings are given."""
    quads = box((0, 0, 0), (1, 1, 1), inward=True)
    lid = quad((gap, gap, 1), (0, 1 - 2 * gap, 0), (1 - 2 * gap, 0, 0))
    patches = rd.subdivide(scene_of([("walls", quads[:5]), ("lid", [lid])]), cells=1)
    given, options = {"walls": 300, "lid": 500}, {"emissivity": 0.8, "rays": 200_000}
    if gap > 0.01:
        with pytest.raises(rd.SceneError, match=r"% of what leaves walls leaves the scene; give surroundings, in K"):
            rd.radiative_exchange(patches, given, **options)
        return
    with pytest.warns(rd.RadiosityWarning, match="'walls': up to .* of their lines escape through seams"):
        heat = rd.radiative_exchange(patches, given, **options)
    assert abs(heat.net.sum()) < 1e-9 * heat.net[1]
    assert heat.surroundings_net == 0


def test_one_way_backs_are_refused():
    scene = cubes(1.0, 2.0)
    passing = rd.Scene.from_arrays(
        scene.vertices, scene.faces, 0.5, 0.0, surface=scene.surface, names=scene.names, back=rd.Back.PASSES
    )
    with pytest.raises(rd.SceneError, match="lines pass through the backs of 'cube 0', 'cube 1'"):
        rd.radiative_exchange(passing, {"*": 300}, emissivity=0.5)


def test_absorbing_backs_that_are_seen_are_told_or_refused():
    """A plate between floor and ceiling of a box, which shows its back to the floor: a small one is told, a large one refused."""
    walls = ("walls", box((0, 0, 0), (1, 1, 1), inward=True)[:4] + box((0, 0, 0), (1, 1, 1), inward=True)[5:])
    floor = ("floor", [box((0, 0, 0), (1, 1, 1), inward=True)[4]])
    options = {"emissivity": 0.8, "rays": 20_000}
    for half, refused in ((0.08, False), (0.4, True)):
        plate = ("plate", [quad((0.5 - half, 0.5 - half, 0.3), (2 * half, 0, 0), (0, 2 * half, 0))])
        patches = rd.subdivide(scene_of([walls, floor, plate]), cells=1)
        if refused:
            with pytest.raises(rd.SceneError, match=r"% of what leaves floor ends on absorbing backs, which have no temperature"):
                rd.radiative_exchange(patches, {"*": 300, "plate": 400}, **options)
        else:
            with pytest.warns(
                rd.RadiosityWarning, match="of their lines end on absorbing backs; they count as if they came back"
            ):
                heat = rd.radiative_exchange(patches, {"*": 300, "plate": 400}, **options)
            assert abs(heat.net.sum()) < 1e-9 * heat.net[2]
            with pytest.warns(rd.RadiosityWarning, match="absorbing backs"):
                even = rd.radiative_exchange(patches, {"*": 300}, **options)
            assert (even.net == 0).all()


def test_floor_below_a_box_is_left_out():
    """Patches that see nothing but the backs of a box on them take no part in a flux, and have no temperature."""
    quads = box((0, 0, 0), (1, 1, 1), inward=True)
    parts = [("walls", [*quads[:4], quads[5]]), ("floor", [quads[4]]), ("box", box((0.25, 0.25, 0), (0.75, 0.75, 0.3))[:4])]
    parts[2][1].append(quad((0.25, 0.25, 0.3), (0.5, 0, 0), (0, 0.5, 0)))
    patches = rd.subdivide(scene_of(parts), cells=4)
    options = {"emissivity": 0.8, "flux": {"floor": 100.0}, "rays": 100_000}
    with pytest.warns(rd.RadiosityWarning, match="4 patches of 'floor' see nothing but absorbing backs"):
        heat = rd.radiative_exchange(patches, {"walls": 300, "box": 310}, **options)
    unknown = np.isnan(heat.patch_temperature)
    assert unknown.sum() == 4
    assert (patches.surface[unknown] == 1).all()
    floor = patches.surface == 1
    assert heat.patch_net[floor & ~unknown] == pytest.approx(np.full(12, 100 / 0.75), rel=1e-6)
    assert heat.temperature[1] > 300


def test_faces_too_narrow_for_lines_are_told():
    corners = [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1e5), (0, 1e5))]
    faces = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]
    strips = rd.Scene.from_arrays(corners, faces, 0.5, 0.0, surface=[0, 0, 1, 1], names=["low", "high"])
    narrow = rd.subdivide(strips, cells=1)
    with pytest.warns(rd.RadiosityWarning, match="faces are so narrow, .*low: .*their view factors, and heat"):
        rd.radiative_exchange(narrow, {"low": 400, "high": 0}, emissivity=1, surroundings=0, **FEW)
    lines = rd.trace_lines(narrow, **FEW)
    with pytest.warns(rd.RadiosityWarning, match="faces are so narrow"):
        rd.gebhart_factors(lines, emissivity=1.0)


def test_a_sheet_needs_an_emissivity_on_both_sides():
    patches = rd.subdivide(scene_of([("room", box((0, 0, 0), (1, 1, 1), inward=True)), ("sheet", SHEET)], ["sheet"]), cells=1)
    with pytest.raises(rd.SceneError, match=r"emissivity of surface 'sheet' is \{'front': 0.1\}; give one for its back, too"):
        rd.radiative_exchange(patches, {"*": 300}, emissivity={"room": 0.5, "sheet": {"front": 0.1}}, **FEW)
    lines = rd.trace_lines(patches, rays=2_000)
    shine = {"room": 0.5, "sheet": {"front": 0.1, "back": 0.8}}
    shares = rd.gebhart_factors(lines, emissivity=shine)
    assert shares.emissivity.tolist() == pytest.approx([0.5, 0.1, 0.8])
    heat = rd.radiative_exchange(lines, {"room": 300, "sheet": 310}, emissivity=shine)
    assert heat["sheet"]["emissivity"] == pytest.approx(0.45)
    conductor = shares.conductors[1:, 0].sum() * SIGMA * (310**4 - 300**4)
    assert heat["sheet"]["net"] == pytest.approx(conductor, rel=0.02)
    with pytest.raises(rd.MethodError, match="none is given for 'sheet', or for one side"):
        rd.gebhart_factors(lines, emissivity={"room": 0.5, "sheet": {"front": 0.1}})


def test_a_surface_that_is_called_like_the_surroundings_is_told():
    patches = rd.subdivide(scene_of([("surroundings", SHEET), ("b", [SHEET[0][::-1] + np.array([0, 0, 0.2])])]), cells=1)
    with pytest.warns(rd.RadiosityWarning, match="a surface is called 'surroundings', too; of two rows"):
        rd.radiative_exchange(patches, {"*": 300}, emissivity=0.5, surroundings=0, **FEW)


SHEET_FILE = "o sheet\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 1 2 3 4\no floor\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 5 6 7 8\n"


@pytest.mark.parametrize("entries", ["{ front = 0.2, back = 0.8 }", "0.8|{ front = 0.2 }", "{ back = 0.8 }|{ front = [0.2] }"])
def test_sides_of_a_toml_have_emissivities_of_their_own(entries, tmp_path):
    """Where no file gives a reflectance each side reflects the rest; the conditions hold what they hold in Python."""
    (tmp_path / "a.obj").write_text(SHEET_FILE)
    path = tmp_path / "a.toml"
    tables = "".join(f'[[surface]]\nname = "sheet"\ntemperature = 300\nemissivity = {one}\n' for one in entries.split("|"))
    path.write_text(
        f'geometry = "a.obj"\nsurroundings = 280\n{tables}[[surface]]\nname = "floor"\nadiabatic = true\nemissivity = 0.5\n'
    )
    scene = rd.load_scene(path)
    assert scene.heat.emissivity == ({"front": (0.2,), "back": (0.8,)}, (0.5,))
    assert scene.reflectance[0].tolist() == [pytest.approx(0.8)]
    assert scene.back_reflectance[0].tolist() == [pytest.approx(0.2)]
    patches = rd.subdivide(scene, cells=1)
    assert Conditions.of(patches).emissivity.tolist() == [[0.2, 0.8, 0.5, 0.5]]
    with pytest.warns(rd.RadiosityWarning, match="surfaces of their own"):
        rd.save_scene(scene, tmp_path / "b.toml")  # each side becomes a surface, with its own emissivity
    assert rd.load_scene(tmp_path / "b.toml").heat.emissivity == ((0.2,), (0.8,), (0.5,))


def test_surfaces_that_one_becomes_share_its_heat_flow(tmp_path):
    """A sheet of 1 m² and 12 W, whose sides reflect otherwise."""
    (tmp_path / "a.obj").write_text(SHEET_FILE)
    (tmp_path / "a.toml").write_text(
        'geometry = "a.obj"\nsurroundings = 280\n[[surface]]\nname = "sheet"\nflux = 12.0\n'
        "emissivity = { front = 0.2, back = 0.8 }\n"
        '[[surface]]\nname = "floor"\nadiabatic = true\nemissivity = 0.5\n'
    )
    with pytest.warns(rd.RadiosityWarning) as told:
        rd.save_scene(rd.load_scene(tmp_path / "a.toml"), tmp_path / "b.toml")
    assert any("share it by area and may differ in temperature: 'sheet'" in str(one.message) for one in told)
    heat = rd.load_scene(tmp_path / "b.toml").heat
    assert heat.flux.tolist() == [6.0, 6.0, 0.0]


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ("{ top = 0.5 }", r"surface 1 \('sheet'\), emissivity, top: Input should be 'front' or 'back'"),
        ("{}", r"surface 1 \('sheet'\), emissivity: .* at least 1 item"),
        ("{ front = 1.5 }", r"surface 1 \('sheet'\), emissivity, front 1: .*less than or equal to 1"),
        ("{ front = 0.5, back = [0.5, 0.6] }", r"emissivity has 2 numbers; wavelengths = \[\] makes 1 band"),
        ('"bright"', r"surface 1 \('sheet'\), emissivity"),
    ],
)
def test_sides_of_a_toml_that_make_no_sense(given, text, tmp_path):
    (tmp_path / "a.obj").write_text(SHEET_FILE)
    (tmp_path / "a.toml").write_text(f'geometry = "a.obj"\n[[surface]]\nname = "sheet"\nemissivity = {given}\n')
    with pytest.raises(rd.SceneError, match=text):
        rd.load_scene(tmp_path / "a.toml")
