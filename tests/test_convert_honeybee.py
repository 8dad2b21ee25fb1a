"""Scenes written as honeybee models read back with the same sides, and honeybee itself takes them for the same light."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from test_convert import again, scenes
from test_convert_programs import LUMENS, RGB, middles, seen, stack

import radiosity as rd

pytest.importorskip("pydantic")
DARK = (0.0, 0.0, 0.0)


@given(scenes())
@hypothesis_settings(max_examples=10, deadline=None)
def test_sides_read_back(tmp_path_factory, scene):
    """But for what lamps reflect and let through, which is told."""
    read, told = again(scene, tmp_path_factory.mktemp("scene") / "x.hbjson")
    text, times = "\n".join(told), 1 / LUMENS if scene.photometric else 1
    turned = "is turned" in text
    assert {name.removesuffix(" (back)") for name in read.names} == set(scene.names)
    if turned:
        read = rd.Scene.from_arrays(
            read.vertices[:, [0, 2, 1]] * [1, 1, -1],
            read.faces,
            read.reflectance,
            read.emission,
            back=read.back,
            transmittance=read.transmittance,
            bands=read.bands,
        )
    for i, (middle, normal) in enumerate(zip(middles(scene), scene.normal, strict=True)):
        for sign in (1, -1)[: 2 if scene.back[i] == rd.Back.RADIATES else 1]:
            one, other = seen(scene, middle, sign * normal), seen(read, middle, sign * normal)
            assert np.broadcast_to(other[0], one[0].shape) == pytest.approx(one[0] * times, rel=1e-9, abs=1e-12)
            if not one[0].any():
                assert other[2] == pytest.approx(one[2], rel=1e-9)
                if "one colour" not in text:
                    assert np.broadcast_to(other[1], one[1].shape) == pytest.approx(one[1], rel=1e-9, abs=1e-12)
            else:
                assert not other[1].any()
                assert not one[1].any() or "become black" in text
                assert one[2] == 0 or "panes that shine become opaque" in text


def rows(count: int, **values) -> rd.Scene:
    """Squares of 1 m² side by side, of which names and values are given."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    corners = (square + np.array([[3.0 * i - 4, -2, i] for i in range(count)])[:, None]).reshape(-1, 3)
    faces = np.arange(4 * count).reshape(count, 4)
    return rd.Scene.from_arrays(corners, faces, surface=range(count), bands=RGB, **values)


def panes() -> rd.Scene:
    """A pane, glass, a sheet that diffuses, one that also lets light straight on, a wall of two colours, and a lamp."""
    reflectance = [(0.1,) * 3, DARK, (0.2, 0.3, 0.1), (0.1,) * 3, (0.5, 0.4, 0.3), DARK]
    return rows(
        6,
        reflectance=reflectance,
        emission=[*([DARK] * 5), (900.0, 500.0, 100.0)],
        names=["Glas süd", "glas_sud", "black", "void", "wall/x", "lampe 1"],
        back=[1, 1, 1, 1, 1, 0],
        back_reflectance=[*reflectance[:4], (0.1, 0.4, 0.8), DARK],
        transmittance=[0.5, 0.7, 0, 0.2, 0, 0],
        refractive_index=[0, 1.52, 0, 0, 0, 0],
        diffuse_transmittance=[DARK, DARK, (0.1, 0.15, 0.05), (0.3,) * 3, DARK, DARK],
    )


def test_panes_glass_and_names_are_kept(tmp_path):
    scene = panes()
    read, told = again(scene, tmp_path / "x.hbjson")
    assert read.names == (*scene.names[:5], "wall/x (back)", "lampe 1")
    of = [0, 1, 2, 3, 4, 6]
    for key in ("reflectance", "emission", "diffuse_transmittance", "transmittance", "refractive_index", "back"):
        assert getattr(read, key)[of] == pytest.approx(getattr(scene, key), rel=1e-9, abs=1e-12), key
    assert middles(read)[of] == pytest.approx(middles(scene), abs=0)
    assert read.normal[of] == pytest.approx(scene.normal, abs=0)
    assert read.reflectance[5] == pytest.approx((0.1, 0.4, 0.8))
    assert (middles(read)[5] - middles(read)[4]) @ scene.normal[4] < 0
    assert [text for text in told if "x.hbjson: sides that differ" in text and "'wall/x'" in text]
    assert len(told) == 2  # the other one is that glass is not diffuse
    model = json.loads((tmp_path / "x.hbjson").read_text())
    assert (len(model["orphaned_apertures"]), len(model["orphaned_shades"])) == (4, 3)
    objects = [*model["orphaned_apertures"], *model["orphaned_shades"]]
    ids = [one["identifier"] for one in (*objects, *model["properties"]["radiance"]["modifiers"])]
    assert len(set(ids)) == len(ids)
    assert all(re.fullmatch(r"[.A-Za-z0-9_-]{1,100}", one) for one in ids)
    assert not {"black", "void"} & {one["properties"]["radiance"]["modifier"] for one in objects}
    assert model["units"] == "Meters"


def test_shares_that_differ_from_band_to_band_keep_their_luminance(tmp_path):
    values = {"reflectance": (0.1, 0.2, 0.3), "diffuse": (0.4, 0.3, 0.1), "transmittance": 0.2}
    scene = stack(pane=values)
    read, told = again(scene, tmp_path / "x.hbjson")
    assert any("panes reflect, diffuse and let through one colour" in text and "'pane'" in text for text in told)
    from radiosity.scene.formats.color import luminance_weights

    weights, row = luminance_weights(), read.names.index("pane")
    assert read.transmittance[row] == pytest.approx(0.2)
    assert weights @ read.reflectance[row] == pytest.approx(weights @ values["reflectance"])
    assert weights @ read.diffuse_transmittance[row] == pytest.approx(weights @ values["diffuse"])


@pytest.mark.parametrize("front", [(30.0, 20.0, 10.0), DARK])
@pytest.mark.parametrize("behind", [(1.0, 2.0, 4.0), DARK])
def test_both_sides_of_a_lamp_stay_what_they_are(front, behind, tmp_path):
    """Where a side shines it is black, and that is told; where it does not it reflects what it did."""
    if not (any(front) or any(behind)):
        return
    colour, other = (0.5, 0.25, 0.75), (0.2, 0.6, 0.1)
    scene = stack(emission=front, back_emission=behind, reflectance=colour, back=rd.Back.RADIATES)
    scene = replace(scene, back_reflectance=np.array([other]))
    read, told = again(scene, tmp_path / "x.hbjson")
    for sign, light in ((1, front), (-1, behind)):
        emission, reflectance, *_ = seen(read, middles(scene)[0], sign * scene.normal[0])
        assert emission == pytest.approx(light)
        assert reflectance == pytest.approx(DARK if any(light) else colour if sign > 0 else other)
    assert any("become black" in text for text in told)


def test_what_lines_pass_is_left_out_unless_it_shines(tmp_path):
    shining = stack(back=rd.Back.OPEN)
    read, told = again(shining, tmp_path / "x.hbjson")
    assert read.emission == pytest.approx(shining.emission)
    assert any("lamps that lines pass absorb what comes to them: 'lamp'" in text for text in told)
    both = rows(2, reflectance=[DARK, (0.5,) * 3], emission=0, names=["air", "wall"], back=[3, 1])
    read, told = again(both, tmp_path / "y.hbjson")
    assert read.names == ("wall",)
    assert any("left out: 'air'" in text for text in told)


def test_many_faces_are_a_mesh_and_a_scene_whose_y_is_up_stands_upright(tmp_path):
    scene = rd.load_scene("cornell-box")
    read, told = again(scene, tmp_path / "box.hbjson")
    assert any("z-up: the scene, whose y is up, is turned: 'cornell-box'" in text for text in told)
    behind = read.surface == read.names.index("light (back)")
    assert read.area[~behind].sum() == pytest.approx(scene.area.sum())
    height = np.ptp(scene.vertices, axis=0)[1]
    assert np.ptp(read.vertices, axis=0)[2] == pytest.approx(height, rel=1e-4)
    floor = read.surface == read.names.index("floor")
    assert read.normal[floor] == pytest.approx(np.array([[0, 0, 1]] * floor.sum()), abs=1e-6)
    block = next(one for one in json.loads((tmp_path / "box.hbjson").read_text())["shade_meshes"] if "tall" in one["identifier"])
    assert block["display_name"] == "tall block"
    assert len(block["geometry"]["faces"]) == (scene.surface == scene.names.index("tall block")).sum()


@pytest.mark.filterwarnings("ignore:.*not diffuse, taken by the diffuse albedo")
def test_honeybee_takes_the_model_for_the_same_light(tmp_path):
    honeybee = pytest.importorskip("honeybee.model", reason="needs honeybee-radiance, which is no part of the project")
    writer = pytest.importorskip("honeybee_radiance.writer", reason="needs honeybee-radiance, which is no part of the project")
    again(panes(), path := tmp_path / "x.hbjson")
    model = honeybee.Model.from_hbjson(str(path))
    assert model.check_all(raise_exception=False) == ""
    geometry, modifiers = writer.model_to_rad(model)
    (tmp_path / "x.rad").write_text(f"{modifiers}\n{geometry}\n")
    (tmp_path / "y.hbjson").write_text(json.dumps(model.to_dict()))
    first, *others = (rd.load_scene(tmp_path / name, max_reflectance=0.9999) for name in ("x.hbjson", "x.rad", "y.hbjson"))
    assert others[1].names == first.names
    for other in others:
        for key in ("reflectance", "emission", "diffuse_transmittance", "transmittance", "refractive_index", "area"):
            values = [np.sort(getattr(one, key), axis=0) for one in (first, other)]
            assert values[0] == pytest.approx(values[1], rel=1e-6), key
