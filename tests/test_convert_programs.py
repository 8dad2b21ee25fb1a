"""Scenes written for Radiance, MGF and Mitsuba: they read back with the same sides, and their own programs see the same light."""

import os
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from mitsuba_rays import scalar_mitsuba
from test_convert import again, scenes

import radiosity as rd
from radiosity.scene.lights import webs as lamps

pytest.importorskip("pyradiance")
SUFFIXES = (".rad", ".mgf", ".xml")
LUMENS = 179.0  # a watt, in Radiance
RGB = ("red", "green", "blue")


def factor(scene: rd.Scene, suffix: str) -> float:
    """What emission is multiplied with in a format."""
    return {".rad": 1 / LUMENS if scene.photometric else 1, ".mgf": 1 if scene.photometric else LUMENS, ".xml": 1}[suffix]


def middles(scene: rd.Scene) -> np.ndarray:
    origin, first, second = scene.frames
    return origin + (first + second) / np.where(scene.is_quad, 2, 3)[:, None]


def seen(scene: rd.Scene, middle, normal):
    """What is seen of one place from where a normal points: emission, reflectance of what is nearest, transmittance, diffuse."""
    near = np.linalg.norm(middles(scene) - middle, axis=1) < 0.02
    found = []
    for i in np.flatnonzero(near):
        front = scene.normal[i] @ normal > 0
        if front or scene.back[i] == rd.Back.RADIATES:
            values = (scene.emission, scene.reflectance) if front else (scene.back_emission, scene.back_reflectance)
            found.append((middles(scene)[i] @ normal, values[0][i], values[1][i]))
    through = [0.0 if part is None else part[near].max() for part in (scene.transmittance, scene.diffuse_transmittance)]
    top = max(found, key=lambda one: one[0])
    return sum(one[1] for one in found), top[2], *through


@given(scenes(), st.sampled_from(SUFFIXES))
@hypothesis_settings(max_examples=18, deadline=None)
def test_sides_read_back(tmp_path_factory, scene, suffix):
    read, told = again(scene, tmp_path_factory.mktemp("scene") / f"x{suffix}")
    times = factor(scene, suffix)
    grey = any("almost grey" in text for text in told)
    tolerance = {"rel": 1e-6, "abs": 1e-6 * 100 * times} if suffix == ".xml" else {"rel": 1e-9, "abs": 1e-12}
    for i, (middle, normal) in enumerate(zip(middles(scene), scene.normal, strict=True)):
        for sign in (1, -1)[: 2 if scene.back[i] == rd.Back.RADIATES else 1]:
            one, other = seen(scene, middle, sign * normal), seen(read, middle, sign * normal)
            assert other[2] == pytest.approx(one[2], rel=1e-6)
            if grey:
                continue
            assert np.broadcast_to(other[1], one[1].shape) == pytest.approx(one[1], **tolerance)
            if not (sign < 0 and one[2] > 0 and suffix != ".mgf"):  # panes shine to one side there
                assert np.broadcast_to(other[0], one[0].shape) == pytest.approx(one[0] * times, **tolerance)


def stack(pane: dict | None = None, **lamp) -> rd.Scene:
    """A lamp of 1 m² that looks down from a height of 1 m, and a pane under it at 0.5 m."""
    corners = [[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1], [-9, -9, 0.5], [9, -9, 0.5], [9, 9, 0.5], [-9, 9, 0.5]]
    pane = pane or {}
    black = (0.0, 0.0, 0.0)
    return rd.Scene.from_arrays(
        corners if pane else corners[:4],
        [[0, 1, 2, 3], [4, 5, 6, 7]][: 2 if pane else 1],
        [lamp.get("reflectance", black), pane.get("reflectance", black)][: 2 if pane else 1],
        [lamp.get("emission", (30.0, 20.0, 10.0)), black][: 2 if pane else 1],
        surface=[0, 1][: 2 if pane else 1],
        names=["lamp", "pane"][: 2 if pane else 1],
        back=[lamp.get("back", rd.Back.ABSORBS), rd.Back.RADIATES][: 2 if pane else 1],
        back_reflectance=[black, pane.get("back_reflectance", pane.get("reflectance", black))][: 2 if pane else 1],
        back_emission=[lamp.get("back_emission", black), black][: 2 if pane else 1],
        bands=RGB,
        transmittance=[0, pane["transmittance"]] if "transmittance" in pane else None,
        diffuse_transmittance=[black, pane["diffuse"]] if "diffuse" in pane else None,
        refractive_index=[0, pane["index"]] if "index" in pane else None,
    )


def radiance(path: Path, origins, directions, *options: str) -> np.ndarray:
    """Radiances that Radiance's rtrace finds along rays, (n, 3); an .mgf goes through mgf2rad."""
    import pyradiance

    root = Path(pyradiance.__file__).parent
    environment = {**os.environ, "RAYPATH": str(root / "lib")}

    def run(name, *words, given=b""):
        done = subprocess.run([root / "bin" / name, *words], input=given, env=environment, capture_output=True, timeout=60)
        assert done.returncode == 0, done.stderr
        return done.stdout

    if path.suffix == ".mgf":
        text = run("mgf2rad", path)
        path = path.with_suffix(".of-mgf.rad")
        path.write_bytes(text)
    octree = path.with_suffix(".oct")
    octree.write_bytes(run("oconv", path))
    rays = "\n".join(" ".join(map(str, [*o, *d])) for o, d in zip(origins, directions, strict=True)).encode()
    return np.array(run("rtrace", "-h", *options, octree, given=rays).split(), float).reshape(-1, 3)


def mitsuba_radiance(path: Path, origins, directions) -> np.ndarray:
    """Radiances that Mitsuba's path tracer finds along rays that meet a lamp after at most some panes, (n, 3)."""
    with scalar_mitsuba() as mitsuba:
        scene = mitsuba.load_file(str(path))
        integrator = mitsuba.load_dict({"type": "path"})
        sampler = mitsuba.load_dict({"type": "independent"})
        sampler.seed(1)
        rays = [mitsuba.RayDifferential3f(o, d) for o, d in zip(origins, directions, strict=True)]
        return np.array([np.array(integrator.sample(scene, sampler, ray)[0]) for ray in rays], float)


UP, DOWN = [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]
BELOW, ABOVE = [0.5, 0.4, 0.1], [0.5, 0.4, 2.0]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_programs_see_both_sides_of_a_lamp(suffix, tmp_path):
    scene = stack(back=rd.Back.RADIATES, back_emission=(1.0, 2.0, 4.0))
    again(scene, path := tmp_path / f"x{suffix}")
    find = mitsuba_radiance if suffix == ".xml" else radiance
    found = find(path, [BELOW, ABOVE], [UP, DOWN])
    assert found == pytest.approx(np.array([[30, 20, 10], [1, 2, 4]]) / np.pi, rel=1e-5)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_programs_see_light_through_a_pane(suffix, tmp_path):
    """Straight on, with a reflectance of its own; of 8000 rays in Mitsuba's mask the mean is within 5 standard errors."""
    again(stack(pane={"transmittance": 0.4, "reflectance": (0.1, 0.2, 0.3)}), path := tmp_path / f"x{suffix}")
    if suffix == ".xml":
        found = mitsuba_radiance(path, [BELOW] * 8000, [UP] * 8000)
        passed = found[:, 0] > 5
        assert passed.mean() == pytest.approx(0.4, abs=5 * (0.24 / 8000) ** 0.5)
        assert found[passed].mean(axis=0) == pytest.approx(np.array([30, 20, 10]) / np.pi, rel=1e-5)
    else:
        found = radiance(path, [BELOW], [UP], "-ab", "0")
        assert found == pytest.approx(0.4 * np.array([[30, 20, 10]]) / np.pi, rel=1e-4)


def test_radiance_sees_glass_and_what_a_pane_diffuses(tmp_path):
    glass, index = 0.8, 1.5
    again(stack(pane={"transmittance": glass, "index": index}), path := tmp_path / "glass.rad")
    from radiosity.scene.clear_glass import of_mean, share_at

    aside = np.array([0.6, 0.0, 0.8])
    origins = [BELOW, np.array([0.5, 0.5, 1.0]) - 0.9 / 0.8 * aside]
    found = radiance(path, origins, [UP, aside], "-ab", "0")
    share = share_at(np.array([1.0, 0.8]), of_mean(glass, index), index)
    assert found == pytest.approx(share[:, None] * np.array([[30, 20, 10]]) / np.pi, rel=2e-3)

    pane = {"diffuse": (0.5, 0.3, 0.2), "reflectance": (0.2, 0.3, 0.4), "back_reflectance": (0.4, 0.3, 0.1)}
    read, _ = again(stack(pane=pane), path := tmp_path / "sheet.rad")
    assert read.diffuse_transmittance[read.names.index("pane")] == pytest.approx((0.5, 0.3, 0.2))
    # from below what the pane diffuses: tau E / pi, from above what it reflects; E of the square at 0.5 m over its middle
    under = [0.5, 0.5]
    found = radiance(path, [[*under, 0.1], [*under, 0.9]], [UP, DOWN], "-ab", "0", "-ds", "0.02", "-dj", "0")
    leg = 1 / np.sqrt(2)  # half side over diagonal: sides a, b and height c give the corner's form factor
    factor = 4 * 2 * leg * np.arctan(leg) / (2 * np.pi)
    light = factor * np.array([30.0, 20.0, 10.0]) / np.pi
    assert found == pytest.approx(np.array([light * (0.5, 0.3, 0.2), light * (0.2, 0.3, 0.4)]), rel=5e-3)


def test_mitsuba_finds_a_furnace(tmp_path):
    """All walls emit 10 and reflect a half: the radiance is 20 / pi; the mean of 3000 rays is within 5 standard errors."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    scene = rd.Scene.from_arrays(corners, faces, 0.5, 10.0, names=["furnace"])
    assert ((middles(scene) - 0.5) * scene.normal).sum(axis=1).max() < 0  # fronts look inwards
    again(scene, path := tmp_path / "x.xml")
    ways = np.random.Generator(np.random.Philox(3)).normal(size=(3000, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    found = mitsuba_radiance(path, [[0.4, 0.5, 0.6]] * 3000, ways.tolist())[:, 0]
    assert found.mean() == pytest.approx(20 / np.pi, abs=5 * found.std() / 3000**0.5)


@pytest.mark.parametrize("suffix", [".rad", ".xml"])
def test_suns_and_skies_stay_or_are_named(suffix, tmp_path):
    room = rd.load_scene("room")
    sky = rd.uniform_sky(100.0, photometric=False) if suffix == ".rad" else None
    scene = room.with_lights(suns=[rd.sun(500.0, direction=(0, 1, 2), diameter=0.5, photometric=False)], sky=sky)
    read, told = again(scene, tmp_path / f"x{suffix}")
    (sun,) = read.lights.suns
    assert sun.irradiance == pytest.approx([500.0])
    assert sun.direction == pytest.approx(scene.lights.suns[0].direction)
    assert any("lose their disc" in text for text in told) == (suffix == ".xml")
    if suffix == ".rad":
        assert sun.diameter == 0.5
        assert read.lights.sky.horizontal == pytest.approx([100.0])
        assert read.lights.sky.flux == pytest.approx(sky.flux)
    overcast = room.with_lights(sky=rd.cie_sky("overcast", 100.0, photometric=False))
    read, told = again(overcast, tmp_path / f"y{suffix}")
    assert read.lights.sky is None
    assert any("left out" in text and "'sky'" in text for text in told)


def test_points_and_spots_stay_in_mitsuba(tmp_path):
    cone = lamps.cone(15, 40, lambda angle: np.clip((np.radians(40) - angle) / np.radians(25), 0, 1), 2)
    point = rd.point_light(position=(1, 1, 2), lumens=30.0, name="globe", color=(1, 0.5, 0.25))
    spot = rd.point_light(position=(2, 1, 2), lumens=10.0, name="spot")
    gauss = rd.point_light(position=(2, 1, 2), lumens=10.0, beam=30, name="gauss")
    scene = replace(rd.load_scene("room"), photometric=True).with_lights([point, replace(spot, web=cone), gauss])
    read, told = again(scene, tmp_path / "x.xml")
    assert [lamp.name for lamp in read.lights.luminaires] == ["globe", "spot"]
    for one, other in zip(scene.lights.luminaires, read.lights.luminaires, strict=False):
        assert other.power == pytest.approx(one.power, rel=1e-6)
        assert other.position == pytest.approx(one.position)
        assert other.axes[2] == pytest.approx(one.axes[2], abs=1e-6)
    assert read.lights.luminaires[1].web.gamma == pytest.approx(cone.gamma)
    assert any("left out: 'gauss'" in text for text in told)
    (camera,), (other,) = scene.cameras, read.cameras
    assert other.fov == pytest.approx(camera.fov)
    gaze = np.subtract(camera.target, camera.origin)
    assert np.subtract(other.target, other.origin) == pytest.approx(gaze / np.linalg.norm(gaze), abs=1e-6)


@pytest.mark.parametrize(
    ("suffix", "name", "becomes"),
    [
        (".rad", "south wall", "south_wall"),
        (".rad", "lamp.12", "lamp.12"),
        (".rad", "void", "surface_0"),
        (".rad", "Wände", "Wände"),
        (".mgf", "Wände", "Wande"),
        (".mgf", "2nd floor", "s2nd_floor"),
        (".mgf", "=", "surface_0"),
        (".xml", "a.b $c <d>", "a_b _c <d>"),
        (".xml", "_arg_0", "surface 0"),
    ],
)
def test_names_that_formats_cannot_hold(suffix, name, becomes, tmp_path):
    scene = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.25, 2.0, names=[name])
    read, told = again(scene, tmp_path / f"x{suffix}")
    assert read.names[0] == becomes
    assert any("are changed" in text and name in text for text in told) == (name != becomes)


def test_lamps_that_lines_pass_stay_so(tmp_path):
    scene = stack(back=rd.Back.OPEN)
    for suffix in (".rad", ".xml"):
        read, _ = again(scene, tmp_path / f"x{suffix}")
        assert read.back.tolist() == [rd.Back.OPEN]
        assert read.emission == pytest.approx(scene.emission, rel=1e-6)
    assert "surfaces that lines pass" in "".join(again(_dark(scene), tmp_path / "y.xml")[1])


def _dark(scene: rd.Scene) -> rd.Scene:
    """A wall and a surface that neither stops lines nor emits."""
    both = rd.load_scene("room")
    back = both.back.copy()
    back[both.surface == 0] = rd.Back.OPEN
    return replace(both, back=back, reflectance=np.where((both.surface == 0)[:, None], 0.0, both.reflectance))
