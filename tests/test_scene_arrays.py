"""`Scene.from_arrays`: every bad value is one clear SceneError, and nothing is repaired in silence."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import radiosity as rd
from radiosity.scene.model import Back

SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
TWO = [(0, 1, 2), (0, 2, 3)]


def build(**changes):
    values = {"vertices": SQUARE, "faces": TWO, "reflectance": 0.5, "emission": 1.0} | changes
    return rd.Scene.from_arrays(
        values.pop("vertices"), values.pop("faces"), values.pop("reflectance"), values.pop("emission"), **values
    )


def with_vertex(value):
    return [*SQUARE[:3], value]


BAD = {
    "vertices of the wrong shape": ({"vertices": [(0, 0), (1, 0), (1, 1)]}, r"vertices have shape \(3, 2\)"),
    "vertices that are no numbers": ({"vertices": [("a", "b", "c")] * 4}, "vertices cannot be read as numbers"),
    "ragged vertices": ({"vertices": [(0, 0, 0), (1, 0)]}, "vertices cannot be read as numbers"),
    "a NaN vertex": ({"vertices": with_vertex((np.nan, 0, 0))}, r"vertex 3 of face 1 is \[nan, 0.0, 0.0\]"),
    "an infinite vertex": ({"vertices": with_vertex((0, np.inf, 0))}, "vertex 3 of face 1"),
    "coordinates of absurd size": ({"vertices": with_vertex((1e30, 0, 0))}, "check the unit"),
    "no faces": ({"faces": []}, "no faces"),
    "no faces, shaped": ({"faces": np.zeros((0, 3), int)}, "no faces"),
    "faces of the wrong shape": ({"faces": [(0, 1)]}, r"faces have shape \(1, 2\)"),
    "one face as a row": ({"faces": (0, 1, 2)}, r"faces have shape \(3,\)"),
    "an index too large": ({"faces": [(0, 1, 2), (0, 1, 4)]}, "face 1 names vertex 4; there are 4"),
    "an index too small": ({"faces": [(0, 1, -1)]}, "face 0 names vertex -1"),
    "a fourth index below -1": ({"faces": [(0, 1, 2, -2)]}, "face 0 names vertex -2"),
    "a fractional index": ({"faces": [(0, 1, 1.5)]}, "whole vertex numbers"),
    "a NaN index": ({"faces": [(0, 1, np.nan)]}, "whole vertex numbers"),
    "no vertices": ({"vertices": np.zeros((0, 3))}, "face 0 names vertex 0"),
    "only degenerate faces": ({"faces": [(0, 1, 1), (2, 2, 2)]}, "no face is left: all 2 have no area"),
    "reflectance of one": ({"reflectance": 1.0}, r"of face 0 \(surface 'surface', band 0\) is 1; it must lie in \[0, 1\)"),
    "reflectance above one on one face": ({"reflectance": [0.5, 1.5]}, "reflectance of face 1 .* is 1.5"),
    "negative reflectance": ({"reflectance": -0.1}, "is -0.1"),
    "NaN reflectance": ({"reflectance": [0.5, np.nan]}, "face 1 .* is nan"),
    "reflectance for other faces": ({"reflectance": [0.5, 0.5, 0.5]}, r"reflectance has shape \(3,\)"),
    "reflectance with no bands": ({"reflectance": np.zeros((2, 0))}, r"reflectance has shape \(2, 0\)"),
    "reflectance with three axes": ({"reflectance": np.zeros((2, 1, 1))}, "reflectance has shape"),
    "reflectance as text": ({"reflectance": "bright"}, "reflectance cannot be read"),
    "complex emission": ({"emission": np.array([1j, 1])}, "emission cannot be read as numbers"),
    "reflectance None": ({"reflectance": None}, "reflectance"),
    "negative emission": ({"emission": [1.0, -2.0]}, "emission of face 1 .* is -2; it must be finite and not negative"),
    "NaN emission": ({"emission": np.nan}, "emission of face 0 .* is nan"),
    "infinite emission": ({"emission": np.inf}, "emission of face 0 .* is inf"),
    "bands that do not agree": ({"reflectance": [[0.1, 0.2, 0.3]], "emission": [[1.0, 2.0]]}, "2 and 3 bands"),
    "band names that do not agree": ({"bands": ("red", "green")}, "2 band names for 1 bands"),
    "a surface for other faces": ({"surface": [0]}, r"surface has shape \(1,\)"),
    "a negative surface": ({"surface": [0, -1]}, "surface of face 1 is -1"),
    "a huge surface": ({"surface": [0, 10**9]}, "without gaps"),
    "a surface that is no number": ({"surface": ["a", "b"]}, "surface cannot be read"),
    "a surface without a name": ({"surface": [0, 1], "names": ["floor"]}, "face 1 has surface 1, but there are 1 names"),
    "a fractional surface": ({"surface": [0, 0.5]}, "surface must hold whole surface numbers"),
    "a NaN surface": ({"surface": [0, np.nan]}, "surface must hold whole"),
    "one name for all": ({"names": "floor"}, "names is 'floor'; expected a sequence of names"),
    "names that are none": ({"names": 3}, "names is 3"),
    "bands that are none": ({"bands": 1}, "bands is 1"),
    "a camera that is none": ({"cameras": ["front"]}, "cameras must be a sequence of Camera"),
    "two_sided for other faces": ({"two_sided": [True]}, "two_sided must be"),
    "two_sided that is no truth value": ({"two_sided": [0.5, 0.5]}, "two_sided must be"),
    "two_sided as text": ({"two_sided": "yes"}, "two_sided cannot be read"),
    "a fractional back": ({"back": [0, 1.5]}, "back must hold whole numbers"),
    "an unknown back": ({"back": 7}, "back must hold 0 .absorbs., 1 .radiates., 2 .passes."),
    "backs for other faces": ({"back": [0, 1, 2]}, "back must hold"),
    "reflectance of one behind": ({"two_sided": True, "back_reflectance": 1.0}, "back reflectance of face 0"),
    "negative emission behind": ({"two_sided": True, "back_emission": -1.0}, "back emission of face 0"),
}


@pytest.mark.parametrize(("changes", "message"), BAD.values(), ids=BAD)
def test_bad_values(changes, message):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(rd.SceneError, match=message) as caught:
            build(source="my arrays", **changes)
    assert str(caught.value).startswith("my arrays: ")
    assert "\n" not in str(caught.value)


def test_values_are_kept():
    scene = build(reflectance=[0.25, 0.5], emission=[[1, 2, 3]], surface=[1, 0], names=["a", "b"], two_sided=[True, False])
    assert scene.reflectance.tolist() == [[0.25] * 3, [0.5] * 3]
    assert scene.emission.tolist() == [[1, 2, 3]] * 2
    assert scene.back_emission.tolist() == [[1, 2, 3]] * 2
    assert scene.bands == ("red", "green", "blue")
    assert [scene.names[s] for s in scene.surface] == ["b", "a"]
    assert scene.back.tolist() == [Back.RADIATES, Back.ABSORBS]
    assert scene.area.tolist() == [0.5, 0.5]
    assert scene.normal.tolist() == [[0, 0, 1]] * 2


def test_arrays_are_copied():
    vertices, reflectance = np.array(SQUARE, float), np.array([0.5, 0.5])
    scene = build(vertices=vertices, reflectance=reflectance)
    before = scene.vertices.copy()
    vertices[:], reflectance[:] = 9, 0.9
    assert (scene.vertices == before).all()
    assert (scene.reflectance == 0.5).all()


def test_faces_in_columns_keep_their_triangles():
    """What measures faces reads columns, and arrays of Fortran's order lend theirs."""
    corners = [*SQUARE, (0, 0, 1), (1, 0, 1)]
    faces = np.array([(0, 1, 2, 3), (0, 1, 5, -1)])
    scenes = [build(vertices=corners, faces=one) for one in (faces, np.asfortranarray(faces))]
    assert all((scene.faces == faces).all() for scene in scenes)
    assert scenes[1].area.tolist() == pytest.approx([1, 0.5])


def test_default_back_absorbs():
    assert build().back.tolist() == [Back.ABSORBS] * 2


def test_degenerate_faces_are_left_out_with_one_warning():
    faces = [*TWO, (0, 0, 1), (0, 1, 1)]
    with pytest.warns(rd.RadiosityWarning, match=r"2 faces without area left out \(first: face 2; surfaces 'c'") as caught:
        scene = build(faces=faces, surface=[0, 1, 2, 2], names=["a", "b", "c"])
    assert len(caught) == 1
    assert scene.n_faces == 2
    assert scene.names == ("a", "b", "c")


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1.0, 1e6, 1e12])
def test_size_alone_makes_no_face_degenerate(scale):
    """What is too thin is so beside where it lies: one part in a million of the scene stays, one in a hundred million goes."""
    points = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 1e-6, 0), (0.5, 1e-8, 0)]) * scale
    thin, thinner = (0, 1, 4, -1), (0, 1, 5, -1)
    scene = build(vertices=points, faces=[(0, 1, 2, 3), thin], surface=[0, 0], names=["a"])
    assert scene.n_faces == 2
    with pytest.warns(rd.RadiosityWarning, match=r"1 face without area left out \(first: face 1"):
        scene = build(vertices=points, faces=[(0, 1, 2, 3), thinner], surface=[0, 0], names=["a"])
    assert scene.n_faces == 1


def test_a_parallelogram_stays_one_face():
    scene = build(faces=[(0, 1, 2, 3)])
    assert scene.n_faces == 1
    assert scene.is_quad.all()
    assert scene.area[0] == 1


@pytest.mark.parametrize("begin", range(4))
@pytest.mark.parametrize("apex", [(3, 2, 0), (0.2, 0.2, 0)], ids=["convex", "concave"])
def test_another_quadrilateral_becomes_two_triangles(apex, begin):
    """Whichever corner comes first: the reflex one may be any of the four."""
    faces = [np.roll([0, 1, 2, 3], begin)]
    scene = build(vertices=[(0, 0, 0), (1, 0, 0), apex, (0, 1, 0)], faces=faces, reflectance=[0.25])
    assert scene.n_faces == 2
    assert not scene.is_quad.any()
    assert (scene.normal == [0, 0, 1]).all()
    x, y = np.array([(0, 0), (1, 0), apex[:2], (0, 1)]).T
    assert scene.area.sum() == pytest.approx(0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    assert scene.reflectance.tolist() == [[0.25]] * 2


def test_hash_tells_scenes_apart():
    variants = [{}, {"reflectance": 0.25}, {"emission": 2.0}, {"two_sided": True}, {"names": ["x"]}, {"photometric": True}]
    assert len({build(**changes).hash for changes in variants}) == len(variants)
    assert build().hash == build().hash


number = st.one_of(st.floats(-2, 2), st.sampled_from([0.0, 1.0, 0.5, np.nan, np.inf, -np.inf, 1e300, 1e-300, 1e17]))
anything = st.one_of(
    st.none(),
    st.text(max_size=3),
    number,
    st.integers(-(2**70), 2**70),
    st.booleans(),
    st.lists(st.one_of(number, st.text(max_size=2), st.none(), st.lists(number, max_size=3)), max_size=4),
)


def matrix(values, rows, columns):
    shape = st.tuples(rows, columns)
    return shape.flatmap(lambda s: arrays.arrays(np.float64, s, elements=values))


plausible = st.fixed_dictionaries(
    {
        "vertices": matrix(number, st.integers(0, 6), st.sampled_from([3, 3, 3, 2])),
        "faces": matrix(st.integers(-1, 6).map(float), st.integers(0, 5), st.sampled_from([3, 4, 4, 2])),
        "reflectance": st.one_of(number, matrix(number, st.integers(0, 3), st.integers(0, 3))),
        "emission": st.one_of(number, matrix(number, st.integers(0, 3), st.integers(0, 3))),
    },
    optional={
        "surface": st.lists(st.integers(-1, 3), max_size=5),
        "two_sided": st.one_of(st.booleans(), st.lists(st.booleans(), max_size=5)),
        "back": st.lists(st.integers(-1, 3), max_size=5),
        "names": st.lists(st.text(max_size=3), max_size=4),
        "back_reflectance": number,
        "back_emission": number,
        "bands": st.lists(st.text(max_size=3), max_size=4),
    },
)
ARGUMENTS = (
    "vertices",
    "faces",
    "reflectance",
    "emission",
    "surface",
    "two_sided",
    "back",
    "names",
    "bands",
    "back_reflectance",
    "back_emission",
    "cameras",
    "photometric",
)
# one or two arguments of a good call are replaced, so that a bad one is not hidden by an earlier one
wild = st.dictionaries(st.sampled_from(ARGUMENTS), anything, min_size=1, max_size=2)


def only_our_errors(values):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        try:
            scene = build(**values)
        except rd.RadiosityError:
            return
    assert scene.n_faces >= 1
    assert np.isfinite(scene.vertices[scene.faces[scene.faces >= 0]]).all()
    assert (scene.area > 0).all()
    assert ((scene.reflectance >= 0) & (scene.reflectance < 1)).all()
    assert (np.isfinite(scene.emission) & (scene.emission >= 0)).all()
    np.testing.assert_allclose(np.linalg.norm(scene.normal, axis=1), 1, rtol=1e-9)


@settings(max_examples=300)
@given(plausible)
def test_fuzz_with_arrays_that_look_right(values):
    only_our_errors(values)


@settings(max_examples=200)
@given(wild)
def test_fuzz_with_anything(values):
    only_our_errors(values)
