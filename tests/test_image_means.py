"""Means of images over footprints: against clipped texels, against a million random points, and closed forms."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radiosity.scene import image_means, repeats
from radiosity.scene.image_means import ImageMeans
from radiosity.scene.paint import look_up
from radiosity.scene.sampler import FILTERS, WRAPS, Sampler, fold

SAMPLERS = [Sampler(wrap, kind) for wrap in itertools.product(WRAPS, WRAPS) for kind in FILTERS]


def generator(seed):
    return np.random.Generator(np.random.Philox(seed))


def over(image, sampler, origin, first, second, triangles=False):
    """One mean over one footprint, or some over some."""
    one = np.ndim(origin) == 1
    result = ImageMeans(np.asarray(image, np.float32), sampler).over(
        *(np.atleast_2d(np.asarray(v, float)) for v in (origin, first, second)), triangles=triangles
    )
    return result[0] if one else result


def clipped(image, sampler, origin, first, second, triangles):
    """The mean of an image whose filter is nearest, from the areas of all texels within the footprint."""
    height, width = image.shape[:2]
    corners = [origin, origin + first, origin + first + second, origin + second]
    corners = [corners[i] for i in ((0, 1, 3) if triangles else range(4))]
    ring = [(u * width, (1 - v) * height) for u, v in corners]
    low, high = np.floor(np.min(ring, axis=0)).astype(int), np.ceil(np.max(ring, axis=0)).astype(int)
    total, whole = np.zeros(image.shape[2]), abs(area_of(ring))
    for x in range(low[0], high[0] + 1):
        column = cut(cut(ring, 0, x, 1), 0, x + 1, -1)
        for y in range(low[1], high[1] + 1):
            inside = cut(cut(column, 1, y, 1), 1, y + 1, -1)
            share = abs(area_of(inside)) / whole
            total += share * image[fold(np.array(y), height, sampler.wrap[1]), fold(np.array(x), width, sampler.wrap[0])]
    return total


def cut(ring, axis, at, side):
    """The part of a convex ring where side * (coordinate - at) >= 0."""
    result = []
    for one, two in zip(ring, ring[1:] + ring[:1], strict=True):
        a, b = side * (one[axis] - at), side * (two[axis] - at)
        if a >= 0:
            result.append(one)
        if (a > 0) != (b > 0) and a != b:
            t = a / (a - b)
            result.append((one[0] + t * (two[0] - one[0]), one[1] + t * (two[1] - one[1])))
    return result


def area_of(ring):
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(ring, ring[1:] + ring[:1], strict=True)) / 2 if len(ring) > 2 else 0.0


def random_points(image, sampler, origin, first, second, triangles, count=1_000_000):
    """Mean and standard error of look-ups at random points."""
    s, t = generator(3).random((2, count))
    if triangles:
        s, t = np.where(s + t > 1, [1 - s, 1 - t], [s, t])
    found = look_up(image, sampler, origin + s[:, None] * first + t[:, None] * second)
    return found.mean(axis=0), found.std(axis=0) / np.sqrt(count)


def sixteen_look_ups(image, sampler, origin, first, second, triangles):
    """What was done before."""
    s, t = (np.arange(16) % 4 + 0.5) / 4, (np.arange(16) // 4 + 0.5) / 4
    return look_up(image, sampler, origin + s[:, None] * first + t[:, None] * second).mean(axis=0)


def without_rows_means(image, sampler, origin, first, second, triangles):
    """Wrong: the sums down an edge start anew in every period."""
    tables = image_means.Tables
    kept = tables.down
    tables.down = lambda self, band, x, y: kept(self, band, x, y % self.y.period if self.y.period else y)
    try:
        return over(image, sampler, origin, first, second, triangles)
    finally:
        tables.down = kept


FOOTPRINTS = {  # origin, first, second
    "along the axes": ((0.13, -0.4), (1.7, 0.0), (0.0, 2.9)),
    "over many periods": ((-7.3, 5.1), (0.0, 8.2), (-6.3, 0.0)),
    "turned": ((0.2, 0.9), (0.8, 0.5), (-0.5, 0.9)),
    "sheared and mirrored": ((3.1, -2.2), (0.3, 1.9), (0.4, 2.2)),
    "within a texel": ((0.261, 0.262), (1e-3, 2e-3), (-1e-3, 3e-3)),
    "a long sliver": ((0.1, 0.2), (9.0, 4.0), (9.0, 4.001)),
}


def check(means, footprint, sampler, triangles):
    origin, first, second = (np.array(v, float) for v in FOOTPRINTS[footprint])
    image = generator(1).random((5, 4, 2)).astype(np.float32) ** 3
    expected = clipped(image, sampler, origin, first, second, triangles)
    np.testing.assert_allclose(means(image, sampler, origin, first, second, triangles), expected, rtol=1e-7)


@pytest.mark.parametrize("triangles", [False, True])
@pytest.mark.parametrize("footprint", FOOTPRINTS)
@pytest.mark.parametrize("sampler", [one for one in SAMPLERS if one.filter == "nearest"], ids=lambda one: "-".join(one.wrap))
def test_nearest_texels_count_by_their_area(sampler, footprint, triangles):
    check(over, footprint, sampler, triangles)


@pytest.mark.parametrize("wrong", [sixteen_look_ups, without_rows_means])
def test_what_is_wrong_is_found(wrong):
    with pytest.raises(AssertionError):
        check(wrong, "over many periods", Sampler(("repeat", "repeat"), "nearest"), False)


@settings(max_examples=10)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from(SAMPLERS),
    st.booleans(),
    st.floats(0, 3),
    st.floats(0, 360),
    st.floats(-1, 1),
    st.tuples(st.integers(1, 9), st.integers(1, 9)),
)
def test_a_million_random_points(seed, sampler, triangles, tiling, angle, shear, shape):
    """At tilings from 1 to 1000, of any rotation, shear, wrap and filter: 6 standard errors, of some 20 means."""
    random = generator(seed)
    image = random.random((*shape, 2)).astype(np.float32) ** 3
    turn = np.radians(angle)
    first = 10**tiling * np.array([np.cos(turn), np.sin(turn)])
    second = 10**tiling * np.array([shear * np.cos(turn) - np.sin(turn), shear * np.sin(turn) + np.cos(turn)])
    origin = random.uniform(-3, 3, 2)
    mean, error = random_points(image, sampler, origin, first, second, triangles)
    assert (np.abs(over(image, sampler, origin, first, second, triangles) - mean) <= 6 * error + 1e-6).all()


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1), st.sampled_from(SAMPLERS), st.floats(-2, 2), st.integers(2, 5))
def test_parts_add_up_to_the_whole(seed, sampler, tiling, count):
    random = generator(seed)
    image = random.random((7, 6, 1)).astype(np.float32) ** 3
    origin, first, second = random.normal(size=(3, 2)) * np.array([1, 10**tiling, 10**tiling])[:, None]
    s, t = (part.ravel() for part in np.meshgrid(np.arange(count), np.arange(count)))
    origins = origin + (s[:, None] * first + t[:, None] * second) / count
    parts = over(image, sampler, origins, *(np.tile(edge / count, (len(s), 1)) for edge in (first, second)))
    whole = over(image, sampler, origin, first, second)
    np.testing.assert_allclose(parts.mean(axis=0), whole, rtol=1e-6)
    halves = [over(image, sampler, *half, True) for half in ((origin, first, second), (origin + first + second, -first, -second))]
    np.testing.assert_allclose(np.mean(halves, axis=0), whole, rtol=1e-6)


def test_a_ramp_has_its_value_in_the_middle():
    """The linear filter between the outermost centres of a clamped ramp, and beyond them its ends."""
    ramp = np.linspace(1, 2, 11)[None, :, None]
    clamp = Sampler(("clamp", "clamp"))
    middle = 1 + (0.1 + 0.235 - 0.5 / 11) * 1.1
    np.testing.assert_allclose(over(ramp, clamp, (0.1, 0.3), (0.5, 0.1), (-0.03, 5)), middle, rtol=1e-7)
    np.testing.assert_allclose(over(ramp, clamp, (1.0, 0.3), (1000, 10), (-0.04, 700)), 2, rtol=1e-7)
    np.testing.assert_allclose(over(ramp, clamp, (-900, 0.3), (899, 10), (-0.04, 700)), 1, rtol=1e-7)
    # half of it lies left of the first centre: 1 there, and from there on a ramp
    half = 0.25 / 11
    np.testing.assert_allclose(over(ramp, clamp, (0.5 / 11 - half, 0), (2 * half, 0), (0, 1)), 1 + half * 1.1 / 4, rtol=1e-7)


@pytest.mark.parametrize("kind", FILTERS)
@pytest.mark.parametrize("tiles", [1, 3, 1000])
@pytest.mark.parametrize("wrap", ["repeat", "mirror"])
def test_a_checkerboard_over_whole_tiles_is_grey(kind, tiles, wrap):
    board = np.array([[[0.0], [1.0]], [[1.0], [0.0]]])
    sampler = Sampler((wrap, wrap), kind)
    for start in ((0, 0), (0.3, -17.2)):
        np.testing.assert_allclose(over(board, sampler, start, (2 * tiles, 0), (0, 2 * tiles)), 0.5, rtol=1e-9)
        np.testing.assert_allclose(over(board, sampler, start, (2 * tiles, 2 * tiles), (-2 * tiles, 2 * tiles)), 0.5, rtol=1e-9)


def test_footprints_without_an_area():
    """A point is looked up, a line has the mean along it: of both edges where they are parallel, as a trapezium's density."""
    image = generator(2).random((4, 4, 3)).astype(np.float32)
    for sampler in SAMPLERS[::5]:
        point = np.array([0.33, 0.71])
        (value,) = look_up(image, sampler, point[None])
        np.testing.assert_allclose(over(image, sampler, point, (0, 0), (0, 0)), value, rtol=1e-3)
        along = np.array([1.3, 0.4])
        for first, second, triangles in ((along, 0 * along, False), (along, 0.5 * along, False), (along, 0.5 * along, True)):
            mean, error = random_points(image, sampler, point, first, second, triangles, 50_000)
            assert (np.abs(over(image, sampler, point, first, second, triangles) - mean) <= 6 * error).all()
    strip = np.linspace(0, 1, 64)[:, None, None]  # a gradient of one column, as programs bake palettes
    np.testing.assert_allclose(over(strip, Sampler(), (0.5, 0.25), (0, 0.5), (0, 0)), 0.5, rtol=1e-6)


TURNED = [((np.cos(t), np.sin(t)), (-np.sin(t), np.cos(t))) for t in np.radians([30.0, 45.0, 26.565051177078, 0.7])]


@pytest.mark.parametrize(
    "edges", [*(np.multiply(size, edges) for size in (0.9, 5.0) for edges in TURNED), np.array([(0.0, 1.7), (1.9, 0.53)])]
)
def test_larger_texels_at_the_rim_of_large_footprints(monkeypatch, edges):
    """Lamps on 1/16 of an image: within 0.1 % of what all crossings give, at the fewest that an edge is ever allowed."""
    lamps = np.zeros((1024, 1024, 1), np.float32)
    for i, j in itertools.product(range(0, 1024, 128), range(0, 1024, 128)):
        lamps[i : i + 32, j : j + 32] = 1
    origin = generator(4).random((3, 2))
    first, second = (np.tile(edge, (3, 1)) for edge in edges)
    monkeypatch.setattr(image_means, "ALL_CROSSINGS", 1)
    few = [over(lamps, Sampler(), origin, first, second, triangles=triangles) for triangles in (False, True)]
    monkeypatch.setattr(image_means, "CROSSINGS", (1 << 30, 1 << 30))
    monkeypatch.setattr(repeats, "TOLERANCE", 0.0)
    exact = [over(lamps, Sampler(), origin, first, second, triangles=triangles) for triangles in (False, True)]
    np.testing.assert_allclose(few, exact, rtol=1e-3)
    assert np.abs(edges).max() < 1 or not np.array_equal(few, exact)


def test_coordinates_far_away_and_of_any_size_end_in_means():
    image = generator(5).random((8, 4, 3)).astype(np.float32)
    mean = image.mean(axis=(0, 1), dtype=np.float64)
    for sampler in SAMPLERS:
        for size in (1e7, 1e15, 1e30):
            found = over(image, sampler, (size, -size), (size, 0.3 * size), (-size, 0.7 * size))
            assert np.isfinite(found).all()
            assert (found <= image.max(axis=(0, 1)) * 1.0001).all()
            if "clamp" not in sampler.wrap:
                np.testing.assert_allclose(found, mean, rtol=1e-3)
