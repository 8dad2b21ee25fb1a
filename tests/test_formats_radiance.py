"""Radiance scenes: statements, surfaces, materials and lights mean what Radiance's reference manual says."""

import re
import warnings

import numpy as np
import pytest

import radiosity as rd
from radiosity.scene.formats.color import luminance_weights
from radiosity.scene.lights.axes import place_of

TILE = "{0} polygon {1} 0 0 12  0 0 0  2 0 0  2 1 0  0 1 0\n"
GREY = "void plastic grey 0 0 5 .5 .5 .5 0 0\n"


@pytest.fixture
def load(tmp_path):
    """Loads a .rad text; warnings are errors, as everywhere in the tests."""

    def of(text, **options):
        file = tmp_path / "scene.rad"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return rd.load_scene(file, **options)

    return of


@pytest.fixture
def told(load):
    """Loads a .rad text, and returns the scene and all warnings as one text."""

    def of(text):
        with warnings.catch_warnings(record=True) as found:
            warnings.simplefilter("always")
            scene = load(text)
        return scene, "\n".join(str(one.message) for one in found)

    return of


def of_surfaces(scene):
    """Area and mean normal of each surface."""
    rows = [scene.surface == i for i in range(len(scene.names))]
    return {
        name: (scene.area[row].sum(), (scene.normal[row] * scene.area[row, None]).sum(axis=0) / scene.area[row].sum())
        for name, row in zip(scene.names, rows, strict=True)
    }


def test_a_polygon_is_a_face_of_two_sides_named_by_its_identifier_and_modifier(load):
    scene = load(GREY + TILE.format("grey", "table.1042") + TILE.format("grey", "grey"))
    assert scene.names == ("table/grey", "grey")
    assert not scene.photometric
    np.testing.assert_array_equal(scene.back, [rd.Back.RADIATES] * 2)
    np.testing.assert_array_equal(scene.reflectance, [[0.5], [0.5]])
    np.testing.assert_allclose(scene.normal, [[0, 0, 1]] * 2)
    assert scene.area == pytest.approx([2, 2])


def test_comments_line_ends_and_numbers_across_lines(load):
    text = "# a comment ! and\nvoid plastic 'my grey' # here\n0\n0 5 .5 .5 # and here\n.5 0 0\r\n"
    scene = load((text + TILE.format('"my grey"', "a").replace("  ", "\r\n")).encode())
    assert scene.names == ("a/my grey",)
    assert scene.area == pytest.approx([2])


def test_holes_that_seams_cut_and_concave_outlines(load):
    hole = "0 0 0  4 0 0  4 4 0  0 4 0  0 0 0  1 1 0  1 2 0  2 2 0  2 1 0  1 1 0"
    corner = "0 0 1  2 0 1  2 1 1  1 1 1  1 2 1  0 2 1"
    scene = load(GREY + f"grey polygon h 0 0 30 {hole}\ngrey polygon l 0 0 18 {corner}\n")
    found = of_surfaces(scene)
    assert found["h/grey"][0] == pytest.approx(15)
    assert found["l/grey"][0] == pytest.approx(3)
    np.testing.assert_allclose(scene.normal[:, 2], 1)


@pytest.mark.parametrize("kind", ["sphere", "bubble", "cone", "cup", "cylinder", "tube", "ring"])
def test_curved_surfaces_have_their_area_and_their_front(load, kind):
    numbers = {"sphere": "4 1 2 3 .5", "ring": "8 1 2 3 0 0 -2 .3 .5"}
    cone, cylinder = "8 1 2 3 1 2 5 .5 .2", "7 1 2 3 1 2 5 .5"
    numbers |= {"bubble": numbers["sphere"], "cone": cone, "cup": cone, "cylinder": cylinder, "tube": cylinder}
    scene = load(GREY + f"grey {kind} x 0 0 {numbers[kind]}\n")
    side = np.pi * 0.7 * np.hypot(2, 0.3)
    area = {"sphere": np.pi, "bubble": np.pi, "cone": side, "cup": side, "cylinder": 2 * np.pi, "tube": 2 * np.pi}
    assert scene.area.sum() == pytest.approx(area.get(kind, np.pi * 0.16), rel=1e-12)
    centre = scene.vertices[np.where(scene.faces < 0, scene.faces[:, :1], scene.faces)].mean(axis=1) - (1, 2, 3)
    if kind == "ring":
        np.testing.assert_allclose(scene.normal, [[0, 0, -1]] * len(scene.normal), atol=1e-12)
    else:
        outward = np.einsum("ij,ij->i", scene.normal, centre * (1, 1, kind in ("sphere", "bubble"))) > 0
        assert outward.all() if kind in ("sphere", "cone", "cylinder") else not outward.any()


def test_a_disk_and_a_cone_with_a_tip_are_triangles_of_the_right_area(load):
    scene = load(GREY + "grey ring d 0 0 8 0 0 0 0 0 1 0 2\ngrey cone c 0 0 8 0 0 0 0 0 1 0 1\n")
    found = of_surfaces(scene)
    assert found["d/grey"][0] == pytest.approx(4 * np.pi)
    assert found["c/grey"][0] == pytest.approx(np.pi * np.sqrt(2))
    assert found["c/grey"][1][2] == pytest.approx(-1 / np.sqrt(2), rel=0.01)  # it widens upwards: outside is below


@pytest.mark.parametrize(
    ("material", "reflectance"),
    [
        ("plastic {} 0 0 5 .2 .4 .6 .1 0", [0.18, 0.36, 0.54]),
        ("metal {} 0 0 5 .5 .5 .5 .9 .1", [0.05]),
        ("plastic2 {} 4 1 0 0 . 0 6 .4 .4 .4 .5 .1 .1", [0.2]),
        ("mirror {} 0 0 3 .9 .9 .9", [0.0]),
        ("ashik2 {} 4 1 0 0 . 0 8 .3 .3 .3 .1 .1 .1 9 9", [0.3]),
    ],
)
def test_materials_are_taken_by_their_diffuse_reflectance(told, material, reflectance):
    scene, text = told("void " + material.format("m") + "\n" + TILE.format("m", "a"))
    np.testing.assert_allclose(scene.reflectance, [reflectance], rtol=1e-12)
    assert "not diffuse, taken by the diffuse albedo: 'a/m'" in text


def test_glass_is_a_pane_by_the_formulas_of_fresnel(told):
    scene, text = told("void glass m 0 0 3 1 1 1\nvoid glass n 0 0 3 .5 .6 .7\n" + TILE.format("m", "a") + TILE.format("n", "b"))
    # clear glass: the share of diffuse light that one side reflects inside and outside, by the numbers of E. Hecht's Optics
    cosine = (np.arange(20000) + 0.5) / 20000
    inner = np.sqrt(1 - (1 - cosine**2) / 1.52**2)
    sides = [((cosine - 1.52 * inner) / (cosine + 1.52 * inner)) ** 2, ((1.52 * cosine - inner) / (1.52 * cosine + inner)) ** 2]
    through = np.mean([(1 - side) / (1 + side) for side in sides], axis=0)
    assert scene.transmittance[0] == pytest.approx((through * 2 * cosine).mean(), rel=1e-5)
    assert 0.4 < scene.transmittance[1] / scene.transmittance[0] < luminance_weights() @ [0.5, 0.6, 0.7]
    assert "coloured panes let all colours through alike, by their luminance: 'n'" in text


def test_trans_lets_a_share_straight_on_and_diffuses_the_rest(told):
    scene, text = told("void trans m 0 0 7 .5 .5 .5 .1 0 .4 .25\n" + TILE.format("m", "a"))
    np.testing.assert_allclose(scene.transmittance, 0.5 * 0.9 * 0.4 * 0.25)
    np.testing.assert_allclose(scene.diffuse_transmittance, 0.5 * 0.9 * 0.4 * 0.75)
    np.testing.assert_allclose(scene.reflectance, 0.5 * 0.9 * 0.6)
    assert scene.back.tolist() == [rd.Back.RADIATES]
    assert "rough" not in text


def test_trans_diffuses_in_colour_and_rough_ones_are_told(told):
    scene, text = told("void trans m 0 0 7 .6 .5 .4 0 .1 .5 0\n" + TILE.format("m", "a"))
    np.testing.assert_allclose(scene.diffuse_transmittance, [[0.3, 0.25, 0.2]])
    assert scene.transmittance is None
    assert text == ""
    scene, text = told("void trans m 0 0 7 .6 .6 .6 0 .1 .5 .5\n" + TILE.format("m", "a"))
    assert "rough materials (trans) let the share that they transmit specularly straight on here" in text
    scene, text = told("void BRTDfunc m 10 0 0 0 0 0 0 0 0 0 . 0 9 .2 .2 .2 .3 .3 .3 .1 .2 .4\n" + TILE.format("m", "a"))
    np.testing.assert_allclose(scene.diffuse_transmittance, [[0.1, 0.2, 0.4]])
    np.testing.assert_allclose([scene.reflectance, scene.back_reflectance], [[[0.2] * 3], [[0.3] * 3]])


def test_lights_emit_from_their_front(load):
    scene = load("void light l 0 0 3 1 2 3\nvoid glow g 0 0 4 2 2 2 1.5\n" + TILE.format("l", "a") + TILE.format("g", "b"))
    np.testing.assert_allclose(scene.emission, np.pi * np.array([[1, 2, 3], [2, 2, 2]]))
    np.testing.assert_array_equal(scene.reflectance, np.zeros((2, 3)))
    np.testing.assert_array_equal(scene.back, [rd.Back.ABSORBS] * 2)


def test_glows_of_negative_radius_are_black_and_spotlights_keep_the_power_of_their_cone(told):
    text = "void glow n 0 0 4 2 2 2 -1\nvoid spotlight s 0 0 7 1 1 1 60 0 0 1\n"
    scene, said = told(text + TILE.format("n", "a") + TILE.format("s", "b"))
    np.testing.assert_allclose(scene.emission[:, 0], [0, np.pi * np.sin(np.radians(30)) ** 2])
    assert "glows of negative radius light nothing in Radiance, and are black here: 'n'" in said
    assert "spotlights send the power of their cone evenly" in said


def test_an_illum_is_a_light_or_the_window_that_a_sky_shines_through(told):
    text = "void glass pane 0 0 3 .9 .9 .9\nvoid illum i 1 pane 0 3 5 5 5\nvoid illum j 0 0 3 1 1 1\n"
    text += TILE.format("i", "a") + TILE.format("j", "b")
    lit, said = told(text)
    np.testing.assert_allclose(lit.emission[:, 0], np.pi * np.array([5, 1]))
    assert lit.back_emission[0, 0] == 0
    assert lit.transmittance[0] > 0.7
    assert lit.back[1] == rd.Back.OPEN  # nothing is there but light
    assert "illums shine as lights" in said
    windows, said = told(text + "void glow sky 0 0 4 1 1 1 0\nsky source s 0 0 4 0 0 1 180\n")
    np.testing.assert_allclose(windows.emission[:, 0], np.pi * np.array([0, 1]))
    assert "illums are taken by their alternate material, since the file has a sky that shines through them: 'i'" in said


def test_sources_are_suns_and_skies(load):
    text = "void light sol 0 0 3 1e6 2e6 1e6\nsol source sun 0 0 4 0 -3 4 .533\nvoid glow one 0 0 4 3 3 3 0\n"
    text += "one source sky 0 0 4 0 0 1 180\nvoid glow two 0 0 4 .5 .5 .5 0\ntwo source ground 0 0 4 0 0 -1 180\n"
    scene = load(GREY + TILE.format("grey", "a") + text)
    (sun,) = scene.lights.suns
    np.testing.assert_allclose(sun.direction, [0, -0.6, 0.8])
    np.testing.assert_allclose(sun.irradiance, np.pi * np.sin(np.radians(0.533 / 2)) ** 2 * np.array([1e6, 2e6, 1e6]))
    sky = scene.lights.sky
    np.testing.assert_allclose(sky.at(np.array([[0.6, 0, 0.8], [0.6, 0, -0.8]]))[:, 0], [3, 0.5])
    assert sky.horizontal == pytest.approx(3 * np.pi)
    assert [sun.photometric, sky.photometric, scene.photometric] == [False] * 3
    assert scene.bands == ("red", "green", "blue")  # the sun has a colour


ROOM = """
void plastic white 0 0 5 .7 .7 .7 0 0
void plastic grey 0 0 5 .3 .3 .3 0 0
grey polygon floor 0 0 12  0 0 0  3 0 0  3 2 0  0 2 0
white polygon ceiling 0 0 12  0 0 2  0 2 2  3 2 2  3 0 2
white polygon west 0 0 12  0 0 0  0 2 0  0 2 2  0 0 2
white polygon east 0 0 12  3 0 0  3 0 2  3 2 2  3 2 0
white polygon north 0 0 12  0 2 0  3 2 0  3 2 2  0 2 2
white polygon south 0 0 30  0 0 0  0 0 2  3 0 2  3 0 0  0 0 0  .2 0 .4  2.8 0 .4  2.8 0 1.9  .2 0 1.9  .2 0 .4
grey sphere ball 0 0 4  2.3 1.4 .4 .3
void glow high 0 0 4 10 10 10 0
high source sky 0 0 4 0 0 1 180
void glow low 0 0 4 4 4 4 0
low source ground 0 0 4 0 0 -1 180
void light bright 0 0 3 90 90 90
bright ring lamp 0 0 8  .8 1 1.99  0 0 -1  0 .3
"""


def test_irradiance_in_a_room_with_a_lamp_and_a_window_is_that_of_rtrace(load):
    """Four points. rtrace follows single paths (`validation/rtrace.py` has its options); alpha is 4 x 2e-5."""
    pytest.importorskip("pyradiance")
    from validation.rtrace import traced

    points = np.array([[1.5, 0.5, 0.8], [1.5, 1.5, 0.8], [2.3, 1.4, 0.8], [0.8, 1.6, 0.01]])
    up, paths = np.tile([0.0, 0, 1], (4, 1)), 8_000
    theirs = traced(ROOM, np.repeat(np.column_stack([points, up]), paths, axis=0))[:, 0].reshape(4, paths).astype(float)
    scene = rd.subdivide(load(ROOM), size=0.5)
    ours = rd.measure(scene, rd.Sensors.of(points, up), rays=200_000, seed=1)
    error = np.hypot(theirs.std(axis=1) / np.sqrt(paths), ours.standard_error[:, 0])
    assert (error < 0.02 * theirs.mean(axis=1)).all()
    np.testing.assert_array_less(np.abs(ours.illuminance[:, 0] - theirs.mean(axis=1)), 4.2 * error)


@pytest.mark.parametrize("towards", [(0, 0, -1), (0, 0.6, 0.8), (0, 0.6, -0.8), (1, 0, 0)])
def test_one_half_of_a_sky_may_look_anywhere(load, towards):
    text = f"void glow g 0 0 4 2 2 2 0\ng source half 0 0 4 {towards[0]} {towards[1]} {towards[2]} 180\n"
    sky = load(GREY + TILE.format("grey", "a") + text).lights.sky
    directions = np.random.default_rng(2).normal(size=(50, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    np.testing.assert_allclose(sky.at(directions)[:, 0], np.where(directions @ towards > 0, 2, 0))


SKY = "skyfunc glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n"
SKY += "skyfunc glow h 0 0 4 1 .8 .6 0\nh source ground 0 0 4 0 0 -1 180\n"


@pytest.mark.parametrize(
    "command", ["gensky 3 21 10 -c", "gensky 3 21 10 +i", "gensky 3 21 10 +s", "gendaylit 3 21 10 -W 400 200"]
)
def test_skies_of_gensky_and_gendaylit_are_those_that_rtrace_sees(load, tmp_path, command):
    pytest.importorskip("pyradiance")
    from validation.rtrace import program

    text = program(command.split()[0], *command.split()[1:]).decode() + SKY + GREY + "grey sphere s 0 0 4 0 0 -9 .1\n"
    scene = load(text)
    (tmp_path / "octree").write_bytes(program("oconv", str(tmp_path / "scene.rad")))
    directions = np.random.default_rng(1).normal(size=(400, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    rays = np.column_stack([np.zeros((400, 3)), directions])
    theirs = program("rtrace", "-h", "-fdf", "-ab", "0", "-oV", str(tmp_path / "octree"), given=rays.tobytes())
    apart = np.all([directions @ sun.direction < 0.999 for sun in scene.lights.suns], axis=0) & (directions[:, 2] > -0.99)
    assert [place_of(scene.lights.sky.axes, np.array([0.0, 1, 0]))[1], *scene.lights.sky.axes[2]] == [0, 0, 0, 1]  # y is north
    ours = np.broadcast_to(scene.lights.sky.at(directions), (400, 3))
    np.testing.assert_allclose(ours[apart], np.frombuffer(theirs, np.float32).reshape(-1, 3)[apart], rtol=0.005)


def test_names_stand_for_what_was_defined_last(load):
    text = GREY + TILE.format("grey", "a") + GREY.replace(".5 .5 .5", ".2 .2 .2") + TILE.format("grey", "b")
    text += "void alias other grey\nvoid alias third other\n" + TILE.format("third", "c")
    scene = load(text)
    assert scene.names == ("a/grey", "b/grey", "c/third")
    np.testing.assert_allclose(scene.reflectance[:, 0], [0.5, 0.2, 0.2])


def test_patterns_are_told_and_lights_under_patterns_are_dark(told):
    text = "void colorpict wood 7 red green blue wood.hdr pic.cal pu pv 0 0\nwood plastic oak 0 0 5 .4 .4 .4 0 0\n"
    text += "void brightdata web 4 flatcorr x.dat source.cal src_theta 0 1 1\nweb light lamp 0 0 3 9 9 9\n"
    text += "oak texfunc bumps 4 x y z . 0 0\n"
    scene, said = told(text + TILE.format("bumps", "a") + TILE.format("lamp", "b"))
    assert scene.names == ("a/oak", "b/lamp")
    np.testing.assert_allclose(scene.reflectance[:, 0], [0.4, 0])
    assert scene.emission.max() == 0
    assert (
        "patterns and textures are left out, and materials keep their own colour: 'bumps (texfunc)', 'wood (colorpict)'" in said
    )
    assert re.search(r"lights whose distribution a pattern gives .*\[\[luminaire\]\].*lamp", said)


def test_what_is_not_there_is_told(told):
    scene, said = told(GREY + TILE.format("nobody", "a") + TILE.format("void", "b") + TILE.format("grey", "c"))
    assert scene.names == ("a/nobody", "c/grey")
    assert "modifiers that the file does not define; where another file does, join them" in said
    assert "no material for 'a/nobody'; reflectance 0.5 taken" in said
    assert "surfaces without a material are invisible to Radiance, and left out: 'b/void'" in said


def test_commands_are_refused_with_what_to_run_by_hand(load):
    with pytest.raises(rd.SceneError, match=r"scene\.rad:2: '!genbox a b 1 1 1' would run a command.*xform -e .*\.rad > exp"):
        load(GREY + "!genbox a b 1 1 1\n" + TILE.format("grey", "a"))


@pytest.mark.parametrize(("kind", "file"), [("instance", "desk.oct"), ("mesh", "desk.rtm")])
def test_compiled_objects_are_refused_by_name(load, kind, file):
    with pytest.raises(rd.SceneError, match=rf"scene\.rad:2: {kind} 'd' shows {file}"):
        load(GREY + f"grey {kind} d 5 {file} -t 1 0 0 0 0\n")


def test_antimatter_is_refused_by_name(load):
    with pytest.raises(rd.SceneError, match="'gap' cuts holes into other surfaces"):
        load(GREY + "void antimatter gap 1 grey 0 0\ngap sphere s 0 0 4 0 0 0 1\n")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("grey sphere s 0 0 3 0 0 0", "a sphere has 4 numbers, and not 3"),
        ("grey cylinder s 0 0 7 0 0 0 0 0 0 1", "two ends that differ"),
        ("grey polygon s 0 0 8 0 0 0 1 1 1 2 2", "three numbers for each"),
        ("grey torus s 0 0 4 0 0 0 1", "'torus' is no type"),
        ("void alias s nothing", "'nothing', which is not defined"),
        ("grey source s 0 0 3 0 0 1", "four numbers"),
    ],
)
def test_faults_are_left_out_with_their_line(told, load, line, message):
    scene, said = told(GREY + line + "\n" + TILE.format("grey", "a"))
    assert scene.n_faces == 1
    assert re.search(rf"scene\.rad:2: .*{message}", said)
    with pytest.raises(rd.SceneError, match=rf"scene\.rad:2: .*{message}"):
        load(GREY + line + "\n" + TILE.format("grey", "a"), strict=True)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("grey polygon a 0 0 nine 0", r"scene\.rad:2: 'nine' stands where the number of numbers of polygon 'a'"),
        ("grey polygon a 0 0 9 0 0 0 1 0 0 0 one 0", r"scene\.rad:2: 'one' stands where a number of polygon 'a'"),
        ("grey polygon a 0 0 9 0 0 0", "the file ends where a number of polygon 'a' is expected"),
        ("", r"scene\.rad: holds no surfaces; .*cat materials\.rad room\.rad > all\.rad"),
    ],
)
def test_text_that_is_no_scene_is_an_error(load, text, message):
    with pytest.raises(rd.SceneError, match=message):
        load(GREY + text)


def test_a_toml_takes_a_radiance_scene_with_its_lights(load, tmp_path):
    load(GREY + TILE.format("grey", "a") + "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 0 1 .5\n")
    (tmp_path / "x.toml").write_text('geometry = "scene.rad"\nunit = "cm"\n[[surface]]\nname = "*/grey"\nreflectance = 0.3\n')
    scene = rd.load_scene(tmp_path / "x.toml")
    assert scene.area == pytest.approx([2e-4])
    assert scene.reflectance == pytest.approx(0.3)
    assert scene.lights.suns[0].irradiance == pytest.approx(np.pi * np.sin(np.radians(0.25)) ** 2 * 1e6)
