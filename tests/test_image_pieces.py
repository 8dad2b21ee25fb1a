"""Long arrays are handled in pieces: files, meshes and pictures are the same however short these are."""

import numpy as np
import pytest
from image_samples import plain_hits, solution

import radiosity as rd
from radiosity import pieces
from radiosity.image import display_mesh, export, picture, ply, render, sheets, tables, vtp
from radiosity.image.quantity import choose

MODULES = (display_mesh, picture, ply, sheets, tables)


@pytest.fixture(scope="module")
def result():
    return solution(rd.subdivide(rd.load_scene("cornell-box"), cells=3))


@pytest.fixture
def short(monkeypatch):
    """Pieces of few rows, of numbers that divide no length here."""
    for module in MODULES:
        monkeypatch.setattr(module, "CHUNK", 7)
    monkeypatch.setattr(vtp, "CHUNK", 33)
    monkeypatch.setattr(pieces, "PIECE", 7)


@pytest.mark.parametrize("smooth", [True, False])
@pytest.mark.parametrize("name", ["a.glb", "a.ply", "a.vtp", "a.csv"])
def test_files(tmp_path, result, request, name, smooth):
    export(result, tmp_path / f"whole {name}", smooth=smooth)
    request.getfixturevalue("short")
    export(result, tmp_path / f"short {name}", smooth=smooth)
    for file in tmp_path.glob("whole*"):  # the table of surfaces, too
        assert file.read_bytes() == (tmp_path / file.name.replace("whole", "short")).read_bytes()


def test_pictures(result, request):
    options = {"hits": plain_hits, "width": 12, "height": 9, "samples": 3, "smooth": False}
    whole = render(result, **options)
    request.getfixturevalue("short")
    np.testing.assert_array_equal(render(result, **options), whole)
    assert np.ptp(whole) > 10


def test_solutions(request):
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=2)
    whole = rd.solve(patches, "random-walk", quanta=5000, replicates=3)
    request.getfixturevalue("short")
    again = rd.solve(patches, "random-walk", quanta=5000, replicates=3)
    for name in ("irradiance", "irradiance_standard_error", "arrivals", "surface_power"):
        np.testing.assert_allclose(getattr(again, name), getattr(whole, name), rtol=1e-12, err_msg=name)
    assert again.error == pytest.approx(whole.error, rel=1e-12)
    assert again.books == whole.books


@pytest.mark.parametrize("count", [0, 1, 6, 7, 8, 21, 22])
def test_pieces_hold_every_row_once(short, count):
    rows = np.arange(count)
    assert np.concatenate([rows[part] for part in pieces.pieces(count)] or [rows]).tolist() == rows.tolist()
    assert all(part.stop - part.start <= 7 for part in pieces.pieces(count))


def test_relative_errors_are_per_cent(result):
    found = choose(result, "relative_error")
    assert found.unit == "%"
    np.testing.assert_allclose(found.values, 10)  # made up so
    assert choose(result, "standard_error").unit == "W/m²"
    single = choose(result, "relative_error", single=True)
    np.testing.assert_allclose(single.values, 10)
