"""What whole lines leave unsent is sent on (contract 12): no bias where patches see their own light. Closed grey cavities with
E = 1 - rho, where B = 1 and so H = 1 everywhere.
"""

import dataclasses
from fractions import Fraction

import drjit as dr
import numpy as np
import pytest
from enclosures import cube

import radiosity as rd
from radiosity.algorithms.firing import algorithm as firing_process
from radiosity.algorithms.firing import residue, residue_walks
from radiosity.algorithms.table import make
from radiosity.device.backend import choose, upload
from radiosity.problem.bands import QUANTUM
from radiosity.problem.model import Problem
from radiosity.problem.quanta import phases, target_counts
from radiosity.scene.shapes import box
from radiosity.tracing.geometry import Geometry

ALPHA = 1e-4  # of each test of a mean, two-sided; seeds are fixed
COLOURS = (0.9, 0.7, 0.5)
few_lines = pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning")


def cavity(reflectance=0.9, gap=0.01, cells=4) -> rd.Patches:
    """1 m x 1 m x gap; of one band or several."""
    quads, rho = box((0, 0, 0), (1, 1, gap), inward=True), np.tile(np.atleast_1d(reflectance), (6, 1))
    scene = rd.Scene.from_arrays(
        np.concatenate(quads),
        np.arange(24).reshape(6, 4),
        rho,
        1 - rho,
        surface=range(6),
        names=[f"wall {i}" for i in range(6)],
        bands=[f"band {i}" for i in range(rho.shape[1])],
    )
    return rd.subdivide(scene, cells=cells)


def opened() -> rd.Patches:
    """Absorbing backs, an opening, several bands."""
    emission = np.zeros((6, 3))
    emission[0] = 1.0
    scene = cube([[0.5, 0.4, 0.2]] * 3 + [[0.1, 0.3, 0.6]] * 3, emission)
    return rd.subdivide(scene.take(np.arange(6) != 5), cells=3)


def process_of(patches, replicates, method=None, seed=1):
    return make(Geometry(patches, choose("cpu")), Problem.of(patches), method or rd.Method(), seed, replicates)


def advanced(algorithm, *stages):
    for quanta in stages:
        algorithm.advance(quanta, lambda lines: None)
    return algorithm.capture()


def means(algorithm, state) -> np.ndarray:
    """(n_groups, replicates) mean irradiance of the scene."""
    area, found = algorithm.problem.patches.area, []
    for group in range(algorithm.problem.groups.n_groups):
        values, unit = algorithm.tally.irradiance(algorithm.problem, state, group)
        found.append(values.sum(axis=1) * unit / area.sum())
    return np.array(found)


def apart(means: np.ndarray) -> np.ndarray:
    """From 1, in standard errors."""
    return (means.mean(axis=1) - 1) / (means.std(axis=1, ddof=1) / np.sqrt(means.shape[1]))


def limit() -> float:
    from scipy.stats import norm

    return float(norm.ppf(1 - ALPHA / 2))


def not_sent(counters, problem, state, begun) -> residue_walks.Sent:
    """A wrong implementation."""
    groups = problem.groups.n_groups
    received = state.arrivals[..., None] * np.int64(QUANTUM) if state.bands is None else state.bands.received
    missed = np.zeros((2, counters.tracer.replicates, groups), np.int64)
    return residue_walks.Sent(received.astype(np.int64), missed, [0] * groups, 0)


@pytest.mark.parametrize("numbers", ["halton", "random"])
def test_a_narrow_cavity_gets_all_its_light(numbers, monkeypatch):
    """200 short runs; without the residue's lines the same test fails by far."""
    algorithm = process_of(cavity(), 200, rd.Method(numbers=numbers))
    state = advanced(algorithm, 150)
    assert abs(apart(means(algorithm, state))[0]) < limit()
    algorithm.tally.forget()
    monkeypatch.setattr(firing_process, "send", not_sent)
    assert apart(means(algorithm, state))[0] < -3 * limit()


@pytest.mark.parametrize("stages", [(150,), (40, 80, 150)])
def test_every_band_of_a_coloured_cavity_does(stages, monkeypatch):
    algorithm = process_of(cavity(COLOURS), 200)
    assert algorithm.problem.groups.n_groups == 3
    state = advanced(algorithm, *stages)
    assert (np.abs(apart(means(algorithm, state))) < limit()).all()
    algorithm.tally.forget()
    monkeypatch.setattr(firing_process, "send", not_sent)
    assert (np.abs(apart(means(algorithm, state))) > limit()).any()


def test_groups_lack_what_they_lack_together(monkeypatch):
    """In groups of many patches the scene has no bias either, nor have its large surfaces."""
    patches = cavity(cells=8)
    assert residue.group_size(len(patches), 200) > 100
    algorithm = process_of(patches, 200, rd.Method(numbers="random"))
    state = advanced(algorithm, 200)
    assert abs(apart(means(algorithm, state))[0]) < limit()
    values, unit = algorithm.tally.irradiance(algorithm.problem, state, 0)
    for surface in np.unique(patches.surface):
        here = patches.surface == surface
        if patches.area[here].sum() > 0.5:
            assert abs(apart(values[:, here].sum(axis=1)[None] * (unit / patches.area[here].sum()))[0]) < limit()


def test_the_residue_is_what_the_contract_owes_less_what_was_fired():
    patches = rd.subdivide(rd.load_scene("room"), cells=3)
    algorithm = process_of(patches, 2, seed=5)
    state, phase = advanced(algorithm, 700), phases(5, 2, len(patches))
    source = algorithm.problem.source
    assert np.array_equal(target_counts(source, 700, state.arrivals, phase), state.fired)
    whole, fraction = source.emitted(700)
    read = residue.Residue.of(algorithm.problem, state, phase).read(1, slice(0, len(patches)))[1][:, 0]
    for i in range(len(patches)):
        exact = (int(whole[i]) << 32) + int(fraction[i]) + int(source.rho[i]) * int(state.arrivals[1, i])
        assert read[i] == exact - (int(state.fired[1, i]) << 32)


@pytest.mark.parametrize("quanta", [100, 3_000, 300_000])
def test_less_than_a_line_is_left_up_to_any_group(quanta):
    """Signed sums of lines follow those of residues along the groups; lines begin within theirs, where something is owed."""
    patches = rd.subdivide(rd.load_scene("room"), cells=12)
    algorithm = process_of(patches, 2, seed=3)
    state, phase = advanced(algorithm, quanta), phases(3, 2, len(patches))
    starts = residue_walks.starts(algorithm.counters, algorithm.problem, state)
    groups = residue.Groups.of(patches, quanta)
    begins = np.arange(len(patches)) if groups.begins is None else groups.begins
    assert (groups.begins is None) == (residue.group_size(len(patches), quanta) == 1)
    assert np.array_equal(np.concatenate([begin + part.start for part, begin in groups.parts()]), begins)
    assert (np.abs(starts.power) == QUANTUM).all()
    for replicate in range(2):
        here = starts.replicate == replicate
        has_due, left = residue.Residue.of(algorithm.problem, state, phase).read(replicate, slice(0, len(patches)))
        assert (has_due[starts.patch[here]] > 0).all()
        lines = np.bincount(starts.patch[here], np.sign(starts.power[here, 0]), len(patches))
        sums, wanted = (np.cumsum(np.add.reduceat(x, begins)) for x in (lines, left[:, 0] / 2**32))
        assert (np.abs(sums - wanted) < 1 + 1e-9).all()
        assert np.array_equal(starts.line[here], np.arange(here.sum()))


def test_lines_of_groups_are_right_in_the_mean():
    """The mean of many roundings is the group's residue; bands keep their ratio to the largest."""
    left = np.array([[3 << 30, -(1 << 30)], [-(7 << 28), 1 << 28], [0, 0], [5 << 33, 1 << 33]])
    groups = residue.Groups(4, np.array([0, 2, 3]))

    class Known(residue.Residue):
        def read(self, replicate, part):
            return np.array([1 << 32, 0, 0, 7], np.uint64)[part], left[part]

    known, total, runs = Known(*[None] * 5), np.zeros((4, 2)), 1_000
    for seed in range(runs):
        patch, power = residue._lines(known, 0, groups, np.random.Generator(np.random.Philox(seed)))
        np.add.at(total, patch, power / QUANTUM)
    expected = np.array([left[0] + left[1], [0, 0], [0, 0], left[3]]) / 2**32
    error = np.sqrt(np.abs(expected) * (1 - np.minimum(np.abs(expected), 1)) / runs) + 1e-9
    assert (np.abs(total / runs - expected) < limit() * error + 1e-6).all()


def test_lines_of_a_group_begin_in_proportion_to_what_patches_owe_up_to_one_line():
    """However much a patch has sent: its residue is less than a line."""
    from scipy.stats import chisquare

    target_counts = np.array([1 << 30, 1 << 31, 1 << 32, 5 << 40, 0, 3 << 32, 1 << 31], np.uint64)
    begins, each = np.array([0, 5]), 40_000
    found = residue._within(target_counts, begins, np.repeat([0, 1], each), np.random.Generator(np.random.Philox(5)))
    counts = np.bincount(found, minlength=len(target_counts))
    assert counts[4] == 0
    share = np.array([0.25, 0.5, 1, 1, 0, 1, 0.5])
    expected = each * share / np.repeat([2.75, 1.5], [5, 2])
    for group in ([0, 1, 2, 3], [5, 6]):
        assert counts[group].sum() == each
        assert chisquare(counts[group], expected[group]).pvalue > ALPHA


def test_groups_keep_to_faces_or_surfaces():
    patches = rd.subdivide(rd.load_scene("room"), cells=12)
    groups = residue.Groups.of(patches, 5_000)
    size = residue.group_size(len(patches), 5_000)
    assert 1 < size < residue.MOST
    assert set(patches.first[:-1]) <= set(groups.begins)
    widths = np.diff(np.append(groups.begins, len(patches)))
    assert widths.min() > 0
    assert widths.max() <= size
    assert residue.Groups.of(rd.subdivide(rd.load_scene("room"), cells=1), 10).begins.tolist() == [0]  # more faces than groups
    assert residue.Groups.of(patches, 10**7).begins is None


def read(method, patches, *stages, seed=4):
    algorithm = process_of(patches, 3, method, seed)
    state = advanced(algorithm, *stages)
    values = [algorithm.tally.irradiance(algorithm.problem, state, g)[0] for g in range(algorithm.problem.groups.n_groups)]
    return np.array(values), algorithm.tally.books(algorithm.problem, state, 0), algorithm.tally.lines(algorithm.problem, state)


@pytest.mark.parametrize("numbers", ["halton", "random"])
def test_results_are_equal_in_any_order_and_stages_and_on_any_threads(numbers):
    patches, before = cavity(gap=0.1, cells=5), dr.thread_count()
    first = read(rd.Method(numbers=numbers), patches, 4_000)
    assert (np.abs(first[0] % QUANTUM) > 0).any()  # not hits alone
    for order in ("depth-first", "staged", "well-distributed"):
        other = read(rd.Method(numbers=numbers, order=order), patches, 4_000)
        assert np.array_equal(other[0], first[0])
        assert other[1:] == first[1:]
    assert np.array_equal(read(rd.Method(numbers=numbers), patches, 3, 1_000, 3_999, 4_000)[0], first[0])
    assert not np.array_equal(read(rd.Method(numbers=numbers), patches, 4_000, seed=5)[0], first[0])
    try:
        for threads in (1, 2, 3):
            dr.set_thread_count(threads)
            assert np.array_equal(read(rd.Method(numbers=numbers), patches, 4_000)[0], first[0])
    finally:
        dr.set_thread_count(before)


@few_lines
@pytest.mark.parametrize(("make_patches", "half"), [(lambda: cavity(gap=0.1), 5_000), (opened, 2**19)], ids=["grey", "coloured"])
def test_a_saved_run_goes_on_to_the_bits_of_one(make_patches, half, tmp_path):
    patches, quanta = make_patches(), half
    whole = rd.solve(patches, "random-walk", quanta=2 * quanta, replicates=2)
    rd.solve(patches, "random-walk", quanta=quanta, replicates=2).save(tmp_path / "half.npz")
    half = rd.load_solution(tmp_path / "half.npz")
    again = rd.solve(patches, "random-walk", quanta=quanta, replicates=2, resume=half)
    assert np.array_equal(again.irradiance, half.irradiance)
    assert again.rays == half.rays
    later = rd.solve(patches, "random-walk", quanta=2 * quanta, replicates=2, resume=half)
    assert np.array_equal(later.irradiance, whole.irradiance)
    assert np.array_equal(later.surface_power, whole.surface_power)
    assert later.books == whole.books
    assert later.rays == whole.rays >= whole.state["fired"].sum()


def test_books_close_with_what_the_residue_brings():
    for patches in (cavity(), opened()):
        algorithm = process_of(patches, 5)
        for quanta in (30, 300, 3_000):
            state = advanced(algorithm, quanta)
            sent = algorithm.tally.sent(state)
            landed = sent.received - not_sent(algorithm.counters, algorithm.problem, state, algorithm.tally.begun(state)).received
            assert landed.any()
            assert [int(landed[..., g].sum() + sent.missed[..., g].sum()) for g in range(len(sent.fired))] == sent.fired
            for group in range(algorithm.problem.groups.n_groups):
                assert algorithm.tally.books(algorithm.problem, state, group)["closes"] is True


def test_energy_is_kept_but_for_walks_that_end_by_chance():
    """Of lines that lose no weight by chance (reflectance 0) all that is unsent is less than one a replicate."""
    rho = np.array([0.5, 0, 0, 0, 0, 0])
    patches = rd.subdivide(cube(rho, np.ones(6)), cells=3)
    for quanta in (50, 500, 5_000):
        algorithm = process_of(patches, 4)
        book = algorithm.tally.books(algorithm.problem, advanced(algorithm, quanta), 0)
        assert abs(book["rounding"]) < 2 * algorithm.problem.source.power / quanta


@few_lines
@pytest.mark.parametrize("rays", [40_000, 400_000, 2_000_000])
def test_residue_lines_count_as_rays(rays):
    patches = rd.subdivide(rd.load_scene("room"), cells=8)
    solution = rd.solve(patches, "random-walk", rays=rays, seed=2)
    assert solution.rays == pytest.approx(rays, rel=0.05)
    fired = solution.state["fired"].sum()
    assert fired < solution.rays < 1.12 * fired
    assert fired == solution.state["arrivals"].sum() + solution.state["missed"].sum()  # no hit of the residue is among them


def test_intermediate_stages_send_nothing(monkeypatch):
    taken, send = [], firing_process.send

    def counted(counters, problem, state, begun):
        taken.append(state.quanta)
        return send(counters, problem, state, begun)

    monkeypatch.setattr(firing_process, "send", counted)
    patches = cavity()
    rd.solve(patches, quanta=4_096, replicates=2, order="staged")
    assert taken == [4_096]  # and none of the stages of 1024 and 2048
    taken.clear()
    rd.solve(patches, quanta=4_096, replicates=2, order="staged", progress=lambda moment: None)
    assert taken == [1_024, 2_048, 4_096]


@few_lines
def test_negative_irradiance_is_kept_and_told_everywhere(tmp_path):
    """A patch that the residue alone reached may be below zero: that is what makes the mean right."""
    patches = rd.subdivide(rd.load_scene("room"), cells=8)
    solution = rd.solve(patches, "random-walk", quanta=100, seed=1)
    assert solution.irradiance.min() < 0
    assert (solution.arrivals[(solution.irradiance < 0)[:, 0]] < 8).all()
    low, high = solution.interval(quantity="irradiance")
    assert np.isfinite(low).all()
    assert (low <= high).all()
    assert (solution.irradiance_standard_error > 0).all()
    for name in ("a.csv", "a.npz", "a.vtp", "a.glb"):
        solution.export(tmp_path / name)
    assert np.array_equal(rd.load_solution(tmp_path / "a.npz").irradiance, solution.irradiance)
    assert "-" in (tmp_path / "a.csv").read_text().split("\n", 1)[1]
    assert solution.report()
    dark = dataclasses.replace(solution, irradiance=-np.abs(solution.irradiance))
    assert dark.report()
    dark.export(tmp_path / "b.glb")


def test_weights_fall_with_the_reflectance_and_chance_keeps_their_mean():
    """In a cube of reflectance 0.75 all that a walk brings is 1 / (1 - 0.75) in the mean, line by line less."""
    patches = rd.subdivide(cube(0.75, 0.25), cells=1)
    algorithm = process_of(patches, 1)
    m, types = 20_000, algorithm.counters.types
    starts = residue.Starts(np.zeros(m, np.int64), np.zeros(m, np.int64), np.arange(m, dtype=np.uint32), np.full((m, 1), QUANTUM))
    tally = upload(types.Int64, np.zeros(8, np.int64))
    fired, lines = residue_walks._walk(algorithm.counters, starts, tally)
    brought = np.array(tally)[:6].sum() / QUANTUM / m
    assert fired == [int(np.array(tally).sum())]
    exact = float(Fraction(1) / (1 - Fraction(3, 4)))
    # 0.75, 0.5625 and then 0.421875 = 0.84375 / 2: three lines for sure, then geometric with steps of 1/2
    deviation = np.sqrt(27 / 32 * (1 + 2 * 3) * 4 / 4)  # of all that is brought, at most: half a geometric number of mean 4
    assert abs(brought - exact) < limit() * deviation / np.sqrt(m)
    assert lines / m == pytest.approx(3 + 27 / 32 * 4, rel=0.03)
