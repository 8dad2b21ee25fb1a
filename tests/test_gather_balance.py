"""The factors by which received power is multiplied so that the power of a scene balances."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.gather import tally
from radiosity.algorithms.gather.balance import factors
from radiosity.patches.scatter import Scatter

OWN, REFLECTANCE = np.array([1.0, 0.0]), np.array([0.0, 0.5])  # a lamp and a floor
RECEIVED = np.array([[0.0, 2.0]]) * np.linspace(0.97, 1.02, 8)[:, None]
OPEN = RECEIVED * (0.75 / 0.75 / 2 * 4 / 3)  # a floor half of whose lines escape


def imbalance(received: np.ndarray, missed: np.ndarray, lines: np.ndarray) -> np.ndarray:
    sent = OWN + REFLECTANCE * received
    return OWN.sum() - received @ (1 - REFLECTANCE) - (sent * missed / lines).sum(axis=1)


def balanced(missed, lines, received=RECEIVED) -> np.ndarray:
    missed, lines = np.broadcast_to(np.array(missed), received.shape), np.array(lines, float)
    return received * factors(OWN, Scatter(REFLECTANCE), received, missed, lines)


def test_a_closed_scene_absorbs_what_lamps_emit():
    assert balanced([0, 0], [16, 100])[:, 1] * 0.5 == pytest.approx(np.ones(8), rel=1e-12)


def test_an_open_scene_balances_where_many_lines_know_what_escapes():
    missed, lines = np.array([0, 10**8]), np.array([10**8, 2 * 10**8])
    left = imbalance(balanced(missed, lines, OPEN), missed, lines)
    assert np.abs(left).max() < 1e-3 * np.abs(imbalance(OPEN, missed, lines)).max()


def test_few_lines_that_escape_are_not_believed():
    """A lamp of 16 lines, an eighth of which escape: the balance in each replicate would err by several percent."""
    missed, lines = np.stack([np.array([1, 2, 4, 2, 3, 1, 3, 0]), np.full(8, 62_500)], axis=1), np.array([16.0, 100_000.0])
    power = RECEIVED * (0.875 / (0.5 + 0.3125) / 2)  # a floor whose power balances in the mean
    assert np.std(imbalance(power, missed, lines)) > 4 * np.std(power[:, 1] * 0.8125)
    assert np.std(balanced(missed, lines, power)[:, 1]) < 2.5 * np.std(power[:, 1])


def test_a_lamp_whose_lines_all_miss_knows_nothing_of_what_arrives():
    """A small sensor far away: shadow rays measure a thousandth of what a single line of the lamp would bring."""
    missed, lines = np.array([50_000, 0]), np.array([50_000.0, 4000.0])
    received = np.array([[0.0, 2e-8]]) * np.linspace(0.99, 1.01, 8)[:, None]
    assert balanced(missed, lines, received)[:, 1] == pytest.approx(received[:, 1], rel=1e-6)


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_light_that_varies_over_a_patch_may_leave_where_it_is_bright(share):
    """What misses is then known too badly to say what arrives; where nothing misses, all is known."""
    lines, received = np.array([1e9, 1e9]), RECEIVED / (1 + share)
    missed = np.broadcast_to([0, share * 1e9], received.shape)
    even = factors(OWN, Scatter(REFLECTANCE), received, missed, lines)
    varied = factors(OWN, Scatter(REFLECTANCE), received, missed, lines, varies=received.mean(axis=0))
    assert np.abs(even - 1).max() > 0.01
    if share == 0:
        assert (varied == even).all()
    else:
        assert np.abs(varied - 1).max() < 0.05 * np.abs(even - 1).max()


def test_balanced_polynomials_are_no_worse_where_light_escapes(monkeypatch):
    """A tube whose floor shines: lines escape from the upper end of its walls, where light is dim."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 2)], float)
    faces = [[0, 4, 6, 2], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
    emission, names = [1, 0, 0, 0, 0], ["lamp", *"abcd"]
    scene = rd.Scene.from_arrays(corners, faces, [0, *[0.8] * 4], emission, surface=range(5), names=names)
    patches = rd.subdivide(scene, cells=1)

    def walls() -> np.ndarray:
        runs = [rd.solve(patches, "gather", basis="linear", rays=20_000, replicates=8, seed=seed) for seed in range(10)]
        return np.array([run.irradiance[1:, 0] for run in runs])

    with_balance = walls()
    monkeypatch.setattr(tally, "factors", lambda own, scatter, received, *rest: np.ones_like(received))
    without = walls()
    assert (with_balance != without).any()
    mean = without.mean()  # by symmetry of all walls
    assert np.sqrt(np.mean((with_balance / mean - 1) ** 2)) < 1.1 * np.sqrt(np.mean((without / mean - 1) ** 2))


def patches_of_two_kinds(even: float, alone: np.ndarray, seed: int = 1) -> np.ndarray:
    """Received power of 256 replicates, in the mean 2 of 100 patches, with errors that all have alike and errors of their own."""
    random = np.random.default_rng(seed)
    return 0.02 * (1 + even * random.normal(size=(256, 1)) + alone * random.normal(size=(256, 100)))


@pytest.mark.parametrize(("even", "alone", "better"), [(0.02, 0.01, 1.9), (0.002, np.repeat([0.3, 0.01], [20, 80]), 1.0)])
def test_the_imbalance_goes_where_its_cause_is(even, alone, better):
    """To all patches alike, or to the twenty that vary much: not to others, whose errors would grow by it."""
    own, reflectance, lines = np.append(1.0, np.zeros(100)), np.append(0.0, np.full(100, 0.5)), np.full(101, 1000)
    received = np.column_stack([np.zeros(256), patches_of_two_kinds(even, alone)])
    found = received * factors(own, Scatter(reflectance), received, np.zeros_like(received), lines)
    before, after = (np.sqrt(np.mean((power[:, 21:] / 0.02 - 1) ** 2)) for power in (received, found))
    assert after < 1.05 * before / better
    assert found.sum(axis=1) == pytest.approx(np.full(256, 2.0), rel=1e-9)
    if better == 1.0:  # what all patches would take if they were scaled alike is more
        scaled = received * (2.0 / received.sum(axis=1, keepdims=True))
        assert np.sqrt(np.mean((scaled[:, 21:] / 0.02 - 1) ** 2)) > 1.3 * after


def test_replicates_that_receive_nothing_stay():
    assert (factors(OWN, Scatter(REFLECTANCE), np.zeros((3, 2)), np.zeros((3, 2)), np.ones(2)) == 1).all()


def test_one_replicate_stays():
    assert (balanced([0, 0], [1, 1], RECEIVED[:1]) == RECEIVED[:1]).all()


def test_what_all_replicates_have_too_much_stays():
    """As where a floor stands twice: both copies receive the light of one."""
    found = balanced([0, 0], [16, 100], RECEIVED * 1.2)
    assert found[:, 1].mean() == pytest.approx(1.2 * RECEIVED[:, 1].mean(), rel=1e-3)
