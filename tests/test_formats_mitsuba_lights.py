"""Mitsuba's emitters that are no surfaces: each sends what Mitsuba's own sends, in each direction."""

import numpy as np
import pytest
from mitsuba_rays import scalar_mitsuba
from samples import png

import radiosity as rd

HEAD, TAIL = '<scene version="3.0.0">', "</scene>"
FLOOR = '<shape type="rectangle" id="floor"><bsdf type="diffuse"><rgb name="reflectance" value="{}"/></bsdf></shape>'
LOOK = '<transform name="to_world"><lookat origin="0.3,0.2,2" target="1,-0.5,0" up="0,1,0"/></transform>'
TURN = '<transform name="to_world"><rotate x="1" angle="90"/><rotate z="1" angle="25"/></transform>'


@pytest.fixture
def load(tmp_path):
    def of(inside, reflectance="0.5", **options):
        (tmp_path / "scene.xml").write_text(HEAD + FLOOR.format(reflectance) + inside + TAIL)
        return rd.load_scene(tmp_path / "scene.xml", **options)

    return of


def seen_by_mitsuba(path, points) -> tuple[np.ndarray, np.ndarray]:
    """What Mitsuba's emitter sends to points: unit directions to it, (n, 3), and irradiance across them, (n, 3), in RGB."""
    with scalar_mitsuba() as mi:
        (emitter,) = mi.load_file(str(path), optimize=False).emitters()
        result = []
        for point in points:
            interaction = mi.SurfaceInteraction3f()
            interaction.p = mi.Point3f(point)
            sample, weight = emitter.sample_direction(interaction, mi.Point2f(0.5, 0.5))
            result.append((np.array(sample.d), np.array(weight)))
    return np.array([one for one, _ in result]), np.array([other for _, other in result])


def radiance_of_mitsuba(path, directions) -> np.ndarray:
    """Radiance of Mitsuba's environment in directions, (n, 3)."""
    with scalar_mitsuba() as mi:
        environment = mi.load_file(str(path), optimize=False).environment()
        result = []
        for direction in directions:
            interaction = mi.SurfaceInteraction3f()
            interaction.wi = mi.Vector3f(-direction)
            result.append(np.array(environment.eval(interaction)))
    return np.array(result)


def arriving(lamp, points) -> tuple[np.ndarray, np.ndarray]:
    """The same of a luminaire here."""
    way = points - lamp.position
    distance = np.linalg.norm(way, axis=1, keepdims=True)
    gamma = np.degrees(np.arccos(np.clip((way / distance) @ lamp.axes[2], -1, 1)))
    share = np.interp(gamma, lamp.web.gamma, lamp.web.intensity[0], left=0, right=0) / lamp.web.flux
    return -way / distance, share[:, None] * lamp.power / distance**2


@pytest.mark.parametrize(
    "emitter",
    [
        '<emitter type="point"><point name="position" x="0.1" y="0.2" z="1.5"/><rgb name="intensity" value="3,2,1"/></emitter>',
        f'<emitter type="point">{LOOK}<rgb name="intensity" value="2"/></emitter>',
        f'<emitter type="spot">{LOOK}<rgb name="intensity" value="5,4,3"/></emitter>',
        f'<emitter type="spot">{LOOK}<float name="cutoff_angle" value="40"/><float name="beam_width" value="5"/></emitter>',
    ],
    ids=["point", "point by to_world", "spot", "wide spot"],
)
def test_points_and_spots_send_what_mitsubas_send(load, tmp_path, random, emitter):
    (lamp,) = load(emitter).lights.luminaires
    points = np.column_stack([random.uniform(-1, 1, (60, 2)), np.zeros(60)])
    (towards, light), (found_towards, found) = seen_by_mitsuba(tmp_path / "scene.xml", points), arriving(lamp, points)
    assert found_towards == pytest.approx(towards, abs=1e-6)
    assert np.broadcast_to(found, light.shape) == pytest.approx(light, abs=1e-5)
    assert light.max() > 0.1
    assert not lamp.photometric


@pytest.mark.parametrize("way", ['<vector name="direction" x="1" y="2" z="-3"/>', LOOK], ids=["direction", "to_world"])
def test_directional_emitters_are_parallel_suns(load, tmp_path, way):
    (sun,) = load(f'<emitter type="directional">{way}<rgb name="irradiance" value="6"/></emitter>').lights.suns
    ((towards,), (light,)) = seen_by_mitsuba(tmp_path / "scene.xml", np.zeros((1, 3)))
    assert sun.direction == pytest.approx(towards, abs=1e-6)
    assert np.broadcast_to(sun.irradiance, 3) == pytest.approx(light)
    assert (sun.diameter, sun.photometric) == (0, False)


def test_a_constant_environment(load):
    """A floor alone under it: pi L."""
    scene = load('<emitter type="constant"><rgb name="radiance" value="2"/></emitter>')
    assert scene.unit == "W/m²"
    solution = rd.solve(rd.subdivide(scene, cells=1), rays=20_000, seed=1)
    assert solution.irradiance == pytest.approx(2 * np.pi, rel=0.02)


@pytest.mark.parametrize("turn", ["", TURN], ids=["y up", "turned"])
@pytest.mark.parametrize("height", [9, 16])
def test_an_image_of_the_surroundings(load, tmp_path, random, turn, height):
    """Between rows a sky is linear in the sine of the elevation and Mitsuba's image in the angle, so that fine tables agree."""
    rows, columns = np.mgrid[0:height, 0 : 2 * height]
    wave = [np.sin(rows / height * 3 + k) * 60 + np.cos(columns / height * np.pi + k) * 60 + 128 for k in range(3)]
    (tmp_path / "sky.png").write_bytes(png(np.stack(wave, axis=-1).astype(np.uint8)))
    image = f'<string name="filename" value="sky.png"/><float name="scale" value="3"/>{turn}'
    sky = load(f'<emitter type="envmap">{image}</emitter>').lights.sky
    directions = random.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    wanted = radiance_of_mitsuba(tmp_path / "scene.xml", directions)
    assert np.abs(sky.at(directions) - wanted).max() < (0.06 if height == 16 else 0.12) * wanted.max()
    assert sky.at(directions).mean(axis=0) == pytest.approx(wanted.mean(axis=0), rel=0.01)


def test_an_image_that_is_too_large_is_averaged_and_told(load, tmp_path, monkeypatch):
    monkeypatch.setattr("radiosity.scene.formats.mitsuba.environment.MOST", (4, 8))
    (tmp_path / "sky.png").write_bytes(png(np.full((8, 16, 3), 255)))
    with pytest.warns(rd.RadiosityWarning, match="16 x 8 pixels, is averaged in blocks of 2 x 2"):
        sky = load('<emitter type="envmap"><string name="filename" value="sky.png"/></emitter>').lights.sky
    assert sky.radiance == pytest.approx(1)


def test_radiation_that_is_alike_at_all_wavelengths_is_grey_in_grey_scenes(load, tmp_path):
    lamp = '<emitter type="point"><spectrum name="intensity" value="2"/></emitter>'
    assert load(lamp).lights.luminaires[0].power == pytest.approx([8 * np.pi])
    colored = load(lamp, reflectance="0.5,0.4,0.3").lights.luminaires[0]
    _, light = seen_by_mitsuba(tmp_path / "scene.xml", np.array([[0, 0, -1.0]]))
    assert colored.power == pytest.approx(4 * np.pi * light[0], rel=1e-3)


@pytest.mark.parametrize(
    ("emitter", "says"),
    [
        ('<emitter type="spot"><float name="cutoff_angle" value="0"/></emitter>', "cutoff_angle 0"),
        ('<emitter type="point"><rgb name="intensity" value="-1"/></emitter>', "must not be negative"),
        ('<emitter type="directional"><vector name="direction" x="0" y="0" z="0"/></emitter>', "is no direction"),
        ('<emitter type="constant"/><emitter type="constant" id="b"/>', "several environments, 'constant', 'b'"),
        ('<emitter type="envmap"><string name="filename" value="none.exr"/></emitter>', "none.exr"),
        ('<emitter type="envmap"/>', "no filename"),
    ],
)
def test_faults_are_one_error(load, emitter, says):
    with pytest.raises(rd.SceneError, match=r"scene\.xml") as error:
        load(emitter)
    assert says in str(error.value)


def test_textures_of_spots_are_told(load, tmp_path):
    (tmp_path / "slide.png").write_bytes(png(np.full((2, 2, 3), 255)))
    slide = '<texture type="bitmap" name="texture"><string name="filename" value="slide.png"/></texture>'
    with pytest.warns(rd.RadiosityWarning, match="textures of spots are left out: 'slide'"):
        load(f'<emitter type="spot" id="slide">{slide}</emitter>')
