"""What lies far away changes nothing here: a room beside a stray object, or on a plain, gives what it gives alone."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.device.backend import choose
from radiosity.diagnostics.check import check
from radiosity.image import render
from radiosity.scene.degenerate import without_area
from radiosity.scene.shapes import quad
from radiosity.tracing.first_hits import first_hits
from radiosity.tracing.geometry import Geometry

KILOMETRE = 1e3


def with_quads(scene: rd.Scene, name: str, quads) -> rd.Scene:
    """One surface more, of reflectance 1/2."""
    count, start = len(quads), len(scene.vertices)
    corners = start + np.arange(4 * count).reshape(count, 4)
    columns = {
        field: np.concatenate([getattr(scene, field), np.broadcast_to(value, (count, *getattr(scene, field).shape[1:]))])
        for field, value in (("reflectance", 0.5), ("emission", 0.0), ("back_reflectance", 0.5), ("back_emission", 0.0))
    }
    return rd.Scene.from_arrays(
        np.concatenate([scene.vertices, *quads]),
        np.concatenate([scene.faces, corners]),
        columns["reflectance"],
        columns["emission"],
        back=np.concatenate([scene.back, np.zeros(count, np.uint8)]),
        back_reflectance=columns["back_reflectance"],
        back_emission=columns["back_emission"],
        surface=np.concatenate([scene.surface, np.full(count, len(scene.names))]),
        names=(*scene.names, name),
    )


def stray(scene: rd.Scene, distance: float, size: float = 6.0) -> rd.Scene:
    """A square more, some way off along two axes, which faces up: of six metres, since an ulp at 1000 km is 12 cm."""
    return with_quads(scene, "stray", [quad((distance, distance, 0), (size, 0, 0), (0, size, 0))])


@pytest.fixture(scope="module")
def room():
    return rd.load_scene("room")


def irradiance(scene: rd.Scene, faces: int, method: str = "random-walk", **options) -> tuple[np.ndarray, np.ndarray]:
    """Of the first faces of a scene, and its standard errors."""
    solution = rd.solve(rd.subdivide(scene, cells=3), method, rays=100_000, seed=1, **options)
    rows = solution.patches.face < faces
    return solution.irradiance[rows, 0], solution.irradiance_standard_error[rows, 0]


@pytest.mark.parametrize("distance", [10 * KILOMETRE, 1000 * KILOMETRE])
def test_a_stray_object_leaves_the_room_as_it_is(room, distance):
    """As where the object stands 20 m off: the lines are the same, and only what is rounded at cells' edges may differ."""
    near, error = irradiance(stray(room, 20), room.n_faces)
    beside, _ = irradiance(stray(room, distance), room.n_faces)
    assert np.sqrt(np.mean(((beside - near)[error > 0] / error[error > 0]) ** 2)) < 0.05
    alone, other = irradiance(room, room.n_faces)
    # Student with 7 degrees of freedom for some 200 patches: beyond 8 in one of 200 000
    assert np.abs((beside - alone) / np.hypot(error, other))[error > 0].max() < 8


@pytest.mark.parametrize("method", ["particle-tracing", "stochastic-jacobi", "global-multipath-first-shot"])
def test_other_methods_beside_a_stray_object(room, method):
    options = {"lines": "spans"} if method.startswith("global") else {}
    alone, error = irradiance(room, room.n_faces, method, **options)
    beside, other = irradiance(stray(room, 1000 * KILOMETRE), room.n_faces, method, **options)
    # Student with 7 degrees of freedom for some 200 patches: beyond 8 in one of 200 000; lines may differ, as those of spans do
    assert np.abs((beside - alone) / np.hypot(error, other))[error > 0].max() < 8
    assert beside.mean() == pytest.approx(alone.mean(), rel=0.01)


def test_a_stray_object_at_a_thousand_kilometres_leaves_millimetres_apart():
    """A lamp one millimetre above a plate of as many millimetres: what the plate receives is the exact form factor."""
    from validation.closed_forms.rectangles import parallel

    size = 1e-3
    quads = [quad((0, 0, 0), (size, 0, 0), (0, size, 0)), quad((0, 0, size), (0, size, 0), (size, 0, 0))]
    far = quad((1000 * KILOMETRE, 0, 0), (100, 0, 0), (0, 100, 0))
    # walls of 100 m hold the median here
    walls = [quad((-50, -50, -0.1), (100, 0, 0), (0, 100, 0)), quad((-50, -50, 0.1), (0, 100, 0), (100, 0, 0))]
    quads = [*quads, *walls, far]
    scene = rd.Scene.from_arrays(np.concatenate(quads), np.arange(20).reshape(5, 4), 0.0, [1.0, 0, 0, 0, 0])
    assert scene.n_faces == 5
    solution = rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=200_000)
    assert solution.irradiance[1, 0] == pytest.approx(parallel(1, 1), abs=5 * solution.irradiance_standard_error[1, 0] + 1e-4)


@pytest.mark.filterwarnings("ignore:.*lamps shine on a face near:radiosity.RadiosityWarning")
def test_a_plain_of_a_hundred_kilometres_under_a_lamp_reflects_as_a_small_one():
    """Particles go on from where they land, 2 cm under the lamp; an ulp at the plain's corners is 4 mm."""
    received = []
    for half in (20.0, 5e4):
        ground = quad((-half, -half, 0), (2 * half, 0, 0), (0, 2 * half, 0))
        lamp = quad((-0.5, -0.5, 0.02), (0, 1, 0), (1, 0, 0))
        scene = rd.Scene.from_arrays(np.concatenate([ground, lamp]), np.arange(8).reshape(2, 4), [0.5, 0], [0, 1.0])
        solution = rd.solve(rd.subdivide(scene, cells=1), equation="continuous", order="depth-first", rays=200_000)
        assert solution.irradiance_standard_error[1, 0] < 0.003
        received.append(solution.irradiance[1, 0])
    assert received[0] > 0.4  # nearly all of what the plain reflects, a half
    assert received[1] == pytest.approx(received[0], abs=0.01)


def test_check_and_pictures_do_not_see_a_stray_object(room):
    beside = stray(room, 1000 * KILOMETRE)
    usual, now = check(room), check(beside)
    assert [(f.severity, f.kind) for f in now.findings] == [(f.severity, f.kind) for f in usual.findings]
    camera = rd.Camera((3, 0.5, 1.5), (3, 3.5, 1.2), (0, 0, 1), 60.0, 24, 16) if not room.cameras else room.cameras[0]
    pictures = []
    for scene in (room, beside):
        solution = rd.solve(rd.subdivide(scene, cells=3), "random-walk", rays=100_000, seed=1)
        pictures.append(render(solution, camera=replace(camera, width=24, height=16), scale=0.01).astype(int))
    assert np.abs(pictures[1] - pictures[0]).mean() < 1
    assert np.ptp(pictures[0]) > 50


def test_faces_are_judged_by_what_single_precision_holds_where_they_lie(room):
    """A face of 10 cm beside the room stays; at 1000 km, where an ulp is 6 cm, it is left out and told of."""
    small = [quad((0.5, 0.5, 0.5), (0.1, 0, 0), (0, 0.1, 0))]
    assert not without_area(with_quads(stray(room, 1000 * KILOMETRE), "small", small)).any()
    with pytest.warns(rd.RadiosityWarning, match="1 face without area left out .*'small'"):
        with_quads(room, "small", [small[0] + [1000 * KILOMETRE, 0, 0]])


def test_the_centre_is_the_median_of_area():
    squares = [quad((x, 0, 0), (1, 0, 0), (0, 1, 0)) for x in (0, 1, 2, 50, 1e6)]
    scene = rd.Scene.from_arrays(np.concatenate(squares), np.arange(20).reshape(5, 4), 0.5, 1.0)
    assert scene.centre.tolist() == [2.5, 0.5, 0.0]
    assert scene.reach == 1e6 + 1 - 2.5
    # the lower of two where half of the area lies on either side
    assert scene.take(np.arange(4)).centre.tolist() == [1.5, 0.5, 0.0]


def test_a_run_from_before_lines_began_elsewhere_is_not_gone_on_with(room):
    patches = rd.subdivide(room, cells=1)
    before = rd.solve(patches, "random-walk", quanta=64, replicates=2)
    old = replace(before, provenance={k: v for k, v in before.provenance.items() if k != "tracing"})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        rd.solve(patches, "random-walk", quanta=128, replicates=2, resume=before)
        with pytest.raises(rd.MethodError, match="cannot go on from that solution: tracing"):
            rd.solve(patches, "random-walk", quanta=128, replicates=2, resume=old)


def test_what_is_no_larger_than_an_ulp_where_it_lies_is_told_by_name(room):
    """A square metre at 1000 km, where an ulp is 12 cm: lines begin a metre in front of it."""
    far = with_quads(room, "pebble", [quad((1000 * KILOMETRE, 0, 0), (1, 0, 0), (0, 1, 0))])
    message = "1 face .*'pebble'.* is hardly larger than what single precision holds apart .*begin 0.954 m in front"
    with pytest.warns(rd.RadiosityWarning, match=message):
        rd.solve(rd.subdivide(far, cells=1), "random-walk", rays=20_000)
    (text,) = [f.message for f in check(far).findings if f.kind == "too small"]
    assert "'pebble'" in text


def test_global_lines_through_a_ball_that_is_nearly_empty_are_told_of_or_refused(room):
    patches = [rd.subdivide(stray(room, distance), cells=1) for distance in (100.0, 1000 * KILOMETRE)]
    with pytest.warns(rd.RadiosityWarning, match="lines 'global-disc'.* 'stray' lies far away; take lines 'spans' or 'local'"):
        rd.solve(patches[0], "global-multipath-first-shot", lines="global-disc", rays=20_000)
    with pytest.raises(rd.MethodError, match="'stray' lies far away"):
        rd.solve(patches[1], "global-multipath-first-shot", lines="global-disc", rays=20_000)


def test_lines_get_past_the_centre_of_a_face_that_they_begin_in():
    """Where the plane and the point are at the centre of coordinates all numbers are zero, and so would their rounding be. A line
    that passes a back went on from where it was, for ever."""
    scene = rd.Scene.from_arrays([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], 0.5, 1.0, back=[int(rd.Back.PASSES)])
    patches = rd.subdivide(scene, cells=1)
    assert np.array_equal(patches.centroid[0], scene.centre)
    assert (Geometry(patches, choose("cpu")).faces.plane_offsets > 0).all()
    hits = first_hits(scene, np.tile(scene.centre, (2, 1)), np.array([(0.1, 0.2, 1), (-0.3, 0.1, 2)]))
    assert hits.face.tolist() == [-1, -1]
    solution = rd.solve(patches, "progressive-refinement", resolution=2)
    assert solution.escaped[0] == pytest.approx(0.5)
