"""Digital sequences: nets, and equal to slow evaluations of their definitions in whole numbers."""

from math import comb

import numpy as np
import pytest
from nets import BASE, COMPARED, T, is_net, top_digits
from scipy import stats
from test_numbers import points

from radiosity.device.backend import choose, upload
from radiosity.sampling.numbers import DIMENSIONS, NUMBERS, faure, make, niederreiter, sobol
from radiosity.sampling.numbers.binary import Binary
from radiosity.sampling.numbers.quinary import Quinary, packed
from radiosity.sampling.streams import Purpose, stream

DIGITS = {2: 16, 5: 8}
INDEX = np.r_[1:4000, np.random.default_rng(8).integers(1, 2**32, 2000), 2**31, 2**32 - 1]


def digits_of(n: int, base: int) -> list[int]:
    """From the least significant one on."""
    digits = []
    while n:
        n, digit = divmod(n, base)
        digits.append(digit)
    return digits


def test_there_is_a_test_for_every_sequence():
    assert set(T) | set(COMPARED) == set(NUMBERS)


@pytest.mark.parametrize("name", T)
@pytest.mark.parametrize("s", [2, 3, 4, 5])
@pytest.mark.parametrize("shifted", [False, True])
def test_blocks_are_nets(name, s, shifted):
    base = BASE[name]
    drawn = make(name).randomisation(stream(3, 1, Purpose.NUMBERS)) if shifted else None
    for m in range(1, 13 if base == 2 else 6):
        for block in (0, 7, (2**32 - 1) // base**m - 1):
            x = top_digits(name, block * base**m + 1 + np.arange(base**m), DIGITS[base], drawn)
            assert is_net(x[:, :s], base, DIGITS[base], m, T[name][s])


@pytest.mark.parametrize("name", T)
def test_the_floats_hold_these_digits(name):
    drawn = make(name).randomisation(stream(4, 0, Purpose.NUMBERS))
    base, most = BASE[name], {2: 24, 5: 8}[BASE[name]]
    x = points(name, INDEX, seed=4).astype(np.float64)
    assert np.array_equal(drawn, make(name).randomisation(stream(4, 0, Purpose.NUMBERS)))
    lower = top_digits(name, INDEX, most, drawn) / base**most
    assert (x - lower).min() > -1.2e-7
    assert (x - lower).max() < (1.2e-7 + 5.0**-8 if base == 5 else 1e-12)


WRONG = {
    "two equal dimensions": Binary(lambda: sobol.matrices()[[0, 1, 2, 2, 4]]),
    "transposed": Binary(lambda: sobol.matrices().swapaxes(1, 2)),
    "Pascal transposed": Quinary(lambda: np.array([faure.pascal(d).T[:12] for d in range(5)])),
    "a power twice": Quinary(lambda: faure.matrices()[[0, 1, 2, 3, 3]]),
    "one wrong diagonal": Quinary(lambda: (faure.matrices() + np.eye(12, 15, 1) * (np.arange(5) == 4)[:, None, None]) % 5),
}


@pytest.mark.parametrize("kind", WRONG)
def test_wrong_matrices_are_rejected(kind):
    base, t = (2, 5) if isinstance(WRONG[kind], Binary) else (5, 0)
    m = 9 if base == 2 else 4
    x = top_digits(WRONG[kind], 1 + np.arange(base**m), DIGITS[base])
    assert not is_net(x, base, DIGITS[base], m, t)


@pytest.mark.parametrize("name", ["sobol", "niederreiter"])
def test_a_smaller_t_is_rejected(name):
    """Five in theory; with three, some block is no net."""
    blocks = [(m, top_digits(name, 1 + np.arange(2**m), 16)) for m in range(4, 13)]
    assert not all(is_net(x, 2, 16, m, T[name][DIMENSIONS] - 2) for m, x in blocks)


def test_sobol_is_scipys_but_for_the_order():
    exact = (stats.qmc.Sobol(DIMENSIONS, scramble=False, bits=32).random(2**12) * 2.0**32).astype(np.int64)
    n = np.arange(2**12)
    assert np.array_equal(top_digits("sobol", (n ^ (n >> 1)) + 1, 32), exact)
    block = top_digits("sobol", 2**10 + 1 + np.arange(2**10), 32)
    assert {tuple(p) for p in block.tolist()} == {tuple(p) for p in exact[2**10 : 2**11].tolist()}


@pytest.mark.parametrize("name", ["sobol", "niederreiter"])
def test_base_2_is_a_product_of_matrix_and_digits(name):
    matrices = {"sobol": sobol, "niederreiter": niederreiter}[name].matrices()
    found = top_digits(name, INDEX, 32)
    for i, row in zip(INDEX.tolist(), found, strict=True):
        columns = [c for c, digit in enumerate(digits_of(i - 1, 2)) if digit]
        for d in range(DIMENSIONS):
            y = matrices[d][:, columns].sum(axis=1) % 2
            assert int("".join(map(str, y.tolist())), 2) == row[d]


@pytest.mark.parametrize("name", ["faure", "generalized-faure"])
@pytest.mark.parametrize("shifted", [False, True])
def test_faure_in_whole_numbers(name, shifted):
    """Binomial coefficients times digits, with twelve digits: high and low as the kernel has them, and as floats."""
    shift = np.random.default_rng(6).integers(0, 5, (DIMENSIONS, 12)) * shifted
    binomials = np.array([[comb(c, r) for c in range(15)] for r in range(15)], np.int64)
    n = np.array([np.pad(digits_of(i - 1, 5), (0, 15))[:15] for i in INDEX.tolist()])
    found, floats = top_digits(name, INDEX, 8, packed(shift)), drawn_points(name, packed(shift))
    for d in range(DIMENSIONS):
        power = np.maximum(np.subtract.outer(np.arange(15), np.arange(15)).T, 0)
        upper = binomials * d**power % 5
        y = n @ upper.T % 5
        if name == "generalized-faure":
            y = y @ upper % 5  # by the transpose of the transpose
        y = (y[:, :12] + shift[d]) % 5
        assert np.array_equal(y[:, :8] @ 5 ** np.arange(7, -1, -1), found[:, d])
        assert np.abs(y @ 5.0 ** -np.arange(1, 13) - floats[:, d]).max() < 1.2e-7


def drawn_points(name, drawn):
    types = choose("cpu").types
    words = [types.UInt32(int(word)) for word in drawn]
    index = upload(types.UInt32, INDEX.astype(np.uint32))
    return np.array(make(name).points(index, types.UInt32(0), words, 32)).T


def test_a_number_next_to_one_stays_below_it():
    all_fours = packed(np.full((DIMENSIONS, 12), 4))
    x = drawn_points("faure", all_fours)
    assert x[0].tolist() == [1 - 2.0**-24] * DIMENSIONS
    assert x.max() < 1
