"""How much two polygons see of each other: full, blocked and partial views, and what the numbers are a function of."""

import numpy as np
import pytest
from enclosures import cube, sphere

import radiosity as rd
from radiosity.device.backend import choose
from radiosity.errors import MethodError
from radiosity.scene.shapes import quad
from radiosity.tracing.drawn_lines import Table, kernels
from radiosity.tracing.faces import OFFSET
from radiosity.tracing.geometry import INSET, Geometry
from radiosity.tracing.visibility import Polygons, records_of, visible_share
from validation.closed_forms.rectangles import parallel


def geometry_of(scene: rd.Scene, cells: int = 1) -> Geometry:
    return Geometry(rd.subdivide(scene, cells=cells), choose("cpu"))


def test_rays_begin_and_end_as_far_from_every_edge():
    """Of long parallelograms, upright or skew: what is drawn in keeps its distance from all four edges."""
    scene = black([quad((0, 0, 0), (8, 0, 0), (0, 1, 0)), quad((0, 0, 3), (0, 1, 0), (8, 5, 0))])
    geometry = geometry_of(scene)
    polygons, tree = Polygons.of(geometry.patches), geometry.bvh
    records = records_of(geometry, polygons).astype(float)
    corners = (polygons.corners - tree.centre) * tree.scale
    for corner, record in zip(corners, records, strict=True):
        origin, first, second, offset = record[:3], record[3:6], record[6:9], record[9]
        drawn = np.array([origin, origin + first, origin + first + second, origin + second])
        along = (np.roll(corner, -1, axis=0) - corner) / np.linalg.norm(np.roll(corner, -1, axis=0) - corner, axis=1)[:, None]
        apart = [np.linalg.norm(np.cross(along[k], drawn[k] - corner[k])) for k in range(4)]
        apart += [np.linalg.norm(np.cross(along[k], drawn[(k + 1) % 4] - corner[k])) for k in range(4)]
        reach = np.abs(corners).max()
        assert apart == pytest.approx([offset * INSET / OFFSET] * 8, rel=0.05, abs=2e-7 * reach)


def all_pairs(geometry: Geometry) -> tuple[Polygons, Polygons]:
    i, j = (x.ravel() for x in np.indices((len(geometry.patches),) * 2))
    polygons = Polygons.of(geometry.patches)
    return polygons.take(i), polygons.take(j)


def black(quads: list[np.ndarray], back=rd.Back.ABSORBS) -> rd.Scene:
    """Parallelograms, a face each."""
    count = len(quads)
    return rd.Scene.from_arrays(np.concatenate(quads), np.arange(4 * count).reshape(count, 4), 0.0, 1.0, back=[back] * count)


@pytest.mark.parametrize(("scale", "move"), [(1.0, 0.0), (1e-4, 3e-2), (1e6, -5e7)])
def test_in_an_empty_cube_all_walls_see_each_other_whole_and_themselves_not_at_all(scale, move):
    inside = cube()
    scene = rd.Scene.from_arrays(inside.vertices * scale + move, inside.faces, 0.5, 1.0)
    geometry = geometry_of(scene, 5)
    share = visible_share(geometry, *all_pairs(geometry), rays=16).reshape(150, 150)
    same = geometry.patches.face[:, None] == geometry.patches.face
    assert (share[~same] == 1).all()
    assert (share[same] == 0).all()


def test_triangles_of_a_sphere_see_each_other_whole():
    """Single precision hides a line or two where neighbours meet at a shallow angle: fewer than 1e-5 of the pairs."""
    geometry = geometry_of(sphere(0.5, 1.0, 2), 1)
    one, other = all_pairs(geometry)
    share = visible_share(geometry, one, other, rays=16)
    apart = (one.corners != other.corners).any(axis=(1, 2))
    assert (share[apart] < 1).sum() <= 1
    assert share[apart].min() > 0.9
    assert (share[~apart] == 0).all()


def test_lines_of_a_table_find_the_form_factors_of_squares_that_alternate():
    """Each line of a pair has ends of its own: a square a side apart, where F is known, and one beside it behind a wall.

    Means of 2^14 points of the Sobol' sequence.
    """
    floors, ceilings = ([quad((x, 0, z), *edges) for x in (0, 3)] for z, edges in ((0, np.eye(3)[:2]), (1, np.eye(3)[1::-1])))
    geometry = geometry_of(black([*floors, *ceilings, quad((2, -5, -5), (0, 10, 0), (0, 0, 10))]))
    first, second = (Table.of(geometry, Polygons.of(geometry.patches, some)) for some in (slice(0, 2), slice(2, 5)))
    table = first.joined(second)
    source, receiver = np.zeros((2, 1 << 14), int), np.full((2, 1 << 14), 2)
    receiver[1, ::2] = 3
    kernel, met = kernels(geometry, table, source, receiver, np.array([5, 6], np.uint64), 1)
    exact = np.pi * parallel(1, 1)
    assert met[0].mean() == pytest.approx(exact, rel=1e-3)
    assert met[1, 1::2].mean() == pytest.approx(exact, rel=1e-3)
    assert (met[1, ::2] == 0).all()
    assert (kernel[1, ::2] > 0).all()
    one, _ = kernels(geometry, table, source[:1, :1], receiver[:1, :1], np.array([5], np.uint64), 1)
    assert one.shape == (1, 1)
    assert one[0, 0] == kernel[0, 0]


def divided(back=rd.Back.ABSORBS) -> rd.Scene:
    """Unit squares at unit distance, and a wall that parts them into halves."""
    floor, ceiling = quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, 1), (0, 1, 0), (1, 0, 0))
    return black([floor, ceiling, quad((0.5, -1, -1), (0, 3, 0), (0, 0, 3))], back)


def test_a_wall_hides_what_the_closed_form_says():
    geometry = geometry_of(divided())
    polygons = Polygons.of(geometry.patches)
    share = visible_share(geometry, polygons.take([0]), polygons.take([1]), rays=1 << 15)
    assert share[0] == pytest.approx(2 * parallel(0.5, 1) / parallel(1, 1), abs=1e-3)
    assert abs(share[0] - 0.5) > 0.05  # what the plain mean of visible lines would say


def halves() -> tuple[Polygons, Polygons]:
    """Parts of the squares of `divided`: below on the left of its wall, above on the right."""
    left, right = quad((0, 0, 0), (0.5, 0, 0), (0, 1, 0)), quad((0.5, 0, 1), (0, 1, 0), (0.5, 0, 0))
    return Polygons(left[None], np.array([0])), Polygons(right[None], np.array([1]))


@pytest.mark.parametrize(
    ("back", "forth", "return_"), [(rd.Back.ABSORBS, 0, 0), (rd.Back.RADIATES, 0, 0), (rd.Back.PASSES, 1, 0)]
)
def test_backs_that_pass_hide_one_way_only(back, forth, return_):
    geometry, (left, right) = geometry_of(divided(back)), halves()  # the wall's front looks to the right
    assert visible_share(geometry, left, right)[0] == forth
    assert visible_share(geometry, right, left)[0] == return_


def test_a_back_that_radiates_is_seen_from_behind():
    floor, sheet = quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, 1), (1, 0, 0), (0, 1, 0))
    geometry = geometry_of(black([floor, sheet], rd.Back.RADIATES))
    front_of_floor, front_of_sheet, back_of_sheet = (Polygons.of(geometry.patches, [i]) for i in (0, 2, 3))
    assert visible_share(geometry, front_of_floor, back_of_sheet)[0] == 1
    assert visible_share(geometry, front_of_floor, front_of_sheet)[0] == 0


def test_a_share_depends_on_the_pair_alone(random):
    geometry = geometry_of(rd.load_scene("room"), 2)
    count = len(geometry.patches)
    polygons = Polygons.of(geometry.patches)
    i, j = random.integers(0, count, (2, 3000))
    share = visible_share(geometry, polygons.take(i), polygons.take(j), rays=32, seed=5)
    assert 0.02 < ((share > 0) & (share < 1)).mean() < 0.98
    some = random.permutation(3000)[:7]
    assert (visible_share(geometry, polygons.take(j[some]), polygons.take(i[some]), rays=32, seed=5) == share[some]).all()
    single = visible_share(geometry, polygons.take(i[some[:1]]), polygons.take(j[some[:1]]), rays=32, seed=5)
    assert single[0] == share[some[0]]
    assert (visible_share(geometry, polygons.take(i), polygons.take(j), rays=32, seed=6) != share).any()


def test_more_rays_say_more(random):
    geometry = geometry_of(rd.load_scene("room"), 2)
    polygons = Polygons.of(geometry.patches)
    one, other = (polygons.take(numbers) for numbers in random.integers(0, len(geometry.patches), (2, 3000)))
    few, many, most = (visible_share(geometry, one, other, rays=rays) for rays in (16, 256, 8192))
    error, less = (np.sqrt(np.mean((share - most) ** 2)) for share in (few, many))
    assert error < 0.2
    assert less < error / 3


def test_one_ray_no_pair_and_too_many_rays():
    geometry, (left, right) = geometry_of(divided()), halves()
    assert visible_share(geometry, left, right, rays=1).shape == (1,)
    assert visible_share(geometry, left.take([]), right.take([])).shape == (0,)
    for rays in (0, 1 << 16):
        with pytest.raises(MethodError, match="rays of a pair"):
            visible_share(geometry, left, right, rays=rays)
