"""Solvers of B = E + rho F B against elimination, on matrices whose rows sum to one or less."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_array

import radiosity as rd
from radiosity.factors.solvers import SOLVERS, System, solve, southwell


def system(seed: int, n: int, bands: int = 2, *, largest: float = 0.9, closed: bool = True) -> System:
    """A random reciprocal matrix, some patches black, or in one band alone, few lights."""
    random = np.random.Generator(np.random.Philox(seed))
    area, exchange = random.random(n) + 0.1, random.random((n, n)) ** 8
    exchange = exchange + exchange.T
    np.fill_diagonal(exchange, 0)
    for _ in range(500):  # to row sums of one
        scale = np.sqrt(area / exchange.sum(axis=1))
        exchange *= scale * scale[:, None]
    share = 1.0 if closed else 0.7
    reflectance = largest * random.random((n, bands)) * (random.random((n, 1)) < 0.9) * (random.random((n, bands)) < 0.9)
    emission = random.random((n, bands)) * (np.arange(n) % 5 == 0)[:, None]
    return System(csr_array(share * exchange / area[:, None]), emission, reflectance, area)


def eliminated(problem: System) -> np.ndarray:
    factors = problem.factors.toarray()
    return np.stack(
        [
            np.linalg.solve(np.eye(len(factors)) - rho[:, None] * factors, emission)
            for rho, emission in zip(problem.reflectance.T, problem.emission.T, strict=True)
        ],
        axis=1,
    )


@pytest.mark.parametrize("name", SOLVERS)
@given(seed=st.integers(0, 2**32), n=st.integers(3, 24), closed=st.booleans())
def test_agree_with_elimination(name, seed, n, closed):
    problem = system(seed, n, closed=closed)
    found = solve(name, problem)
    exact = eliminated(problem)
    assert np.abs(found.radiosity - exact).max() <= 1e-9 * exact.max()
    assert found.history[-1] <= 1e-9
    assert (found.history >= 0).all()


@pytest.mark.parametrize("name", SOLVERS)
def test_bright_enclosures_take_more_steps_and_end(name):
    """Reflectance 0.998: a residual of 1e-10 there means an error of 5e-8, so the solver must go on below it."""
    problem = system(3, 4)  # relaxation takes as many steps as there are patches, a thousand times
    problem = System(problem.factors, problem.emission, np.full_like(problem.reflectance, 0.998), problem.area)
    found, exact = solve(name, problem), eliminated(problem)
    assert np.abs(found.radiosity / exact - 1).max() < 1e-8


@pytest.mark.parametrize("name", SOLVERS)
def test_black_and_dark_scenes(name):
    problem = system(5, 12)
    black = System(problem.factors, problem.emission, 0 * problem.reflectance, problem.area)
    assert np.array_equal(solve(name, black).radiosity, problem.emission)
    dark = System(problem.factors, 0 * problem.emission, problem.reflectance, problem.area)
    assert not solve(name, dark).radiosity.any()


def test_faster_solvers_take_fewer_steps():
    problem = system(7, 60)
    steps = {name: len(solve(name, problem).history) for name in SOLVERS}
    assert steps["gauss-seidel"] < steps["jacobi"]
    assert steps["conjugate-gradients"] < steps["jacobi"]


def test_a_shooting_step_with_the_transposed_row_is_rejected(monkeypatch):
    """Wrong on purpose: F_ij in place of F_ji."""
    problem = system(9, 20)
    wrong = System(csr_array(problem.factors.T), problem.emission, problem.reflectance, problem.area)
    exact = eliminated(problem)
    assert np.abs(southwell.solve(wrong).radiosity - exact).max() > 1e-3 * exact.max()


class Shots(list):
    """Where columns begin, (n + 1,); remembers of whom it was asked: a shot of patch i asks for i and i + 1."""

    def __init__(self, begin):
        super().__init__(begin)
        self.asked = []

    def __getitem__(self, index):
        self.asked.append(index)
        return super().__getitem__(index)


def shots_of(problem: System) -> list[int]:
    """The patches that Southwell relaxation shoots, one after the other."""
    columns = problem.factors.tocsc()
    begin = Shots(columns.indptr.tolist())

    class Watched:
        data, sum = problem.factors.data, problem.factors.sum

        @staticmethod
        def tocsc():
            return SimpleNamespace(indptr=begin, indices=columns.indices, data=columns.data)

    southwell.solve(System(Watched(), problem.emission, problem.reflectance, problem.area))
    asked = begin.asked[::4]
    assert begin.asked == [index for i in asked for index in (i, i + 1, i, i + 1)]
    return asked


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_southwell_shoots_from_the_patch_with_the_most_unshot_power(seed):
    """Power, not radiosity: the first shot is that of the largest A E, not of the largest E or A; then likewise with what
    arrived, all bands together."""
    problem, n = system(seed, 20, bands=2), 20
    area = problem.area * np.where(np.arange(n) == 5, 8.0, 1.0)
    emission = problem.emission.copy()
    emission[[0, 5, 10, 15]] = [[0.9, 0.9], [0.5, 0.4], [2.0, 0.0], [0.0, 1.9]]
    area[[0, 10, 15]] = 1.0
    area[3] = 2 * area[5]
    assert len({int(np.argmax(x)) for x in (area * emission.sum(axis=1), emission.sum(axis=1), area, emission[:, 0])}) == 3
    problem = System(problem.factors, emission, problem.reflectance, area)
    shots = shots_of(problem)
    assert shots[0] == 5
    factors, unshot = problem.factors.toarray(), emission.copy()
    for i in shots[:60]:
        power = area * unshot.sum(axis=1)
        assert power[i] == pytest.approx(power.max(), rel=1e-9)
        shot = unshot[i].copy()
        unshot[i] = 0
        unshot += problem.reflectance * factors[:, [i]] * shot


def test_conjugate_gradients_refuse_what_is_not_reciprocal():
    problem = system(11, 10)
    factors = problem.factors.toarray()
    factors[0] *= 0.5
    with pytest.raises(rd.MethodError, match="restore reciprocity"):
        solve("conjugate-gradients", System(csr_array(factors), problem.emission, problem.reflectance, problem.area))


def test_unknown_solvers_and_broken_factors_are_refused():
    problem = system(13, 10)
    with pytest.raises(rd.MethodError, match="known are jacobi, gauss-seidel"):
        solve("magic", problem)
    factors = problem.factors.toarray()
    factors[1, 2] = np.nan
    with pytest.raises(rd.MethodError, match="not finite"):
        solve("jacobi", System(csr_array(factors), problem.emission, problem.reflectance, problem.area))
