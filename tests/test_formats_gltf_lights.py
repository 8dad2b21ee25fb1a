"""Lights of glTF files (KHR_lights_punctual): what they send, where to, and one clear error for each fault."""

import numpy as np
import pytest
from samples import Gltf

import radiosity as rd

GREY = {"name": "grey", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}}
QUARTER = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]  # about x: -z becomes y


@pytest.fixture
def load(tmp_path):
    def of(*lights, nodes=None, material=GREY, name="lit.glb", **options):
        gltf = Gltf(extensionsUsed=["KHR_lights_punctual"], extensions={"KHR_lights_punctual": {"lights": list(lights)}})
        gltf.node(mesh=gltf.mesh(material=material), name="square")
        for number, node in enumerate(nodes or [{"translation": [0, 0, 2]}] * len(lights)):
            gltf.node(**({"name": f"lamp {number}", "extensions": {"KHR_lights_punctual": {"light": number}}} | node))
        return rd.load_scene(gltf.write(tmp_path / name), **options)

    return of


def test_a_point_light_in_candela(load):
    scene = load({"type": "point", "intensity": 100})
    (lamp,) = scene.lights.luminaires
    assert lamp.power == pytest.approx([400 * np.pi])
    assert (lamp.name, lamp.position.tolist()) == ("lamp 0", [0, 0, 2])
    assert (scene.unit, scene.bands) == ("lm/m²", ("grey",))


def test_a_light_below_a_square_as_pixels_show_it(load):
    """E = I cos / d^2 at the middle of small patches."""
    scene = load({"type": "point", "intensity": 50}, nodes=[{"translation": [0.3, 0.4, 1.5]}])
    solution = rd.solve(rd.subdivide(scene, cells=5), rays=60_000, seed=1)
    way = solution.patches.centroid - (0.3, 0.4, 1.5)
    lit = ~solution.patches.is_back
    assert solution.irradiance[lit, 0] == pytest.approx((50 * 1.5 / (way**2).sum(axis=1) ** 1.5)[lit], rel=0.02)


def test_colours_multiply_the_intensity_of_each_band(load):
    """A grey scene becomes coloured."""
    scene = load({"type": "point", "intensity": 100, "color": [1, 0.5, 0]}, {"type": "point", "intensity": 1})
    assert scene.lights.luminaires[0].power == pytest.approx(400 * np.pi * np.array([1, 0.5, 0]))
    assert scene.lights.luminaires[1].power == pytest.approx([4 * np.pi] * 3)
    assert scene.bands == ("red", "green", "blue")
    assert scene.reflectance.tolist() == [[0.5] * 3]


@pytest.mark.parametrize(("inner", "outer"), [(0.0, np.pi / 4), (0.3, 0.8), (0.5, 0.501)])
def test_spots_fall_off_as_the_specification_says(load, inner, outer):
    spot = {"innerConeAngle": inner, "outerConeAngle": outer}
    scene = load({"type": "spot", "intensity": 10, "spot": spot}, nodes=[{"rotation": QUARTER, "scale": [2, 3, 5]}])
    (lamp,) = scene.lights.luminaires
    assert lamp.axes[2] == pytest.approx((0, 1, 0), abs=1e-7)
    angle = np.linspace(0, 1, 301)
    found = np.interp(np.degrees(angle), lamp.web.gamma, lamp.web.intensity[0], right=0) * lamp.power[0] / lamp.web.flux
    part = np.clip((np.cos(angle) - np.cos(outer)) / max(0.001, np.cos(inner) - np.cos(outer)), 0, 1)
    assert found == pytest.approx(10 * part**2, abs=2e-3)


def test_the_cone_angles_have_defaults(load):
    (lamp,) = load({"type": "spot"}).lights.luminaires
    assert lamp.web.gamma[-1] == pytest.approx(45)
    assert lamp.axes[2].tolist() == [0, 0, -1]


def test_a_directional_light_is_a_sun_in_lux(load):
    scene = load({"type": "directional", "intensity": 5000, "color": [1, 1, 1]}, nodes=[{"translation": [9, 9, 9]}])
    (sun,) = scene.lights.suns
    assert (sun.name, sun.direction.tolist(), sun.irradiance.tolist(), sun.diameter) == ("lamp 0", [0, 0, 1], [5000], 0)
    solution = rd.solve(rd.subdivide(scene, cells=2), rays=20_000, seed=1)
    assert solution.irradiance[~solution.patches.is_back, 0] == pytest.approx(5000, rel=0.02)


def test_lights_of_parents_that_are_turned_and_of_several_nodes(load):
    lamp = {"extensions": {"KHR_lights_punctual": {"light": 0}}, "name": "lamp"}
    nodes = [{"name": "arm", "translation": [0, 0, 3], "rotation": QUARTER, "children": [2], "extensions": {}}, lamp, lamp]
    scene = load({"type": "spot", "intensity": 3}, nodes=nodes)
    assert [one.name for one in scene.lights.luminaires] == ["lamp", "lamp#2"]
    assert scene.lights.luminaires[0].position.tolist() == [0, 0, 3]
    assert scene.lights.luminaires[0].axes[2] == pytest.approx((0, 1, 0), abs=1e-7)


def test_what_is_left_out_is_told(load):
    hidden = {"KHR_node_visibility": {"visible": False}, "KHR_lights_punctual": {"light": 0}}
    with pytest.warns(rd.RadiosityWarning) as caught:
        scene = load({"type": "point", "range": 3}, {"type": "area"}, nodes=[{}, {}, {"name": "off", "extensions": hidden}])
    texts = sorted(str(one.message).split(": ", 1)[1] for one in caught)
    assert texts == [
        "hidden objects (KHR_node_visibility) are left out: 'off'",
        "lights of unknown types are left out: 'lamp 1 (area)'",
        "ranges of lights (light goes on beyond them) are left out: 'lamp 0'",
    ]
    assert len(scene.lights.luminaires) == 1


def test_surfaces_that_emit_beside_lights_are_photometric_too(load):
    with pytest.warns(rd.RadiosityWarning, match="emission is in cd/m²"):
        scene = load({"type": "point"}, material={**GREY, "emissiveFactor": [1, 1, 1]})
    assert scene.photometric


def test_a_light_that_is_off_is_none(load):
    scene = load({"type": "point", "intensity": 0})
    assert not scene.lights
    assert not scene.photometric


@pytest.mark.parametrize(
    ("light", "node", "says"),
    [
        ({"type": "point"}, {"extensions": {"KHR_lights_punctual": {"light": 4}}}, "is number 4; the file has 1"),
        ({"type": "point", "intensity": -2}, {}, "must not be negative"),
        ({"type": "point", "intensity": "bright"}, {}, "expected 1 finite"),
        ({"type": "spot", "spot": {"innerConeAngle": 1, "outerConeAngle": 0.5}}, {}, "inner < outer"),
        ({"type": "spot", "spot": {"outerConeAngle": 2}}, {}, "inner < outer"),
        ({"type": "spot"}, {"scale": [0, 0, 0]}, "without direction"),
    ],
)
def test_faults_are_one_error(load, light, node, says):
    with pytest.raises(rd.SceneError, match=r"lit\.glb") as error:
        load(light, nodes=[node])
    assert says in str(error.value)


def test_a_toml_scales_places_and_keeps_units_apart(load, tmp_path):
    load({"type": "point", "intensity": 100})
    (tmp_path / "lit.toml").write_text('geometry = "lit.glb"\nscale = 2\n')
    scene = rd.load_scene(tmp_path / "lit.toml")
    assert scene.lights.luminaires[0].position.tolist() == [0, 0, 4]
    assert scene.lights.luminaires[0].power == pytest.approx([400 * np.pi])
    assert scene.photometric
    for text, says in (
        ("photometric = false\n", "photometric is false, and light 'lamp 0' is in lm"),
        ('[[luminaire]]\ntype = "point"\nposition = [0, 0, 1]\npower = 5\n', "luminaire 'point' in W"),
    ):
        (tmp_path / "lit.toml").write_text('geometry = "lit.glb"\n' + text)
        with pytest.raises(rd.SceneError, match=says):
            rd.load_scene(tmp_path / "lit.toml")
