"""Reciprocity and closure restored, of sparse and of full matrices."""

import numpy as np
import pytest
from enclosures import cube

import radiosity as rd
from radiosity.factors.balance import BALANCED, restored, restored_matrix
from radiosity.factors.counts import WORD
from radiosity.factors.model import Factors
from radiosity.factors.polygons import exchange
from radiosity.factors.solve import of_both_ways


def exact() -> tuple[np.ndarray, np.ndarray]:
    """Form factors of a cube with patches of two sizes, and areas."""
    patches = rd.subdivide(cube(), cells=1)
    corners = np.concatenate([patches.corners[:3], *([_quarter(c, k) for k in range(4)] for c in patches.corners[3:])])
    i, j = (x.ravel() for x in np.indices((15, 15)))
    area = np.repeat([1.0, 0.25], [3, 12])
    return exchange(corners[i], corners[j]).reshape(15, 15) / area[:, None], area


def _quarter(corners: np.ndarray, k: int) -> np.ndarray:
    return (corners + corners[k]) / 2


def sparse(matrix: np.ndarray, missed: np.ndarray) -> Factors:
    rows, columns = np.nonzero(matrix)
    return Factors(rows, columns, matrix[rows, columns], missed, np.zeros(len(missed)))


def exchanged(matrix: np.ndarray, area: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """(n, n) m² what a pair exchanges, both estimates of it weighted as their rows: one entry after the other."""
    n = len(area)
    result = np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            both = weight[i] * area[i] * matrix[i, j] + weight[j] * area[j] * matrix[j, i]
            result[i, j] = both / (weight[i] + weight[j])
    return result


@pytest.mark.parametrize("weighted", [False, True])
def test_noise_becomes_reciprocal_and_closed(random, weighted):
    """Both estimates of a pair become one of the variance 1 / (1 / s_i² + 1 / s_j²) where weights are 1 / s²; scaling then moves
    errors between pairs, and adds a sixth. Weights the wrong way round come to 1.6 and 3 times that spread."""
    truth, area = exact()
    spread = np.where(np.arange(15) % 2, 0.04, 0.16) if weighted else 0.1 * np.sqrt(area)
    weight = 1 / spread**2 if weighted else None
    pairs, found = truth > 1e-9, []
    for _ in range(20):
        noisy = truth * (1 + spread[:, None] * random.normal(size=truth.shape))
        full = restored_matrix(noisy, area, np.zeros(15), weight)
        assert restored(sparse(noisy, np.zeros(15)), area, weight).dense() == pytest.approx(full, rel=1e-12)
        assert full.sum(axis=1) == pytest.approx(np.ones(15), rel=1e-14)
        exchange = area[:, None] * full
        assert np.abs(exchange - exchange.T).sum() < 2 * BALANCED * area.sum()
        assert ((full > 0) == (truth > 0)).all()
        found.append(full[pairs] / truth[pairs] - 1)
    expected = np.sqrt(1 / (1 / spread[:, None] ** 2 + 1 / spread**2))[pairs]
    assert np.sqrt(np.mean((np.array(found) / expected) ** 2)) < 1.25


@pytest.mark.parametrize("weighted", [False, True])
def test_pairs_are_weighted_by_their_rows(random, weighted):
    """Before any scaling: what escapes is such that rows sum to what is wanted as they are."""
    truth, area = exact()
    noisy = truth * (1 + 0.1 * random.normal(size=truth.shape))
    weight = 0.5 + random.random(15) if weighted else None
    exchange = exchanged(noisy, area, 1 / area if weight is None else weight)
    missed = 1 - exchange.sum(axis=1) / area
    missed = (missed + 1) / 2  # a half of everything, so that no share is below zero
    expected = exchange / area[:, None] / 2
    assert restored(sparse(noisy / 2, missed), area, weight).dense() == pytest.approx(expected, rel=1e-9)
    assert restored_matrix(noisy / 2, area, missed, weight) == pytest.approx(expected, rel=1e-9)


def test_lines_count_at_both_their_ends(random):
    """(n_ij + n_ji) / (n_i / A_i + n_j / A_j) of patches of unequal areas, and lines that are not in proportion to them; rows are
    scaled to their sums alone, and what escapes and is lost with them."""
    n, area = 6, np.array([0.1, 0.5, 1.0, 2.0, 5.0, 0.3])
    lines = random.integers(1, 50, (n, n + 2)) * (np.arange(n + 2) != np.arange(n)[:, None])
    rows, columns = np.nonzero(lines)
    keys, counts = (rows.astype(np.uint64) << WORD) | columns.astype(np.uint64), lines[rows, columns].astype(np.uint32)
    found, fired = of_both_ways(keys, counts, n, area), lines.sum(axis=1)
    assert found.escaped * lines[:, n + 1] == pytest.approx(found.lost * lines[:, n], rel=1e-12)
    assert found.dense().sum(axis=1) + found.escaped + found.lost == pytest.approx(np.ones(n), rel=1e-12)
    exchange = np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            exchange[i, j] = (lines[i, j] + lines[j, i]) / (fired[i] / area[i] + fired[j] / area[j])
    # d_i d_j X_ij: of four patches the scales drop out
    factors = area[:, None] * found.dense()
    for i, j, k, m in ((0, 1, 2, 3), (1, 4, 3, 5), (2, 5, 0, 4)):
        cross = factors[i, j] * factors[k, m] / (factors[i, m] * factors[k, j])
        assert cross == pytest.approx(exchange[i, j] * exchange[k, m] / (exchange[i, m] * exchange[k, j]), rel=1e-9)
    # d_i alone, from what escapes: X_01 d_1 and X_12 d_1
    scale = found.escaped * fired / lines[:, n]
    assert factors[0, 1] / scale[0] / (factors[1, 2] / scale[2]) == pytest.approx(exchange[0, 1] / exchange[1, 2], rel=1e-3)


def test_what_a_small_patch_found_stays_where_a_large_one_missed_it():
    """All 1 000 lines of a square metre escape, and 70 of 1 000 from a hundredth of one hit it: so do its 0.7 lines' worth."""
    area, lines = np.array([1.0, 0.01]), np.array([[0, 0, 1000, 0], [70, 0, 930, 0]])
    rows, columns = np.nonzero(lines)
    keys = (rows.astype(np.uint64) << WORD) | columns.astype(np.uint64)
    found = of_both_ways(keys, lines[rows, columns].astype(np.uint32), 2, area)
    both = 70 / (1000 / 1 + 1000 / 0.01)
    assert found.dense()[1, 0] == pytest.approx(both / 0.01 / (both / 0.01 + 0.93), rel=1e-3)
    assert found.dense()[0, 1] == pytest.approx(0.01 * found.dense()[1, 0], rel=1e-5)


def test_true_factors_stay_and_what_escapes_is_left_out(random):
    truth, area = exact()
    assert restored_matrix(truth, area, np.zeros(15)) == pytest.approx(truth, rel=1e-12)
    opened, rest = truth.copy(), slice(0, 14)
    missed = truth[:, 14]  # a wall is taken away
    opened[:, 14] = opened[14] = 0
    missed[14] = 1
    found = restored(sparse(opened, missed), area)
    assert found.dense()[rest, rest] == pytest.approx(truth[rest, rest], rel=1e-9)
    assert found.escaped is missed


def test_lines_own_directions_are_the_transpose_by_areas():
    """A_i F_ij / A_j of patches of unlike areas, and what it gathers: what i sends arrives at j."""
    area = np.array([1.0, 4.0, 0.5])
    matrix = np.array([[0.0, 0.3, 0.1], [0.0, 0.0, 0.05], [0.6, 0.2, 0.0]])  # not reciprocal: backs let lines pass
    seen = sparse(matrix, 1 - matrix.sum(axis=1)).sent(area)
    assert seen.dense() == pytest.approx((area[:, None] * matrix / area).T)
    radiosity = np.array([2.0, 3.0, 5.0])
    assert area * seen.gather(radiosity) == pytest.approx((area * radiosity) @ matrix)  # power
    assert sparse(matrix, np.zeros(3)).gather(radiosity) == pytest.approx(matrix @ radiosity)
    assert seen.sparse(3).toarray() == pytest.approx(seen.dense())


def test_rows_of_no_weight_follow_the_other_side():
    truth, area = exact()
    wrong, weight = truth.copy(), np.ones(15)
    wrong[4] = truth[4] * np.linspace(0.5, 1.5, 15)
    weight[4] = 0
    assert restored_matrix(wrong, area, np.zeros(15), weight) == pytest.approx(truth, rel=1e-12)
    assert restored(sparse(wrong, np.zeros(15)), area, np.zeros(15)).values == pytest.approx(0)  # nothing is known


def test_an_empty_matrix():
    nothing = Factors(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0), np.ones(3), np.zeros(3))
    assert len(restored(nothing, np.ones(3)).values) == 0
    assert not restored_matrix(np.zeros((3, 3)), np.ones(3), np.ones(3)).any()


def test_rows_that_are_lost_but_for_rounding_become_empty():
    truth, area = exact()
    lost = np.zeros(15)
    lost[6] = 1 + 2e-16 + 1e-15  # a patch under a box, as a hemicube sums it
    found = restored(sparse(truth, lost), area).dense()
    assert not found[6].any()
    assert not found[:, 6].any()
    assert found.sum(axis=1) == pytest.approx(1 - (np.arange(15) == 6), abs=1e-12)
