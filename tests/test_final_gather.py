"""Pictures with a final gather: closed forms, sensors at the points that are seen, shadows where boxes stand, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from image_samples import far_room
from light_samples import bulb, lit
from test_panes import two_rooms

import radiosity as rd
from radiosity.cli import main
from radiosity.image import export, render
from radiosity.image.denoise import denoised
from radiosity.image.edges import rough
from radiosity.image.picture import Picture, first_hits
from radiosity.image.view import directions
from radiosity.scene.paint import Paint
from radiosity.scene.sampler import Sampler
from radiosity.scene.shapes import box, join, quad
from radiosity.sensors.shares import PILOT, pooled

ABOVE = rd.Camera((0.1, 0.2, 2.5), (0.1, 0.2, 0), (0, 1, 0), 60.0, 9, 7)


def solved(scene, cells=1, rays=20_000, **options):
    return rd.solve(rd.subdivide(scene, cells=cells), method="gather", rays=rays, replicates=2, **options)


def values(solution, folder, **options):
    """Linear values of a picture, (height, width, n_bands)."""
    return render(solution, folder / "a.exr", **{"final_gather": 64, "samples": 1, **options}).astype(float)


def seen(scene, camera) -> np.ndarray:
    """The points that the middles of pixels see, (height, width, 3)."""
    x, y = (a.ravel() + 0.5 for a in np.meshgrid(np.arange(camera.width), np.arange(camera.height)))
    rays = directions(camera, x, y)
    origins = np.broadcast_to(camera.origin, rays.shape)
    return (origins + rays * first_hits(scene, origins, rays).distance[:, None]).reshape(camera.height, camera.width, 3)


def test_a_furnace_is_even(tmp_path):
    """All walls emit 1 and reflect rho: 1 / (1 - rho) everywhere, at edges too."""
    room = join([("walls", 0.6, 1.0, box((0, 0, 0), (2, 1, 3), inward=True))], source="furnace")
    camera = rd.Camera((0.2, 0.3, 0.4), (2, 0.9, 3), (0, 0, 1), 80.0, 12, 9)
    found = values(solved(room, 2, 200_000), tmp_path, camera=camera, final_gather=1024, samples=4)
    np.testing.assert_allclose(found, 2.5, rtol=0.03)
    assert abs(found.mean() - 2.5) < 0.01


def test_a_point_lamp_over_a_floor(tmp_path):
    """rho I cos / d^2, to single precision, in every quantity; the pebble is out of sight."""
    scene = lit(("floor", 0.5, 0.0, [quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))]), luminaires=(bulb((0, 0, 2), 400 * np.pi),))
    solution, points = solved(scene), seen(scene, ABOVE)
    irradiance = 100 * 2 / np.linalg.norm(points - [0, 0, 2], axis=-1) ** 3
    for quantity, factor in (("radiosity", 0.5), ("irradiance", 1.0), ("luminance", 0.5 / np.pi)):
        found = values(solution, tmp_path, camera=ABOVE, quantity=quantity)[..., 0]
        np.testing.assert_allclose(found, factor * irradiance, rtol=1e-4, err_msg=quantity)
    assert np.ptp(values(solution, tmp_path, camera=ABOVE, final_gather=None)) == 0  # the floor is one patch


def test_a_pixel_is_what_a_sensor_measures_there(tmp_path):
    """Light of a lamp and of walls, on floor and box. Each pixel and sensor has about 0.5 % of noise."""
    parts = [
        ("walls", 0.6, 0.0, box((-2, -2, 0), (2, 2, 3), inward=True)),
        ("box", 0.3, 0.0, box((-0.5, -0.5, 0), (0.5, 0.4, 0.7))),
        ("lamp", 0.0, 100.0, [quad((-0.5, -0.5, 2.99), (0, 1, 0), (1, 0, 0))]),
    ]
    scene = join(parts, source="room")
    camera = rd.Camera((1.5, 0.2, 1.5), (0.3, 0.1, 0.4), (0, 0, 1), 70.0, 6, 5)
    solution, points = solved(scene, 3, 200_000), seen(scene, camera).reshape(-1, 3)
    x, y = (a.ravel() + 0.5 for a in np.meshgrid(np.arange(6), np.arange(5)))
    hits = first_hits(scene, np.broadcast_to(camera.origin, points.shape), directions(camera, x, y))
    found = values(solution, tmp_path, camera=camera, final_gather=16384, quantity="irradiance")[..., 0].ravel()
    measured = rd.measure(solution, rd.Sensors.of(points, scene.normal[hits.face]), rays=16384 * len(points)).illuminance[:, 0]
    np.testing.assert_allclose(found, measured, rtol=0.05)
    assert np.sqrt(np.mean((found / measured - 1) ** 2)) < 0.015
    assert np.ptp(found) > found.mean() / 2


@pytest.fixture(scope="module")
def standing():
    """A box that stands on a floor, a lamp above it, patches of a metre."""
    lamp = quad((-0.5, -0.5, 3), (0, 1, 0), (1, 0, 0))
    parts = [("floor", 0.5, 0.0, [quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))]), ("lamp", 0.0, 100.0, [lamp])]
    return join([*parts, ("box", 0.0, 0.0, box((0.1, -0.6, 0), (0.9, 0.6, 1)))], source="standing")


def test_a_shadow_begins_at_the_box(tmp_path, standing):
    """Beside a black box all of the lamp is hidden; the picture of patches has the light of what is far away there."""
    scene = standing
    camera = rd.Camera((1.5, 0.01, 0.5), (0.93, 0.01, 0), (0, 1, 0), 2.0, 3, 3)
    solution, points = solved(scene, 4), seen(scene, camera).reshape(-1, 3)
    assert (points[:, 2] < 1e-6).all()
    assert (points[:, 0] > 0.9).all()
    assert (points[:, 0] < 0.96).all()
    assert ((0.9 - points[:, 0]) * 3 + points[:, 0] > 0.5).all()  # the box's upper edge hides all of the lamp
    found = values(solution, tmp_path, camera=camera, final_gather=64).ravel()
    patches = values(solution, tmp_path, camera=camera, final_gather=None).ravel()
    assert (found == 0).all()
    assert (patches > 0.5).all()


def test_images_are_seen_as_they_are(tmp_path):
    """Reflectance is that of the image at each point, where a picture of patches has the patch's mean."""
    image = np.linspace(0, 1, 16, dtype=np.float32).reshape(4, 4, 1)
    corners = np.broadcast_to(np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32), (2, 4, 2))
    paint = Paint((image,), np.array([-1, 0]), corners, np.ones((2, 4, 1), np.float32), 0.7, (Sampler(filter="nearest"),))
    floor = ("floor", 0.8, 0.0, [quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))])
    scene = replace(lit(floor, luminaires=(bulb((0, 0, 2), 400 * np.pi),)), reflectance_paint=paint)
    points = seen(scene, ABOVE)
    column, row = ((points[..., i] + 2).astype(int) for i in (0, 1))
    reflectance = np.minimum(0.8 * image[3 - row, column, 0], 0.7)
    found = values(solved(scene), tmp_path, camera=ABOVE)[..., 0]
    np.testing.assert_allclose(found, reflectance * 200 / np.linalg.norm(points - [0, 0, 2], axis=-1) ** 3, rtol=1e-4)
    assert len(np.unique(reflectance)) > 8


def test_panes_show_what_is_behind_them(tmp_path):
    """A closed furnace with E = 1 - rho - t: the walls behind a pane of t = 0.4 are seen as bright as those before it."""
    scene = two_rooms(0.5 - 0.15 * (np.arange(11) == 10))
    camera = rd.Camera((0.1, 0.4, 0.5), (2, 0.5, 0.5), (0, 0, 1), 80.0, 12, 9)
    found = values(solved(scene, 2, 200_000), tmp_path, camera=camera, final_gather=1024, samples=4)
    np.testing.assert_allclose(found, 1.0, rtol=0.05)
    assert abs(found.mean() - 1) < 0.01


def test_bands_and_false_colours(tmp_path):
    """A band is a column of all of them, and what false colours show is the luminance."""
    solution = solved(rd.load_scene("cornell-box"), 3, 50_000)
    every = values(solution, tmp_path, width=6)
    assert np.array_equal(values(solution, tmp_path, width=6, band="green"), every[..., 1:2])
    assert render(solution, width=6, final_gather=64, false_color=True).shape[0] >= 6


def test_scenes_far_away(tmp_path):
    """Metres of a map: the same picture as near the origin."""
    near, far = rd.load_scene("room"), far_room()
    found = []
    for scene in (near, far):
        corner = scene.bounds[0]
        camera = rd.Camera(tuple(np.add(corner, (0.3, 0.3, 1.9))), tuple(np.add(corner, (4, 2.6, 0.8))), (0, 0, 1), 60.0, 8, 6)
        found.append(values(solved(scene, 2, 50_000), tmp_path, camera=camera))
    np.testing.assert_allclose(*found, rtol=0.05)
    assert np.ptp(found[0]) > 0.1


def test_equal_seeds_give_equal_bits(standing):
    solution = solved(standing, 2)
    one, again, other = (render(solution, camera=ABOVE, final_gather=32, seed=seed) for seed in (3, 3, 4))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_a_short_pilot_takes_the_variances_of_neighbours_too():
    """Pilots of 2 lines take nine packets by their points, those of 4 five, and full ones, or nearly, each alone."""
    variance, sizes = np.random.default_rng(0).random((2, 40)), np.where(np.arange(40) == 39, 3, 16)
    for pilot, beside in ((2, 4), (4, 2), (9, 0), (PILOT, 0)):
        found = pooled(variance, sizes, pilot)
        for at in (0, 1, 20, 39):
            there = slice(max(at - beside, 0), at + beside + 1)
            np.testing.assert_allclose(found[:, at], np.average(variance[:, there], axis=1, weights=sizes[there]), rtol=1e-12)
    assert pooled(variance[:, :2], sizes[:2], 2) == pytest.approx(np.repeat(variance[:, :2].mean(axis=1), 2).reshape(2, 2))


def test_pieces_have_numbers_of_their_own(monkeypatch, standing, tmp_path):
    """The same point twice, in two pieces: other noise, the same light within it."""
    from radiosity.sensors import pixels

    gather = pixels.Gather.of(solved(standing, 2), 64.0, 2)
    floor = np.zeros(1, int), np.full(1, 0.1), np.full(1, 0.1)
    whole = gather.irradiance(*floor), gather.irradiance(*floor)
    assert whole[0] != whole[1]
    np.testing.assert_allclose(*whole, rtol=0.3)
    monkeypatch.setattr(pixels, "PIECE", 7)
    pieces = [values(solved(standing, 2), tmp_path, camera=ABOVE, seed=seed) for seed in (1, 1)]
    assert np.array_equal(*pieces)


def test_backs_have_light_of_their_own(tmp_path):
    """A lamp over a floor that radiates on both sides: nothing arrives below."""
    floor = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))
    scene = join(
        [("floor", 0.5, 0.0, [floor]), ("lamp", 0.0, 100.0, [quad((-0.5, -0.5, 3), (0, 1, 0), (1, 0, 0))])],
        source="sheet",
        backs={"floor": 0.5},
    )
    below = replace(ABOVE, origin=(0.1, 0.2, -2.5))
    solution = solved(scene, 2)
    assert (values(solution, tmp_path, camera=below, quantity="irradiance") == 0).all()
    assert (values(solution, tmp_path, camera=ABOVE, quantity="irradiance") > 1).all()


def test_noise_is_filtered_and_edges_are_kept():
    """Two even planes of noise beside each other: each keeps its mean, and 0.05 of noise becomes a third or less."""
    noise = 0.05 * np.random.default_rng(1).standard_normal((24, 24, 1))
    flat = np.repeat([[0, 1]], 12, axis=1).repeat(24, axis=0)
    flat[:, 11] = -1  # an edge, half of each
    true = np.where(flat == 0, 1.0, np.where(flat == 1, 1.1, 1.05))[..., None]
    every = np.ones((24, 24))
    picture = Picture(true + noise, every, every < 0, np.full(noise.shape, 0.05**2), flat, ABOVE)
    found = denoised(picture)
    assert np.array_equal(found[:, 11], picture.values[:, 11])
    for plane in (0, 1):
        left = (found - true)[flat == plane]
        assert left.std() < 0.05 / 3
        assert abs(left.mean()) < 0.005
    exact = replace(picture, values=true + np.eye(24)[..., None], variance=np.zeros(noise.shape))
    np.testing.assert_allclose(denoised(exact), exact.values, atol=1e-6)  # without noise there is nothing to filter


def test_denoised_pictures_are_nearer_to_the_truth(tmp_path, standing):
    solution = solved(standing, 4)
    camera = rd.Camera((0.1, 3, 2.5), (0.1, 0.2, 0), (0, 0, 1), 60.0, 40, 30)
    truth = values(solution, tmp_path, camera=camera, final_gather=4096, samples=4)
    plain, clean = (
        np.sqrt(np.square(values(solution, tmp_path, camera=camera, final_gather=32, samples=4, denoise=on) - truth).mean())
        for on in (False, True)
    )
    assert clean < 0.8 * plain


def test_rims_of_lamps_are_sampled_more(tmp_path, monkeypatch):
    """Turned rims of a lamp 300 times as bright as the floor: with more lines of sight the error of the pixels on them falls."""
    lamp, floor = quad((0.3, 0.1, 1), (0.43, 0.04, 0), (-0.04, 0.43, 0)), quad((-1, -1, 0), (3, 0, 0), (0, 3, 0))
    scene = join([("floor", 0.5, 1.0, [floor]), ("lamp", 0.0, 300.0, [lamp])], source="rims")
    camera = rd.Camera((0.5, 0.5, 3.0), (0.5, 0.5, 0.0), (0, 1, 0), 40.0, 24, 24)
    solution = solved(scene, rays=2_000)

    def picture(samples: int) -> np.ndarray:
        return render(solution, tmp_path / "a.exr", camera=camera, samples=samples, final_gather=4 * samples)[..., 0]

    truth, better = picture(128), picture(4)
    monkeypatch.setattr("radiosity.image.picture.AT_EDGES", 0)
    plain = picture(4)
    rims = (truth > 10) & (truth < 290)
    assert rims.sum() > 20
    assert np.sqrt(np.mean((better - truth)[rims] ** 2)) < 0.4 * np.sqrt(np.mean((plain - truth)[rims] ** 2))
    assert (better == plain)[:3].all()  # far from all rims nothing changes


def test_rough_pixels_are_those_on_edges_and_beside_them():
    variance, flat, level = np.zeros(49), np.zeros(49, int), np.ones(49)
    variance[[0, 24]], flat[24] = 4.0, -1  # the first is noise within a plane
    assert rough(variance, flat, level, 7).tolist() == [16, 17, 18, 23, 24, 25, 30, 31, 32]
    assert not len(rough(variance, flat, 100 * level, 7))
    assert not len(rough(variance, flat, 0 * level, 7))


def test_progress_is_told(standing):
    told = []
    render(solved(standing), camera=ABOVE, final_gather=64, progress=told.append)
    assert told[-1].message == "gathering"
    assert 0.3 < told[-1].fraction <= 1


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"final_gather": 15}, "final_gather is 15; it must be a whole number of lines a pixel, from 16 "),
        ({"final_gather": 99.5}, "final_gather is 99.5"),
        ({"final_gather": True}, "final_gather is True"),
        ({"denoise": True, "final_gather": None}, "denoise is of a final gather"),
        ({"denoise": True, "samples": 1}, "denoise is of a final gather with 2 samples"),
        ({"quantity": "standard_error"}, "a final gather finds radiosity, irradiance, luminance, radiance, not 'standard_error'"),
    ],
)
def test_refusals(standing, options, message):
    with pytest.raises(rd.OutputError, match=message):
        render(solved(standing, rays=2000), camera=ABOVE, **{"final_gather": 64, **options})


def test_meshes_have_no_final_gather(standing, tmp_path):
    with pytest.raises(rd.OutputError, match="a final gather is of pictures"):
        export(solved(standing, rays=2000), tmp_path / "a.glb", final_gather=64)


def test_the_command(tmp_path, standing):
    solved(standing, rays=2000).save(tmp_path / "a.npz")
    options = [tmp_path / "a.npz", "-o", tmp_path / "a.png", "--width", 8, "--height", 6, "--final-gather", 32, "--seed", 5]
    assert main([str(word) for word in ("render", *options)]) == 0
    from PIL import Image

    with Image.open(tmp_path / "a.png") as picture:
        assert (picture.text["final gather"], picture.text["seed"]) == ("32 lines a pixel", "5")
        shown = np.asarray(picture)
    wanted = render(rd.load_solution(tmp_path / "a.npz"), width=8, height=6, final_gather=32, seed=5)
    assert np.array_equal(shown, wanted)


def test_a_seed_without_a_gather_is_refused(tmp_path, standing, capsys):
    solved(standing, rays=2000).save(tmp_path / "a.npz")
    assert main([str(word) for word in ("render", tmp_path / "a.npz", "-o", tmp_path / "a.png", "--seed", 5)]) == 2
    assert "--seed 5 is that of a final gather: give --final-gather N" in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "a.png").exists()
