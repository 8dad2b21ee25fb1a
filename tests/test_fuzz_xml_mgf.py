"""Damaged Mitsuba XML and MGF: a scene or an error of our own class, in this very process."""

import warnings
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from samples import MGF, XML_BEGIN, XML_END

import radiosity as rd

XML = XML_BEGIN + XML_END
PART = b"m wall =\n\tsides 1\n\trd .5\nv q =\n p 0 0 9\nf q q q\n"
WORDS = [
    *b'nan 1e999 -1 99999999999999999999 < /> " $r $x &x; \xff \0 sphere obj ply serialized bitmap volume mask blendbsdf'.split(),
    *b"instance shapegroup merge reflectance radiance filename to_world include ref xf m v o".split(),
    *(b"\n", b"\\\n", b" ", b"-a 1000", b"i part.mgf", b"cct 3000", b"f a b c", b"cmix 1 red", b"cspec 380 780 1 2"),
    b"xf -a 9 -t 1 1 1",
]

place = st.floats(0, 1)
edits = st.lists(
    st.one_of(
        st.tuples(st.just("put"), place, st.sampled_from(WORDS) | st.binary(max_size=3)),
        st.tuples(st.just("cut"), place, st.integers(1, 30)),
        st.tuples(st.just("copy"), place, place),
        st.tuples(st.just("end"), place, st.none()),
    ),
    min_size=1,
    max_size=4,
)
fuzz = settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])


def edited(data: bytes, changes) -> bytes:
    for kind, where, what in changes:
        at = int(where * len(data))
        if kind == "put":
            data = data[:at] + what + data[at + len(what) // 2 :]
        elif kind == "cut":
            data = data[:at] + data[at + what :]
        elif kind == "copy":
            start = int(what * len(data))
            data = data[:at] + data[start : start + 60] + data[at:]
        else:
            data = data[:at]
    return data


def survives(file: Path) -> None:
    """A scene with faces, or an error that names the file's folder."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        try:
            told = rd.load_scene(file).n_faces
        except rd.SceneError as error:
            told = str(error).count(file.parent.name)
    assert told > 0


@fuzz
@given(edits)
def test_mitsuba_xml(tmp_path, changes):
    (tmp_path / "mesh.obj").write_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "scene.xml").write_bytes(edited(XML, changes))
    survives(tmp_path / "scene.xml")


@fuzz
@given(edits)
def test_mgf(tmp_path, changes):
    pytest.importorskip("pyradiance")
    (tmp_path / "part.mgf").write_bytes(PART)
    (tmp_path / "scene.mgf").write_bytes(edited(MGF, changes))
    survives(tmp_path / "scene.mgf")


@fuzz
@given(edits)
def test_mgf_in_an_included_file(tmp_path, changes):
    pytest.importorskip("pyradiance")
    (tmp_path / "part.mgf").write_bytes(edited(PART, changes))
    (tmp_path / "scene.mgf").write_bytes(MGF)
    survives(tmp_path / "scene.mgf")


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=200))
def test_anything_else(tmp_path, data):
    for name in ("scene.xml", "scene.mgf"):
        (tmp_path / name).write_bytes(data)
        survives(tmp_path / name)
