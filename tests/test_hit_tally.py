"""Lines land in counters: atomically or in copies, the sums are those of whole numbers."""

from types import SimpleNamespace

import drjit as dr
import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.firing.orders import breadth_first
from radiosity.device.backend import choose, frozen, upload
from radiosity.tally import hit_tally

SLOTS = 37


def tally(groups: int):
    """Hit counts, some lines landed before."""
    types = choose("cpu").types
    bands = (
        SimpleNamespace(n=groups, received=upload(types.UInt64, np.arange(SLOTS * groups, dtype=np.uint64))) if groups else None
    )
    return SimpleNamespace(
        tracer=SimpleNamespace(types=types),
        bands=bands,
        arrivals=upload(types.UInt32, np.arange(SLOTS, dtype=np.uint32)),
        touched=dr.opaque(types.Bool, False, SLOTS),
    )


@pytest.mark.parametrize("kind", [hit_tally.Atomic, hit_tally.Copied])
@pytest.mark.parametrize("groups", [0, 2, 3, 4, 8])
@pytest.mark.parametrize("lines", [1, 1000, 100_000])
def test_sums_are_those_of_whole_numbers(kind, groups, lines, random):
    """In several launches, most lines in few slots, some lanes without a line."""
    hits, types = tally(groups), choose("cpu").types
    arrivals = np.arange(SLOTS, dtype=np.uint64)
    received = np.arange(SLOTS * groups, dtype=np.uint64).reshape(SLOTS, groups)
    landed = kind(hits, True)
    for _ in range(3):
        slot = (random.random(lines) ** 4 * (SLOTS - 1)).astype(np.uint32)
        power = random.integers(0, 2**31, (lines, groups), dtype=np.uint32)
        active = random.random(lines) < 0.8
        words = [types.UInt64(upload(types.UInt32, power[:, g])) for g in range(groups)]
        landed.add(upload(types.UInt32, slot), words, upload(types.UInt32, active.astype(np.uint32)) == 1)
        dr.eval(*landed.arrays())
        np.add.at(arrivals, slot[active], np.uint64(1))
        for g in range(groups):
            np.add.at(received[:, g], slot[active], power[active, g].astype(np.uint64))
    landed.settle()
    assert np.array_equal(frozen(hits.arrivals), arrivals)
    assert np.array_equal(frozen(hits.touched), arrivals > np.arange(SLOTS))
    if groups:
        assert np.array_equal(frozen(hits.bands.received).reshape(SLOTS, groups), received)


@pytest.mark.parametrize("name", ["room", "cornell-box"])
def test_copies_end_in_equal_integers(name, monkeypatch):
    """All sweeps in copies, none, and some; also where flags tell which patches go on."""
    monkeypatch.setattr(breadth_first, "TAILS", {"cpu": 1 << 13})
    patches, took = rd.subdivide(rd.load_scene(name), cells=20), []
    for dense, most in ((0, hit_tally.MOST), (np.inf, hit_tally.MOST), (0, 0), (hit_tally.SHARED, hit_tally.MOST)):
        monkeypatch.setattr(hit_tally, "SHARED", dense)
        monkeypatch.setattr(hit_tally, "MOST", most)
        kinds = []

        def remembered(*arguments, kinds=kinds, of=hit_tally.hit_tally, **more):
            kinds.append(type(of(*arguments, **more)))
            return of(*arguments, **more)

        with monkeypatch.context() as patched:
            patched.setattr("radiosity.algorithms.firing.fire.hit_tally", remembered)
            took.append((kinds, rd.solve(patches, "random-walk", quanta=40_000, replicates=2).state))
    (all_copied, one), (none, two), (full, three), (some, four) = took
    assert set(all_copied) == {hit_tally.Copied}
    assert set(none) == set(full) == {hit_tally.Atomic}
    assert set(some) == {hit_tally.Copied, hit_tally.Atomic}
    for other in (two, three, four):
        assert all(np.array_equal(one[key], other[key]) for key in one)


def test_a_packet_holds_a_count_and_three_groups():
    assert [hit_tally.packets(groups) for groups in (0, 2, 3, 4, 7, 8)] == [1, 1, 1, 2, 2, 3]
