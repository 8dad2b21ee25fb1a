"""Luminaires in a face, or nearly: shadow rays do not find the spot that they light there, which is told; walks do."""

import warnings

import numpy as np
import pytest
from light_samples import bulb, lit

import radiosity as rd
from radiosity.diagnostics.lamps_at_faces import spots
from radiosity.scene.lights.web import Web
from radiosity.scene.shapes import box

ROOM = ("walls", 0.5, 0.0, box((0, 0, 0), (4, 4, 3), inward=True))


def cut(*luminaires) -> rd.Patches:
    return rd.subdivide(lit(ROOM, luminaires=luminaires), cells=2)


def received(patches: rd.Patches, method: str) -> float:
    """The lm that all walls of the room receive: 1000 / (1 - 0.5) where nothing is lost."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        solution = rd.solve(patches, method, rays=100_000)
    return float(solution.irradiance[:, 0] @ patches.area)


def test_a_globe_in_the_ceiling_goes_to_the_walk():
    patches = cut(bulb((2.3, 2.2, 3), power=1000.0))
    assert received(patches, "auto") == pytest.approx(2000, rel=0.01)
    assert received(patches, "gather") == pytest.approx(1000, rel=0.01)  # what the warning is about
    with pytest.warns(rd.RadiosityWarning, match=r"bulb at walls \(0 m\).*50 %.*random-walk"):
        rd.solve(patches, "gather", rays=20_000)
    told = rd.solve(patches, rays=20_000).provenance["auto"]
    assert told["chosen"] == "random-walk"
    assert "'bulb' is 0 m from 'walls', too near" in told["why"]


@pytest.mark.parametrize("disc", [False, True])
def test_a_soft_luminaire_through_a_wall_goes_to_the_walk(disc):
    """Its area of 1 m goes half through the wall: shadow rays between both hardly find the light of the last centimetres."""
    size, web = np.array([1.0, 1.0, 0]), Web(np.zeros(1), np.array([0.0, 90]), np.array([[1.0, 0]]))
    through, beside = (bulb((x, 2, 2.5), power=1000.0, size=size, soft=True, disc=disc, web=web) for x in (0.0, 0.6))
    (spot,) = spots(cut(through))
    assert (spot.surface, spot.distance) == ("walls", pytest.approx(0, abs=0.01))
    assert 0.005 < spot.share < 0.05
    assert spots(cut(beside)) == []
    assert spots(cut(bulb((2, 2, 3), power=1000.0, size=size, soft=True, disc=disc, web=web))) == []  # it shines down
    with pytest.warns(rd.RadiosityWarning, match=r"bulb at walls.*random-walk"):
        rd.solve(cut(through), "gather", rays=20_000)
    assert rd.solve(cut(through), rays=20_000).provenance["auto"]["chosen"] == "random-walk"


def test_others_are_not_concerned():
    """Far enough; behind the ceiling; shining down; and a faint one among bright ones."""
    down = rd.point_light(position=(2.3, 2.2, 3), lumens=1000, beam=40)
    faint, bright = bulb((2.3, 2.2, 3), power=1.0), bulb((2, 2, 2), power=1000.0)
    for luminaires in ([bulb((2.3, 2.2, 2.9))], [bulb((2.3, 2.2, 3.001))], [down], [faint, bright]):
        patches = cut(*luminaires)
        assert spots(patches) == []
    assert rd.solve(patches, rays=20_000).provenance["auto"]["chosen"] == "gather"
    (spot,) = spots(cut(faint))
    assert (spot.surface, spot.size) == ("walls", 2.0)
    assert spot.share == pytest.approx(0.5, abs=0.01)
