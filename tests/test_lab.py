"""The paper's claims, as tests over what ``radiosity experiment all --quick`` computes, with half its lines and a shorter
reference; and the machinery of the study.

Slopes have five replicates; an interval at alpha = 1e-3 (Student, 4 degrees of freedom) is 3.1 times the 95 % one printed.
"""

import csv
import os
import shutil
from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.lab import cases, kept, pictures, report, slopes
from radiosity.lab.bits import bits
from radiosity.lab.calibration import LEVELS, coverage
from radiosity.lab.discretisation import discretisation
from radiosity.lab.experiments import EXPERIMENTS, module
from radiosity.lab.measure import Series
from radiosity.lab.results import Results
from radiosity.lab.run import _write, run
from radiosity.lab.start import starts
from radiosity.lab.study import Arm, Claim, Protocol

SHORT = Protocol(last=16, reference=20)
WIDER = 8.61 / 2.776
SCENES = ("labyrinth-0.1", "labyrinth-0.5", "labyrinth-0.9", "room")
FEW = ("labyrinth-0.9", "room")  # of the experiments; all scenes with the slow tests


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("study")


@pytest.fixture(scope="module", params=[FEW, pytest.param(SCENES, marks=pytest.mark.slow)], ids=["few", "all"])
def scenes(request):
    """The scenes of the experiments, within the modules too."""
    with pytest.MonkeyPatch.context() as patch:
        for number in (1, 2, 3, 4):
            patch.setattr(module(number), "SCENES", request.param)
        yield request.param


@pytest.fixture(scope="module")
def study(folder, scenes):
    known = {}

    def get(number):
        if number not in known:
            known[number] = run(number, SHORT, folder / "series", lambda what, done, total: None)
        return known[number]

    return get


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """What draws the picture of the scenes, once for all reports."""
    made = pictures.scenes(tmp_path_factory.mktemp("drawn") / "scenes", SHORT)

    def draw(path, protocol):
        return [shutil.copy(picture, path.with_suffix(picture.suffix)) for picture in made]

    return draw


def test_random_numbers_converge_with_the_root_of_the_lines(study, scenes):
    for scene in scenes:
        slope = study(4).slope(scene, "random")
        assert abs(slope.value + 0.5) < WIDER * slope.half, scene
        assert slope.half < 0.1, scene


def test_halton_is_steeper_in_the_local_discrete_walk_and_better_at_the_end(study, scenes):
    results = study(4)
    for scene in scenes:
        assert results.slope(scene, "halton").value < -0.55, scene
        assert results.last(scene, "halton") < results.last(scene, "random"), scene


def test_generators_are_within_a_factor_of_two(study, scenes):
    for scene in scenes:
        last = [study(4).last(scene, name) for name in module(4).SEQUENCES]
        assert max(last) < 2 * min(last), scene


def test_global_lines_without_a_first_shot_are_clearly_worse_in_the_room(study):
    results = study(2)
    for kind in ("random", "Halton"):
        worse, within = results.ratio("room", f"global, {kind}", f"local, {kind}")
        assert worse / within > 3
        repaired, _ = results.ratio("room", f"global, first shot, {kind}", f"local, {kind}")
        assert repaired < worse / 3


def test_order_has_no_influence(study, scenes):
    """To the bit on one machine; and the slope of an iteration, which draws lines anew, is not less steep."""
    results = study(1)
    for scene in scenes:
        for kind in ("random", "Halton"):
            for name in ("WDRS", "Shirley", "Feda-Purgathofer"):
                assert results.equal(scene, f"{name}, {kind}", f"random walk, {kind}"), scene
            ray, walk = results.slope(scene, f"stochastic ray, {kind}"), results.slope(scene, f"random walk, {kind}")
            assert ray.value - walk.value < WIDER * np.hypot(ray.half, walk.half), scene


BEYOND = (8, 9)  # of the open ends of the paper


@pytest.mark.parametrize(
    "number",
    [pytest.param(n, marks=[pytest.mark.slow] * (n in BEYOND)) for n in EXPERIMENTS if hasattr(module(n), "SCENES")],
)
def test_every_claim_has_a_verdict_and_figures(study, number):
    for claim in module(number).claims(study(number)):
        assert claim.agrees in (True, False, None)
        assert any(character.isdigit() for character in claim.found) or "bit" in claim.found


def made_up(number, slope):
    """Return results of an experiment whose errors fall with given exponents: ``slope`` of the arm's name."""
    lines, found = 2.0 ** np.arange(10, 21), {}
    for scene in module(number).SCENES:
        for arm in module(number).ARMS:
            noise = 1 + 0.01 * np.random.default_rng(len(arm.name)).standard_normal((5, len(lines)))
            errors = lines ** slope(arm.name) * noise
            found[scene, arm.name] = Series(lines, lines / 1e6, errors, errors, np.full_like(errors, np.nan))
    return Results(found)


EXPECTED = {  # slopes with which all claims agree, slopes with which some do not and their verdicts, and all other slopes
    8: (
        {"spans, Halton": -0.602, "spans, Sobol": -0.56},
        {"two points, Sobol": -0.7, "spans, Sobol": -0.65},
        [False, False, False],
        -0.6,
    ),
    9: ({"sorted, Halton": -0.65, "sorted, Sobol": -0.65}, {"sorted, Halton": -0.45}, [False, True, False], -0.5),
}


@pytest.mark.parametrize("number", BEYOND)
def test_claims_about_open_ends_follow_from_slopes_and_errors(number):
    good, bad, verdicts, other = EXPECTED[number]
    for slope, expected in ((good, [True, True, True]), (bad, verdicts)):
        claims = module(number).claims(made_up(number, lambda name, slope=slope: slope.get(name, other)))
        assert [claim.agrees for claim in claims] == expected
        assert all(scene in claim.found for claim in claims for scene in module(number).SCENES)


def test_lines_are_met_and_errors_have_every_replicate(study):
    for series in study(3).series.values():
        assert series.lines == pytest.approx(SHORT.rungs, rel=0.1)
        assert series.area_weighted.shape == (SHORT.replicates, len(SHORT.rungs))
        assert (series.area_weighted > 0).all()
        assert (np.diff(series.seconds) > 0).all()


def test_a_study_goes_on_where_it_stopped(tmp_path):
    protocol, told = Protocol(last=11, replicates=2, reference=1), []

    def stop(what, done, total):
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(4, protocol, tmp_path, stop)
    before = {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert len(before) == 3
    run(4, protocol, tmp_path, lambda what, done, total: told.append(done))
    assert told[-1] == 7 * len(module(4).SCENES)
    assert all(path.stat().st_mtime_ns == time for path, time in before.items())


def test_a_slope_is_recovered_with_its_interval():
    lines = 2.0 ** np.arange(10, 20)
    random = np.random.default_rng(0)
    errors = 3 * lines**-0.625 * np.exp(0.05 * random.standard_normal((5, len(lines))))
    slope = slopes.fit(lines, errors)
    assert abs(slope.value + 0.625) < WIDER * slope.half < 0.2
    assert str(slope).startswith("-0.6")


def test_starts_end_alike_and_breadth_first_lacks_light_before():
    case = cases.maze("labyrinth-0.5")
    depth, staged, breadth = starts(case, cases.ones(case), 3)
    assert np.array_equal(depth.errors[:, -1], staged.errors[:, -1])
    assert np.array_equal(depth.errors[:, -1], breadth.errors[:, -1])
    early = slopes.mean_error(breadth.errors)[0]
    at = np.searchsorted(depth.lines, breadth.lines[0])
    assert early > 3 * slopes.mean_error(depth.errors)[at]


def test_hashes_agree_but_for_another_seed():
    rows = bits(cases.maze("labyrinth-0.5"), 7)
    assert len({row.digest for row in rows[:-1]}) == 1
    assert rows[-1].digest != rows[0].digest


def test_intervals_hold_the_truth_as_often_as_they_say():
    case = cases.maze("labyrinth-0.5")
    covered = coverage(Arm("halton", rd.Method(), "halton"), case, cases.ones(case), 1).covered
    for level, (share, error) in zip(LEVELS, covered, strict=True):
        assert abs(share - level) < 4 * error + 0.005


@pytest.mark.slow
def test_discretisation_error_falls_with_the_mesh_and_is_less_for_continuous_walks():
    coarse, fine = (discretisation(count, 3e6, 5) for count in (2, 5))
    assert fine.discrete < 0.9 * coarse.discrete
    assert coarse.continuous < coarse.discrete
    assert 0.3 * coarse.discrete < coarse.delta < 1.5 * coarse.discrete


@pytest.mark.parametrize(
    ("number", "text"),
    [(2, "first shot"), pytest.param(5, "All runs of one seed end in the same bits", marks=pytest.mark.slow)],
)
def test_the_command_writes_a_report_that_stands_alone(study, folder, drawn, capsys, monkeypatch, number, text):
    """That of experiment 2 from series that the tests above have made."""
    from radiosity.cli.app import run as command

    for name in ("study", "make"):
        monkeypatch.setattr(f"radiosity.lab.{name}.QUICK", SHORT)
    monkeypatch.setattr(pictures, "scenes", drawn)
    if number == 2:
        study(2)
    assert command(["experiment", str(number), "--quick", "-o", str(folder)]) == 0
    report = (folder / f"report-{number}-quick.html").read_text()
    assert capsys.readouterr().out.strip() == str(folder / f"report-{number}-quick.html")
    assert text in report
    assert "src=" not in report.replace("src='data:", "")
    assert command(["experiment", "99", "-o", str(folder)]) == 2
    assert "known are 1, 2, 3, 4, 5, 6, 7, 8, 9 and all" in capsys.readouterr().err


@pytest.mark.slow
def test_the_page_of_baselines_compares_runs_in_processes_of_their_own(tmp_path, monkeypatch):
    from radiosity.lab import contest
    from radiosity.lab.experiments import baselines

    arms = {name: contest.ARMS[name] for name in ("random walk", "full matrix, hemicubes", "progressive, hemicubes")}
    runs = (("8 pixels", {"resolution": 8}), ("32 pixels", {"resolution": 32}))
    arms["full matrix, hemicubes"] = replace(arms["full matrix, hemicubes"], runs=runs)
    arms["progressive, hemicubes"] = replace(arms["progressive, hemicubes"], most=10)
    monkeypatch.setattr(contest, "ARMS", arms)
    monkeypatch.setattr(baselines, "ARMS", arms)
    monkeypatch.setattr(baselines, "QUICK_REFERENCE", 3_000_000)
    figure, *_, verdict, table = baselines.extras(SHORT, tmp_path)
    assert "<svg" in figure
    assert "random walk has" in verdict
    assert "not run: it would take too long with more than 10 patches" in table
    rows = [row.split("</td><td>") for row in table.split("<tr>")[2:]]
    errors = {(row[0][4:], row[3]): float(row[4].strip("%")) for row in rows if row[4]}
    for scene in ("room", "hall"):
        assert errors[scene, "1e+06 lines"] < errors[scene, "1e+05 lines"]
        assert errors[scene, "32 pixels"] < 1.05 * errors[scene, "8 pixels"]
    assert all(float(row[7].split("<")[0]) < 500 for row in rows if row[4])  # MiB of a few hundred patches


def test_the_page_of_bases_compares_meshes(tmp_path, monkeypatch):
    bases = module(7)
    for name, value in (("ROOMS", ("room",)), ("QUICK_CELLS", (1,)), ("FINER", 2), ("QUICK_LINES", 400_000)):
        monkeypatch.setattr(bases, name, value)
    figure, reference, verdict, table = bases.extras(Protocol(last=13, replicates=3), tmp_path)
    assert "<svg" in figure
    assert "reference of room in 72 patches" in reference
    assert verdict.count("Not in the paper") == 2
    rows = [row.replace("<tr><td>", "").split("</td><td>") for row in table.split("</tr>")[1:-1]]
    assert {(row[1], row[2]) for row in rows} == {("constant", "72"), ("linear", "18"), ("quadratic", "18")}
    assert all(0 < float(row[4].strip("%")) < 60 for row in rows)


def test_a_baseline_that_does_not_fit_has_a_row_that_says_so():
    from radiosity.lab.footprint import footprints

    found = footprints("room", 1_000_000, "full-matrix-hemicube", [("64 pixels", {})], warm=False)
    assert isinstance(found, str)
    assert "GiB are free" in found


def test_figures_tables_and_stores(tmp_path, drawn, monkeypatch):
    import xarray

    from radiosity.lab.make import make

    monkeypatch.setattr(module(4), "SCENES", ("labyrinth-0.1", "room"))
    monkeypatch.setattr(pictures, "scenes", drawn)
    protocol = Protocol(last=12, replicates=2, reference=2)
    report = make([4], protocol, tmp_path, "radiosity experiment 4", lambda *told: None, image=True)
    assert report.read_text().count("<svg") == 2
    for name in ("experiment-4.png", "experiment-4.svg", "experiment-4-picture.png"):
        assert (tmp_path / name).stat().st_size > 10_000
    with (tmp_path / "results-4.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 7 * 2 * 2 * len(protocol.rungs)
    with xarray.open_dataset(tmp_path / "experiment-4.nc", engine="scipy") as store:
        assert store["error_area_weighted"].shape == (7, 2, 2, len(protocol.rungs))
        assert store.attrs["command"] == "radiosity experiment 4"
        assert float(store["error_area_weighted"].sel(arm="sobol", scene="room")[0, -1]) > 0
    room = [row for row in rows if row["scene"] == "room" and row["arm"] == "halton"]
    assert all(0 < float(row["error_picture"]) < 1 for row in room)


def test_parts_that_are_done_are_kept_while_their_figures_are_there(tmp_path):
    made = []

    def make(protocol, folder):
        made.append(protocol)
        (folder / "experiment-5.svg").write_text("<svg/>", "utf-8")
        return [f"<p>{len(made)}</p>"]

    short, long = Protocol(last=11), Protocol(last=12)
    assert kept.parts(5, make, short, tmp_path) == kept.parts(5, make, short, tmp_path) == ["<p>1</p>"]
    assert kept.parts(5, make, long, tmp_path) == ["<p>2</p>"]  # another study
    assert kept.parts(5, make, short, tmp_path) == ["<p>1</p>"]
    (tmp_path / "experiment-5.svg").unlink()
    assert kept.parts(5, make, short, tmp_path) == ["<p>3</p>"]


def test_two_studies_of_one_folder_do_not_meet(tmp_path, monkeypatch):
    """Another process writes the same series while this one does: both go on, and the file is whole at any time."""
    path, savez, own = tmp_path / "series-room-1.npz", np.savez, os.getpid()

    def meanwhile(file, lines):
        savez(file, lines=lines)
        if os.getpid() == own:
            monkeypatch.setattr(os, "getpid", lambda: 1)
            _write(path, {"lines": np.arange(3)})
            monkeypatch.setattr(os, "getpid", lambda: own)
            assert np.load(path)["lines"].tolist() == [0, 1, 2]

    monkeypatch.setattr(np, "savez", meanwhile)
    _write(path, {"lines": np.arange(4)})
    assert np.load(path)["lines"].tolist() == [0, 1, 2, 3]
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def test_only_the_papers_claims_are_called_so():
    page = report.verdicts([Claim("Halton behaves well.", True, "a"), Claim("Not in the paper: ours is faster.", None, "b")])
    assert page.count("The paper:") == 1
    assert "<b>The paper:</b> Halton" in page
    assert "<b>Not in the paper:</b> ours" in page
