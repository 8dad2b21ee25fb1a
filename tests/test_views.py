"""Plans, orthographic views, panoramas, and tone curves: where points appear, what is cut off, and what colours become."""

from dataclasses import replace

import numpy as np
import pytest
from image_samples import plain_hits, solution
from light_samples import bulb, lit
from PIL import Image

import radiosity as rd
from radiosity.cli import main
from radiosity.image import curves, export, render, tone
from radiosity.image.projections import lines_of_sight
from radiosity.scene.shapes import box, join, quad


def tiles():
    """A floor of 4 m x 2 m in 4 x 2 unit tiles of radiosity 1 to 8, below a ceiling of 100; z is up."""
    floor = [quad((x, y, 0), (1, 0, 0), (0, 1, 0)) for y in range(2) for x in range(4)]
    ceiling = quad((0, 0, 3), (0, 2, 0), (4, 0, 0))
    scene = join([("floor", 0.5, 0.0, floor), ("ceiling", 0.5, 1.0, [ceiling])], source="tiles.obj")
    patches = rd.subdivide(replace(scene, cameras=(rd.Camera((2, 1, 1), (2, 2, 1)),)), cells=1)
    return solution(patches, np.append(np.arange(1.0, 9.0), 100.0)[:, None])


def size_of(path):
    with Image.open(path) as picture:
        return picture.size


def shown(one, view, tmp_path, **options):
    return render(one, tmp_path / "a.exr", camera=view, hits=plain_hits, smooth=False, samples=1, **options)[..., 0]


def test_a_plan_shows_the_scene_to_scale_from_above(tmp_path):
    """North is up, east right; the ceiling above the cut is not seen. A margin of 2 % on each side."""
    one = tiles()
    view = rd.plan(one.patches.scene, cut=2.0, width=104)
    assert (view.width, view.height) == (104, 52)
    found = shown(one, view, tmp_path)
    assert [[found[38, 2 + 25 * k + 12] for k in range(4)], [found[13, 2 + 25 * k + 12] for k in range(4)]] == [
        [1, 2, 3, 4],
        [5, 6, 7, 8],
    ]
    assert (found[:, 0] == 0).all()
    assert (found[:, 3] > 0).sum() == 50  # two metres at 25 pixels each
    with pytest.warns(rd.RadiosityWarning, match="picture is empty"):  # the ceiling's back
        assert (shown(one, rd.plan(one.patches.scene, width=40), tmp_path) == 0).all()


def test_an_elevation_has_no_perspective(tmp_path):
    """Seen from below, the ceiling is as large as it is from anywhere."""
    one = tiles()
    sizes = []
    for z in (0.5, 2.5):
        view = rd.Orthographic((2, 1, z), (2, 1, 5), (0, 1, 0), size=4.0, width=80, height=40)
        sizes.append((shown(one, view, tmp_path) == 100).sum())
    assert sizes == [800, 800]


def test_a_panorama_looks_all_around():
    view = rd.Panorama((1, 2, 3), (2, 2, 3), width=360, height=180)
    x, y = np.array([180.0, 270, 90, 0, 180, 180]), np.array([90.0, 90, 90, 90, 45, 180])
    origins, rays = lines_of_sight(view, x, y)
    half = np.sqrt(0.5)
    np.testing.assert_allclose(rays, [[1, 0, 0], [0, -1, 0], [0, 1, 0], [-1, 0, 0], [half, 0, half], [0, 0, -1]], atol=1e-12)
    assert (origins == [1, 2, 3]).all()


def test_pinhole_lines_are_as_they_were():
    camera = rd.Camera((0, 0, 1), (0, 5, 1), fov=90.0, width=4, height=4)
    _, rays = lines_of_sight(camera, np.array([2.0, 4.0]), np.array([2.0, 2.0]))
    np.testing.assert_allclose(rays, [[0, 1, 0], [np.sqrt(0.5), np.sqrt(0.5), 0]], atol=1e-12)


def test_a_plan_takes_a_final_gather(tmp_path):
    """A point lamp over a floor: rho I cos / d² at the points of the plan."""
    scene = lit(("floor", 0.5, 0.0, [quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))]), luminaires=(bulb((0, 0, 2), 400 * np.pi),))
    one = rd.solve(rd.subdivide(scene, cells=1), method="gather", rays=5_000, replicates=2)
    view = rd.Orthographic((0, 0, 1), (0, 0, 0), (0, 1, 0), size=2.0, width=5, height=4)
    found = render(one, tmp_path / "a.exr", camera=view, final_gather=16, samples=1)[..., 0]
    x, y = np.meshgrid((np.arange(5) - 2) * 0.5, (1.5 - np.arange(4)) * 0.5)
    np.testing.assert_allclose(found, 0.5 * 200 / np.sqrt(x**2 + y**2 + 4) ** 3, rtol=1e-4)


@pytest.mark.parametrize("name", list(curves.CURVES))
def test_curves_lead_from_black_to_white_and_keep_grey(name):
    """They rise without end; middle grey keeps its tone within a tenth, and greys stay grey."""
    light = np.repeat(np.append(0, np.geomspace(1e-4, 16, 200))[:, None], 3, axis=1)
    found = curves.CURVES[name](light)
    assert (np.diff(found, axis=0) >= 0).all()
    assert np.ptp(found, axis=1).max() < 1e-12
    assert found[0] == pytest.approx(0, abs=1e-3)
    assert found[-1] == pytest.approx(1, abs=0.02)
    grey = curves.CURVES[name](np.full((1, 3), 0.18))[0, 0]
    assert grey == pytest.approx(tone.srgb(np.array(0.18)), rel=0.1)


def test_rolled_off_light_keeps_a_shape():
    """Twice the light that clips is brighter than that light, by both curves, and bright colours become paler by agx."""
    for name in ("filmic", "agx"):
        one, two = curves.CURVES[name](np.array([[1.0] * 3, [2.0] * 3]))[:, 0]
        assert one < two - 0.02
    red = curves.agx(np.array([[2.0, 0.1, 0.1]]))[0]
    assert red[1] > curves.agx(np.array([[0.1, 0.1, 0.1]]))[0, 1] + 0.1


def test_files_are_denoised_and_toned(tmp_path):
    one = rd.solve(rd.subdivide(rd.load_scene("cornell-box"), cells=2), method="gather", rays=20_000, replicates=2)
    one = replace(one, patches=replace(one.patches, scene=replace(one.patches.scene, cameras=(SMALL,))))
    for k, options in enumerate(({"denoise": False}, {"denoise": True}, {"denoise": True, "tone_map": "agx"})):
        export(one, tmp_path / f"{k}.png", final_gather=32, **options)
    pictures = []
    for k in range(3):
        with Image.open(tmp_path / f"{k}.png") as picture:
            pictures.append(np.asarray(picture).astype(int))
    assert np.abs(pictures[0] - pictures[1]).max() > 3
    assert np.abs(pictures[1] - pictures[2]).max() > 3
    with pytest.raises(rd.OutputError, match="denoise and tone_map are of pictures"):
        export(one, tmp_path / "a.glb", tone_map="agx")


SMALL = rd.Camera((0.278, 0.273, -0.8), (0.278, 0.273, 0), (0, 1, 0), 39.3, 24, 24)


def test_the_commands(tmp_path, capsys):
    room = join([("walls", 0.5, 1.0, box((0, 0, 0), (4, 2, 3), inward=True))], source="room.obj")
    rd.solve(rd.subdivide(room, cells=1), method="gather", rays=5_000, replicates=2).save(tmp_path / "a.npz")

    def run(*options):
        return main(["render", str(tmp_path / "a.npz"), "-o", str(tmp_path / "a.png"), *options]), capsys.readouterr().err

    assert run("--plan", "150cm", "--width", "40")[0] == 0
    assert size_of(tmp_path / "a.png") == (40, 30)  # y is up
    assert run("--panorama", "--origin", "1,1,1", "--target", "2,1,1", "--width", "40", "--tone-map", "filmic")[0] == 0
    assert size_of(tmp_path / "a.png") == (40, 20)
    assert run("--width", "40")[0] == 0
    assert size_of(tmp_path / "a.png") == (40, 30)  # a fitted camera keeps its proportions
    for options, message in (
        (("--plan", "-3"), "the plan's cut is at -3.0 m; the scene begins at 0 m and ends at 2 m"),
        (("--plan", "high"), "'high' is no height"),
        (("--plan", "1", "--fov", "30"), "--plan chooses its own view"),
        (("--panorama",), "--panorama needs --origin and --target"),
        (("--tone-map", "agx", "--false-color"), "tone_map is of PNG pictures without false colours"),
    ):
        status, said = run(*options)
        assert status == 2
        assert message in said


@pytest.mark.parametrize("size", [0.0, -1.0, np.nan, np.inf])
def test_a_view_without_a_size_is_refused(size):
    view = rd.Orthographic((2, 1, 2), (2, 1, 0), (0, 1, 0), size=size)
    with pytest.raises(rd.SceneError, match="the size is"):
        render(tiles(), camera=view, hits=plain_hits)
