"""Files of radiative exchange, and the command."""

import csv
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from command_line import run
from PIL import Image
from test_docs import blocks
from test_exchange import big_box
from test_exchange_conditions import oven

import radiosity as rd
from radiosity.cli import main
from radiosity.exchange.flow_picture import flows


@pytest.fixture(scope="module")
def heat():
    patches, *_ = big_box()
    return rd.radiative_exchange(
        rd.subdivide(patches.scene, cells=2),
        {"z low": 400, "x high": 300},
        emissivity=0.5,
        adiabatic=["x low", "y high", "z high"],
        flux={"y low": 100},
        rays=20_000,
    )


def rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_a_saved_exchange_is_the_same(heat, tmp_path):
    again = rd.load_exchange(heat.save(tmp_path / "heat.npz"))
    assert str(again) == str(heat)
    for name in ("exchange", "exchange_standard_error", "patch_net", "patch_temperature", "emissivity"):
        assert np.array_equal(getattr(again, name), getattr(heat, name))
    assert len(again.patches) == len(heat.patches)
    assert again.provenance == heat.provenance


def test_other_files_are_told_apart(heat, tmp_path):
    path = heat.save(tmp_path / "heat.npz")
    with pytest.raises(rd.SceneError, match=r"holds a radiative exchange, not a solution; load_exchange reads it"):
        rd.load_solution(path)
    rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), rays=5_000).save(tmp_path / "room.npz")
    with pytest.raises(rd.SceneError, match="holds a solution, not a radiative exchange"):
        rd.load_exchange(tmp_path / "room.npz")
    rd.view_factors(heat.patches, rays=2_000).to_npz(tmp_path / "factors.npz")
    with pytest.raises(rd.SceneError, match="holds view factors, not a radiative exchange; load_view_factors reads it"):
        rd.load_exchange(tmp_path / "factors.npz")
    with pytest.raises(rd.SceneError, match="holds a radiative exchange, not view factors; load_exchange reads it"):
        rd.load_view_factors(path)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    with pytest.raises(rd.SceneError, match="is no radiative exchange of this program, or damaged"):
        rd.load_exchange(path)
    with pytest.raises(rd.SceneError, match="no such file; radiosity exchange SCENE -o"):
        rd.load_exchange(tmp_path / "none.npz")


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("scene_vertices", lambda values: values * np.nan),
        ("scene_vertices", lambda values: values * 1.5),
        ("scene_surface", lambda values: values + 99),
        ("patches_columns", lambda values: values + 1),
        ("net", lambda values: values * np.nan),
        ("net_standard_error", lambda values: -1 - values),
        ("emissivity", lambda values: values + 1),
    ],
)
def test_a_changed_file_is_refused(heat, tmp_path, name, change):
    with np.load(heat.save(tmp_path / "heat.npz")) as file:
        arrays = dict(file)
    np.savez(tmp_path / "heat.npz", **(arrays | {name: change(arrays[name])}))
    with pytest.raises(rd.SceneError, match="is no radiative exchange of this program, or damaged"):
        rd.load_exchange(tmp_path / "heat.npz")


def test_tables_say_what_the_sign_means(heat, tmp_path):
    heat.export(tmp_path / "heat.csv")
    found = {row["surface"]: row for row in rows(tmp_path / "heat.csv")}
    assert float(found["z low"]["net heat given off [W]"]) == pytest.approx(heat.net[4])
    assert float(found["z low"]["net heat given off [W]"]) > 0 > float(found["x high"]["net heat given off [W]"])
    assert found["x low"]["condition"] == "adiabatic"
    pairs = rows(tmp_path / "heat.exchange.csv")
    watts = {(row["from"], row["to"]): float(row["net heat straight from one to the other [W]"]) for row in pairs}
    assert watts["z low", "x high"] == pytest.approx(heat.exchange[4, 1])
    assert min(watts.values()) > 0
    left = sum(w for (one, _), w in watts.items() if one == "z low") - sum(w for (_, o), w in watts.items() if o == "z low")
    assert left == pytest.approx(heat.net[4], rel=1e-9)
    assert "it must be heated" in str(heat)


def test_pictures_of_heat(heat, tmp_path):
    heat.export(tmp_path / "heat.png")
    with Image.open(tmp_path / "heat.png") as picture:
        view = np.asarray(picture, float)
    assert view[..., 0].max() > 150  # red, or blue, and not one colour
    assert view.std() > 10
    for name in ("heat.exchange.png", "heat.flows.png"):
        with Image.open(tmp_path / name) as picture:
            assert picture.size[0] > 300
    with pytest.raises(rd.OutputError, match=r"unknown output format '.glb'"):
        heat.export(tmp_path / "heat.glb")


def test_bands_are_as_wide_as_the_heat_that_flows(tmp_path):
    """From a to b 3 W and to c 1 W, in columns of pixels: the bar of a, and three quarters of it, and one."""
    watts = np.zeros((4, 4))
    watts[0, 1:3], watts[1:3, 0] = (3, 1), (-3, -1)
    found = SimpleNamespace(exchange=watts, names=("a", "b", "c"), temperature=np.array([400.0, 300, 200]), surroundings=None)
    flows(found, tmp_path / "flows.png")
    with Image.open(tmp_path / "flows.png") as picture:
        pixels = np.asarray(picture.convert("RGB"), int)
    grey = (np.abs(pixels - 0.45 * 255) < 2).all(axis=2)
    bars = grey[:, grey.sum(axis=0).argmax()]
    edges = np.flatnonzero(np.diff(np.concatenate([[0], bars.astype(int), [0]])))
    (one, other), colors = np.diff(edges)[::2], (np.ptp(pixels, axis=2) > 50).sum(axis=0)
    assert one / other == pytest.approx(3, rel=0.05)
    left = np.flatnonzero(colors)[5:100]  # from the bar of a into the bands
    np.testing.assert_allclose(colors[left], one + other, rtol=0.03)
    nothing = SimpleNamespace(**(vars(found) | {"exchange": 0 * watts}))
    flows(nothing, tmp_path / "nothing.png")
    assert (tmp_path / "nothing.png").stat().st_size > 1_000


def test_the_page_runs(tmp_path, monkeypatch):
    """The furnace of the page, in order, with its assertions; its table shows the same watts."""
    monkeypatch.chdir(tmp_path)
    page = Path(__file__).parents[1] / "docs" / "radiative-exchange.md"
    names: dict = {"__name__": "page"}
    for block in blocks(page):
        exec(compile(block, str(page), "exec"), names)
    (watts,) = (float(found) for found in re.findall(r"^heater .* (\d+) ± 19 ", page.read_text(encoding="utf-8"), re.MULTILINE))
    assert names["heat"]["heater"]["net"] == pytest.approx(watts, abs=30)


def test_the_command(capsys, tmp_path):
    scene = oven(tmp_path, "temperature = 600")
    status, out, err = run(capsys, "exchange", scene, "--cells", 1, "--rays", "20k", "-o", tmp_path / "a.csv", tmp_path / "a.npz")
    assert (status, err) == (0, "")
    heat = rd.load_exchange(tmp_path / "a.npz")
    assert out.startswith(str(heat))
    assert f"wrote {tmp_path / 'a.csv'}" in out
    assert (tmp_path / "a.exchange.csv").exists()
    options = ["--emissivity", "*=0.3", "load*=1", "--flux", "load*=100", "--surroundings", "280", "--rays", "20k"]
    status, out, err = run(capsys, "exchange", scene, "--cells", 1, *options)
    assert (status, err) == (0, "")
    assert "flux" in out
    assert "surroundings" in out


def test_the_command_takes_lines(capsys, tmp_path):
    scene = oven(tmp_path, "temperature = 600")
    assert main(["lines", str(scene), "--cells", "1", "--rays", "20k", "-o", str(tmp_path / "lines.npz")]) == 0
    capsys.readouterr()
    status, out, err = run(capsys, "exchange", tmp_path / "lines.npz", "--temperature", "load*=700")
    assert (status, err) == (0, "")
    patches = rd.subdivide(rd.load_scene(scene), cells=1)
    heat = rd.radiative_exchange(rd.trace_lines(patches, rays=20_000), {"load*": 700})
    assert out.splitlines()[1:] == str(heat).splitlines()[1:]
    status, _, err = run(capsys, "exchange", tmp_path / "lines.npz", "--rays", "1M")
    assert status == 2
    assert "leave --rays out" in err


@pytest.mark.parametrize(
    ("options", "status", "text"),
    [
        (["--temperature", "hot"], 2, "--temperature is 'hot'; write NAME=VALUE"),
        (["--temperature", "load=x"], 2, "'x' is no number"),
        (["--temperature", "load=1", "load=1"], 2, "gives 'load' twice"),
        (["--flux", "load=1,2"], 2, "give one number"),
        (["--emissivity", "load=0.1", "load:front=0.2"], 2, "gives 'load:front' twice"),
        (["--emissivity", "load*:back=0.2"], 2, "its back does not radiate"),
        (["--temperature", "q=300"], 2, "no surface is called 'q'"),
        (["--temperature", "load*=900", "--rays", "3k", "--error", "0.001%"], 3, "was not reached with"),
    ],
)
def test_the_command_refuses(capsys, tmp_path, options, status, text):
    found, _, err = run(capsys, "exchange", oven(tmp_path, "temperature = 600"), "--cells", 2, *options)
    assert found == status
    assert text in err


def test_outputs_are_refused_before_the_run(capsys, tmp_path):
    status, _, err = run(capsys, "exchange", "nothing.toml", "-o", tmp_path / "a.glb")
    assert status == 2
    assert "unknown output format '.glb'" in err
    status, _, err = run(capsys, "exchange", "nothing.toml", "-o", tmp_path / "a.csv", tmp_path / "a.exchange.csv")
    assert status == 2
    assert "writes a.exchange.csv, and so does" in err
