"""CSV tables."""

import csv

import numpy as np
import pytest
from image_samples import quad_scene, solution

import radiosity as rd
from radiosity.image import export, tables
from radiosity.scene.csv_cells import guarded, unguarded


def rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_a_row_for_each_patch_and_each_surface(tmp_path, monkeypatch):
    monkeypatch.setattr(tables, "CHUNK", 7)
    result = solution(rd.subdivide(rd.load_scene("cornell-box"), cells=2))
    export(result, tmp_path / "a.csv")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv", "a.surfaces.csv"]
    table = rows(tmp_path / "a.csv")
    patches = result.patches
    assert [int(row["patch"]) for row in table] == list(range(len(patches)))
    assert [row["surface"] for row in table] == [patches.scene.names[s] for s in patches.surface]
    assert [row["side"] == "back" for row in table] == patches.is_back.tolist()
    for title, expected in {
        "centroid y [m]": patches.centroid[:, 1],
        "normal z": patches.normal[:, 2],
        "area [m²]": patches.area,
        "reflectance green": patches.reflectance[:, 1],
        "emission blue [W/m²]": patches.emission[:, 2],
        "radiosity red [W/m²]": result.radiosity[:, 0],
        "standard error of radiosity red [W/m²]": result.standard_error[:, 0],
        "irradiance blue [W/m²]": result.irradiance[:, 2],
        "standard error of irradiance blue [W/m²]": result.irradiance_standard_error[:, 2],
        "arrivals": result.arrivals,
        "few arrivals": result.few,
        "irradiance, 95 % from red [W/m²]": result.interval(0.95, "irradiance")[0][:, 0],
        "irradiance, 95 % to blue [W/m²]": result.interval(0.95, "irradiance")[1][:, 2],
    }.items():
        np.testing.assert_allclose([float(row[title]) for row in table], expected, rtol=1e-8)
    assert len(table[0]) == 3 + 6 + 1 + 6 * 3 + 2 + 2 * 3
    surfaces = rows(tmp_path / "a.surfaces.csv")
    assert [row["surface"] for row in surfaces] == list(patches.scene.names)
    assert list(surfaces[0]) == ["surface", "area [m²]", *(f"emitted {band} [W]" for band in patches.scene.bands), "error"]
    assert {row["emitted green [W]"] for row in surfaces} == {"0.5"}


@pytest.mark.parametrize("name", ['say "hi", all', "two\nlines", "per % cent", "Größe"])
def test_names_are_quoted(tmp_path, name):
    result = solution(rd.subdivide(quad_scene((name,)), cells=1), [np.nan])
    export(result, tmp_path / "a.csv")
    assert rows(tmp_path / "a.csv")[0]["surface"] == name
    assert rows(tmp_path / "a.csv")[0]["radiosity [W/m²]"] == "nan"
    assert rows(tmp_path / "a.surfaces.csv")[0]["surface"] == name


def test_backs_are_named(tmp_path):
    export(solution(rd.subdivide(quad_scene(two_sided=True), cells=1)), tmp_path / "a.csv")
    assert [row["side"] for row in rows(tmp_path / "a.csv")] == ["front", "back"]


def test_no_name_is_a_formula_in_a_spreadsheet(tmp_path):
    """OWASP, CSV Injection; our readers get each name back."""
    names = ("=1+1", "@sum", "+x", "-x", "\t=1", "'=1", "''-x", "'quoted'", "wall=1", "-2.5", "")
    result = solution(rd.subdivide(quad_scene(names[:1]), cells=1))
    export(result, tmp_path / "a.csv")
    assert rows(tmp_path / "a.csv")[0]["surface"] == rows(tmp_path / "a.surfaces.csv")[0]["surface"] == "'=1+1"
    cells = [guarded(name) for name in names]
    assert [cell[:1] in "=+-@\t" for cell in cells if cell] == [False] * 9 + [True]  # a number is none
    assert tuple(map(unguarded, cells)) == names
    table = "x,y,z,name\n" + "".join(f'0,0,{i},"{cell}"\n' for i, cell in enumerate(cells[:4]))
    (tmp_path / "points.csv").write_text(table)
    assert rd.Sensors.from_csv(tmp_path / "points.csv").names == names[:4]
