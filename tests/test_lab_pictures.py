"""Figures 1 to 3 of the paper: files, spans, and the numbers of the lines."""

import numpy as np
import pytest

pytest.importorskip("matplotlib")

import radiosity as rd
from radiosity.lab import pictures
from radiosity.lab.sample_lines import breadth_first, chords, crossings, depth_first, local_lines, nearest, spans, walks
from radiosity.lab.study import Protocol
from radiosity.scene import load_scene
from radiosity.scene.model import Back
from radiosity.tracing.first_hits import first_hits


@pytest.fixture(scope="module")
def room():
    return load_scene("room")


def check_written(paths, path):
    from PIL import Image

    assert paths == [path.with_suffix(".png"), path.with_suffix(".svg")]
    pixels = np.asarray(Image.open(paths[0]).convert("RGB"))
    assert pixels.shape[0] > 300
    assert 0.02 < (pixels < 250).any(axis=2).mean() < 0.98
    assert paths[1].read_text(encoding="utf-8").count("<path") > 50


@pytest.mark.parametrize("name", ["sample_lines", "orders"])
def test_pictures_of_lines(name, tmp_path):
    paths = getattr(pictures, name)(tmp_path / "a")
    check_written(paths, tmp_path / "a")
    again = getattr(pictures, name)(tmp_path / "b")
    assert paths[1].read_bytes() == again[1].read_bytes()


def test_picture_of_the_scenes(tmp_path):
    check_written(pictures.scenes(tmp_path / "scenes", Protocol(last=10)), tmp_path / "scenes")


def radiates_towards(scene, face, way):
    """Does the side of each face that a line in direction ``way`` leaves send light?"""
    return (np.sum(scene.normal[face] * way, axis=1) > 0) | (scene.back[face] == Back.RADIATES)


def test_spans_lie_on_faces_that_face_each_other(room):
    lines = chords(room, 500, 1)
    found = spans(room, lines)
    way = np.diff(found.ends, axis=1)[:, 0]
    assert len(found.line) > 300
    for side, sign in ((0, 1), (1, -1)):
        face, point = found.face[:, side], found.ends[:, side]
        corner, first, second = (edge[face] for edge in room.frames)
        for apart, u, v in zip(point - corner, first, second, strict=True):
            uv, *_ = np.linalg.lstsq(np.stack([u, v], axis=1), apart, rcond=None)
            assert np.abs(np.stack([u, v], axis=1) @ uv - apart).max() < 1e-9
            assert uv.min() > -1e-9
            assert uv.max() < 1 + 1e-9
        assert radiates_towards(room, face, sign * way).all()
    # on the chord, in its direction
    chord = np.diff(lines[found.line], axis=1)[:, 0]
    assert np.abs(np.cross(found.ends - lines[found.line][:, :1], chord[:, None])).max() < 1e-9
    assert (np.sum(way * chord, axis=1) > 0).all()


def test_spans_are_what_repeated_nearest_hits_find(room):
    lines = chords(room, 300, 2)
    found = spans(room, lines)
    way = np.diff(lines, axis=1)[:, 0]
    unit = way / np.linalg.norm(way, axis=1, keepdims=True)
    expected, at, last, alive = set(), lines[:, 0].copy(), np.full(len(lines), -1), np.arange(len(lines))
    while len(alive):
        hits = first_hits(room, at[alive], unit[alive], "cpu")
        met = hits.face >= 0
        alive, face = alive[met], hits.face[met]
        known = last[alive] >= 0
        a, b, which = last[alive][known], face[known], alive[known]
        good = radiates_towards(room, a, unit[which]) & radiates_towards(room, b, -unit[which])
        expected |= set(zip(which[good].tolist(), a[good].tolist(), b[good].tolist(), strict=True))
        at[alive] += (hits.distance[met] + 1e-4)[:, None] * unit[alive]
        last[alive] = face
    assert {(line, *face) for line, face in zip(found.line.tolist(), found.face.tolist(), strict=True)} == expected


def test_crossings_of_triangles_and_of_backs_that_let_pass():
    scene = rd.Scene.from_arrays([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], 0.5, 1.0, back=[Back.PASSES])
    origins = np.array([(0.2, 0.2, 2.0), (0.8, 0.8, 2.0), (0.2, 0.2, -2.0)])
    t = crossings(scene, origins, np.array([(0, 0, -1.0), (0, 0, -1.0), (0, 0, 1.0)]))
    assert t.ravel().tolist() == [2.0, np.inf, np.inf]


def test_local_lines_start_on_the_patch_and_end_on_the_nearest_face(room):
    patches = rd.subdivide(room, cells=6)
    patch = int(np.flatnonzero(patches.normal[:, 2] > 0.5)[20])
    lines = local_lines(patches, patch, 200, 3)
    low, high = patches.corners[patch].min(axis=0), patches.corners[patch].max(axis=0)
    assert ((lines[:, 0] >= low - 1e-9) & (lines[:, 0] <= high + 1e-9)).all()
    way = np.diff(lines, axis=1)[:, 0]
    hits = first_hits(room, lines[:, 0] + 1e-4 * patches.normal[patch], way, "cpu")
    assert np.abs(hits.distance - np.linalg.norm(way, axis=1)).max() < 0.02
    cosine = way @ patches.normal[patch] / np.linalg.norm(way, axis=1)
    assert abs((cosine**2).mean() - 0.5) < 0.06


def test_walks_leave_the_light_and_are_absorbed_by_reflectance(room):
    light = int(room.emission[:, 0].argmax())
    paths = walks(room, light, 400, 5)
    assert all(np.isclose(points[0, 2], 2.99) and len(points) > 1 for points in paths)
    legs = np.concatenate([np.stack([points[:-1], points[1:]], axis=1) for points in paths])
    way = np.diff(legs, axis=1)[:, 0]
    ends, face = nearest(room, legs[:, 0], way / np.linalg.norm(way, axis=1, keepdims=True))
    assert np.abs(ends - legs[:, 1]).max() < 1e-6
    # as many legs in the mean as survivals allow: walks end at each hit with probability 1 - rho
    survived = 1 - len(paths) / len(legs)
    assert abs(survived - room.reflectance[face, 0].mean()) < 0.06


def test_both_orders_number_the_same_legs():
    lengths = [3, 1, 4, 2]
    legs = {(walk, leg) for walk, length in enumerate(lengths) for leg in range(length)}
    for order in (breadth_first(lengths), depth_first(lengths)):
        assert len(order) == len(legs)
        assert set(order) == legs
    assert [leg for _, leg in breadth_first(lengths)] == [0, 0, 0, 0, 1, 1, 1, 2, 2, 3]
    assert [walk for walk, _ in depth_first(lengths)] == [0, 0, 0, 1, 2, 2, 2, 2, 3, 3]
    assert breadth_first([]) == depth_first([]) == []
