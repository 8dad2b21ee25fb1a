"""Reflectance and emission of painted patches: area means whatever their size, with colours, limits and two sides."""

import json
from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.errors import RadiosityWarning
from radiosity.scene import Back, image_means
from radiosity.scene.assemble import Material, Part, ReadOptions, assemble
from radiosity.scene.paint import Paint
from radiosity.scene.ramp import mean_below
from radiosity.scene.sampler import DEFAULT_SAMPLER, Sampler

SQUARE = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)]
CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
HALVES = [(0, 1, 2, -1), (0, 2, 3, -1)]


def generator(seed):
    return np.random.Generator(np.random.Philox(seed))


def scene_of(faces, reflectance=0.5, emission=1.0, **rest):
    return rd.Scene.from_arrays(SQUARE, faces, np.atleast_2d(reflectance), np.atleast_2d(emission), **rest)


def painted(faces, image, uv, sampler=DEFAULT_SAMPLER, color=None, limit=np.inf, **rest):
    """A scene whose faces have an image, at texture coordinates (4, 2) of the square's corners, or colours (4, n) of them."""
    scene = scene_of(faces, **rest)
    n, corner = scene.n_faces, np.where(scene.faces < 0, scene.faces[:, [2]], scene.faces)
    bands = scene.n_bands
    colors = np.ones((n, 4, bands), np.float32) if color is None else np.asarray(color, np.float32).reshape(4, -1)[corner]
    images = () if image is None else (np.broadcast_to(image, (*image.shape[:2], bands)).astype(np.float32),)
    which = np.full(n, -1 if image is None else 0, np.int32)
    return scene, Paint(
        images, which, np.asarray(uv, np.float32)[corner], np.broadcast_to(colors, (n, 4, bands)), limit, (sampler,) * len(images)
    )


def mean_of(scene, quantity="reflectance", **cut):
    patches = rd.subdivide(scene, **cut)
    value = getattr(patches, quantity)
    return (value * patches.area[:, None]).sum(axis=0) / patches.area.sum()


LAMP = np.zeros((16, 16, 1), np.float32)
LAMP[4:8, 4:8] = 16


@pytest.mark.parametrize("faces", [[(0, 1, 2, 3)], HALVES], ids=["quad", "triangles"])
@pytest.mark.parametrize("tiles", [(1, 1), (7, 3), (180, 144), (1000, 800)])
@pytest.mark.parametrize("turn", [0, 90])
def test_the_power_of_a_lamp_is_that_of_its_image(faces, tiles, turn):
    """Whole tiles: the image's mean, at any patch size. Look-ups in a regular grid may all miss the bright part."""
    uv = CORNERS * tiles
    uv = uv[:, ::-1] if turn else uv
    scene, paint = painted(faces, LAMP, uv)
    scene = replace(scene, emission_paint=paint)
    for cut in ({"cells": 1}, {"cells": 3}, {"cells": 8}, {"size": 0.3}):
        assert mean_of(scene, "emission", **cut) == pytest.approx([1.0], rel=1e-6)


@pytest.mark.parametrize("tiling", [0.4, 3.3, 217.0])
def test_power_does_not_depend_on_the_patch_size(tiling):
    turn = np.array([[np.cos(1.1), np.sin(1.1)], [-np.sin(1.1), np.cos(1.1)]])
    uv = CORNERS * tiling @ turn + 0.37
    for sampler in (Sampler(), Sampler(("clamp", "mirror"), "nearest"), Sampler(("mirror", "repeat"))):
        image = generator(1).random((33, 20, 1)) ** 4
        found = []
        for faces in ([(0, 1, 2, 3)], HALVES):
            scene, paint = painted(faces, image, uv, sampler)
            found += [mean_of(replace(scene, emission_paint=paint), "emission", cells=cells) for cells in (1, 2, 7)]
        np.testing.assert_allclose(found, np.broadcast_to(found[0], np.shape(found)), rtol=1e-5)


def test_colours_times_an_image_is_the_mean_of_the_product():
    """Also where both grow the same way, so that the product of the means is 1/3 too small."""
    ramp = np.linspace(0, 1, 16)[None, :, None]
    color = np.array([0.0, 1.0, 1.0, 0.0])
    for faces in ([(0, 1, 2, 3)], HALVES):
        for tiles in (1, 10):
            middles = (np.arange(16 * tiles) + 0.5) / (16 * tiles)  # of texels, where a colour is its mean over them
            expected = (np.tile(ramp.ravel(), tiles) * middles).mean()
            scene, paint = painted(faces, ramp, CORNERS * (tiles, 1), Sampler(("repeat", "repeat"), "nearest"), color)
            for cells in (1, 5):
                found = mean_of(replace(scene, reflectance_paint=paint), cells=cells)
                assert found == pytest.approx([0.5 * expected], rel=1e-5)


def test_limits_do_not_depend_on_the_patch_size():
    image = np.array([[[0.2, 0.2], [1.0, 0.5]]])  # in one band one of the texels is too bright
    scene, paint = painted(
        [(0, 1, 2, 3)], image, CORNERS, Sampler(filter="nearest"), limit=0.6, reflectance=[0.8, 0.8], emission=[1, 1]
    )
    color = np.array([0.0, 1.0, 1.0, 0.0])
    ramps = [painted(faces, None, CORNERS, color=color, limit=0.6, reflectance=0.9) for faces in ([(0, 1, 2, 3)], HALVES)]
    for cells in (1, 2, 3, 16):
        found = mean_of(replace(scene, reflectance_paint=paint), cells=cells)
        np.testing.assert_allclose(found, [(0.16 + 0.6) / 2, (0.16 + 0.4) / 2], rtol=1e-7)
        for ramp, colors in ramps:
            found = mean_of(replace(ramp, reflectance_paint=colors), cells=cells)
            np.testing.assert_allclose(found, 0.9 * 0.5 - 0.9 * (1 / 3) ** 2 / 2, rtol=1e-7)
    for bright in (1, 2):
        both, paint = painted(
            [(0, 1, 2, 3)], image[:, :, :1], CORNERS, Sampler(filter="nearest"), bright * color, 0.6, reflectance=0.8 / bright
        )
        for cells in (1, 4, 32):  # texels of 0.16 and 0.6 where the colour is brightest
            found = rd.subdivide(replace(both, reflectance_paint=paint), cells=cells).reflectance
            np.testing.assert_allclose(found.mean(), 0.16 / 8 + 0.6 * 3 / 8, rtol=1e-3)


@pytest.mark.parametrize("base", [(1.0,), (0.98,), (2.0,), (1.0, 0.5, 0.96)])
@pytest.mark.parametrize("limit", [0.95, 0.6])
def test_white_faces_are_limited(base, limit):
    """A colour of 1 at all corners, as programs write it for what nobody has painted, beside coloured faces or alone."""
    corners = np.array([*SQUARE, *SQUARE], float)
    red = np.array([[1, 1, 1]] * 4 + [[1, 0.2, 0.2]] * 4, float)
    for faces, color in (([(0, 1, 2, 3), (4, 5, 6, 7)], red), ([(0, 1, 2, 3)], red[:, :1]), (HALVES, red[:, :1])):
        part = Part("wall", corners, np.array(faces), Material(base), color=color)
        with pytest.warns(RadiosityWarning, match="brought down"):
            scene = assemble([part], "x", ReadOptions(max_reflectance=limit))
        found = rd.subdivide(scene, cells=1).reflectance
        np.testing.assert_allclose(found[0], np.broadcast_to(np.minimum(base, limit), found[0].shape), rtol=1e-6)
        if color is red:
            np.testing.assert_allclose(found[-1], np.minimum(np.array(base) * red[-1], limit), rtol=1e-6)


def test_bands_of_large_images_one_after_another(monkeypatch):
    image = generator(2).random((5, 4, 3))
    scene, paint = painted(
        HALVES,
        image,
        CORNERS * 1.3,
        color=generator(3).random((4, 3)),
        limit=0.4,
        reflectance=[0.5, 0.9, 0.2],
        emission=[1, 1, 1],
    )
    scene = replace(scene, reflectance_paint=paint)
    together = rd.subdivide(scene, cells=4).reflectance
    monkeypatch.setattr(image_means, "AT_ONCE", 1)
    np.testing.assert_allclose(rd.subdivide(scene, cells=4).reflectance, together, rtol=1e-12)


def test_means_of_ramps_that_are_cut_off(random):
    corners = random.random((200, 3, 1))
    corners[:20, 1] = corners[:20, 0]
    corners[20:30] = corners[20:30, :1]
    u, v = generator(1).random((2, 200_000))
    u, v = np.where(u + v > 1, [1 - u, 1 - v], [u, v])
    for corner, limit in zip(corners, np.linspace(0, 1, 200), strict=True):
        values = np.minimum(corner[0] + (corner[1] - corner[0]) * u + (corner[2] - corner[0]) * v, limit)
        error = values.std() / np.sqrt(len(u))
        assert mean_below(corner[None], limit)[0, 0] == pytest.approx(values.mean(), abs=5 * error + 1e-12)


def test_backs_of_another_colour_have_their_own_limit():
    image = np.array([[[0.2], [1.0]]])
    scene, paint = painted([(0, 1, 2, 3)], image, CORNERS, Sampler(filter="nearest"), limit=0.6, two_sided=True)
    scene = replace(scene, back_reflectance=np.array([[0.9]]), reflectance_paint=paint)
    patches = rd.subdivide(scene, cells=4)
    assert (scene.back == Back.RADIATES).all()
    front, back = (patches.reflectance[patches.is_back == side, 0].reshape(4, 4) for side in (False, True))
    np.testing.assert_allclose(front, np.tile([0.1, 0.1, 0.5, 0.5], (4, 1)))
    np.testing.assert_allclose(back, np.tile([0.18, 0.18, 0.6, 0.6], (4, 1)))


def test_many_images_and_faces_keep_their_places():
    """Images of one texel and colours of one value: the product, in the order of the patches, backs included."""
    random = generator(6)
    room = rd.load_scene("room")
    n = room.n_faces
    images = tuple(random.random((1, 1, 1)).astype(np.float32) for _ in range(3))
    color = np.broadcast_to(random.random((n, 1, 1)), (n, 4, 1)).astype(np.float32)
    paint = Paint(images, np.arange(n, dtype=np.int32) % 4 - 1, random.random((n, 4, 2)).astype(np.float32), color)
    patches = rd.subdivide(replace(room, reflectance_paint=paint), size=1.0)
    factor = [1.0, *(float(image.item()) for image in images)]
    base = np.where(patches.is_back, room.back_reflectance[patches.face, 0], room.reflectance[patches.face, 0])
    expected = base * color[patches.face, 0, 0] * np.array(factor)[paint.image[patches.face] + 1]
    np.testing.assert_allclose(patches.reflectance[:, 0], expected, rtol=1e-6)


def test_texture_coordinates_that_are_not_linear_over_a_parallelogram():
    """A file's quadrilateral is cut in two, as other programs do; one that is not is taken as it is, by small parts."""
    ramp = np.linspace(0.1, 0.9, 64)[None, :, None]
    uv = np.array([(0.1, 0), (0.3, 0), (0.9, 1), (0.1, 1)])
    part = Part(
        "s",
        np.array(SQUARE, float),
        np.array([(0, 1, 2, 3)]),
        Material((0.5,)),
        uv,
        texture=ramp,
        sampler=Sampler(("clamp", "clamp")),
    )
    scene = assemble([part], "test", ReadOptions())
    assert scene.is_quad.tolist() == [False, False]
    assert {tuple(face) for face in scene.faces[:, :3].tolist()} == {(0, 1, 2), (0, 2, 3)}

    def value(u):
        return 0.1 + 0.8 * (u * 64 - 0.5) / 63

    for cells in (1, 4):
        expected = 0.5 * (value((0.1 + 0.3 + 0.9) / 3) + value((0.1 + 0.9 + 0.1) / 3)) / 2
        assert mean_of(scene, cells=cells) == pytest.approx([expected], rel=1e-6)
    whole, paint = painted([(0, 1, 2, 3)], ramp, uv, Sampler(("clamp", "clamp")))
    for cells in (1, 4):
        assert mean_of(replace(whole, reflectance_paint=paint), cells=cells) == pytest.approx([0.5 * value(0.35)], rel=1e-3)
    straight = replace(part, uv=CORNERS)
    assert assemble([straight], "test", ReadOptions()).is_quad.tolist() == [True]


def test_halves_that_are_nearly_linear_are_one_face_only_in_proportion_to_their_extent():
    """A hundredth of a small region of an atlas is not nothing, and neither is a tenth of a tile of many."""
    image = np.full((2, 2, 1), 0.5)

    def faces(uv):
        part = Part("s", np.array(SQUARE, float), np.array(HALVES)[:, :3], Material((0.5,)), np.array(uv), texture=image)
        return assemble([part], "test", ReadOptions()).n_faces

    small, many = CORNERS * 1e-3 + 0.4, CORNERS * 900
    assert (faces(small), faces(many)) == (1, 1)
    bent = np.array([(0, 0), (0, 0), (1, 0), (0, 0)])
    assert faces(small + 1e-5 * bent) == 2
    assert faces(many + 0.1 * bent) == 2


def test_coordinates_far_away_are_moved_near():
    """A map's coordinates of 1e6 keep their fractions, which single precision would lose."""
    image = np.array([[[0.1], [0.9]]])
    for shift in (0.0, 1e6, -3e6):
        uv = CORNERS * 0.1 + (0.3 + shift, shift)
        part = Part(
            "s",
            np.array(SQUARE, float),
            np.array([(0, 1, 2, 3)]),
            Material((0.9,)),
            uv,
            texture=image,
            sampler=Sampler(("repeat", "mirror"), "nearest"),
        )
        scene = assemble([part], "test", ReadOptions())
        assert mean_of(scene, cells=1) == pytest.approx([0.09], rel=1e-5)


def test_old_files_repeat_and_are_linear(tmp_path):
    image = generator(3).random((4, 4, 1))
    _, paint = painted([(0, 1, 2, 3)], image, CORNERS * 1.5)
    light = rd.Scene.from_arrays(
        [*SQUARE, *((x, y, 1) for x, y, _ in SQUARE)], [(0, 1, 2, 3), (4, 7, 6, 5)], np.full((2, 1), 0.5), [[0.0], [1.0]]
    )
    both = Paint(
        paint.images,
        np.array([0, -1], np.int32),
        np.repeat(paint.uv, 2, axis=0),
        np.ones((2, 4, 1), np.float32),
        0.95,
        paint.samplers,
    )
    solution = rd.solve(rd.subdivide(replace(light, reflectance_paint=both), cells=2), "random-walk", quanta=1000)
    solution.save(tmp_path / "new.npz")
    with np.load(tmp_path / "new.npz") as file:
        arrays = {name: file[name] for name in file.files}
    meta = json.loads(str(arrays["meta"]))
    assert meta["paints"]["reflectance_paint"].pop("samplers") == [{"wrap": ["repeat", "repeat"], "filter": "linear"}]
    np.savez(tmp_path / "old.npz", **arrays | {"meta": np.array(json.dumps(meta))})
    old = rd.load_solution(tmp_path / "old.npz")
    assert old.patches.scene.hash == solution.patches.scene.hash
    assert old.patches.scene.reflectance_paint.sampler(0) == Sampler()
    np.testing.assert_array_equal(old.patches.reflectance, solution.patches.reflectance)
    for wrong in (
        [{"wrap": ["repeat", "around"], "filter": "linear"}],
        [{"wrap": ["clamp"], "filter": "linear"}],
        3 * [{}],
        2 * [{"wrap": ["clamp", "clamp"], "filter": "linear"}],
    ):
        meta["paints"]["reflectance_paint"]["samplers"] = wrong
        np.savez(tmp_path / "wrong.npz", **arrays | {"meta": np.array(json.dumps(meta))})
        with pytest.raises(rd.SceneError, match="or damaged"):
            rd.load_solution(tmp_path / "wrong.npz")


def test_points_are_looked_up_by_wrap_and_filter():
    image = np.array([[[0.0], [1.0]], [[2.0], [3.0]]])  # the first row is the upper one
    points = np.array([(0.25, 0.75), (1.25, 0.75), (-0.1, 0.75), (0.5, 0.5), (0.25, 1.2)])
    u, v = points.T
    quad = np.ones(len(points), bool)
    expected = {
        Sampler(): [0, 0, 0.7, 1.5, 1.8],
        Sampler(("clamp", "clamp")): [0, 1, 0, 1.5, 0],
        Sampler(("mirror", "mirror")): [0, 1, 0, 1.5, 0],
        Sampler(("repeat", "clamp"), "nearest"): [0, 0, 1, 3, 0],
        Sampler(("mirror", "repeat"), "nearest"): [0, 1, 0, 3, 2],
    }
    for sampler, values in expected.items():
        _, paint = painted([(0, 1, 2, 3)], image, CORNERS, sampler)
        found = paint.factor(np.zeros(len(points), int), u, v, quad)[:, 0]
        np.testing.assert_allclose(found, values, atol=1e-6, err_msg=str(sampler))
