"""MGF: contexts, transformations, sides, colours and curved primitives mean what the specification says."""

import warnings

import numpy as np
import pytest

import radiosity as rd
from radiosity.scene.formats.color import luminance_weights, unit_rgb

pytest.importorskip("pyradiance")

CORNERS = "".join(f"v {name} =\n p {x} {y} 0\n" for name, x, y in (("a", 0, 0), ("b", 2, 0), ("c", 2, 1), ("d", 0, 1)))
GREY = "m grey =\n c\n rd 0.5\n"


@pytest.fixture
def load(tmp_path):
    """Loads an MGF text; warnings are errors, as everywhere in the tests."""

    def of(text, **options):
        file = tmp_path / "scene.mgf"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return rd.load_scene(file, **options)

    return of


def face_normal(scene):
    return (scene.normal * scene.area[:, None]).sum(axis=0) / scene.area.sum()


def test_a_rectangle_is_one_grey_face_of_two_sides(load):
    scene = load(CORNERS + GREY + "o desk\no top\nf a b c d\no\no\n")
    assert scene.faces.shape == (1, 4)
    assert scene.is_quad.all()
    assert scene.bands == ("grey",)
    assert scene.names == ("desk.top/grey",)
    assert scene.photometric
    assert scene.area == pytest.approx([2.0])
    np.testing.assert_allclose(scene.normal, [[0, 0, 1]])  # counterclockwise seen from the front
    np.testing.assert_array_equal(scene.reflectance, [[0.5]])
    np.testing.assert_array_equal(scene.back, [rd.Back.RADIATES])


def test_one_sided_faces_are_invisible_from_behind(load):
    scene = load(CORNERS + "m lamp =\n sides 1\n c\n ed 100\nf a b c d\n")
    np.testing.assert_array_equal(scene.back, [rd.Back.PASSES])
    assert scene.emission * scene.area == pytest.approx(np.array([[200.0]]))  # lm


def test_a_two_sided_emitter_looks_identical_from_both_sides(load):
    scene = load(CORNERS + "m lamp =\n c\n ed 100\nf a b c d\n")
    np.testing.assert_array_equal(scene.back_emission, scene.emission)
    assert rd.subdivide(scene, cells=1).emission.sum() == pytest.approx(200.0)


def test_a_material_that_is_used_again_or_redefined_does_not_change_faces_before(load):
    scene = load(
        CORNERS
        + "c tint =\n cxy 0.3 0.4\nm one =\n c tint\n rd 0.2\nf a b c d\n rd 0.4\nf a b c d\nm two = one\nf a b c d\n"
        + "m one =\nf a b c d\nm\nf a b c d\nm two\nf a c d\n"
    )
    luminance = scene.reflectance @ luminance_weights()
    assert scene.names == ("one", "two", "unnamed")
    assert sorted(luminance.round(9)) == pytest.approx([0.0, 0.0, 0.2, 0.4, 0.4, 0.4])


def test_colours_keep_luminance_and_are_brought_into_the_triangle_of_primaries():
    assert luminance_weights() == pytest.approx([0.265, 0.670, 0.065], abs=5e-4)
    np.testing.assert_allclose(unit_rgb(0.33333, 0.33333), 1.0)
    np.testing.assert_allclose(unit_rgb(0.64, 0.33), [1 / luminance_weights()[0], 0, 0], atol=1e-9)
    for x, y in ((0.0, 0.38), (0.75, 0.1), (0.2, 0.7), (0.4, 0.4)):
        rgb = unit_rgb(x, y)
        assert rgb.min() >= 0
        assert rgb @ luminance_weights() == pytest.approx(1.0)
    assert unit_rgb(0.0, 0.38).min() == 0  # it lies outside


def test_spectra_temperatures_and_mixtures_are_colours_too(load):
    text = "c red =\n cxy 0.64 0.33\nc warm =\n cct 3000\nc mixed =\n cmix 1 red 1 warm\nc flat =\n cspec 400 700 1 1 1 1\n"
    scene = load(CORNERS + text + "".join(f"m {m} =\n c {m}\n ed 10\nf a b c d\n" for m in ("warm", "mixed", "flat")))
    np.testing.assert_allclose(scene.emission @ luminance_weights(), 10.0)
    warm, mixed, flat = scene.emission
    assert warm[0] > warm[1] > warm[2]
    assert mixed[0] > warm[0]
    np.testing.assert_allclose(flat, 10.0, rtol=0.06)


@pytest.mark.parametrize(
    ("transform", "one", "other", "normal"),
    [
        ("-t 1 2 3", (1, 2, 3), (3, 3, 3), (0, 0, 1)),
        ("-rx 90", (0, 0, 0), (2, 0, 1), (0, -1, 0)),
        ("-ry 90", (0, 0, 0), (0, 1, -2), (1, 0, 0)),
        ("-t 1 0 0 -rz 90", (0, 1, 0), (-1, 3, 0), (0, 0, 1)),
        ("-t 1 0 0 -s 2", (2, 0, 0), (6, 2, 0), (0, 0, 1)),
        ("-mx -t 5 0 0", (5, 0, 0), (3, 1, 0), (0, 0, 1)),
        ("-mz", (0, 0, 0), (2, 1, 0), (0, 0, -1)),
        ("-i 3 -t 1 0 0 -i 1 -t 0 1 0", (3, 1, 0), (5, 2, 0), (0, 0, 1)),
        ("-i 0 -t 1 0 0 -t 0 1 0", (0, 0, 0), (2, 1, 0), (0, 0, 1)),
        ("-i 5 -s 2 -i 1", (0, 0, 0), (64, 32, 0), (0, 0, 1)),
    ],
)
def test_transformations(load, transform, one, other, normal):
    """Two opposite corners of the rectangle, and which way it faces."""
    scene = load(CORNERS + GREY + f"xf {transform}\nf a b c d\nxf\n")
    np.testing.assert_allclose(scene.bounds, np.sort([one, other], axis=0), atol=1e-12)
    np.testing.assert_allclose(face_normal(scene), normal, atol=1e-12)


def test_the_inner_of_nested_transformations_applies_first(load):
    # the specification's own example: "-rx 180 -t 5 0 0" is in effect
    scene = load("v v1 =\n p 0 10 0\n n 0 0 1\n" + GREY + "xf -t 5 0 0\nxf -rx 180\nring v1 0 2\nxf\nxf\n")
    np.testing.assert_allclose(scene.bounds.mean(axis=0), (5, -10, 0), atol=1e-9)
    np.testing.assert_allclose(face_normal(scene), (0, 0, -1), atol=1e-9)


def test_arrays_repeat_in_every_dimension(load):
    scene = load(CORNERS + GREY + "xf -a 3 -t 10 0 0 -a 4 -t 0 10 0 -i 1 -t 15 30 45\nf a b c d\nxf\n")
    origins = scene.frames[0]
    expected = [(15 + 10 * i, 30 + 10 * j, 45) for i in range(3) for j in range(4)]
    np.testing.assert_allclose(sorted(map(tuple, origins)), expected)


def test_included_files_with_transformations_and_odd_names(load, tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "face.inc").write_bytes(
        b"o caf\xe9\n" + CORNERS.encode() + b"m w\xe4nd =\r\n rd .3\r\nf a b \\\n c d\no\n"
    )
    with pytest.warns(rd.RadiosityWarning, match="face.inc: is not UTF-8; its names are read as Latin-1") as caught:
        scene = load("i parts/face.inc -a 2 -t 0 0 5\ni parts/face.inc -mz -t 0 0 -1\n")
    assert len(caught) == 1  # an object that includes and arrays repeat is one
    assert scene.names == ("café/wänd",)
    np.testing.assert_allclose(sorted(scene.frames[0][:, 2]), (-1, 0, 5))
    np.testing.assert_allclose(sorted(scene.normal[:, 2]), (-1, 1, 1))


@pytest.mark.parametrize(("codec", "name"), [("cp932", "機能"), ("cp950", "成功"), ("gb18030", "地板"), ("utf-16", "機能")])
def test_names_of_code_pages(tmp_path, codec, name):
    """A name whose last byte is a backslash's continues no line, and an included file of few names is read as the main one is."""
    (tmp_path / "colour.inc").write_bytes(f"m {name} =\n\trd 0.3\n".encode(codec))
    (tmp_path / "scene.mgf").write_bytes(f"o {name}\no {name}\ni colour.inc\n{CORNERS}f a b c d\no\no\n".encode(codec))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        scene = rd.load_scene(tmp_path / "scene.mgf")
    assert scene.names == (f"{name}.{name}/{name}",)
    assert scene.reflectance.tolist() == [[pytest.approx(0.3)]] * scene.n_faces
    assert ["scene.mgf: is not UTF-8" in str(w.message) for w in caught] == [True] * (codec != "utf-16")


def test_a_mark_at_the_beginning_is_no_statement(tmp_path):
    (tmp_path / "scene.mgf").write_text("\ufeff" + CORNERS + GREY + "f a b c d\n", encoding="utf-8")
    assert rd.load_scene(tmp_path / "scene.mgf").n_faces == 1


def test_objects_of_the_same_name_become_one_and_are_told(load):
    body = CORNERS + GREY + "f a b c d\n"
    with pytest.warns(rd.RadiosityWarning, match=r"objects of the same name become one: 'chair \(2\)'$"):
        scene = load(f"o chair\n{body}o\nxf -t 0 0 1 -a 3 -t 0 0 1\no chair\n{body}o\nxf\n")
    assert len(scene.names) == 1


def test_faces_with_holes_joined_by_seams(load):
    ring = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)]
    text = "".join(f"v v{i} =\n p {x} {y} 0\n" for i, (x, y) in enumerate(ring))
    scene = load(text + GREY + "f " + " ".join(f"v{i}" for i in range(10)) + "\n")
    assert scene.area.sum() == pytest.approx(12.0)
    np.testing.assert_allclose(scene.normal, [(0, 0, 1)] * scene.n_faces)


def test_faces_with_holes_given_as_such(load):
    hole = "".join(f"v h{i} =\n p {x} {y} 0\n" for i, (x, y) in enumerate([(0.5, 0.25), (0.5, 0.75), (1, 0.75), (1, 0.25)]))
    scene = load(CORNERS + hole + GREY + "fh a b c d - h0 h1 h2 h3\n")
    assert scene.area.sum() == pytest.approx(2 - 0.25)
    np.testing.assert_allclose(scene.normal, [(0, 0, 1)] * scene.n_faces)


def test_what_is_not_diffuse_is_named(load):
    with pytest.warns(rd.RadiosityWarning, match="not diffuse.*'shiny'"):
        scene = load(CORNERS + "m shiny =\n rd 0.3\n rs 0.2 0.05\nf a b c d\n")
    np.testing.assert_array_equal(scene.reflectance, [[0.3]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load(CORNERS + "m dull =\n rd 0.3\n rs 0 0\nf a b c d\n")
        load(CORNERS + "m polished =\n rd 0.3\n rs 0.2 0.05\nm dull = polished\n rs 0 0\nf a b c d\n")  # said anew
