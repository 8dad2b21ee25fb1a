"""Nothing is lost between a solution, its file and what is taken of a scene: field by field, so that a new one
cannot be forgotten. No field has its default here, or it could be lost unseen.
"""

import json
from dataclasses import MISSING, fields, replace

import numpy as np
import pytest
from members import OPTIONS, accepted

import radiosity as rd
from radiosity.method.baseline import CHOICES, USED
from radiosity.scene import Back, Camera
from radiosity.scene.combine import combine
from radiosity.scene.cut import Cut
from radiosity.scene.heat import Heat
from radiosity.scene.lights.model import Lights
from radiosity.scene.lights.sun import Sun
from radiosity.scene.paint import Paint
from radiosity.scene.sampler import Sampler
from radiosity.scene.sensor_request import SensorRequest
from radiosity.solution.npz import CUT_ARRAYS


def paint(random, n: int, limit: float) -> Paint:
    images = (random.random((3, 2, 2)).astype(np.float32), random.random((1, 4, 1)).astype(np.float32))
    uv = random.random((n, 4, 2)).astype(np.float32)
    color = 1 - random.random((n, 4, 2)).astype(np.float32) / 64  # cells of stronger colours are cut finer, which takes time
    samplers = Sampler(("clamp", "mirror"), "linear"), Sampler(("mirror", "repeat"), "nearest")
    return Paint(images, np.arange(n, dtype=np.int32) % 3 - 1, uv, color, limit, samplers)


def everything() -> rd.Scene:
    """The room and a triangle within it, with all that a scene may have."""
    random = np.random.Generator(np.random.Philox(1))
    room = rd.load_scene("room")
    n = room.n_faces + 1
    vertices = [*room.vertices.tolist(), [1.0, 1.0, 1.9], [1.5, 1.0, 1.9], [1.0, 1.5, 2.0]]
    triangle = [len(vertices) - 3, len(vertices) - 2, len(vertices) - 1, -1]
    back = np.where(np.arange(n) == 1, Back.OPEN, np.arange(n) % 3)
    reflectance = np.where(back[:, None] == Back.OPEN, 0.0, random.random((n, 2)) / 2)
    scene = rd.Scene.from_arrays(
        vertices,
        [*room.faces.tolist(), triangle],
        reflectance,
        random.random((n, 2)),
        surface=[*room.surface, 0],
        names=room.names,
        back=back,
        back_reflectance=random.random((n, 2)) / 2,
        back_emission=random.random((n, 2)),
        bands=("warm", "cold"),
        photometric=True,
        source="everything",
        cameras=(Camera((1.0, 2.0, 3.0), (4.0, 5.0, 6.0), (0.0, 1.0, 0.0), 33.0, 640, 480), Camera((0, 0, 1), (1, 1, 1))),
    )
    k = len(room.names)
    sizes = np.where(np.arange(k) % 2, 0.5, np.nan)
    emissivity = tuple(None if i == 1 else {"front": (0.5, 0.25), "back": (0.5,)} if i == 2 else (0.5, 0.25) for i in range(k))
    known, isothermal = np.where(np.arange(k) % 2, 300.0, np.nan), np.arange(k) % 4 == 0
    heat = Heat(known, np.where(isothermal, 5.0, np.nan), emissivity, isothermal, 290.0, (3.0,))
    paints = {"reflectance_paint": paint(random, n, 0.9), "emission_paint": paint(random, n, 7.0)}
    through = np.where((back == Back.RADIATES) | (back == Back.ABSORBS), (np.arange(n) % 4 + 1) / 16, 0.0)
    diffused = np.where(back == Back.RADIATES, 1 / 16, 0.0)[:, None] * [1.0, 2.0]
    point = SensorRequest("point", points=((1.0, 2.0, 3.0),), normals=((0.0, 0.0, 1.0),))
    asked = (SensorRequest("plane", surface="floor", spacing=0.5), point)
    plain = {"patch_size": sizes, "scale": 0.01, "heat": heat, "assumed": room.names[:2]}
    plain["cut"] = Cut("hash of the whole scene", np.arange(n) // 2, np.arange(n) % 3)
    panes = {"transmittance": through, "diffuse_transmittance": diffused, "refractive_index": np.where(through > 0, 1.5, 0.0)}
    return replace(scene, sensors=asked, **panes, **plain, **paints)


def same(one, other, name: str) -> None:
    """Equal to the bit, kinds of arrays included; dataclasses field by field."""
    if hasattr(one, "__dataclass_fields__"):
        assert type(one) is type(other), name
        for field in fields(one):
            same(getattr(one, field.name), getattr(other, field.name), f"{name}.{field.name}")
    elif isinstance(one, np.ndarray):
        assert one.dtype == other.dtype, name
        np.testing.assert_array_equal(one, other, err_msg=name)
    elif isinstance(one, dict):
        assert one.keys() == other.keys(), name
        for key, value in one.items():
            same(value, other[key], f"{name}[{key!r}]")
    elif isinstance(one, tuple | list):
        assert (type(one), len(one)) == (type(other), len(other)), name
        for i, value in enumerate(one):
            same(value, other[i], f"{name}[{i}]")
    else:
        assert one == other, name


def is_default(field, value) -> bool:
    default = field.default if field.default_factory is MISSING else field.default_factory()
    return default is not MISSING and np.array_equal(default, value)


@pytest.fixture(scope="module")
def solution() -> rd.Solution:
    patches, random = rd.subdivide(everything(), size=2.5), np.random.Generator(np.random.Philox(2))
    own = {"own_reflectance": patches.reflectance / 2, "own_emission": random.random(patches.emission.shape)}
    solution = rd.solve(replace(patches, **own), "random-walk", quanta=2000, replicates=3, seed=2**40)
    bias = random.random((2 * len(patches.scene.names), 2))
    return replace(solution, warnings=("one", "another"), side_bias=bias)


def test_no_field_has_its_default(solution):
    scene = solution.patches.scene
    for value in (solution, solution.patches, scene, scene.cameras[0], scene.reflectance_paint):
        for field in fields(value):
            # the first is of what is solved; the second see test_gather_lights; the third and fourth see test_bases
            if field.name not in ("pane_of", "lights", "irradiance_coefficients", "irradiance_coefficients_standard_error"):
                assert not is_default(field, getattr(value, field.name)), f"{type(value).__name__}.{field.name}"
    assert set(scene.back) == set(Back)
    assert np.isfinite(scene.patch_size).any()
    assert solution.state
    assert not (solution.patches.columns == solution.patches.rows).all()


def test_every_field_survives_a_file(solution, tmp_path):
    solution.save(tmp_path / "a.npz")
    loaded = rd.load_solution(tmp_path / "a.npz")
    as_json = {"provenance": json.loads(json.dumps(solution.provenance)), "books": tuple(dict(book) for book in solution.books)}
    same(replace(solution, **as_json), loaded, "solution")
    for name in ("radiosity", "standard_error", "escaped", "bands", "unit", "few", "error"):
        same(getattr(solution, name), getattr(loaded, name), name)
    for name in ("hash", "area", "normal", "bounds", "unit", "power_unit"):
        same(getattr(solution.patches.scene, name), getattr(loaded.patches.scene, name), name)
    for name in ("hash", "face", "is_back", "area", "normal", "centroid", "surface", "reflectance", "emission"):
        same(getattr(solution.patches, name), getattr(loaded.patches, name), name)
    loaded.save(tmp_path / "b.npz")
    same(loaded, rd.load_solution(tmp_path / "b.npz"), "solution")


@pytest.mark.parametrize("state", [{}, None], ids=["without a state", "with a state"])
@pytest.mark.parametrize("power", [True, False])
def test_what_may_be_absent_stays_absent(solution, tmp_path, state, power):
    kept = replace(
        solution,
        state=solution.state if state is None else state,
        surface_power=solution.surface_power if power else None,
    )
    kept.save(tmp_path / "a.npz")
    loaded = rd.load_solution(tmp_path / "a.npz")
    same(kept.state, loaded.state, "state")
    same(kept.surface_power, loaded.surface_power, "surface_power")


def spoilt(name: str, change):
    """Of a file's arrays: one of them changed at its last entry."""

    def of(arrays: dict) -> dict:
        values = arrays[name].copy()
        values.flat[-1] = change(values.flat[-1], arrays)
        return arrays | {name: values}

    return of


DAMAGE = {
    "a vertex after the last": spoilt("scene_faces", lambda old, arrays: len(arrays["scene_vertices"])),
    "a vertex before the first": spoilt("scene_faces", lambda old, arrays: -2),
    "a surface after the last": spoilt("scene_surface", lambda old, arrays: len(arrays["scene_patch_size"])),
    "a reflectance of one": spoilt("scene_reflectance", lambda old, arrays: 1.0),
    "a reflectance below zero": spoilt("scene_back_reflectance", lambda old, arrays: -1e-9),
    "an emission below zero": spoilt("scene_emission", lambda old, arrays: -1.0),
    "an infinite emission": spoilt("scene_back_emission", lambda old, arrays: np.inf),
    "a back of no kind": spoilt("scene_back", lambda old, arrays: len(Back)),
    "an own reflectance of one": spoilt("patches_own_reflectance", lambda old, arrays: 1.0),
    "an own emission below zero": spoilt("patches_own_emission", lambda old, arrays: -1.0),
    "no columns": spoilt("patches_columns", lambda old, arrays: 0),
    "a triangle cut unevenly": spoilt("patches_rows", lambda old, arrays: old + 1),
    "an irradiance that is unknown": spoilt("irradiance", lambda old, arrays: np.nan),
    "an error below zero": spoilt("irradiance_standard_error", lambda old, arrays: -1e-9),
    "arrivals below zero": spoilt("arrivals", lambda old, arrays: -1),
    "an infinite power": spoilt("surface_power", lambda old, arrays: np.inf),
    "an image after the last": spoilt("reflectance_paint_image", lambda old, arrays: 2),
    "a texture that is placed nowhere": lambda arrays: (
        arrays
        | {"emission_paint_uv": np.where(np.arange(4)[:, None] == 3, np.nan, arrays["emission_paint_uv"]).astype(np.float32)}
    ),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_what_does_not_fit_together_is_refused(solution, tmp_path, damage):
    solution.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as file:
        arrays = {name: file[name] for name in file.files}
    np.savez(tmp_path / "same.npz", **arrays)
    same(rd.load_solution(tmp_path / "a.npz"), rd.load_solution(tmp_path / "same.npz"), "solution")
    np.savez(tmp_path / "b.npz", **DAMAGE[damage](arrays))
    with pytest.raises(rd.SceneError, match=r"b\.npz: is no solution of this program, or damaged"):
        rd.load_solution(tmp_path / "b.npz")


FACE_FIELDS = {"faces", "reflectance", "emission", "back", "back_reflectance", "back_emission", "surface"}
FACE_FIELDS |= {"transmittance", "diffuse_transmittance", "refractive_index"}
PAINT_FIELDS = {"image", "uv", "color"}


def test_files_with_values_of_patches_are_refused_by_versions_that_do_not_know_them(solution, tmp_path):
    diffuse = replace(everything(), refractive_index=None)
    panes = replace(diffuse, diffuse_transmittance=None)
    clear = replace(panes, transmittance=None)
    own, *others = (replace(solution.patches, scene=scene) for scene in (clear, panes, diffuse))
    of_cut = rd.subdivide(clear, size=2.5)
    for patches, number in zip((own, of_cut, *others, solution.patches), (2, 1, 4, 5, 6), strict=True):
        replace(solution, patches=patches).save(tmp_path / "a.npz")
        with np.load(tmp_path / "a.npz") as file:
            assert json.loads(str(file["meta"]))["format"] == number


@pytest.mark.parametrize("name", ["own_reflectance", "own_emission"])
def test_the_hash_of_the_cut_sees_values_of_patches(solution, name):
    patches = solution.patches
    other = replace(patches, **{name: getattr(patches, name) / 2})
    assert len({patches.hash, other.hash, replace(patches, **{name: None}).hash}) == 3


@pytest.mark.parametrize("masked", [False, True])
def test_a_choice_of_faces_keeps_all_of_them(masked):
    scene, rows = everything(), np.array([4, 0, 2])
    if masked:
        rows = np.arange(scene.n_faces) % 2 == 0
    taken = scene.take(rows)
    for field in fields(scene):
        whole, part = getattr(scene, field.name), getattr(taken, field.name)
        if isinstance(whole, Paint | Cut):
            for inner in fields(whole):
                value = getattr(whole, inner.name)
                same(value[rows] if inner.name in (*PAINT_FIELDS, *CUT_ARRAYS) else value, getattr(part, inner.name), inner.name)
        else:
            same(whole[rows] if field.name in FACE_FIELDS else whole, part, field.name)


def test_a_scene_combined_with_nothing_or_with_itself_is_there_whole():
    scene = everything()
    alone = combine([scene], source=scene.source, photometric=scene.photometric, scale=scene.scale)
    for which in ("reflectance_paint", "emission_paint"):
        one, other = getattr(scene, which), getattr(alone, which)
        for image, again in zip(one.images, other.images, strict=True):
            np.testing.assert_array_equal(np.broadcast_to(image, (*image.shape[:2], 2)), again)  # one band becomes two
        same(replace(one, images=()), replace(other, images=()), which)
    plain = {"reflectance_paint": None, "emission_paint": None}
    same(replace(scene, **plain), replace(alone, **plain), "scene")
    renamed = replace(scene, names=tuple(f"other {name}" for name in scene.names))
    for which in ("reflectance_paint", "emission_paint"):
        one = getattr(renamed, which)
        renamed = replace(renamed, **{which: replace(one, images=tuple(1 - image / 2 for image in one.images))})
    twice = combine([scene, renamed], source="", photometric=True, scale=1.0)
    n = scene.n_faces
    one, other = (rd.subdivide(twice.take(np.arange(k, k + n)), cells=2) for k in (0, n))
    for patches, alike in ((one, scene), (other, renamed)):
        expected = rd.subdivide(alike, cells=2)
        for name in ("corners", "normal", "area", "reflectance", "emission", "is_back"):
            same(getattr(expected, name), getattr(patches, name), name)
    assert twice.names == (*scene.names, *(f"other {name}" for name in scene.names))
    np.testing.assert_array_equal(twice.patch_size, np.tile(scene.patch_size, 2))
    assert twice.cameras == 2 * scene.cameras


NO_LIGHT = ("cameras", "scale", "source", "patch_size", "heat", "assumed", "sensors", "cut")  # light does not depend on them


@pytest.mark.parametrize("name", [f.name for f in fields(rd.Scene) if f.name not in NO_LIGHT])
def test_the_hash_sees_every_field_that_results_depend_on(name):
    scene = everything()
    value = getattr(scene, name)
    if isinstance(value, Paint):
        for inner in fields(value):
            old = getattr(value, inner.name)
            if inner.name == "images":
                new = (old[0], old[1] + 1)
            elif inner.name == "samplers":
                new = (old[0], replace(old[1], filter="linear"))
                turned = (replace(old[0], wrap=old[0].wrap[::-1]), old[1])
                assert replace(scene, **{name: replace(value, samplers=turned)}).hash != scene.hash
            else:
                new = old + 1
            assert replace(scene, **{name: replace(value, **{inner.name: new})}).hash != scene.hash, inner.name
        other = None
    elif isinstance(value, np.ndarray):
        other = value.copy()
        other.flat[-1] += 1
    elif isinstance(value, Lights):
        other = Lights(suns=(Sun("sun", np.array([0.0, 0.0, 1.0]), np.ones(3)),))
        again = Lights(suns=(replace(other.suns[0], diameter=1.0),))
        assert replace(scene, lights=other).hash != replace(scene, lights=again).hash
    else:
        other = not value if isinstance(value, bool) else (*value[:-1], "another")
    assert replace(scene, **{name: other}).hash != scene.hash


METHODS = [*accepted(), *(preset.method for preset in rd.PRESETS.values())]


def test_methods_come_back_from_what_solutions_say_of_them(solution, tmp_path):
    """Through a file, every method that makes sense, with each option that goes with it, and baselines with each choice."""
    methods = list(dict.fromkeys(METHODS))
    for option, on in [(option, on) for option, values in OPTIONS.items() for on in values] + [
        ("coherent", True),
        ("numbers", "sobol"),
    ]:
        for method in tuple(methods):
            try:
                methods.append(replace(method, **{option: on}))
            except rd.MethodError:
                continue
    baselines = CHOICES | {"samples": (7,), "epsilon": (1e-3,), "reciprocal": (True,), "ambient": (True,)}
    for scheme in USED:
        for choice, values in baselines.items():
            for value in values:
                try:
                    methods.append(rd.Baseline(**({"scheme": scheme} | {choice: value})))
                except rd.MethodError:
                    continue
    assert len(set(methods)) > 100
    names = {}
    for method in dict.fromkeys(methods):
        choices = {field.name: getattr(method, field.name) for field in fields(method)}
        kept = json.loads(json.dumps(choices))
        assert type(method)(**kept) == method
        assert names.setdefault(str(method), method) == method  # two methods of one name could not be told apart in a report
    for method in (rd.Method(numbers="sobol", order="regular", warm_up=True), rd.PRESETS["stochastic-jacobi"].method):
        done = rd.solve(solution.patches.scene.take([0, 3]), method, quanta=10, replicates=2)
        done.save(tmp_path / "a.npz")
        assert rd.Method(**rd.load_solution(tmp_path / "a.npz").provenance["choices"]) == method
