"""View factors as values: sums of rows, groups, errors where no line went, restoration, and what is refused.

About 40 comparisons at 5 standard errors (Student with 15 degrees of freedom: p = 2e-4) leave a chance of about 1 % for a false
alarm, and seeds are fixed.
"""

from dataclasses import replace

import numpy as np
import pytest
from enclosures import cube, parallel_squares, sphere_in_box

import radiosity as rd
from radiosity.device.backend import choose
from radiosity.exchange.from_polygons import FacingPairs
from radiosity.exchange.least_squares import Unknowns, nearest
from radiosity.factors.polygons import exchange
from radiosity.scene.shapes import box, quad
from radiosity.tracing.geometry import Geometry
from validation.closed_forms.rectangles import parallel, perpendicular
from validation.shapes import disc, moved, scene, tube, turned

SIZES = (4.0, 3.0, 2.5)
WALLS = ("south", "north", "west", "east", "floor", "ceiling")


def room(*more) -> rd.Scene:
    """A box of 4 x 3 x 2.5 m seen from inside, and other bodies in it."""
    walls = [(name, 0.5, 1.0, [corners]) for name, corners in zip(WALLS, box((0, 0, 0), SIZES, inward=True), strict=True)]
    return scene(*walls, *more)


def with_a_cylinder(sides: int = 8) -> rd.Scene:
    """The box with a standing cylinder that is closed at both ends and does not touch a wall."""
    rim = 0.5 * np.cos(np.pi / sides) * np.sqrt(2 * np.pi / sides / np.sin(2 * np.pi / sides))
    body = [*tube(0.5, 0, 1.6, sides), *turned(disc(rim, 0, sides)), *disc(rim, 1.6, sides)]
    return room(("cylinder", 0.5, 1.0, moved(body, (1.8, 1.4, 0.3))))


def exact_room() -> np.ndarray:
    """Exact factors of the empty box, (6, 6)."""
    x, y, z = SIZES
    area = np.array([x * z, x * z, y * z, y * z, x * y, x * y])
    exchange = np.zeros((6, 6))
    for i, (a, b, d) in zip((0, 2, 4), ((x, z, y), (y, z, x), (x, y, z)), strict=True):
        exchange[i, i + 1] = exchange[i + 1, i] = d * d * parallel(a / d, b / d)
    for (i, j), (edge, one, other) in {(0, 2): (z, x, y), (0, 4): (x, z, y), (2, 4): (y, z, x)}.items():
        for one_wall, other_wall in ((i, j), (i, j + 1), (i + 1, j), (i + 1, j + 1)):
            value = edge * edge * perpendicular(one / edge, other / edge)
            exchange[one_wall, other_wall] = exchange[other_wall, one_wall] = value
    return exchange / area[:, None]


def distance(factors: rd.ViewFactors, exact: np.ndarray) -> float:
    """The RMS error of exchange areas, relative to their RMS."""
    power = factors.area[:, None] * exact
    return float(np.linalg.norm(factors.area[:, None] * factors.matrix - power) / np.linalg.norm(power))


@pytest.fixture(scope="module")
def raw() -> list[rd.ViewFactors]:
    """Factors of the empty box, of several seeds."""
    return [rd.view_factors(room(), rays=40_000, method="lines", replicates=16, seed=seed) for seed in range(4)]


def test_rows_of_a_box_are_exact_within_their_errors_and_better_restored(raw):
    exact, errors = exact_room(), []
    for factors in raw:
        assert factors.names == WALLS
        assert np.abs(factors.row_sums - 1).max() < 1e-12
        assert np.diag(factors.matrix).tolist() == np.diag(factors.standard_error).tolist() == [0] * 6
        found, own = factors.restored(), ~np.eye(6, dtype=bool)
        for some in (factors, found):
            assert (np.abs(some.matrix - exact)[own] < 5 * some.standard_error[own]).all()
        exchange = found.area[:, None] * found.matrix
        assert np.abs(exchange - exchange.T).max() < 1e-12
        assert np.abs(found.row_sums - 1).max() < 1e-12
        assert (found.values >= 0).all()
        assert found.restoration == "least squares"
        assert found.restored() is found
        errors.append((distance(factors, exact), distance(found, exact)))
        assert errors[-1][1] < errors[-1][0]
    before, after = np.mean(errors, axis=0)
    assert after < 0.7 * before
    spread = [np.sqrt(np.mean(((f.matrix - exact)[own] / f.standard_error[own]) ** 2)) for f in raw]
    assert 0.7 < np.mean(spread) < 1.4


def test_intervals_of_restored_factors_hold_the_truth():
    """Of 400 made-up measurements between six groups, whose entries have normal errors of Poisson's variances.

    The share of entries that 90 % intervals hold has a standard error of 0.005. Weights that follow the eight replicates closely
    (8 degrees of freedom of the prior) make it 0.87.
    """
    draw = np.random.default_rng(2)
    power = draw.random((6, 6)) * draw.random((6, 6))
    power = np.where(np.eye(6) > 0, 0, power + power.T)
    area = power.sum(axis=1)
    exact = power / area[:, None]
    rows, columns = np.nonzero(exact)
    lines, values, held = 10_000 * area / area.sum(), exact[rows, columns], []
    for _ in range(400):
        samples = values + np.sqrt(values / lines[rows]) * draw.normal(size=(8, len(values)))
        samples /= np.array([np.bincount(rows, sample, 6)[rows] for sample in samples])
        factors = rd.ViewFactors(
            names=WALLS,
            area=area,
            rows=rows,
            columns=columns,
            values=samples.mean(axis=0),
            errors=samples.std(axis=0, ddof=1) / np.sqrt(8),
            replicates=8,
            samples=samples,
            line=1 / (8 * lines),
            hits=(values * lines[rows] * 8).astype(np.int64),
        )
        low, high = (end[:, :6][exact > 0] for end in factors.restored().interval(0.9))
        held.append(np.mean((low <= values) & (values <= high)))
    assert np.std(held) / 20 < 0.006
    assert 0.885 < np.mean(held) < 0.915


def problem(draw: np.random.Generator, n: int) -> Unknowns:
    one, other = np.triu_indices(n)
    one, other = np.append(one, np.arange(n)), np.append(other, np.arange(n))
    true = draw.random(len(one)) * (draw.random(len(one)) > 0.3)
    variance = (0.3 * true + 0.05) ** 2 * draw.random(len(one)) ** 2 + 1e-8
    sums = Unknowns(one, other, true, variance, np.zeros(n)).sums(true)
    return Unknowns(one, other, np.maximum(true + np.sqrt(variance) * draw.normal(size=len(one)), 0), variance, sums)


def test_the_nearest_exchange_areas_are_those_of_a_quadratic_program():
    """A general method finds no smaller sum of squares, and the same values to its own accuracy."""
    from scipy.optimize import minimize

    draw, at_zero = np.random.default_rng(0), 0
    for _ in range(8):
        unknowns = problem(draw, 4)
        found = nearest(unknowns)
        matrix = np.array([unknowns.sums(one) for one in np.eye(len(unknowns.values))]).T

        def squares(x, unknowns=unknowns):
            return float(((x - unknowns.values) ** 2 / unknowns.variance).sum()) / 1000

        def slope(x, unknowns=unknowns):
            return 2 * (x - unknowns.values) / unknowns.variance / 1000

        sums = {"type": "eq", "fun": lambda x, m=matrix, u=unknowns: m @ x - u.wanted, "jac": lambda x, m=matrix: m}
        bounds = [(0, None)] * len(unknowns.values)
        other = minimize(
            squares,
            unknowns.values,
            jac=slope,
            bounds=bounds,
            constraints=sums,
            method="SLSQP",
            options={"ftol": 1e-15, "maxiter": 1000},
        )
        assert found.closes
        assert np.abs(matrix @ found.values - unknowns.wanted).max() < 1e-12
        assert found.values.min() >= 0
        assert squares(found.values) <= squares(other.x) * (1 + 1e-9)
        assert np.abs(found.values - other.x).max() < 1e-6
        at_zero += int((found.values == 0).sum())
    assert at_zero > 3  # bounds that matter


def test_a_wrong_weighting_is_worse():
    """Equal weights err more against the values from which the measured ones were made, and weights the wrong way round far more.

    Of 100 problems each; the ratios were 1.5 and 2.9 with other seeds, give or take a tenth.
    """
    draw, errors = np.random.default_rng(1), np.zeros(3)
    for _ in range(100):
        one, other = np.triu_indices(6)
        true, variance = draw.random(len(one)), 10 ** draw.uniform(-5, -3, len(one))
        wanted = Unknowns(one, other, true, variance, np.zeros(6)).sums(true)
        measured = np.maximum(true + np.sqrt(variance) * draw.normal(size=len(one)), 0)
        weights = (variance, np.full(len(one), 1e-4), 1e-8 / variance)
        errors += [((nearest(Unknowns(one, other, measured, v, wanted)).values - true) ** 2).sum() for v in weights]
    assert errors[1] > 1.2 * errors[0]
    assert errors[2] > 2.0 * errors[0]


def test_areas_that_cannot_close_are_told():
    """Two groups that see only each other, of areas 1 and 2."""
    unknowns = Unknowns(np.array([0]), np.array([1]), np.array([1.5]), np.array([0.1]), np.array([1.0, 2.0]))
    assert not nearest(unknowns).closes
    equal = Unknowns(np.array([0]), np.array([1]), np.array([1.5]), np.array([0.1]), np.array([1.0, 1.0]))
    assert nearest(equal).values == pytest.approx([1.0], rel=1e-12)


def test_what_escapes_is_a_column_and_errors_of_rows_hold():
    squares, exact = parallel_squares()
    factors = rd.view_factors(squares, rays=100_000, method="lines", replicates=16)
    assert factors.escaped + factors.lost + factors.matrix.sum(axis=1) == pytest.approx([1, 1], abs=1e-12)
    assert (np.abs(factors.escaped - (1 - exact)) < 5 * factors.escaped_standard_error).all()
    assert (factors.escaped_standard_error > 0).all()
    assert factors.restored().escaped == pytest.approx([1 - exact] * 2, abs=5 * factors.escaped_standard_error.max())


def test_a_factor_without_lines_has_an_upper_bound_and_not_no_error():
    """A far small square, of which a hundred lines meet nothing: its factor is below the bound of 3.7 lines, and not 0 ± 0."""
    lamp, far = quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, 9), (0, 0.05, 0), (0.05, 0, 0))
    aside = quad((5, 0, -1), (1, 0, 0), (0, 1, 0))  # behind the lamp: the two cannot see each other
    parts = [(name, 0.0, 1.0, [corners]) for name, corners in (("lamp", lamp), ("far", far), ("aside", aside))]
    factors = rd.view_factors(scene(*parts), rays=100, method="lines")
    assert factors.matrix[0, 1] == 0
    line = factors.line[0]
    assert factors.standard_error[0, 1] == pytest.approx(line)
    low, high = factors.interval(0.95)
    assert (low[0, 1], high[0, 1]) == (0, pytest.approx(-np.log(0.025) * line, rel=1e-9))
    true = 0.05**2 / (np.pi * 81)
    assert 0 < true < high[0, 1]
    assert factors.standard_error[0, 2] == high[0, 2] == 0
    assert factors.restored().standard_error[0, 1] < line  # both directions together are more lines
    assert factors.restored().interval()[1][0, 1] < high[0, 1]


def test_intervals_hold_the_exact_factor():
    """Of 60 runs with few lines, 95 % intervals: at least 50 hold each factor (binomial, p = 7e-4 below that)."""
    squares, exact = parallel_squares()
    patches = rd.subdivide(squares, cells=1)
    held = np.zeros((2, 2))
    for seed in range(60):
        low, high = rd.view_factors(patches, rays=400, method="lines", seed=seed).interval(0.95)
        for i in range(2):
            held[i] += (low[i, 1 - i] <= exact <= high[i, 1 - i]), (low[i, 2] <= 1 - exact <= high[i, 2])
    assert held.min() >= 50


def test_one_replicate_has_unknown_errors():
    factors = rd.view_factors(room(), rays=4000, method="lines", replicates=1)
    own = np.eye(6, dtype=bool)
    assert np.isnan(factors.standard_error[~own]).all()
    assert np.isnan(factors.restored().errors).all()
    assert np.abs(factors.restored().row_sums - 1).max() < 1e-12
    polygons = rd.view_factors(with_a_cylinder(), rays=100_000, method="polygons", replicates=1)
    assert np.isnan(polygons.errors).all()
    assert np.isnan(polygons.interval()[1][polygons.rows, polygons.columns]).all()


def test_groups_by_name_by_label_and_by_side():
    lines = rd.trace_lines(rd.subdivide(room(), cells=2), rays=40_000)
    each, patches = rd.view_factors(lines), lines.patches
    whole = rd.view_factors(lines, group={"walls": ["south", "north", "*st"]})
    assert whole.names == ("walls", "floor", "ceiling")
    assert whole.area.tolist() == pytest.approx([each.area[:4].sum(), 12, 12])
    power = each.area[:, None] * each.matrix
    assert whole.matrix[0, 1:] == pytest.approx(power[:4, 4:].sum(axis=0) / each.area[:4].sum(), rel=1e-12)
    assert whole.matrix[0, 0] == pytest.approx(power[:4, :4].sum() / each.area[:4].sum(), rel=1e-12)
    labelled = rd.view_factors(lines, group=np.where(patches.surface < 4, 7, patches.surface))
    assert labelled.names == ("group 4", "group 5", "group 7")
    assert labelled.matrix[2, :2] == pytest.approx(whole.matrix[0, 1:], rel=1e-12)
    patch = rd.view_factors(lines, group="patch")
    assert (len(patch), patch.names[0]) == (24, "south 0")
    assert patch.area @ patch.matrix[:, 20:].sum(axis=1) == pytest.approx(each.area @ each.matrix[:, 5], rel=1e-12)
    assert patch.sparse().toarray() == pytest.approx(patch.matrix)
    shield = scene(
        ("room", 0.5, 1.0, box((0, 0, 0), (2, 2, 2), inward=True)), ("shield", 0.5, 0.0, [quad((0, 0, 1), (1, 0, 0), (0, 1, 0))])
    )
    two = rd.Scene.from_arrays(
        shield.vertices,
        shield.faces,
        0.5,
        1.0,
        surface=shield.surface,
        names=["room", "shield"],
        back=[rd.Back.ABSORBS] * 6 + [rd.Back.RADIATES],
    )
    sides = rd.view_factors(two, rays=1000)
    assert sides.names == ("room", "shield (front)", "shield (back)")
    assert rd.view_factors(two, rays=1000, group={"up": ["shield (front)"]}).names == ("up", "room", "shield (back)")


@pytest.mark.parametrize(
    ("group", "told"),
    [
        ({"walls": ["nort"]}, "no surface is called 'nort'.*north"),
        ({"a": ["north"], "b": ["north", "south"]}, "'north' is in the groups 'a' and 'b'"),
        ({"floor": ["north"]}, "two groups would be called 'floor'"),
        ({"none": []}, "'none' have no radiating side"),
        ("face", "group 'face' does not exist; known are surface, patch"),
        ([1, 2], "whole number of 0 or more for each of the 6 patches"),
        (np.full(6, 0.5), "whole number"),
        (np.full(6, -1), "whole number"),
        (None, "group must be"),
    ],
)
def test_groups_that_make_no_sense_are_refused(group, told):
    with pytest.raises(rd.MethodError, match=told):
        rd.view_factors(rd.subdivide(room(), cells=1), rays=1000, group=group)


def test_other_arguments_that_make_no_sense_are_refused():
    patches = rd.subdivide(room(), cells=1)
    with pytest.raises(rd.MethodError, match="method 'rays' does not exist; known are auto, lines, polygons"):
        rd.view_factors(patches, method="rays")
    with pytest.raises(rd.MethodError, match="takes a Scene, Patches or a LineSet, not str"):
        rd.view_factors("room")  # pyright: ignore[reportArgumentType]
    lines = rd.trace_lines(patches, rays=1000)
    for wrong in ({"rays": 1000}, {"method": "polygons"}):
        with pytest.raises(rd.MethodError, match="of a line set"):
            rd.view_factors(lines, **wrong)
    with pytest.raises(rd.MethodError, match="level"):
        rd.view_factors(lines).interval(1.0)


def test_backs_that_pass_are_counted_one_way_and_not_restored():
    one_way = room(("pane", 0.5, 1.0, [quad((1, 1, 1), (1, 0, 0), (0, 1, 0))]))
    passing = replace(one_way, back=np.where(one_way.surface == 6, int(rd.Back.PASSES), one_way.back).astype(np.uint8))
    factors = rd.view_factors(passing, rays=100_000)
    area, matrix = factors.area, factors.matrix
    assert factors.method == "lines"
    assert matrix[4, 6] == 0  # the floor sees through the pane
    assert area[6] * matrix[6, 5] > 0.1
    assert abs(area[4] * matrix[4, 5] - area[5] * matrix[5, 4]) > 10 * area[4] * factors.standard_error[4, 5]
    with pytest.raises(rd.MethodError, match="not reciprocal"):
        factors.restored()
    with pytest.raises(rd.MethodError, match="take method='lines'"):
        rd.view_factors(passing, rays=100_000, method="polygons")


def test_what_absorbing_backs_take_is_a_column():
    hidden = room(("shelf", 0.5, 1.0, [quad((1, 1, 1), (1, 0, 0), (0, 1, 0))]))
    factors = rd.view_factors(hidden, rays=200_000, method="lines", replicates=16)
    d = 1.0
    assert factors.lost[4] > 0.01  # of the floor, by the shelf's back
    assert factors.lost[5] == factors.matrix[4, 6] == 0
    far = rd.view_factors(room(), rays=200_000, method="lines").matrix[4]
    assert far.sum() - factors.matrix[4, :6].sum() == pytest.approx(factors.lost[4], abs=2e-3 * d)


def test_convex_rooms_are_exact_by_polygons_and_auto_takes_them():
    for group in ("surface", "patch"):
        patches = rd.subdivide(room(), cells=1)
        factors = rd.view_factors(patches, rays=100_000, group=group)
        assert factors.method == "polygons"
        assert np.abs(factors.matrix - exact_room()).max() < 1e-7
        assert factors.standard_error.max() < 1e-6
        assert np.abs(factors.row_sums - 1).max() < 1e-12
        assert (factors.escaped == 0).all()
    closed = rd.view_factors(rd.subdivide(cube(), cells=4), rays=400_000, group="surface", method="polygons")
    assert np.abs(closed.matrix - np.where(np.eye(6) > 0, 0, closed.matrix)).max() == 0
    assert np.unique(closed.matrix.round(7)) == pytest.approx([0, parallel(1, 1), perpendicular(1, 1)], abs=2e-7)


def test_polygons_and_lines_agree_in_a_room_with_a_cylinder():
    patches = rd.subdivide(with_a_cylinder(), cells=1)
    made = {m: rd.view_factors(patches, rays=1_000_000, method=m, replicates=16).restored() for m in ("lines", "polygons")}
    lines, polygons = made["lines"], made["polygons"]
    assert polygons.restoration == lines.restoration == "least squares"
    difference = np.abs(lines.matrix - polygons.matrix)
    assert (difference <= 6 * np.hypot(lines.standard_error, polygons.standard_error) + 1e-12).all()
    assert distance(polygons, lines.matrix) < 0.01
    auto = rd.view_factors(patches, rays=1_000_000, replicates=16)
    predicted = auto.provenance["predicted"]
    assert auto.method == min(("lines", "polygons"), key=lambda name: predicted[name])


def test_no_pair_that_faces_is_left_out():
    """Pairs are looked through roughly first: corners in a plane, or nearly, are looked at, here at the rims of walls."""
    patches = rd.subdivide(with_a_cylinder(), cells=2)
    one, other = np.triu_indices(len(patches), 1)
    values = exchange(patches.corners[one], patches.corners[other])
    pairs = FacingPairs.of(Geometry(patches, choose()), 1)
    found = np.zeros((len(patches), len(patches)))
    found[pairs.one, pairs.other] = pairs.values
    assert found[one, other] == pytest.approx(values, rel=1e-12)
    assert 0.1 < len(pairs.one) / len(one) < 0.9


def test_auto_takes_lines_where_the_work_is_not_a_ray_a_pair():
    """And polygons of a few rays a pair err less than ten times as many lines, where the work is enough for them."""
    patches = rd.subdivide(with_a_cylinder(), cells=3)
    little = rd.view_factors(patches, rays=15_000, group="patch")
    assert (little.method, "predicted" in little.provenance) == ("lines", False)
    more = rd.view_factors(patches, rays=30_000, group="patch", seed=1)
    assert (more.method, more.rays < 60_000) == ("polygons", True)
    many = rd.view_factors(patches, rays=2_000_000, group="patch", seed=2)
    lines = rd.view_factors(patches, rays=300_000, group="patch", method="lines", seed=1).restored()
    off = [float(np.linalg.norm(factors.matrix - many.matrix)) for factors in (more, lines)]
    assert off[0] < 0.25 * off[1]
    assert 0.5 < off[0] / more.provenance["predicted"]["polygons"] < 2


def test_lines_that_were_traced_go_on_to_the_bits_of_one_run():
    """ "auto" goes on from its pilot where it takes lines."""
    patches = rd.subdivide(with_a_cylinder(), cells=6)
    auto, lines = (rd.view_factors(patches, rays=300_000, method=m) for m in ("auto", "lines"))
    assert auto.provenance["predicted"]["lines"] < auto.provenance["predicted"]["polygons"]
    assert auto.method == "lines"
    assert np.array_equal(auto.values, lines.values)
    assert np.array_equal(auto.errors, lines.errors)


def test_a_sphere_in_a_box():
    inside, exact = sphere_in_box()
    factors = rd.view_factors(inside, rays=400_000, method="lines", replicates=16)
    assert factors.matrix[0, 1] > 1 - 1e-5
    found = factors.restored()
    assert abs(found.matrix[1, 0] - exact) < 1e-4 * exact  # the sphere's row and reciprocity give it
    assert abs(factors.matrix[1, 0] - exact) < 5 * factors.standard_error[1, 0]


def test_many_groups_are_restored_by_scaling(monkeypatch):
    from radiosity.exchange import restored as module

    factors = rd.view_factors(rd.subdivide(with_a_cylinder(), cells=1), rays=100_000, group="patch", method="lines")
    squares = factors.restored()
    monkeypatch.setattr(module, "SAMPLED", 10)
    found = factors.restored()
    assert found.restoration == "scaling"
    exchange = found.area[:, None] * found.matrix
    assert np.abs(exchange - exchange.T).max() < 1e-5
    assert np.abs(found.row_sums - 1).max() < 1e-12
    assert (found.values >= 0).all()
    assert distance(found, squares.matrix) < 0.02
    ratio = found.standard_error[squares.matrix > 0.05] / squares.standard_error[squares.matrix > 0.05]
    assert 0.5 < np.median(ratio) < 2


# 1 - F of equal squares, by their distance over their width: C-11 in 40 digits, since 16 are not enough
GAPS = {1e-2: 0.019583397074026676, 1e-3: 0.0019943680924202623, 1e-4: 0.00019992902221144249, 1e-5: 1.9999143635152095e-05}


def plates(width: float, length: float, distance: float) -> rd.Scene:
    low, high = quad((0, 0, 0), (length, 0, 0), (0, width, 0)), quad((0, 0, distance), (0, width, 0), (length, 0, 0))
    return scene(("low", 0.5, 1.0, [low]), ("high", 0.5, 0.0, [high]))


@pytest.mark.parametrize(("gap", "escapes"), GAPS.items())
def test_what_thin_gaps_let_escape(gap, escapes):
    """By lines within their errors; by polygons to 1e-4 of itself, and not zero where no line found it."""
    lines = rd.view_factors(plates(1, 1, gap), rays=300_000, method="lines", replicates=16)
    assert (np.abs(lines.escaped - escapes) < 5 * lines.escaped_standard_error).all()
    assert (lines.interval()[1][:, 2] > escapes).all()
    exact = rd.view_factors(plates(1, 1, gap), rays=300_000)
    assert exact.method == "polygons"
    assert exact.escaped == pytest.approx([escapes] * 2, rel=1e-4)
    assert (exact.escaped_standard_error < 1e-6).all()
    few = rd.view_factors(plates(1, 1, gap), rays=1000, method="polygons")  # of so few, none finds gaps of 1e-4
    assert few.escaped == pytest.approx([escapes] * 2, rel=1e-4)


def test_faces_too_near_for_lines_are_told():
    with pytest.warns(rd.RadiosityWarning, match=r"nearer than single precision holds apart.*'low' and 'high'"):
        rd.view_factors(plates(1, 1, 1e-7), rays=10_000)


def test_strips_of_an_aspect_of_a_hundred_thousand():
    """Crossed strings (C-1), but for the ends. Lines begin inside the edges, which are a large part of it, and tell so."""
    narrow, exact = plates(1e-5, 1, 1e-5), np.sqrt(2) - 1
    factors = rd.view_factors(narrow, rays=200_000)
    assert factors.method == "polygons"
    assert factors.matrix[0, 1] == pytest.approx(exact, abs=2e-5)
    with pytest.warns(rd.RadiosityWarning, match="lines leave out a part of their area along the edges .'low: [34].%"):
        lines = rd.view_factors(narrow, rays=200_000, method="lines")
    assert abs(lines.matrix[0, 1] - exact) < 0.1 * exact
    wider = rd.view_factors(plates(1e-3, 1, 1e-3), rays=200_000, method="lines", replicates=16)
    assert abs(wider.matrix[0, 1] - exact) < 5 * wider.standard_error[0, 1] + 2e-3
