"""The unified glare rating against its formula by hand, a surface against a luminaire that sends the same, and refusals."""

from dataclasses import replace

import numpy as np
import pytest
from light_samples import DOWN, overcast

import radiosity as rd
from radiosity.scene.lights.luminaire import Luminaire
from radiosity.scene.lights.model import Lights
from radiosity.scene.lights.web import Web
from radiosity.scene.shapes import box, join, quad
from radiosity.sensors.glare_sources import solid_angle
from radiosity.sensors.guth import position_index

GAMMA = np.arange(0.0, 91.0)
LAMBERT = Web(np.zeros(1), GAMMA, np.cos(np.radians(GAMMA))[None])
EYE, GAZE = np.array([0.5, 2, 1.2]), np.array([1.0, 0, 0])
SIDE, POWER, PLACE = 0.4, 2000.0, np.array([4.0, 2.5, 2.99])


def lamp(**more) -> Luminaire:
    size = more.pop("size", np.array([SIDE, SIDE, 0]))
    return Luminaire("panel", PLACE, DOWN, LAMBERT, np.array([POWER]), size, **more)


def hall(*lamps: Luminaire, parts=(), **more) -> rd.Patches:
    walls = [("walls", 0.5, 0.0, box((0, 0, 0), (6, 4, 3), inward=True)), *parts]
    scene = replace(join(walls, source="hall"), photometric=True, lights=Lights(luminaires=lamps, **more))
    return rd.subdivide(scene, cells=6)


@pytest.fixture(scope="module")
def rated() -> tuple[rd.Solution, rd.GlareRating]:
    solution = rd.solve(hall(lamp()), "gather", rays=400_000, replicates=8)
    return solution, rd.unified_glare_rating(solution, EYE, GAZE, error=0.005)


def test_one_luminaire_by_hand(rated):
    _, found = rated
    way = PLACE - EYE
    square = way @ way
    intensity = POWER / np.pi * way[2] / np.sqrt(square)
    area = SIDE**2 * way[2] / np.sqrt(square)
    index = np.exp(_guth(np.degrees(np.arctan2(0.5, 1.79)), np.degrees(np.arctan2(np.hypot(0.5, 1.79), 3.5))))
    background = found.background.mean()
    wanted = 8 * np.log10(0.25 / background * (intensity / area) ** 2 * (area / square) / index**2)
    assert found.ugr[0] == pytest.approx(wanted, abs=0.02)
    row = found.sources[0][0]
    assert row["luminance"] == pytest.approx(POWER / np.pi / SIDE**2, rel=1e-3)
    assert row["position index"] == pytest.approx(index, rel=1e-6)
    assert f"UGR {wanted:.1f}" in found.report()


def _guth(tau: float, sigma: float) -> float:
    first = 35.2 - 0.31889 * tau - 1.22 * np.exp(-2 * tau / 9)
    return first * sigma / 1000 + (21 + 0.26667 * tau - 0.002963 * tau * tau) * sigma * sigma / 100_000


def test_the_background_is_what_surfaces_reflect(rated):
    """All light on the eye's plane, less what comes straight from the luminaire."""
    solution, found = rated
    way = PLACE - EYE
    square = way @ way
    straight = POWER / np.pi * way[2] / np.sqrt(square) * (way @ GAZE) / np.sqrt(square) / square
    everything = rd.measure(solution, rd.Sensors.of(EYE, GAZE), rays=400_000)
    assert np.pi * found.background.mean() == pytest.approx(everything.illuminance[0, 0] - straight, rel=0.01)


def test_a_surface_that_sends_the_same_is_rated_the_same(rated):
    panel = quad(PLACE - [SIDE / 2, SIDE / 2, 0], (0, SIDE, 0), (SIDE, 0, 0))
    surface = hall(parts=[("panel", 0.0, POWER / SIDE**2, [panel])])
    found = rd.unified_glare_rating(surface, [EYE, EYE], [GAZE, -GAZE], rays=1_000_000)
    assert found.ugr[0] == pytest.approx(rated[1].ugr[0], abs=0.15)
    assert found.ugr[1] == -np.inf  # behind the observer
    assert found.sources[1] == ()
    assert "no source in view" in found.report()


def test_what_hides_a_luminaire_counts(rated):
    """A screen before half of it, then before all of it."""
    half, every = (
        hall(lamp(), parts=[("screen", 0.5, 0.0, [quad((3.7, low, 2.6), (0, 0, 0.38), (0, 2, 0))])]) for low in (2.5, 2.2)
    )
    found, hidden = (rd.unified_glare_rating(scene, EYE, GAZE, rays=300_000) for scene in (half, every))
    assert found.sources[0][0]["solid angle"] == pytest.approx(rated[1].sources[0][0]["solid angle"] / 2, rel=0.3)
    assert hidden.sources[0] == ()


def test_position_indices():
    """On the line of sight 1; CIE 117's table has 2.86 at H/R = 0.5; below the line 1 + 0.8 R/D, from 0.6 on 1 + 1.2 R/D."""
    way = np.array([[1, 0, 0], [2, 0, 1], [1, 0, -0.5], [1, 1, -1e-9], [-1, 0, 0]], float)
    index = position_index(way, np.array([1.0, 0, 0]), np.array([0, 0, 1.0]))
    assert index[:3] == pytest.approx([1, 2.86, 1.4], abs=0.005)
    assert index[3] == pytest.approx(2.2)
    assert index[4] == np.inf


def test_solid_angles():
    """A side of a cube seen from the middle is a sixth of the sphere; a corner's square is an octant's third."""
    side = quad((-1, -1, 1), (2, 0, 0), (0, 2, 0))
    octant = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 1]], float)
    assert solid_angle(np.stack([side, octant])) == pytest.approx([4 * np.pi / 6, np.pi / 2])


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        (lambda: hall(lamp(size=np.zeros(3))), "panel.* have no luminous size"),
        (lambda: hall(lamp(), sky=overcast(1.0)), "leave the sun and the sky out"),
        (lambda: rd.load_scene("room"), "the scene is in W"),
    ],
)
def test_scenes_without_a_rating(scene, words):
    with pytest.raises(rd.MethodError, match=words):
        rd.unified_glare_rating(scene(), EYE, GAZE)


def test_a_gaze_straight_up_is_refused():
    with pytest.raises(rd.MethodError, match="observer 1 looks straight up or down"):
        rd.unified_glare_rating(hall(lamp()), [EYE, EYE], [GAZE, [0, 0, 2.0]])
