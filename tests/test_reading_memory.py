"""Files that do not fit in memory are refused by name before they are read; no file that fits is."""

import tracemalloc
import warnings

import numpy as np
import pytest
from samples import ply_bytes, ply_text, stl_bytes, stl_text

import radiosity as rd
from radiosity.errors import SceneError

SIDE = 30
U, V = (axis.ravel().astype(float) for axis in np.meshgrid(np.arange(SIDE + 1), np.arange(SIDE + 1)))
CORNERS = np.column_stack([U, V, np.sin(U) * np.cos(V)])  # no parallelograms
FIRST = np.flatnonzero((U < SIDE) & (V < SIDE))
FACES = np.concatenate([FIRST[:, None] + [0, 1, SIDE + 2], FIRST[:, None] + [0, SIDE + 2, SIDE + 1]])  # 1800 triangles


def lines(text, rows):
    return "".join(text % tuple(row) for row in rows)


MGF = "m grey =\n rd 0.5\n" + lines("v %d =\n p %.6f %.6f %.6f\n", [(n, *p) for n, p in enumerate(CORNERS)]).replace("v ", "v v")
RAD = "void plastic grey 0 0 5 0.5 0.5 0.5 0 0\n"
FILES = {
    "binary.ply": ply_bytes(CORNERS, faces=FACES.tolist()),
    "text.ply": ply_text(CORNERS.round(6).tolist(), faces=FACES.tolist()),
    "binary.stl": stl_bytes(CORNERS[FACES]),
    "text.stl": stl_text({"sheet": CORNERS[FACES].round(6)}),
    "mesh.obj": lines("v %.6f %.6f %.6f\n", CORNERS) + lines("f %d %d %d\n", FACES + 1),
    "mesh.mgf": MGF + lines("f v%d v%d v%d\n", FACES),
    "mesh.rad": RAD + lines("grey polygon floor 0 0 9" + 9 * " %.6f" + "\n", CORNERS[FACES].reshape(-1, 9)),
}


@pytest.fixture(params=FILES)
def path(request, tmp_path):
    content = FILES[request.param]
    (tmp_path / request.param).write_bytes(content if isinstance(content, bytes) else content.encode())
    return tmp_path / request.param


def load(path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # no material, and code pages
        return rd.load_scene(path)


def wanted(path, monkeypatch):
    """Return the bytes that a refusal names."""
    monkeypatch.setenv("RADIOSITY_MEMORY", str(path.stat().st_size))
    with pytest.raises(SceneError, match=r"may be taken; .*RADIOSITY_MEMORY=16G or none") as caught:
        load(path)
    text = str(caught.value)
    assert str(path) in text
    return 2**20 * float(text.split(" MiB of memory")[0].split()[-1])


def test_a_file_that_does_not_fit_is_refused_with_both_numbers(path, monkeypatch):
    bytes_wanted = wanted(path, monkeypatch)
    monkeypatch.setenv("RADIOSITY_MEMORY", str(0.98 * bytes_wanted))
    with pytest.raises(SceneError, match="may be taken"):
        load(path)
    monkeypatch.setenv("RADIOSITY_MEMORY", str(1.02 * bytes_wanted))
    assert load(path).n_faces == len(FACES)


def test_no_file_is_refused_that_takes_less_memory_than_is_there(path, monkeypatch):
    """What is foretold is less than what reading takes at its peak, and not a tenth of it."""
    bytes_wanted = wanted(path, monkeypatch)
    monkeypatch.delenv("RADIOSITY_MEMORY")
    load(path)  # imports
    tracemalloc.start()
    try:
        load(path)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak / 10 < bytes_wanted < peak


def test_what_a_damaged_header_announces_is_not_taken_for_memory(tmp_path, monkeypatch):
    path = tmp_path / "damaged.ply"
    path.write_bytes(ply_bytes(counts=(4, 10**11)))
    monkeypatch.setenv("RADIOSITY_MEMORY", "1M")
    with pytest.raises(SceneError, match="truncated or damaged"):
        load(path)


def test_geometry_of_a_toml_is_refused_by_its_own_name(tmp_path, monkeypatch):
    (tmp_path / "lamp.stl").write_bytes(FILES["binary.stl"])
    (tmp_path / "scene.toml").write_text('geometry = "lamp.stl"')
    monkeypatch.setenv("RADIOSITY_MEMORY", "100K")
    with pytest.raises(SceneError, match=r"lamp\.stl: reading its 0\.0859 MiB takes about 0\.515 MiB"):
        load(tmp_path / "scene.toml")
