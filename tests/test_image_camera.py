"""Pinhole cameras, given and fitted."""

import numpy as np
import pytest
from image_samples import plain_hits, quad_scene

import radiosity as rd
from radiosity.image import fit, view
from radiosity.image.standing import face_at, tell_of_nothing
from radiosity.scene.shapes import box, join
from radiosity.scene.up import up_axis

FRONT = rd.Camera((0, -5, 0), (0, 0, 0), (0, 0, 1), 90.0, 200, 100)


def test_a_known_corner_falls_on_its_pixel():
    # 5 m ahead the picture is 10 m high and 20 m wide
    points = [[0, 0, 0], [10, 0, 5], [-10, 0, -5], [2, 0, 1], [0, -10, 0]]
    seen = view.project(FRONT, points)
    np.testing.assert_allclose(seen[:4, :2], [[100, 50], [200, 0], [0, 100], [120, 40]], atol=1e-9)
    np.testing.assert_allclose(seen[:, 2], [5, 5, 5, 5, -5])


def test_the_cornell_box_fills_its_picture_with_red_on_the_left():
    scene = rd.load_scene("cornell-box")
    camera = scene.cameras[0]
    left = scene.names.index("left wall")
    corners = scene.vertices[scene.faces[scene.surface == left][:, :3]].reshape(-1, 3)
    x, y, _ = view.project(camera, corners).T
    assert x.max() < 200
    assert 0 < x.min() < 20
    assert 5 < y.min() < 20
    assert 580 < y.max() < 595


def test_directions_and_projection_are_inverse(random):
    camera = rd.Camera((1, 2, 3), (4, -1, 2), (0.1, 0.2, 1), 55.0, 320, 200)
    x, y = random.random((2, 50)) * [[320], [200]]
    rays = view.directions(camera, x, y)
    np.testing.assert_allclose(np.linalg.norm(rays, axis=1), 1)
    np.testing.assert_allclose(view.project(camera, camera.origin + 7 * rays)[:, :2], np.stack([x, y], axis=1), atol=1e-9)


def test_looking_along_up_still_makes_a_picture():
    right, up, forward = view.axes(rd.Camera((0, 0, 5), (0, 0, 0)))
    np.testing.assert_allclose(np.stack([right, up, forward]) @ np.stack([right, up, forward]).T, np.eye(3), atol=1e-12)


@pytest.mark.parametrize(
    ("camera", "message"),
    [
        (rd.Camera((0, 0, 0), (0, 0, 0)), "origin and target"),
        (rd.Camera((0, 0, np.nan), (0, 0, 0)), "finite"),
        (rd.Camera((0, 0, 1), (0, 0, 0), fov=180), "180"),
        (rd.Camera((0, 0, 1), (0, 0, 0), width=0), "0 x 600"),
        (rd.Camera((0, 0, 1), (0, 0, 0), height=10**6, width=10**6), "more than"),
    ],
)
def test_impossible_cameras_are_refused(camera, message):
    with pytest.raises(rd.SceneError, match=message):
        view.check(camera)


def test_up_is_that_of_the_camera_then_of_the_floors_then_of_the_format():
    assert up_axis(rd.load_scene("cornell-box")) == "y"
    assert up_axis(rd.load_scene("room")) == "z"
    assert up_axis(quad_scene(source="x.glb")) == "z"
    cube = box((0, 0, 0), (1, 1, 1))
    assert [up_axis(join([("a", 0.5, 0.0, cube)], source=source)) for source in ("x.glb", "x.mgf")] == ["y", "z"]


@pytest.mark.parametrize(
    ("floors", "source", "up"),
    [
        ((50, 1.0, 1.4), "x.obj", "z"),  # clearly more area across z than across y, whatever stands across x
        ((0, 1.0, 1.4), "x.obj", "z"),
        ((50, 1.0, 1.2), "x.obj", "y"),  # not clearly: what is usual in the format
        ((50, 1.4, 1.0), "x.obj", "y"),
        ((50, 1.4, 1.0), "x.mgf", "y"),
        ((0, 1.4, 1.0), "x.mgf", "y"),
        ((50, 1.2, 1.0), "x.mgf", "z"),
        ((50, 1.0, 1.4), "x.mgf", "z"),
    ],
)
def test_up_is_where_clearly_more_floors_are(floors, source, up):
    """Squares across x, y and z of so many square metres."""
    quads = []
    for axis, area in enumerate(floors):
        if area:
            one, other = np.roll(np.eye(3), axis + 1, axis=1)[:2] * np.sqrt(area)
            quads.append([10 * np.eye(3)[axis] + p for p in (0 * one, one, one + other, other)])
    scene = rd.Scene.from_arrays(np.concatenate(quads), np.arange(4 * len(quads)).reshape(-1, 4), 0.5, 0.0, source=source)
    assert set(np.abs(scene.normal).argmax(axis=1)) == {axis for axis, area in enumerate(floors) if area}
    assert up_axis(scene) == up


def light(patches):
    return np.ones(len(patches))


def test_a_closed_room_is_seen_from_inside(cube):
    camera = fit.fitted(rd.subdivide(cube, cells=2), np.ones(24), plain_hits, width=64, height=48)
    assert (np.array(camera.origin) > 0).all()
    assert (np.array(camera.origin) < 1).all()
    assert (camera.width, camera.height) == (64, 48)


def test_an_object_is_seen_from_outside_and_whole():
    scene = join([(str(i), 0.5, 0.0, [face]) for i, face in enumerate(box((0, 0, 0), (1, 2, 3)))], source="block")
    patches = rd.subdivide(scene, cells=1)
    for width, height in ((64, 48), (30, 90)):
        camera = fit.fitted(patches, np.ones(len(patches)), plain_hits, width=width, height=height)
        x, y, depth = view.project(camera, scene.vertices).T
        assert depth.min() > 0
        assert x.min() >= 0
        assert x.max() <= width
        assert y.min() >= 0
        assert y.max() <= height
        assert max(np.ptp(x) / width, np.ptp(y) / height) > 0.5


@pytest.mark.parametrize(
    ("point", "face"),
    [
        ((0.5, 0.5, 0.0), 0),  # on the square
        ((1.0, 1.0, 1e-8), 0),  # its corner, within rounding
        ((1.01, 0.5, 0.0), None),  # in its plane, beside it
        ((0.5, 0.5, 0.001), None),  # a millimetre in front
        ((2.25, 0.25, 5.0), 1),  # on the triangle
        ((2.75, 0.75, 5.0), None),  # beyond its long edge
    ],
)
def test_which_face_a_point_lies_on(point, face):
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 5], [3, 0, 5], [2, 1, 5]]
    scene = rd.Scene.from_arrays(vertices, [[0, 1, 2, 3], [4, 5, 6, -1]], 0.5, 1.0)
    assert face_at(scene, point) == face


def test_cameras_that_stand_in_a_face_or_see_nothing_are_told(cube, recwarn):
    nothing, something = np.zeros((3, 4)), np.eye(3, 4)
    middle = (0.5, 0.5, 0.5)
    with pytest.warns(rd.RadiosityWarning, match=r"camera at \(0.5, 0, 0.5\) stands in a face of"):
        tell_of_nothing(cube, rd.Camera((0.5, 0.0, 0.5), middle), something)
    with pytest.warns(rd.RadiosityWarning, match="picture is empty"):
        tell_of_nothing(cube, rd.Camera((5, 5, 5), (6, 6, 6)), nothing)
    recwarn.clear()
    tell_of_nothing(cube, rd.Camera((0.5, 0.001, 0.5), middle), something)
    tell_of_nothing(cube, rd.plan(cube, cut=1.0), something)
    assert not recwarn.list
