"""Diffusing panes and light without area: opal covers, windows under a sky, sunlit sheets, sensors and pictures behind them."""

from dataclasses import replace

import numpy as np
import pytest
from test_diffusers import TAU, means, two_boxes

import radiosity as rd
from radiosity.factors.polygons import from_points
from radiosity.image import render
from radiosity.scene.shapes import box, quad

PANE = quad((1, 0, 1), (0, 0, 1), (2, 0, 0))  # looks inward, as y grows
VERTICAL = 0.396171  # of the horizontal irradiance of CIE's overcast sky: 3 / 7 (1 / 2 + 4 / (3 pi)) on a vertical plane


def opal(tau=0.5, rho=0.2) -> rd.Scene:
    """A black box of 1 m whose bottom is an opal cover, a lamp of 600 lm in its middle, and a black floor 2 m below."""
    faces = [*box((0, 0, 0), (1, 1, 1), inward=True), quad((-3, -3, -2), (7, 0, 0), (0, 7, 0))]
    cover = np.array([not face[:, 2].any() for face in faces])
    scene = rd.Scene.from_arrays(
        np.concatenate(faces),
        np.arange(28).reshape(7, 4),
        rho * cover,
        0.0,
        surface=np.where(cover, 1, np.arange(7) // 6 * 2),
        names=["housing", "cover", "floor"],
        two_sided=cover,
        diffuse_transmittance=tau * cover,
        photometric=True,
    )
    return scene.with_lights([rd.point_light(position=(0.5, 0.5, 0.5), lumens=600)])


@pytest.mark.parametrize("method", ["random-walk", "gather"])
def test_an_opal_cover_sends_on_what_the_lamp_brings(method):
    """A sixth of 600 lm falls on it. A sensor below sees what each point of the cover then sends."""
    patches = rd.subdivide(opal(), cells=8)
    solution = rd.solve(patches, method, rays=200_000, replicates=8)
    below = (patches.surface == 1) & (patches.normal[:, 2] < 0)
    assert patches.area[below] @ solution.radiosity[below, 0] == pytest.approx(50, rel=0.005)
    found = rd.measure(solution, rd.Sensors.of([[0.5, 0.5, -1.5]], [0, 0, 1]), rays=60_000)
    x, y = (np.stack(np.meshgrid(*[(np.arange(100) + 0.5) / 100 - 0.5] * 2)) ** 2).reshape(2, -1)
    exitance = 0.5 * 600 / (4 * np.pi) * 0.5 / (x + y + 0.25) ** 1.5
    wanted = (exitance / np.pi * 1.5**2 / (x + y + 1.5**2) ** 2).mean()
    assert abs(found.illuminance[0, 0] - wanted) < 4 * found.standard_error[0, 0] + 1e-3 * wanted
    assert found.standard_error[0, 0] < 0.01 * wanted


@pytest.mark.parametrize("openings", [None, [PANE]])
def test_a_window_of_opal_glass_under_an_overcast_sky(openings):
    """The outside of the pane has 0.396 of the horizontal irradiance; the room is black."""
    walls = [face for face in box((0, 0, 0), (4, 5, 3), inward=True) if face[:, 1].any()]
    for x, z, size in (((0, 1), 0, 3), ((3, 4), 0, 3), ((1, 3), 0, 1), ((1, 3), 2, 1)):
        walls.append(quad((x[0], 0, z), (0, 0, size), (x[1] - x[0], 0, 0)))
    faces = [*walls, PANE]
    is_pane = np.arange(len(faces)) == len(walls)
    scene = rd.Scene.from_arrays(
        np.concatenate(faces),
        np.arange(4 * len(faces)).reshape(-1, 4),
        0.0,
        0.0,
        surface=is_pane.astype(int),
        names=["room", "pane"],
        two_sided=is_pane,
        diffuse_transmittance=0.5 * is_pane,
        photometric=True,
    ).with_lights(sky=rd.cie_sky("overcast", 10_000), openings=openings)
    patches, wanted = rd.subdivide(scene, cells=2), 0.5 * VERTICAL * 10_000
    inside = (patches.surface == 1) & ~patches.is_back
    if openings:
        walked = rd.solve(patches, "random-walk", rays=30_000, replicates=8)
        assert abs(walked.radiosity[inside, 0].mean() - wanted) < 4 * walked.standard_error[inside, 0].mean() < 0.1 * wanted
        return
    solution = rd.solve(patches, "gather", rays=50_000, replicates=8)
    assert solution.radiosity[inside, 0] == pytest.approx(wanted, rel=5e-3)
    point, normal = np.array([[2, 4, 0.85]]), np.array([[0.0, 0, 1]])
    found = rd.measure(solution, rd.Sensors.of(point, normal[0]), rays=100_000)
    wanted *= np.ravel(from_points(point, normal, PANE[None]))[0]
    assert abs(found.illuminance[0, 0] - wanted) < 4 * found.standard_error[0, 0] < 0.1 * wanted


def test_the_sun_strikes_one_side_and_leaves_the_other():
    """1000 lux across the light at 30 degrees from a sheet's normal."""
    sheet = rd.Scene.from_arrays(
        quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), [[0, 1, 2, 3]], 0.3, 0.0, two_sided=True, diffuse_transmittance=0.4
    )
    scene = replace(sheet, photometric=True).with_lights(suns=[rd.sun(1000, altitude=60, azimuth=180)])
    for method in ("random-walk", "gather"):
        solution = rd.solve(rd.subdivide(scene, cells=1), method, rays=20_000, replicates=4)
        lux = 1000 * np.sin(np.radians(60))
        np.testing.assert_allclose(solution.radiosity[:, 0], [0.3 * lux, 0.4 * lux], rtol=0.01)
        np.testing.assert_allclose(solution.irradiance[:, 0], [lux, 0], rtol=0.01, atol=1e-9)


def test_a_picture_with_a_final_gather_shows_the_light_behind(tmp_path):
    """The far side of a sheet before black walls of exitance 3; the box in front of it is dark."""
    scene = two_boxes((3.0, 0.0), (0.0, 0.0))
    solution = rd.solve(rd.subdivide(scene, cells=1), "gather", rays=20_000, replicates=2)
    assert means(solution, solution.radiosity)[3, 0] == pytest.approx(3 * TAU, rel=0.01)
    camera = rd.Camera((1.9, 0.5, 0.5), (1, 0.5, 0.5), (0, 0, 1), 40.0, 4, 3)
    for gather in (None, 1024):
        found = render(solution, tmp_path / "a.exr", camera=camera, final_gather=gather, samples=1).astype(float)
        assert found.mean() == pytest.approx(3 * TAU, rel=0.02)


def test_glare_does_not_take_covers_for_background():
    with pytest.raises(rd.MethodError, match=r"cover.*diffuse_transmittance"):
        rd.unified_glare_rating(opal(), [0.5, -2, -1], [0, 1, 0], rays=1_000)
