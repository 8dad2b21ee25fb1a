"""Solvers of B = E + rho F B against elimination, on matrices whose rows sum to one or less."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_array

import radiosity as rd
from radiosity.deterministic.solvers import SOLVERS, System, solve


def system(seed: int, n: int, bands: int = 2, *, largest: float = 0.9, closed: bool = True) -> System:
    """A random reciprocal matrix, some black patches, few lights."""
    random = np.random.Generator(np.random.Philox(seed))
    area, exchange = random.random(n) + 0.1, random.random((n, n)) ** 8
    exchange = exchange + exchange.T
    np.fill_diagonal(exchange, 0)
    for _ in range(500):  # to row sums of one
        scale = np.sqrt(area / exchange.sum(axis=1))
        exchange *= scale * scale[:, None]
    share = 1.0 if closed else 0.7
    reflectance = largest * random.random((n, bands)) * (random.random((n, 1)) < 0.8)
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
    """Reflectance 0.999: a residual of 1e-10 there means an error of 1e-7, so the solver must go on below it."""
    problem = system(3, 12)
    problem = System(problem.factors, problem.emission, np.full_like(problem.reflectance, 0.999), problem.area)
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
    from radiosity.deterministic.solvers import southwell

    problem = system(9, 20)
    wrong = System(csr_array(problem.factors.T), problem.emission, problem.reflectance, problem.area)
    exact = eliminated(problem)
    assert np.abs(southwell.solve(wrong).radiosity - exact).max() > 1e-3 * exact.max()


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
