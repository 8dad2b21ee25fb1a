"""Honeybee models: rooms, windows, doors and shades stand where they are, with the modifiers that honeybee gives them."""

import json
import warnings

import numpy as np
import pytest

import radiosity as rd

pytest.importorskip("pydantic")
GREY = {"type": "Plastic", "identifier": "paint", "r_reflectance": 0.3, "g_reflectance": 0.3, "b_reflectance": 0.3}
GLASS = {"type": "Glass", "identifier": "pane", "r_transmissivity": 1, "g_transmissivity": 1, "b_transmissivity": 1}


def loop(*points):
    return [list(map(float, point)) for point in points]


def face(name, kind, points, **more):
    return {"type": "Face", "identifier": name, "face_type": kind, "geometry": {"boundary": loop(*points)}, **more}


def room(name, x, *, wall=None, **more):
    """A box of 4 x 3 x 3 m from x on; ``wall`` are keys of the walls at its ends."""
    a, b, c, d = ((x, 0), (x + 4, 0), (x + 4, 3), (x, 3))
    sides = {"south": (a, b), "east": (b, c), "north": (c, d), "west": (d, a)}
    walls = [
        face(f"{name}_{side}", "Wall", [(*p, 0), (*q, 0), (*q, 3), (*p, 3)], **(wall or {}).get(side, {}))
        for side, (p, q) in sides.items()
    ]
    floor = face(f"{name}_floor", "Floor", [(*p, 0) for p in (d, c, b, a)], boundary_condition={"type": "Ground"})
    return {
        "identifier": name,
        "faces": [*walls, floor, face(f"{name}_top", "RoofCeiling", [(*p, 3) for p in (a, b, c, d)])],
        **more,
    }


def object_of(name, *points, **more):
    return {"identifier": name, "geometry": {"boundary": loop(*points)}, **more}


def modified(name):
    return {"properties": {"radiance": {"modifier": name}}}


WINDOW = object_of("w", (1, 0, 1), (3, 0, 1), (3, 0, 2), (1, 0, 2))
DOOR = object_of("d", (3.1, 0, 0), (3.9, 0, 0), (3.9, 0, 2.1), (3.1, 0, 2.1))  # it stands on the floor


@pytest.fixture
def load(tmp_path):
    """Loads a model of these keys; the warning that glass is no diffuse surface is left out."""

    def of(**model):
        text = json.dumps({"type": "Model", "identifier": "m", **model})
        (tmp_path / "m.hbjson").write_text(text)
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message=".*not diffuse, taken by the diffuse albedo")
            return rd.load_scene(tmp_path / "m.hbjson")

    return of


def areas(scene):
    return {name: scene.area[scene.surface == i].sum() for i, name in enumerate(scene.names)}


def of(scene, name, key):
    return getattr(scene, key)[scene.surface == scene.names.index(name)].max()


def test_a_room_with_a_window_and_a_door_has_holes_for_them(load):
    scene = load(rooms=[room("r", 0, wall={"south": {"apertures": [WINDOW], "doors": [DOOR]}})])
    found = areas(scene)
    assert found["wall/r_south"] == pytest.approx(12 - 2 - 0.8 * 2.1)
    assert found["aperture/w"] == pytest.approx(2)
    assert found["door/d"] == pytest.approx(0.8 * 2.1)
    assert sum(found.values()) == pytest.approx(2 * 12 + 2 * 12 + 2 * 9)
    vector = (scene.normal * scene.area[:, None]).sum(axis=0)
    np.testing.assert_allclose(vector, 0, atol=1e-9)
    inward = (scene.frames[0] - (2, 1.5, 1.5)) * scene.normal
    assert (inward.sum(axis=1) < 0).all()  # all fronts look into the room
    np.testing.assert_array_equal(scene.back, [rd.Back.RADIATES] * scene.n_faces)


def test_a_window_that_is_all_of_its_wall_leaves_no_wall(load):
    whole = object_of("w", (0, 0, 0), (4, 0, 0), (4, 0, 3), (0, 0, 3))
    scene = load(rooms=[room("r", 0, wall={"south": {"apertures": [whole]}})])
    assert "wall/r_south" not in scene.names
    assert areas(scene)["aperture/w"] == pytest.approx(12)


def test_without_modifiers_surfaces_have_the_defaults_of_honeybee(load):
    skylight = object_of("s", (1, 1, 3), (2, 1, 3), (2, 2, 3), (1, 2, 3), is_operable=True)
    one = room(
        "r",
        0,
        wall={"south": {"apertures": [WINDOW], "doors": [DOOR]}},
        indoor_shades=[object_of("i", *loop((0, 0, 1), (1, 0, 1), (1, 1, 1)))],
    )
    one["faces"][-1]["apertures"] = [skylight]
    context = object_of("c", (9, 0, 0), (9, 1, 0), (9, 1, 1), is_detached=True)
    scene = load(rooms=[one], orphaned_shades=[context, object_of("o", (8, 0, 0), (8, 1, 0), (8, 1, 1))])
    names = {
        "wall/r_south": 0.5,
        "floor/r_floor": 0.2,
        "ceiling/r_top": 0.8,
        "door/d": 0.5,
        "shade/i": 0.5,
        "shade/c": 0.2,
        "shade/o": 0.35,
    }
    assert {name: of(scene, name, "reflectance") for name in names} == names
    # 0.64 of the light goes through at right angles; of diffuse light it is less
    assert of(scene, "aperture/w", "transmittance") == of(scene, "aperture/s", "transmittance") == pytest.approx(0.559, abs=0.001)


def test_modifiers_are_those_of_the_object_or_of_its_room_or_of_the_model(load):
    sets = [{"type": "ModifierSetAbridged", "identifier": "s", "wall_set": {"exterior_modifier": "paint"}}]
    own = {**modified({**GREY, "identifier": "own", "g_reflectance": 0.1})}
    one = room(
        "a",
        0,
        wall={"east": own, "south": {"apertures": [{**WINDOW, **modified("pane")}]}},
        properties={"radiance": {"modifier_set": "s"}},
    )
    light = {
        "modifiers": [GREY, GLASS],
        "modifier_sets": sets,
        "global_modifier_set": {"floor_set": {"interior_modifier": "paint"}},
    }
    scene = load(rooms=[one, room("b", 9)], properties={"radiance": light})
    wall = scene.reflectance[scene.surface == scene.names.index("wall/a_east")][0]
    np.testing.assert_allclose(wall, [0.3, 0.1, 0.3])
    assert of(scene, "wall/a_south", "reflectance") == 0.3
    assert of(scene, "wall/b_south", "reflectance") == 0.5
    assert of(scene, "floor/b_floor", "reflectance") == 0.3
    assert of(scene, "aperture/w", "transmittance") == pytest.approx(0.846, abs=0.001)


def test_of_two_faces_between_rooms_one_is_there_with_both_reflectances(load):
    def between(mine, other, **more):
        name = f"{mine[0]}w"
        opening = object_of(
            name,
            (4, 1, 1),
            (4, 2, 1),
            (4, 2, 2),
            (4, 1, 2),
            boundary_condition={"type": "Surface", "boundary_condition_objects": [f"{other[0]}w"]},
        )
        condition = {"type": "Surface", "boundary_condition_objects": [other, other[0]]}
        return {"boundary_condition": condition, "apertures": [opening], **more}

    rooms = [
        room("a", 0, wall={"east": between("a_east", "b_west", **modified(GREY))}),
        room(
            "b",
            4,
            wall={
                "west": between(
                    "b_west", "a_east", **modified({**GREY, "r_reflectance": 0.6, "g_reflectance": 0.6, "b_reflectance": 0.6})
                )
            },
        ),
    ]
    scene = load(rooms=rooms)
    assert "wall/b_west" not in scene.names
    assert "aperture/bw" not in scene.names
    assert of(scene, "wall/a_east", "reflectance") == 0.3
    assert of(scene, "wall/a_east", "back_reflectance") == 0.6  # its back looks into the second room
    assert areas(scene)["wall/a_east"] == pytest.approx(8)
    assert of(scene, "aperture/aw", "transmittance") == pytest.approx(0.8056, abs=1e-4)  # 0.88 straight on


def test_air_boundaries_are_not_there_and_shades_may_be_meshes_in_any_unit(load):
    one = room("r", 0)
    one["faces"][1]["face_type"] = "AirBoundary"
    mesh = {"vertices": loop((0, 0, 9), (2, 0, 9), (2, 2, 9), (0, 2, 9)), "faces": [[0, 1, 2, 3]]}
    scene = load(units="Feet", rooms=[one], shade_meshes=[{"identifier": "m", "geometry": mesh}])
    assert "wall/r_east" not in scene.names
    assert areas(scene)["shade/m"] == pytest.approx(4 * 0.3048**2)


def test_what_is_taken_in_another_way_is_told(load):
    outside = object_of("w", (3, 0, 1), (5, 0, 1), (5, 0, 2), (3, 0, 2))
    bsdf = {"type": "BSDF", "identifier": "blind"}
    walls = {
        "south": {"apertures": [outside]},
        "north": modified("nobody"),
        "east": modified(bsdf),
        "west": modified({"type": "Void"}),
    }
    lamps = [{"identifier": "lamp"}]
    with pytest.warns(rd.RadiosityWarning) as found:
        scene = load(rooms=[room("r", 0, wall=walls)], properties={"radiance": {"luminaires": lamps}})
    said = "\n".join(str(one.message) for one in found)
    assert "modifiers that the model does not define: 'nobody'" in said
    assert "materials that are not read, taken as if there were none: 'blind (BSDF)'" in said
    assert "surfaces whose modifier is void are invisible, and left out: 'wall/r_west'" in said
    assert "windows and doors overlap or reach out of their wall" in said
    assert "luminaires are left out" in said
    assert "wall/r_west" not in scene.names


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "is no JSON"),
        ('{"type": "Room"}', "holds 'Room' and no honeybee Model"),
        ('{"type": "Model", "rooms": [{"identifier": "r"}]}', "rooms 1, faces: Field required"),
        ('{"type": "Model", "units": "Miles"}', "units: Input should be"),
        ('{"type": "Model"}', "the file holds no faces"),
    ],
)
def test_a_file_that_is_no_model_is_an_error(tmp_path, text, message):
    (tmp_path / "m.hbjson").write_text(text)
    with pytest.raises(rd.SceneError, match=message):
        rd.load_scene(tmp_path / "m.hbjson")


def test_a_toml_names_windows_by_a_pattern(load, tmp_path):
    load(rooms=[room("r", 0, wall={"south": {"apertures": [WINDOW]}})])
    text = 'geometry = "m.hbjson"\n[[surface]]\nname = "aperture/*"\ntransmittance = 0.5\nreflectance = 0\n'
    text += '[sky]\ntype = "cie-overcast"\nhorizontal = 10000\nopenings = ["aperture/*"]\n'
    (tmp_path / "x.toml").write_text(text)
    scene = rd.load_scene(tmp_path / "x.toml")
    assert of(scene, "aperture/w", "transmittance") == 0.5
    np.testing.assert_allclose(scene.lights.openings.mean(axis=(0, 1)), [2, 0, 1.5])
