"""Edges of shadows: where they fall, which ones a mesh is cut along, and what it gains."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.patches.contact import cut_at_contacts
from radiosity.patches.contact.convex import parts
from radiosity.run.shadows import shadow_lines
from radiosity.run.shadows.edges import crossed, shadow_of

LAMP = (1.8, 2.0, 2.5)
HEIGHT = 1.0  # of the board


def board(turn: float) -> np.ndarray:
    """A board of 1.2 x 0.7 m, a metre above the floor, (4, 3)."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    corners = np.array([[-0.6, -0.35], [0.6, -0.35], [0.6, 0.35], [-0.6, 0.35]]) @ np.array([[c, s], [-s, c]]) + (2.1, 1.9)
    return np.column_stack([corners, np.full(4, HEIGHT)])


def floor_and_board(turn=30.0, lamp=0.02, triangles=False, pane=0.0, axes=None) -> rd.Scene:
    """A floor of 4 x 4 m, a black board above it, and a square lamp of 100 W; without a lamp where its edge is 0."""
    floor = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], float)
    above = np.array([[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [1, -1, 0]]) * max(lamp, 0.02) / 2 + LAMP
    corners = np.concatenate([floor, board(turn), above])
    if axes is not None:
        corners = corners @ axes.T + (7, -3, 2)
    middle = [[4, 5, 6, -1], [4, 6, 7, -1]] if triangles else [[4, 5, 6, 7]]
    boards = len(middle)
    return rd.Scene.from_arrays(
        corners,
        [[0, 1, 2, 3], *middle, [8, 9, 10, 11]],
        [0.5, *[0.0] * boards, 0.0],
        [0.0, *[0.0] * boards, 100 / lamp**2 if lamp else 0.0],
        surface=[0, *[1] * boards, 2],
        names=["floor", "board", "lamp"],
        two_sided=[False, *[pane > 0] * boards, False],
        transmittance=[0.0, *[pane] * boards, 0.0],
        photometric=True,
    )


def shadow_corners(turn: float, lamp=LAMP) -> np.ndarray:
    """The exact corners of the board's shadow on the floor if all light came from one point, (4, 2)."""
    lamp, corners = np.array(lamp), board(turn)
    return lamp[:2] + (corners[:, :2] - lamp[:2]) * lamp[2] / (lamp[2] - HEIGHT)


def area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def sides_of_shadow(lines, corners: np.ndarray, scale=4.0) -> list[int]:
    """The sides of an exact outline that lines have both ends of, to 1e-6 m, sorted."""
    found = []
    for line in lines:
        ends = line.ends * scale
        for k in range(4):
            pair = corners[[k, (k + 1) % 4]]
            if min(np.abs(ends - pair).max(), np.abs(ends[::-1] - pair).max()) < 1e-6:
                found.append(k)
    return sorted(found)


def test_the_shadow_of_an_edge_is_where_the_plane_through_it_and_the_light_meets_the_floor():
    """A light at a height of 3 m: what is 1 m high throws its shadow half as far again as it stands off. The sun's goes along."""
    level, post, high, rising = [[1.0, 0, 1], [1, 2, 1]], [[1, 0, 0], [1, 0, 2]], [[1, 0, 4], [1, 2, 4]], [[1, 0, -1], [1, 2, 1]]
    ends = np.array([level, level, post, high, rising], float)
    places = np.array([[0.0, 0, 3, 1], [-1, 0, 1, 0], [0, 0, 3, 1], [0, 0, 3, 1], [0, 0, 3, 1]])
    origin, up = np.zeros((5, 3)), np.tile([0.0, 0, 1], (5, 1))
    found, there = shadow_of(places, ends, origin, up)
    assert there.tolist() == [True, True, True, False, True]
    assert found[0] == pytest.approx(np.array([[1.5, 0, 0], [1.5, 3, 0]]))
    assert found[1] == pytest.approx(np.array([[2.0, 0, 0], [2, 2, 0]]))
    assert found[2] == pytest.approx(np.array([[1.0, 0, 0], [3, 0, 0]]))
    assert found[4] == pytest.approx(np.array([[1.0, 1, 0], [1.5, 3, 0]]))  # from where the edge comes out of the floor
    assert shadow_of(places[:1] * (1, 1, -1, 1), ends[:1], origin[:1], up[:1])[1].tolist() == [False]  # a light below the floor


def test_the_edge_is_found_that_hides_the_light():
    """Points just beside each side of the board's shadow; a triangle's missing fourth edge hides nothing."""
    outline = shadow_corners(30.0)
    middle, sides = outline.mean(axis=0), (outline + np.roll(outline, -1, axis=0)) / 2
    lit, dark = (np.column_stack([middle + share * (sides - middle), np.zeros(4)]) for share in (1.001, 0.999))
    places, faces = np.tile([*LAMP, 1.0], (4, 1)), np.tile(board(30.0), (4, 1, 1))
    assert crossed(places, lit, dark, faces).tolist() == [0, 1, 2, 3]
    assert crossed(places, dark, lit, faces).tolist() == [0, 1, 2, 3]
    assert crossed(places, lit, lit + 1e-4, faces).tolist() == [-1] * 4  # both on one side
    away = lit + (lit - np.array([*middle, 0])) * 3, dark + (lit - np.array([*middle, 0])) * 3
    assert crossed(places, *away, faces).tolist() == [-1] * 4  # nothing ends there
    triangle = board(30.0)[[0, 1, 2, 2]]
    assert crossed(places[:2], lit[:2], dark[:2], np.stack([triangle] * 2)).tolist() == [0, 1]


def test_a_penumbra_lies_between_planes_through_the_lamps_vertices_and_the_edge():
    """A lamp of 1 x 1 m: beyond the shadows of an edge that its four vertices throw, a long wall hides all of it or nothing."""
    edge, lamp = np.array([[1.0, -50, 1], [1.0, 50, 1]]), np.array([[-1.0, -0.5, 3], [0, -0.5, 3], [0, 0.5, 3], [-1, 0.5, 3]])
    places = np.column_stack([lamp, np.ones(4)])
    found, _ = shadow_of(places, np.tile(edge, (4, 1, 1)), np.zeros((4, 3)), np.tile([0.0, 0, 1], (4, 1)))
    x = np.sort(found[:, :, 0].ravel())
    assert (x[0], x[-1]) == pytest.approx((1.5, 2.0))
    grid = np.linspace(-1, 0, 201)

    def seen(point: float) -> float:  # the share of the lamp above the wall's upper edge, which stands on the floor
        at = point + (grid - point) / 3
        return float((at > 1).mean() if point > 1 else 1.0)

    assert [seen(x[0] - 1e-3), seen(x[-1] + 1e-3)] == [0.0, 1.0]
    assert 0 < seen(x[0] + 0.02) < seen(x[-1] - 0.02) < 1
    assert seen(x[0] + 0.25) == pytest.approx(0.5, abs=0.01)  # the plane through the middle, which meshes are cut along


@pytest.mark.parametrize("light", ["lamp", "point", "sun", "triangles"])
def test_meshes_are_cut_along_the_exact_shadow(light):
    lamp = 0.02 if light in ("lamp", "triangles") else 0.0
    scene, corners = floor_and_board(30.0, lamp, triangles=light == "triangles"), shadow_corners(30.0)
    if light == "point":
        scene = scene.with_lights([rd.point_light(position=LAMP, lumens=800)])
    if light == "sun":
        scene = scene.with_lights(suns=[rd.sun(1000, direction=(-0.5, 0.2, 1))])
        corners = board(30.0)[:, :2] + (0.5, -0.2)
    lines = shadow_lines(scene, 1000)
    assert sides_of_shadow(lines, corners) == [0, 1, 2, 3]
    assert sides_of_shadow(lines, corners + 0.01) == []  # a shadow that is a centimetre off is not there
    assert [line.ends.tolist() for line in shadow_lines(scene, 1000)] == [line.ends.tolist() for line in lines]


def test_a_turned_scene_has_the_same_lines(random):
    axes = np.linalg.qr(random.normal(size=(3, 3)))[0]
    axes *= np.linalg.det(axes)
    lines = shadow_lines(floor_and_board(axes=axes), 1000)
    assert sides_of_shadow(lines, shadow_corners(30.0)) == [0, 1, 2, 3]


@pytest.mark.parametrize(
    "of",
    [
        pytest.param({"turn": 0.0}, id="halves follow a shadow along edges of the floor"),
        pytest.param({"lamp": 2.0}, id="the penumbra of a large lamp is wide"),
        pytest.param({"pane": 0.3}, id="a pane"),
        pytest.param({"lamp": 0.0}, id="no light"),
    ],
)
def test_other_lines_are_left_to_the_pilots(of):
    assert shadow_lines(floor_and_board(**of), 1000) == []
    assert shadow_lines(floor_and_board(**of).take(np.array([0, 2])), 1000) == []  # nothing stands between


def test_cuts_along_shadows_keep_to_their_share():
    scene = floor_and_board()
    lines = shadow_lines(scene, 1000)
    faces = [cut_at_contacts(scene, 1000, 100, shadows=lines, more=more).n_faces for more in (0, 2, 5, 100)]
    assert faces[0] == scene.n_faces
    assert all(count <= scene.n_faces + more for count, more in zip(faces, (0, 2, 5, 100), strict=True))
    assert faces[2] < faces[3]


def test_trapezoids_become_a_parallelogram_and_a_triangle():
    """So halves of it lie along the shadow's edge, which is one of its sides."""
    for corners in ([[0, 0], [4, 0], [3, 1], [1, 1]], [[0, 0], [1, 0], [2, 1], [-1, 1]], [[0, 0], [3, 0], [2, 2], [0, 2]]):
        trapezoid = np.array(corners, float)
        for turned in (np.roll(trapezoid, k, axis=0) for k in range(4)):
            pieces = parts(turned, trapezoids=True)
            assert sorted(map(len, pieces)) == [3, 4]
            assert sum(map(area, pieces)) == pytest.approx(area(trapezoid))
            assert min(map(area, pieces)) > 0
            assert sorted(map(len, parts(turned))) == [3, 3]


def test_a_mesh_that_follows_the_light_has_no_patch_on_both_sides_of_a_shadow():
    """Of a board turned by 30 degrees. Along the shadow's sides no patch of the floor reaches over by more than 1e-6 m."""
    scene, outline = floor_and_board(), shadow_corners(30.0)
    mesh = rd.adapt(scene, 150)
    assert len(mesh) <= 150
    floor = np.flatnonzero(mesh.surface == 0)
    along = np.roll(outline, -1, axis=0) - outline
    normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    inner = floor[(((mesh.centroid[floor, None, :2] - outline) * normal).sum(axis=2) < 0).all(axis=1)]
    beyond = ((mesh.corners[inner][:, :, None, :2] - outline) * normal).sum(axis=3)
    assert beyond.max() < 1e-6
    assert mesh.area[inner].sum() == pytest.approx(1.2 * 0.7 * (2.5 / 1.5) ** 2, abs=1e-6)
    even = rd.subdivide(scene, cells=12)
    inner = np.flatnonzero((even.surface == 0) & (((even.centroid[:, None, :2] - outline) * normal).sum(axis=2) < 0).all(axis=1))
    assert ((even.corners[inner][:, :, None, :2] - outline) * normal).sum(axis=3).max() > 0.05


def test_a_plate_just_in_front_of_a_face_is_cut_out_of_it_where_asked():
    """A lamp that hangs a centimetre below a ceiling hides a part of it."""
    scene = rd.load_scene("room")
    cuts = [cut_at_contacts(scene, 5000, 100, near=near) for near in (0.02, 0.1)]
    ceiling = scene.names.index("ceiling")
    assert [int((cut.surface == ceiling).sum()) for cut in cuts] == [1, 5]
