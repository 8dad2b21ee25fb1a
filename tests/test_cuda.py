"""The same kernels on an NVIDIA GPU: left out, with the reason, where there is none.

Powers that surfaces receive are compared in combined standard errors of 16 replicates each; the bound is Student's at ALPHA of
`methods`, for all comparisons of a test together.
"""

import numpy as np
import pytest
from methods import METHODS, critical
from replicates import difference, powers

import radiosity as rd

REPLICATES = 16
EDGES = 1e-3  # of a surface's power: few lines meet an edge otherwise on the other device; another seed's lines change up to 1e-2
START_UP = 2e-4  # iterations leave so much of the light out, in a furnace, where they have no spread


@pytest.fixture(scope="module", autouse=True)
def gpu():
    """Everything here needs one."""
    import drjit as dr

    if not dr.has_backend(dr.JitBackend.CUDA):
        pytest.skip("no CUDA device on this machine")


@pytest.fixture(scope="module")
def furnace():
    return rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1)


def integers(patches, order: str, **budget):
    solution = rd.solve(patches, rd.Method(order=order), replicates=2, device="cuda", **budget)
    assert solution.provenance["device"] == "cuda"
    return [solution.state[name] for name in ("arrivals", "fired", "missed")]


@pytest.mark.parametrize("order", ["breadth-first", "depth-first", "staged", "well-distributed"])
def test_integers_do_not_depend_on_order(furnace, order):
    usual = integers(furnace, "breadth-first", quanta=1 << 20)
    for one, other in zip(usual, integers(furnace, order, quanta=1 << 20), strict=True):
        assert np.array_equal(one, other)


def test_integers_do_not_depend_on_stages(furnace):
    first = rd.solve(furnace, "random-walk", replicates=2, quanta=70_001, device="cuda")
    resumed = rd.solve(furnace, "random-walk", replicates=2, quanta=300_007, device="cuda", resume=first)
    once = rd.solve(furnace, "random-walk", replicates=2, quanta=300_007, device="cuda")
    assert np.array_equal(resumed.state["arrivals"], once.state["arrivals"])


def test_bands_repeat_to_the_bit():
    one, other = (rd.solve(rd.load_scene("cornell-box"), "random-walk", rays=3_000_000, device="cuda") for _ in range(2))
    assert np.array_equal(one.irradiance, other.irradiance)


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_every_method_in_the_furnace(furnace, method):
    power = powers(rd.solve(furnace, method, rays=1_000_000, replicates=REPLICATES, device="cuda"))
    exact = np.bincount(furnace.surface, furnace.area)
    error = np.maximum(power.std(axis=0, ddof=1) / REPLICATES**0.5, START_UP * exact)
    assert np.abs((power.mean(axis=0) - exact) / error).max() < critical(REPLICATES, len(exact))


@pytest.mark.parametrize("name", ["room", "cornell-box"])
def test_agrees_with_the_processor(name):
    """Also where bands differ. Other seeds, so that errors are independent."""
    patches = rd.subdivide(rd.load_scene(name))
    one = powers(rd.solve(patches, "random-walk", rays=20_000_000, replicates=REPLICATES, device="cuda", seed=1))
    other = powers(rd.solve(patches, "random-walk", rays=20_000_000, replicates=REPLICATES, device="cpu", seed=2))
    seen = other.min(axis=0) > 0.2 * other.mean(axis=0)  # many arrivals in each replicate, so that means are near normal
    assert seen.sum() > 5
    assert np.abs(difference(one, other))[seen].max() < critical(REPLICATES, int(seen.sum()))


@pytest.mark.filterwarnings("ignore:.*out of balance")  # of hemicubes, on both
@pytest.mark.parametrize("name", sorted(rd.BASELINES))
def test_baselines_agree_with_the_processor(name):
    """With equal seeds, so that the lines are the same."""
    needed = rd.BASELINES[name].method.needs_powers_of_two
    patches = rd.subdivide(rd.load_scene("room"), cells=4, powers_of_two=needed)
    one, other = (rd.solve(patches, name, device=device).irradiance[:, 0] for device in ("cuda", "cpu"))
    one, other = (np.bincount(patches.surface, patches.area * irradiance) for irradiance in (one, other))
    assert np.abs(one / other - 1).max() < EDGES
