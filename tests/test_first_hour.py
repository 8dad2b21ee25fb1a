"""What a new user meets first: folders, extras, coordinates below zero, frames and five lines, lux, and results that warnings do
not take away."""

import itertools
import re
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

import radiosity as rd
from radiosity.cli.app import run
from radiosity.image import check_writable, legend
from radiosity.run.error_target import Target

ROOT = Path(__file__).resolve().parent.parent
SUFFIXES = (".npz", ".glb", ".ply", ".vtp", ".csv", ".png", ".exr")


@pytest.fixture(scope="module")
def box():
    """Of the Cornell box, in three bands."""
    return rd.solve(rd.subdivide(rd.load_scene("cornell-box"), cells=2), "random-walk", rays=50_000)


@pytest.fixture(scope="module")
def room():
    return rd.solve(rd.subdivide(rd.load_scene("room"), cells=2), "random-walk", rays=50_000)


@pytest.fixture(scope="module")
def photometric():
    """A lamp over a floor, in lm/m²."""
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (0, 1, 1), (1, 1, 1), (1, 0, 1)]
    scene = rd.Scene.from_arrays(
        corners, [(0, 1, 2, 3), (4, 5, 6, 7)], [0.5, 0.0], [0.0, 100.0], surface=[0, 1], names=["floor", "lamp"], photometric=True
    )
    return rd.solve(rd.subdivide(scene, cells=2), "random-walk", rays=20_000)


# ---- folders -------------------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("small_pictures")
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_outputs_make_their_folder_and_a_check_leaves_no_trace(room, tmp_path, suffix):
    path = tmp_path / "new" / "er" / f"a{suffix}"
    check_writable(path)
    assert not list(tmp_path.iterdir())
    room.export(path)
    assert path.stat().st_size > 0


def test_the_command_makes_folders_of_outputs_and_checkpoints(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["solve", "room", "--cells", "1", "--rays", "10k", "-o", "out/x.npz", "--checkpoint", "kept/y.npz"]) == 0
    assert (tmp_path / "out" / "x.npz").exists()
    assert run(["render", "out/x.npz", "-o", "pictures/x.png", "--width", "40"]) == 0
    assert (tmp_path / "pictures" / "x.png").exists()
    solution = rd.load_solution("out/x.npz")
    solution.save("deep/er/z.npz")
    assert rd.load_solution("deep/er/z.npz").rays == solution.rays
    capsys.readouterr()
    (tmp_path / "file").write_text("")
    assert run(["solve", "room", "-o", "file/deep/x.npz"]) == 2
    assert "'file' is a file, not a folder" in capsys.readouterr().err.replace(f"{tmp_path}/", "")


# ---- extras --------------------------------------------------------------------------------------------------------------


def test_extras_have_one_name(monkeypatch, tmp_path):
    """Whatever is missing, the same words say how to get it."""
    from radiosity import errors
    from radiosity.image import output
    from radiosity.lab import make
    from radiosity.solution import frames

    monkeypatch.setattr(output, "find_spec", lambda module: None)
    monkeypatch.setattr(frames, "find_spec", lambda module: None)
    solution = SimpleNamespace()
    for attempt in (
        lambda: output.require("matplotlib", "the legend"),
        lambda: frames.to_xarray(solution),
        lambda: frames.to_dataframe(solution),
        lambda: make.make([4], None, tmp_path / "new", "", None),
    ):
        with pytest.raises(rd.OutputError, match=r"pip install 'radiosity\[all\]'") as caught:
            attempt()
        assert errors.INSTALL in str(caught.value)
    assert not list(tmp_path.iterdir())  # the study says so before it begins
    others = [
        line
        for path in [*ROOT.glob("src/**/*.py"), *ROOT.glob("docs/*.md"), ROOT / "README.md"]
        for line in path.read_text(encoding="utf-8").splitlines()
        if re.search(r"install.*radiosity\[(?!all\]|ifc\]|\{extra\})", line)
    ]
    assert not others  # but for IFC, whose 40 MB few need


# ---- the study -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "numbers", "command"),
    [
        (["1", "3"], [1, 3], "radiosity experiment 1 3"),
        (["3", "1", "3"], [1, 3], "radiosity experiment 3 1 3"),
        (["4", "all", "--quick"], [1, 2, 3, 4, 5, 6, 7, 8, 9], "radiosity experiment 4 all --quick"),
    ],
)
def test_several_experiments_run_in_one_command(monkeypatch, tmp_path, words, numbers, command):
    from radiosity.lab import make

    asked = []
    monkeypatch.setattr(make, "make", lambda *arguments, **options: asked.append(arguments) or tmp_path)
    assert run(["experiment", *words, "-o", str(tmp_path)]) == 0
    assert (asked[0][0], asked[0][3]) == (numbers, command)


def test_reports_of_different_commands_have_different_names():
    from radiosity.lab.experiments import EXPERIMENTS
    from radiosity.lab.make import _tag
    from radiosity.lab.study import FULL, QUICK

    asked = [(list(EXPERIMENTS), FULL), (list(EXPERIMENTS), QUICK), ([1], FULL), ([3], FULL), ([1, 3], FULL), ([1, 3], QUICK)]
    assert [_tag(*one) for one in asked] == ["", "-quick", "-1", "-3", "-1-3", "-1-3-quick"]


def test_curves_that_coincide_stay_apart():
    """Each has a width, a mark and places of marks that no neighbour has."""
    from radiosity.lab.figures import _look

    looks = [_look(number, 7) for number in range(7)]
    assert len({look["marker"] for look in looks}) == 7
    widths = [look["linewidth"] for look in looks]
    assert (np.diff(widths) < -0.3).all()
    assert all(one["markevery"] != other["markevery"] for one, other in itertools.pairwise(looks))


def test_pages_agree_on_how_long_the_study_takes():
    from radiosity.cli.experiment import experiment

    pages = (ROOT / "README.md").read_text(), (ROOT / "docs" / "experiments.md").read_text(), experiment.__doc__ or ""
    for page in pages:
        assert "two to three minutes" in page
        assert "fifty" in page


# ---- solutions at a prompt -----------------------------------------------------------------------------------------------


def test_a_solution_shows_itself_in_five_lines(box, room):
    for solution in (box, room):
        lines = repr(solution).splitlines()
        assert len(lines) == 5
        assert max(map(len, lines)) < 140
        assert f"{solution.rays:,}" in lines[2]
        assert solution.status in lines[2]
        area = solution.patches.area
        for value in area @ solution.irradiance / area.sum():
            assert f"{value:.4g} W/m² ±" in lines[4]
    assert "<table>" in box._repr_html_()
    assert box._repr_html_().count("<tr>") == 10  # a head, eight surfaces, and the lamp's back


def test_what_is_not_known_is_not_shown(room):
    from radiosity.solution.without_results import without_results

    none = without_results(room.patches, 8, 1.0, "interrupted", room.provenance, {})
    assert len(repr(none).splitlines()) == 5
    assert "unknown (no stage is complete yet)" in repr(none)
    assert "<table>" not in none._repr_html_()
    single = rd.solve(room.patches, "random-walk", rays=5_000, replicates=1)
    assert "±" not in repr(single)


def test_markup_in_names_is_shown_as_it_is():
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1]]
    scene = rd.Scene.from_arrays(corners, [[0, 1, 2], [5, 4, 3]], 0.5, 1.0, names=["<b>x</b>"])
    shown = rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=5_000)._repr_html_()
    assert "&lt;b&gt;x&lt;/b&gt;" in shown


def test_frames_hold_the_results(box):
    import pandas

    frame = box.to_dataframe()
    assert frame.index.name == "patch"
    np.testing.assert_array_equal(frame["irradiance green [W/m²]"], box.irradiance[:, 1])
    assert frame["surface"][0] == box.patches.scene.names[box.patches.surface[0]]
    low, high = box.interval(0.95, "irradiance")
    np.testing.assert_array_equal(frame["irradiance, 95 % to blue [W/m²]"], high[:, 2])
    data = box.to_xarray()
    np.testing.assert_array_equal(data["radiosity"].sel(band="red"), box.radiosity[:, 0])
    np.testing.assert_array_equal(data["irradiance_low"], low)
    assert data["irradiance"].attrs["units"] == "W/m²"
    means = (data["irradiance"] * data["area"]).groupby("surface").sum() / data["area"].groupby("surface").sum()
    row = next(row for row in box.surface_table() if row["surface"] == "floor")
    assert float(means.sel(surface="floor", band="red")) == pytest.approx(row["irradiance [red]"])
    assert isinstance(frame, pandas.DataFrame)


# ---- the command line ----------------------------------------------------------------------------------------------------


def test_coordinates_and_ranges_below_zero_need_no_equals_sign(room, tmp_path, monkeypatch):
    room.save(tmp_path / "a.npz")
    asked = {}
    monkeypatch.setattr("radiosity.image.render", lambda loaded, path, **options: asked.update(options))
    arguments = ["--origin", "-1,0.5,0.5", "--target", "-2,.5,1", "--range", "-1,1", "--false-color", "--exposure", "-1"]
    assert run(["render", str(tmp_path / "a.npz"), "-o", str(tmp_path / "a.png"), *arguments, "--samples", "9"]) == 0
    assert asked["camera"].origin == (-1, 0.5, 0.5)
    assert asked["camera"].target == (-2, 0.5, 1)
    assert (asked["range"], asked["exposure"], asked["samples"]) == ((-1, 1), -1, 9)


def test_more_samples_make_finer_edges(room, tmp_path):
    room.save(tmp_path / "a.npz")
    pictures = {}
    for samples in ("1", "16"):
        path = tmp_path / f"{samples}.png"
        options = ["--width", "30", "--no-smooth", "--samples", samples]
        assert run(["render", str(tmp_path / "a.npz"), "-o", str(path), *options]) == 0
        with Image.open(path) as picture:
            pictures[samples] = np.asarray(picture).astype(int)
    assert len(np.unique(pictures["1"])) < len(np.unique(pictures["16"]))  # edges between patches have tones of their own


def test_powers_of_two_give_other_methods_the_patches_of_hierarchical(tmp_path):
    def patches(*arguments):
        assert run(["solve", "room", *arguments, "-o", str(tmp_path / "a.npz")]) == 0
        return rd.load_solution(tmp_path / "a.npz").patches

    theirs = patches("--method", "hierarchical", "--patch-size", "0.9", "--seconds", "1")
    ours = patches("--patch-size", "0.9", "--powers-of-two", "--rays", "10k")
    assert ours.hash == theirs.hash != patches("--patch-size", "0.9", "--rays", "10k").hash
    alone = patches("--powers-of-two", "--rays", "20k")
    assert (np.log2(alone.columns) % 1 == 0).all()
    assert 5_000 < len(alone) < 80_000


def test_bounds_that_are_left_out_say_so(room):
    with pytest.raises(rd.SceneError, match=r"max_reflectance is 1; it must be above 0 and strictly below 1"):
        rd.load_scene(str(ROOT / "README.md"), max_reflectance=1)
    with pytest.raises(rd.MethodError, match="above 0 and strictly below 1"):
        room.interval(1.0)
    with pytest.raises(rd.MethodError, match="level is 'floor'; it must be above 0"):
        room.surface_interval("floor")
    with pytest.raises(rd.SceneError, match="strictly below 1"):
        rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 1.0, 1.0)


LEGENDS = {"irradiance": "[lx]", "radiosity": "[lm/m²]", "luminance": "[cd/m²]", "relative_error": "[%]"}


@pytest.mark.parametrize(("quantity", "unit"), LEGENDS.items())
def test_legends_of_light_have_its_units(photometric, monkeypatch, quantity, unit):
    labels = []
    drawn = legend.drawn
    monkeypatch.setattr(legend, "drawn", lambda *given: labels.append(given[2]) or drawn(*given))
    rd.image.render(photometric, false_color=True, quantity=quantity, width=30, camera=rd.Camera((0.5, -2, 0.5), (0.5, 0.5, 0.5)))
    label, *arrow = labels[0].replace("\n", " ").split("; ")
    assert label.endswith(unit)
    assert arrow in ([], ["arrow: brighter than 99 % of the view without lamps"])


def test_luminance_is_of_light(room):
    with pytest.raises(rd.OutputError, match="take radiance"):
        rd.image.render(room, false_color=True, quantity="luminance", width=30)


def test_photometric_results_are_in_lx_and_lm(photometric, tmp_path):
    """Irradiance in lx, radiosity and emission in lm/m², power in lm: in reports, tables and frames."""
    photometric.export(tmp_path / "a.csv")
    patches, surfaces = ((tmp_path / name).read_text("utf-8").splitlines()[0] for name in ("a.csv", "a.surfaces.csv"))
    for head in (patches, surfaces):
        assert "irradiance [lx]" in head
        assert "radiosity [lm/m²]" in head
        assert "W" not in head
    assert "irradiance, 95 % from [lx]" in patches
    assert "received [lm]" in surfaces
    assert "radiosity B in lm/m² and irradiance H in lx" in photometric.report()
    assert " lx" in repr(photometric)
    assert (photometric.unit, photometric.irradiance_unit, photometric.patches.scene.radiance_unit) == ("lm/m²", "lx", "cd/m²")


def test_red_green_and_blue_of_light_are_one_column_of_lux(photometric, tmp_path):
    """By the photopic weights; scenes in W, and other bands, have no such column."""
    grey = photometric.patches.scene
    options = {"photometric": True, "surface": grey.surface, "names": list(grey.names)}
    three = rd.Scene.from_arrays(
        grey.vertices, grey.faces, np.array([[0.6, 0.5, 0.1], [0, 0, 0]]), np.array([[0, 0, 0], [100, 50, 20]]), **options
    )
    solution = rd.solve(rd.subdivide(three, cells=1), rays=20_000)
    wanted = solution.irradiance @ [0.2126, 0.7152, 0.0722]
    solution.export(tmp_path / "a.csv")
    frame = solution.to_dataframe()
    np.testing.assert_allclose(frame["illuminance [lx]"], wanted, rtol=1e-12)
    np.testing.assert_allclose(
        frame["standard error of illuminance [lx]"], solution.irradiance_standard_error @ [0.2126, 0.7152, 0.0722], rtol=1e-12
    )
    assert "illuminance [lx]" in (tmp_path / "a.surfaces.csv").read_text("utf-8")
    floor = next(row for row in solution.surface_table() if row["surface"] == "floor")
    assert floor["illuminance"] == pytest.approx(wanted[0])
    assert "illuminance" not in photometric.surface_table()[0]
    in_watts = rd.solve(rd.subdivide(replace(three, photometric=False), cells=1), rays=20_000)
    assert "illuminance" not in in_watts.surface_table()[0]


# ---- warnings after a run ------------------------------------------------------------------------------------------------

LAST = """
import warnings
from dataclasses import replace
import radiosity as rd
scene = rd.load_scene("room")
runs = {"full-matrix": {"factors": "hemicube", "resolution": 8}, "random-walk": {"error": 1e-4, "rays": 20_000}}
for method, options in runs.items():
    solution = rd.solve(rd.subdivide(scene, cells=1), method, **options)
    print(solution.status, solution.irradiance.sum() > 0)
try:
    rd.load_scene("bright.obj")
except rd.RadiosityWarning:
    print("raised")
"""


def test_a_warning_after_a_run_loses_no_result_though_warnings_are_errors(tmp_path):
    """What is told after a run stays told, and what is told before one still raises."""
    (tmp_path / "bright.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    command = [sys.executable, "-W", "error::UserWarning", "-c", LAST]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.stdout.split("\n")[:3] == ["complete True", "not reached True", "raised"], done.stderr
    assert "out of balance" in done.stderr
    assert "the error 0.01% of the scene was not reached" in done.stderr


def test_warnings_that_lose_nothing_are_warnings_where_they_may_be():
    from radiosity.errors import result_kept

    with pytest.warns(rd.RadiosityWarning, match="one") as caught, result_kept():
        warnings.warn("one", rd.RadiosityWarning, stacklevel=1)
    assert [Path(w.filename).name for w in caught] == ["test_first_hour.py"]


# ---- the error of a mean -------------------------------------------------------------------------------------------------


def test_a_mean_reaches_its_error_sooner_than_patches():
    patches = rd.subdivide(rd.load_scene("room"), cells=4)
    mean = rd.solve(patches, "random-walk", error=0.01, error_of="mean:tall box")
    row = next(row for row in mean.surface_table() if row["surface"] == "tall box")
    assert row["interval"] <= 0.01  # half the interval of 95 % is what it goes by
    assert row["error"] > 0.01  # of the patches
    assert mean.status == "complete"
    assert mean.provenance["budget"] == {"error": 0.01, "error_of": "mean:tall box"}
    several = Target.of(patches, "mean:*box")
    assert several.surfaces.tolist() == [patches.scene.names.index("low box"), patches.scene.names.index("tall box")]
    with pytest.raises(rd.MethodError, match=r"mean:NAME.*such as surface:"):
        rd.solve(patches, "random-walk", error=0.01, error_of="middle:floor")


def test_the_command_takes_the_error_of_a_mean(capsys):
    assert run(["solve", "room", "--cells", "2", "--error", "2%", "--error-of", "mean:floor"]) == 0
    status = run(["solve", "room", "--cells", "2", "--error", "0.001%", "--error-of", "mean:floor", "--rays", "50k"])
    assert status == 3
    assert "the error 0.001% of mean:floor was not reached" in capsys.readouterr().err


def test_the_studio_shows_colour():
    """Its patches are of the size that its furniture was laid out for."""
    scene = rd.load_scene("studio")
    patches = rd.subdivide(scene)
    assert patches.area == pytest.approx(np.where(patches.area > 0.009, 0.01, patches.area))
    solution = rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=50_000)
    pixels = rd.image.render(solution, width=60).astype(float)
    assert np.ptp(pixels, axis=2).max() > 100
    assert 60 < pixels.mean() < 190
