"""Mitsuba's lamps: what they reflect without a BSDF, and lines that go through those with a null one."""

import numpy as np
import pytest
from mitsuba_rays import scalar_mitsuba

import radiosity as rd
from radiosity.diagnostics.check import check
from radiosity.image import picture

HEAD, TAIL = '<scene version="3.0.0">', "</scene>"
WHITE = '<bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf>'
NULL = '<bsdf type="null"/>'
LIGHT = '<emitter type="area"><rgb name="radiance" value="2"/></emitter>'
DOWN = '<scale value="0.5"/><rotate x="1" angle="180"/><translate z="{}"/>'
ROOM = {
    "floor": '<translate z="-1"/>',
    "ceiling": '<rotate x="1" angle="180"/><translate z="1"/>',
    "west": '<rotate y="1" angle="90"/><translate x="-1"/>',
    "east": '<rotate y="1" angle="-90"/><translate x="1"/>',
    "south": '<rotate x="1" angle="-90"/><translate y="-1"/>',
    "north": '<rotate x="1" angle="90"/><translate y="1"/>',
}


@pytest.fixture
def load(tmp_path):
    def of(inside):
        (tmp_path / "scene.xml").write_text(HEAD + inside + TAIL)
        return rd.load_scene(tmp_path / "scene.xml")

    return of


def shape(name, place, inside, kind="rectangle"):
    return f'<shape type="{kind}" id="{name}"><transform name="to_world">{place}</transform>{inside}</shape>'


def lamp(name="lamp", height=0.5, bsdf=NULL):
    return shape(name, DOWN.format(height), LIGHT + bsdf)


def room(bsdf=WHITE):
    return "".join(shape(name, place, bsdf) for name, place in ROOM.items())


def mean(solution, name, quantity="irradiance"):
    rows = solution.patches.surface == solution.patches.scene.names.index(name)
    return np.average(getattr(solution, quantity)[rows, 0], weights=solution.patches.area[rows])


def mitsuba_albedo(path):
    """What Mitsuba's own lamp reflects."""
    with scalar_mitsuba() as mi:
        (shape,) = mi.load_file(str(path), optimize=False).shapes()
        return float(np.ravel(mi.traverse(shape.bsdf())["reflectance.value"])[0])


def test_a_lamp_without_bsdf_is_black_as_in_mitsuba(load, tmp_path):
    scene = load(lamp(bsdf=""))
    assert scene.reflectance.tolist() == [[mitsuba_albedo(tmp_path / "scene.xml")]] == [[0.0]]
    assert scene.back.tolist() == [rd.Back.ABSORBS]
    np.testing.assert_allclose(scene.emission, 2 * np.pi)


@pytest.mark.parametrize(
    "bsdf",
    [
        NULL,
        f'<bsdf type="mask"><float name="opacity" value="0"/>{WHITE}</bsdf>',
        f'<bsdf type="mask"><float name="opacity" value="0.5"/>{NULL}</bsdf>',
        f'<bsdf type="blendbsdf"><float name="weight" value="0"/>{NULL}{WHITE}</bsdf>',
    ],
)
def test_a_lamp_that_is_not_there_shines_all_the_same(load, bsdf):
    scene = load(lamp(bsdf=bsdf))
    assert scene.back.tolist() == [rd.Back.OPEN]
    assert scene.reflectance.tolist() == [[0.0]]
    np.testing.assert_allclose(scene.emission, 2 * np.pi)


def test_all_that_an_open_lamp_emits_is_absorbed_by_the_walls(load):
    solution = rd.solve(rd.subdivide(load(room() + lamp()), cells=4), "random-walk", rays=100_000, seed=1)
    patches = solution.patches
    taken = ((1 - patches.reflectance) * solution.irradiance * patches.area[:, None])[patches.reflectance[:, 0] > 0].sum()
    assert taken == pytest.approx(2 * np.pi * 1.0, rel=1e-3)  # radiance 2 from 1 m²; a black lamp keeps a tenth of it
    assert mean(solution, "lamp") == 0
    on_lamp = solution.patches.surface == solution.patches.scene.names.index("lamp")
    assert not solution.arrivals[on_lamp].any()
    assert not solution.few.any()  # no patch is said to be known badly because lines go through it


@pytest.mark.parametrize("method", ["random-walk", "particle-tracing"])
def test_lamps_in_front_of_each_other_add_up(load, method):
    black = '<bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>'
    floors = []
    for lamps in (lamp("a", 0.5), lamp("b", 0.9), lamp("a", 0.5) + lamp("b", 0.9)):
        patches = rd.subdivide(load(room(black) + lamps), cells=4)
        solution = rd.solve(patches, method, rays=60_000 * (lamps.count("<shape")), seed=1)
        floors.append(mean(solution, "floor"))
        assert mean(solution, "ceiling") == 0
    assert floors[2] == pytest.approx(floors[0] + floors[1], rel=0.01)


def test_a_wall_behind_an_open_lamp_is_lit_through_it(load):
    """From the side that it emits to, and where both lie in one plane."""
    bright = {}
    for name, inside in {"behind": lamp(height=0.9), "in one plane": lamp(height=1), "hidden": lamp(height=0.9, bsdf="")}.items():
        solution = rd.solve(rd.subdivide(load(room() + inside), cells=4), "random-walk", rays=60_000, seed=2)
        ceiling = np.flatnonzero(solution.patches.surface == solution.patches.scene.names.index("ceiling"))
        middle = ceiling[(np.abs(solution.patches.centroid[ceiling, :2]) < 0.5).all(axis=1)]
        bright[name] = solution.irradiance[middle].mean()
    assert bright["in one plane"] == pytest.approx(bright["behind"], rel=0.1)
    assert bright["hidden"] < 0.5 * bright["behind"]


@pytest.mark.parametrize(
    "method",
    [
        "stochastic-ray",
        "stochastic-jacobi-control-variate",
        "transillumination",
        "global-multipath",
        "global-form-factors",
        "full-matrix",
        "progressive-refinement",
        "hierarchical",
    ],
)
def test_methods_that_cannot_tell_a_lamp_from_what_is_behind_it_are_refused(load, method):
    with pytest.raises(rd.MethodError, match=r"'lamp' .*random-walk"):
        rd.solve(load(room() + lamp()), method, **({"rays": 1000} if "matrix" not in method else {}))


def test_pictures_show_an_open_lamp_from_its_front(load):
    scene = load(room() + lamp())
    hits = picture.first_hits(scene, np.array([[0, 0, -0.5], [0, 0, 0.8]]), np.array([[0, 0, 1.0], [0, 0, -1.0]]))
    assert [scene.names[scene.surface[face]] for face in hits.face] == ["lamp", "floor"]


def test_open_lamps_are_kept_in_files_and_checked(load, tmp_path):
    scene = load(room() + lamp())
    solution = rd.solve(rd.subdivide(scene, cells=2), "random-walk", rays=10_000)
    solution.save(tmp_path / "box.npz")
    assert (rd.load_solution(tmp_path / "box.npz").patches.scene.back == scene.back).all()
    report = check(scene)
    assert [s.sides for s in report.surfaces if s.name == "lamp"] == ["one, clear on both"]
    assert not report.serious


def test_what_is_open_reflects_nothing():
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    with pytest.raises(rd.SceneError, match=r"face 0 .*open.*0.5"):
        rd.Scene.from_arrays(square, [[0, 1, 2, 3]], 0.5, 1.0, back=rd.Back.OPEN)


def test_a_partial_mask_is_a_pane(load):
    mask = f'<bsdf type="mask"><float name="opacity" value="0.3"/>{WHITE}</bsdf>'
    with pytest.warns(rd.RadiosityWarning, match=r"masks, .* make clear panes, .*'net \(0.7\)'"):
        scene = load(shape("net", "", mask))
    assert (scene.reflectance.item(), scene.back.item()) == (pytest.approx(0.15), rd.Back.ABSORBS)
    assert scene.transmittance.tolist() == [0.7]


@pytest.mark.parametrize(("weight", "order"), [("0.25", 1), ("0.75", -1)])
def test_a_blend_with_nothing_is_a_mask(load, weight, order):
    both = "".join((NULL, WHITE)[::order])
    with pytest.warns(rd.RadiosityWarning, match=r"'net \(0.75\)'"):
        scene = load(shape("net", "", f'<bsdf type="blendbsdf"><float name="weight" value="{weight}"/>{both}</bsdf>'))
    assert scene.reflectance.item() == pytest.approx(0.125)


def test_a_whole_mask_is_the_material_itself_and_none_leaves_nothing(load):
    mask = '<bsdf type="mask"><float name="opacity" value="{}"/><bsdf type="twosided">' + WHITE + "</bsdf></bsdf>"
    with pytest.warns(rd.RadiosityWarning, match=r"left out: 'gone \(null\)'$"):
        scene = load(shape("net", "", mask.format(1)) + shape("gone", '<translate z="1"/>', mask.format(0)))
    assert (scene.names, scene.back.tolist()) == (("net",), [rd.Back.RADIATES])


@pytest.mark.parametrize(
    ("inside", "what"),
    [
        (WHITE + WHITE, "has 2 BSDFs"),
        (LIGHT + LIGHT, "2 area emitters"),
        ('<bsdf type="twosided"/>', "'twosided' BSDF of nothing"),
        (f'<bsdf type="twosided">{3 * WHITE}</bsdf>', "'twosided' BSDF of 'diffuse', 'diffuse', 'diffuse'"),
        (f'<bsdf type="twosided">{NULL}</bsdf>', "'twosided' BSDF of 'null'.*no light through"),
        (f'<bsdf type="twosided"><bsdf type="mask">{WHITE}</bsdf></bsdf>', "put a mask around"),
        ('<bsdf type="mask"/>', "a 'mask' holds 0 BSDFs"),
    ],
)
def test_what_mitsuba_refuses_is_refused(load, tmp_path, inside, what):
    with pytest.raises(rd.SceneError, match=what):
        load(shape("thing", "", inside))
    with scalar_mitsuba() as mi, pytest.raises(RuntimeError):
        mi.load_file(str(tmp_path / "scene.xml"))


@pytest.mark.parametrize(
    ("kind", "place", "good"),
    [
        ("sphere", '<scale value="2"/>', True),
        ("sphere", '<scale x="-1" y="1" z="1"/><rotate x="0.6" y="0.8" angle="30"/>', True),
        ("sphere", '<scale x="2" y="1" z="1"/>', False),
        ("cylinder", '<scale x="1" y="1" z="3"/>', True),
        ("cylinder", '<scale x="2" y="1" z="1"/>', False),
        ("cylinder", '<matrix value="1 0 0.5 0 0 1 0 0 0 0 1 0 0 0 0 1"/>', False),
        ("disk", '<scale x="2" y="1" z="1"/>', True),
    ],
)
def test_round_shapes_must_stay_round_as_in_mitsuba(load, tmp_path, kind, place, good):
    inside = shape("ball", place, WHITE, kind)
    if good:
        with scalar_mitsuba() as mi:
            area = mi.load_string(HEAD + inside + TAIL).shapes()[0].surface_area()
        assert load(inside).area.sum() == pytest.approx(area, rel=1e-5)
    else:
        with pytest.raises(rd.SceneError, match=f"{kind} 'ball' is scaled unevenly or sheared"):
            load(inside)
