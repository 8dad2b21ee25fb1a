"""Triangles that were one parallelogram become it again, and paints follow faces through splitting and merging."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import radiosity as rd
from radiosity.errors import RadiosityWarning, SceneError
from radiosity.scene import Back
from radiosity.scene.assemble import Material, Part, ReadOptions, assemble

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
HALVES = np.array([[0, 1, 2], [0, 2, 3]])
GREY = Material((0.5,))


def scene_of(*parts, **options):
    return assemble(list(parts), "test", ReadOptions(**options))


def part(vertices=SQUARE, faces=HALVES, material=GREY, name="s", **more):
    return Part(name, np.asarray(vertices, float), np.asarray(faces), material, **more)


def painted(function):
    """A part's colours from a function of its vertices."""
    return np.tile(function(SQUARE[:, 0], SQUARE[:, 1])[:, None], 3)


def test_all_ways_to_cut_a_square_give_it_back():
    for first in ([0, 1, 2], [1, 2, 0], [2, 0, 1]):
        for second in ([0, 2, 3], [2, 3, 0], [3, 0, 2]):
            for faces in ([first, second], [second, first]):
                scene = scene_of(part(faces=faces))
                assert scene.is_quad.tolist() == [True]
                assert scene.area.tolist() == [1]
                assert scene.normal.tolist() == [[0, 0, 1]]


def test_what_is_no_pair_stays_apart():
    bent = SQUARE.copy()
    bent[3, 2] = 1e-3
    kite = SQUARE.copy()
    kite[3] = [0.2, 0.8, 0]
    for vertices, faces in ((bent, HALVES), (kite, HALVES), (SQUARE, [[0, 1, 2], [0, 3, 2]])):
        assert scene_of(part(vertices, faces)).is_quad.tolist() == [False, False]
    other = Material((0.5,), back=Back.ABSORBS)
    for one, two in (
        (part(faces=HALVES[:1]), part(faces=HALVES[1:], name="t")),
        (part(faces=HALVES[:1]), part(faces=HALVES[1:], material=other)),
        (part(faces=HALVES[:1]), part(faces=HALVES[1:], material=Material((0.4,)))),
        (part(faces=HALVES[:1]), part(faces=HALVES[1:], material=Material((0.5,), (1.0,)))),
    ):
        assert scene_of(one, two).n_faces == 2
    assert scene_of(part(faces=HALVES[:1]), part(faces=HALVES[1:])).n_faces == 1


def test_halves_that_follow_each_other_come_before_those_of_the_longer_diagonal():
    """Three triangles in a row: the middle one fits either neighbour, and better the first, by its longer diagonal."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0.3, 1, 0], [1.3, 1, 0], [2, 0, 0], [9, 9, 0], [9, 8, 0], [8, 8, 0]])
    first, middle, last, apart = [0, 1, 2], [1, 3, 2], [1, 4, 3], [5, 6, 7]
    for faces, kept in (
        ([first, apart, middle, last], last),  # the last follows in the file
        ([last, apart, middle, first], first),
        ([first, apart, last, apart, middle], first),  # none follows
    ):
        scene = scene_of(part(points, faces))
        (quad,) = scene.faces[scene.is_quad]
        joined = {tuple(p) for p in np.round(scene.vertices[quad], 9).tolist()}
        assert joined == {tuple(p) for p in points[sorted({*middle, *kept})].tolist()}


def test_backs_that_are_too_bright_are_told_and_brought_down_as_fronts_are():
    bright = Material((0.5,), back_reflectance=(0.99,))
    with pytest.warns(RadiosityWarning, match=r"reflectance above 0\.95 brought down to it \(at most 0\.99\): 's'"):
        scene = scene_of(part(material=bright))
    assert (scene.reflectance.tolist(), scene.back_reflectance.tolist()) == ([[0.5]], [[0.95]])


def test_vertices_of_their_own_are_welded():
    scene = scene_of(part(SQUARE[HALVES].reshape(-1, 3), np.arange(6).reshape(2, 3)))
    assert scene.is_quad.tolist() == [True]


def test_halves_that_follow_a_face_without_area_are_merged():
    """Other triangles are unlike, so that only those are looked at that are seen to be alike."""
    random = np.random.Generator(np.random.Philox(3))
    vertices = np.concatenate([SQUARE, random.normal(size=(18, 3))])
    faces = [[0, 1, 1], *np.arange(4, 22).reshape(6, 3), *HALVES]
    with pytest.warns(RadiosityWarning, match="1 face without area"):
        scene = scene_of(part(vertices, faces))
    assert scene.is_quad.tolist() == 6 * [False] + [True]


@pytest.mark.parametrize("shuffled", [False, True])
def test_a_grid_becomes_its_squares(shuffled):
    n = 8
    x, y = np.meshgrid(np.arange(n + 1), np.arange(n + 1))
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    a, b, c, d = corner, corner + 1, corner + n + 2, corner + n + 1
    halves = [np.column_stack([a, b, c]), np.column_stack([a, c, d])]
    if shuffled:
        random = np.random.Generator(np.random.Philox(1))
        halves = [random.permutation(half) for half in halves]
    faces = np.concatenate(halves)  # those of a square are far apart in the file
    scene = scene_of(part(vertices, faces))
    assert scene.is_quad.all()
    assert scene.n_faces == n * n
    np.testing.assert_allclose(scene.area, 1)
    low, high = (f(scene.vertices[scene.faces], axis=1) for f in (np.min, np.max))
    assert (high - low == [1, 1, 0]).all()  # squares, not slanted


@settings(max_examples=50)
@given(st.integers(0, 2**32 - 1))
def test_merging_keeps_the_surface(seed):
    """Any soup of triangles of a grid: area, surfaces, normals and the colour at every point stay."""
    random = np.random.Generator(np.random.Philox(seed))
    n = int(random.integers(1, 5))
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0))
    vertices = np.column_stack([x.ravel(), y.ravel(), x.ravel() * random.integers(0, 2)])
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    a, b, c, d = corner, corner + 1, corner + n + 2, corner + n + 1
    other = random.random(len(a))[:, None] < 0.5
    first = np.where(other, np.column_stack([a, b, c]), np.column_stack([a, b, d]))
    second = np.where(other, np.column_stack([a, c, d]), np.column_stack([b, c, d]))
    faces = random.permutation(np.concatenate([first, second]))[: random.integers(1, 2 * n * n + 1)]
    faces = np.where(random.random(len(faces))[:, None] < 0.3, faces[:, ::-1], faces)
    color = np.tile((vertices[:, 0] * 0.1 + vertices[:, 1] ** random.integers(1, 3) * 0.05)[:, None], 3)
    scene = scene_of(part(vertices, faces, color=color))
    corners = vertices[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    np.testing.assert_allclose((scene.area[:, None] * scene.normal).sum(axis=0), cross.sum(axis=0), atol=1e-12)
    assert scene.area.sum() == pytest.approx(np.linalg.norm(cross, axis=1).sum())
    patches = rd.subdivide(scene, cells=1)
    mean = (np.linalg.norm(cross, axis=1) * color[faces][:, :, 0].mean(axis=1)).sum() * 0.5
    front = ~patches.is_back
    assert (patches.reflectance[front, 0] * patches.area[front]).sum() == pytest.approx(mean, rel=1e-5)


def test_linear_colours_survive_the_merge():
    """The mean of a linear colour over a cell is its value at the centre, whichever way the square was cut."""
    color = painted(lambda x, y: 0.1 + 0.3 * x + 0.2 * y)
    for faces in (HALVES, [[1, 2, 3], [1, 3, 0]], [[0, 1, 2, 3]]):
        patches = rd.subdivide(scene_of(part(faces=faces, color=color)), cells=3)
        assert patches.scene.is_quad.all()
        x, y, _ = patches.centroid.T
        np.testing.assert_allclose(patches.reflectance[:, 0], 0.5 * (0.1 + 0.3 * x + 0.2 * y), rtol=1e-6)


def test_colours_that_are_not_linear_keep_triangles_apart():
    scene = scene_of(part(color=painted(lambda x, y: 0.8 * x * y)))
    assert not scene.is_quad.any()
    patches = rd.subdivide(scene, cells=4)
    x, y, _ = patches.centroid.T
    np.testing.assert_allclose(patches.reflectance[:, 0], 0.4 * np.minimum(x, y), rtol=1e-6)


def test_colours_follow_a_quadrilateral_that_is_split():
    vertices = SQUARE.copy()
    vertices[2] = [2, 2, 0]
    color = np.column_stack([vertices[:, 0] * 0.2, vertices[:, 1] * 0.3, vertices[:, 0] * 0.0])
    scene = scene_of(
        part(SQUARE + np.array([5, 0, 0]), [[0, 1, 2, 3]], Material((0.9,)), name="before"),
        part(vertices, [[0, 1, 2, 3]], color=color),
        part(SQUARE + np.array([9, 0, 0]), [[0, 1, 2, 3]], Material((0.7,)), name="after"),
    )
    assert scene.surface.tolist() == [0, 1, 1, 2]
    patches = rd.subdivide(scene, cells=2)
    mine = patches.surface == 1
    x, y, _ = patches.centroid[mine].T
    np.testing.assert_allclose(patches.reflectance[mine], 0.5 * np.column_stack([0.2 * x, 0.3 * y, 0 * x]), atol=1e-7)
    np.testing.assert_allclose(patches.reflectance[patches.surface == 0], 0.9)
    np.testing.assert_allclose(patches.reflectance[patches.surface == 2], 0.7)


def test_texture_follows_faces_however_they_are_cut():
    """A texture that is linear inside: the mean over a cell away from the rim is its value at the centre."""
    ramp = np.linspace(0.1, 0.8, 64)
    texture = np.broadcast_to((ramp[:, None] * 0.5 + ramp[None, :] * 0.5)[:, :, None], (64, 64, 1))
    uv = SQUARE[:, :2]
    for faces in (HALVES, [[1, 2, 3], [1, 3, 0]], [[0, 1, 2, 3]], [[0, 1, 2]]):
        patches = rd.subdivide(scene_of(part(faces=faces, uv=uv, texture=texture)), cells=8)
        x, y, _ = patches.centroid.T
        inside = (np.minimum(x, y) > 0.13) & (np.maximum(x, y) < 0.87)
        value = 0.1 + 0.7 * ((x + 1 - y) * 32 - 0.5) / 63  # row 0 of an image is its top
        np.testing.assert_allclose(patches.reflectance[inside, 0], 0.5 * value[inside], rtol=1e-5)


def test_textures_stay_apart_where_coordinates_jump():
    texture = np.full((2, 2, 1), 0.5, np.float32)
    uv = np.concatenate([SQUARE[HALVES[0], :2], SQUARE[HALVES[1], :2] + 3.0])
    vertices, faces = SQUARE[HALVES].reshape(-1, 3), np.arange(6).reshape(2, 3)
    far = part(
        SQUARE + np.array([0, 0, 9]), HALVES, uv=SQUARE[:, :2] * 1e5, texture=texture
    )  # large coordinates elsewhere change nothing
    assert scene_of(part(vertices, faces, uv=uv, texture=texture), far).is_quad.tolist() == [False, False, True]


def test_painted_reflectance_is_bounded_by_product():
    color = painted(lambda x, y: 0.5 + 0.5 * x)
    scene = scene_of(part(material=Material((0.9,)), color=color))  # at most 0.9: nothing to warn of
    patches = rd.subdivide(scene, cells=2)
    np.testing.assert_allclose(patches.reflectance[:, 0], 0.9 * (0.5 + 0.5 * patches.centroid[:, 0]), rtol=1e-6)
    with pytest.warns(RadiosityWarning, match=r"above 0\.8.*at most 0\.9\)"):
        scene = scene_of(part(material=Material((0.9,)), color=color), max_reflectance=0.8)
    assert rd.subdivide(scene, cells=8).reflectance.max() == pytest.approx(0.8)
    scene = scene_of(part(material=Material((3.0,)), color=painted(lambda x, y: 0.2 + 0 * x)))  # 0.6 in all
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, 0.6, rtol=1e-6)
    red = np.array([[[0.3, 1.0, 1.0]]])
    scene = scene_of(part(material=Material((1.0, 0.5, 0.0)), uv=SQUARE[:, :2], texture=red))
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance[0], [0.3, 0.5, 0], rtol=1e-6)


def test_degenerate_faces_are_numbered_as_in_the_file():
    faces = [[0, 1, 2], [0, 2, 3], [0, 1, 1], [2, 2, 2]]
    with pytest.warns(RadiosityWarning, match=r"2 faces without area left out \(first: face 2; surfaces 's'\)"):
        scene = scene_of(part(faces=faces, color=np.full((4, 3), 0.5)))
    assert scene.is_quad.tolist() == [True]
    assert len(scene.reflectance_paint.color) == 1


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"faces": [[0, 1, 4]]}, "face 0 of surface 's' names vertex 4"),
        ({"faces": [[0, 1, 2], [0, -1, 2]]}, "face 1 of surface 's' names vertex -1"),
        ({"vertices": SQUARE * np.nan}, "coordinates of vertex 0 .face 0 of surface 's'. are .nan"),
        ({"color": np.full((4, 3), -1.0)}, "colour of vertex 0"),
        ({"color": np.full((4, 3), np.inf)}, "colour of vertex 0"),
        ({"uv": np.full((4, 2), np.nan), "texture": np.ones((1, 1, 1))}, "texture coordinates of vertex 0"),
        ({"uv": np.zeros((4, 2)), "texture": np.full((1, 1, 1), np.nan)}, "texture of surface 's'"),
        ({"material": Material((np.nan,))}, "reflectance of surface 's' is nan"),
        ({"material": Material((0.5,), (-1.0,))}, "emission of surface 's' is -1"),
        ({"material": Material((0.5,), back_emission=(np.inf,))}, "emission of surface 's' is inf"),
    ],
)
def test_senseless_parts(more, words):
    with pytest.raises(SceneError, match=words):
        scene_of(part(**more))


def test_unused_vertices_may_hold_anything():
    vertices = np.vstack([SQUARE, [np.nan] * 3])
    assert scene_of(part(vertices)).area.tolist() == [1]
