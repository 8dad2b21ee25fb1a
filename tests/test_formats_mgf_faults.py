"""Faulty MGF: what can be loaded is, with a warning for each fault that names file and line; nothing runs away."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.scene.formats.mgf import faces as mgf_faces
from radiosity.scene.formats.mgf import filter as mgf_filter

pytest.importorskip("pyradiance")

FACE = "v a =\n p 0 0 0\nv b =\n p 1 0 0\nv c =\n p 1 1 0\nm grey =\n rd 0.5\nf a b c\n"  # 9 lines


@pytest.fixture
def write(tmp_path):
    def of(text, name="scene.mgf"):
        (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
        return tmp_path / name

    return of


@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("0 bogus", "unknown entity '0'"),
        ("f a b nowhere", "'nowhere' is not defined"),
        ("f a b", "three vertices"),
        ("cspec 400 700 1 -1", "illegal argument value"),
        ("c nowhere", "undefined reference"),
        ("cxy 0.3 0", "chromaticity"),
        ("rd 1.5", "1.5 is out of range"),
        ("rd", "a value is missing"),
        ("ed -1", "-1 is out of range"),
        ("ed nan", "nan is out of range"),
        ("sides 3", "sides must be 1 or 2"),
        ("p 1 2 1e999", "not finite"),
        ("p 1 2", "wrong number of arguments"),
        ("xf", "no transformation to end"),
        ("o", "no object to end"),
        ("i missing.mgf", "missing.mgf' does not exist"),
        ("i scene.mgf", "includes itself"),
        ("ies lamp.ies", "IES photometry"),
        ("sph nowhere 1", "undefined reference"),
        ("sph a", "wrong number of arguments"),
        ("f " + "a " * 3000, "bytes; at most"),
    ],
)
def test_a_faulty_line_is_left_out_and_named(write, line, what):
    file = write(FACE + line + "\n")
    with pytest.warns(rd.RadiosityWarning, match=rf"scene\.mgf:10: .*({what})") as caught:
        scene = rd.load_scene(file)
    assert len(caught) == 1
    assert scene.n_faces == 1
    with pytest.raises(rd.SceneError, match=rf"scene\.mgf:10: .*({what})"):
        rd.load_scene(file, strict=True)


@pytest.mark.parametrize(
    ("points", "what"),
    [
        ([(0, 3), (2, -3), (-3, 1), (3, 1), (-2, -3)], "crosses itself"),
        ([(0, 0), (1, 0), (2, 0), (3, 0), (4, 0)], "has no area"),
    ],
)
def test_a_large_face_that_is_no_polygon(write, points, what):
    vertices = "".join(f"v v{i} =\n p {x} {y} 0\n" for i, (x, y) in enumerate(points))
    with pytest.warns(rd.RadiosityWarning, match=rf"scene\.mgf:20: .*{what}"):
        scene = rd.load_scene(write(FACE + vertices + "f v0 v1 v2 v3 v4\n"))
    assert scene.n_faces == 1


def test_an_undefined_material_is_grey_and_named(write):
    file = write(FACE + "m unheard\nf a b c\n")
    with pytest.warns(rd.RadiosityWarning) as caught:
        scene = rd.load_scene(file)
    messages = " | ".join(str(w.message) for w in caught)
    assert "scene.mgf:10: 'unheard' is not defined" in messages
    assert "no material for 'unheard'; reflectance 0.5 taken" in messages
    assert scene.names == ("grey", "unheard")


def test_a_block_under_a_bad_transformation_is_left_out(write):
    file = write(FACE + "xf -t 1 2\nxf -t 0 0 1\nf a b c\nxf\nxf\nxf -t 0 0 9\nf a b c\nxf\n")
    with pytest.warns(rd.RadiosityWarning, match=r"scene\.mgf:10: transformation '-t' without its numbers"):
        scene = rd.load_scene(file)
    np.testing.assert_allclose(sorted(scene.frames[0][:, 2]), (0, 9))


def test_a_fault_in_an_included_file_names_that_file_once(write):
    write(FACE + "bogus 1\n", "part.mgf")
    with pytest.warns(rd.RadiosityWarning, match=r"part\.mgf:10: unknown entity 'bogus'") as caught:
        scene = rd.load_scene(write("i part.mgf\ni part.mgf -t 0 0 1\n"))
    assert len(caught) == 1
    assert scene.n_faces == 2


def test_a_statement_of_several_lines_is_called_by_its_first(write):
    with pytest.warns(rd.RadiosityWarning, match=r"scene\.mgf:11: 'nowhere' is not defined"):
        rd.load_scene(write(FACE + "# one more line\nf a \\\n b \\\n nowhere\n"))


def test_very_many_faults_end_in_one_summary(write):
    with pytest.warns(rd.RadiosityWarning) as caught:
        rd.load_scene(write(FACE + "f a b nowhere\n" * 100))
    assert len(caught) == 31
    assert "70 more lines left out" in str(caught[-1].message)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("# nothing\n", "no faces could be read"),
        ("f a b c\n", r"no faces could be read.*first fault: .*scene\.mgf:1: 'a' is not defined"),
        (b"MZ\0\1\2", "binary data"),
        (FACE.replace("p 1 1 0", "p 2 0 0"), "no area"),
        (FACE + "xf -a 1000000 -t 1 0 0\nf a b c\nxf -a 1000000 -t 0 1 0\nf a b c\nxf\nxf\n", "unfold to more than"),
        ("sph nowhere 1\n" * 5, "no faces"),
    ],
)
def test_nothing_left_is_an_error(write, text, what, monkeypatch):
    monkeypatch.setattr(mgf_faces, "MOST_STATEMENTS", 10_000)
    with pytest.raises(rd.SceneError, match=what):
        rd.load_scene(write(text))


def test_bounds_on_what_the_filter_may_do(write, monkeypatch):
    monkeypatch.setattr(mgf_filter, "MOST_BYTES", 1000)
    with pytest.raises(rd.SceneError, match="split the scene"):
        rd.load_scene(write(FACE + "sph a 1\n"))
    monkeypatch.undo()
    monkeypatch.setattr(mgf_filter, "MOST_RUNS", 3)
    with pytest.raises(rd.SceneError, match=r"more than 3 faulty lines; first fault: .*:10"):
        rd.load_scene(write(FACE + "".join(f"sph no{i} 1\n" for i in range(5))))


def test_missing_and_empty_files(write, tmp_path):
    with pytest.raises(rd.SceneError, match="no such file"):
        rd.load_scene(tmp_path / "absent.mgf")
    with pytest.raises(rd.SceneError, match="empty"):
        rd.load_scene(write(""))
