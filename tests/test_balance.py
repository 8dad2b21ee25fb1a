"""Reciprocity and closure restored, of sparse and of full matrices."""

import numpy as np
import pytest
from enclosures import cube

import radiosity as rd
from radiosity.deterministic.factors import exchange
from radiosity.engine.matrix.balance import BALANCED, restored, restored_matrix
from radiosity.engine.matrix.factors import Factors


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


@pytest.mark.parametrize("weighted", [False, True])
def test_noise_becomes_reciprocal_and_closed(random, weighted):
    truth, area = exact()
    noisy = truth * (1 + 0.2 * random.normal(size=truth.shape))
    weight = random.random(15) if weighted else None
    full = restored_matrix(noisy, area, np.zeros(15), weight)
    found = restored(sparse(noisy, np.zeros(15)), area, weight)
    assert found.dense() == pytest.approx(full, rel=1e-12)
    assert full.sum(axis=1) == pytest.approx(np.ones(15), rel=1e-14)
    exchanged = area[:, None] * full
    assert np.abs(exchanged - exchanged.T).sum() < 2 * BALANCED * area.sum()
    assert ((full > 0) == (truth > 0)).all()
    assert np.linalg.norm(full - truth) < np.linalg.norm(noisy - truth)


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
