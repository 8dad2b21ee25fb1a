"""Lights that are dimmed after the run: sums of groups, with errors, against lights that were dimmed before it."""

from dataclasses import replace

import numpy as np
import pytest
from light_samples import bulb, lit, overcast

import radiosity as rd
from radiosity.scene.shapes import quad
from radiosity.sensors.groups import parts_of
from radiosity.sensors.measure import scene_of

POINTS = rd.Sensors.of([[0, 0, 0.5], [2, 0, 0.5], [2, 1, 0]])


def hall(first: float = 1.0, second: float = 1.0, panel: float = 1.0) -> rd.Scene:
    """A grey floor, two luminaires of a group and one by itself, and a panel, dimmed before the run."""
    lamps = (
        bulb((0, 0, 2), first * 1000, name="a", group="row"),
        bulb((1, 0, 2), first * 1000, name="b", group="row"),
        bulb((2, 1, 2), second * 3000, name="row b"),
    )
    floor = ("floor", 0.5, 0.0, [quad((-3, -3, 0), (6, 0, 0), (0, 6, 0))])
    wall = ("wall", 0.5, 0.0, [quad((3, -3, 0), (0, 0, 3), (0, 6, 0))])
    return lit(floor, wall, ("panel", 0.0, panel * 200, [quad((-2, -2, 2.5), (0, 1, 0), (1, 0, 0))]), luminaires=lamps)


def cut(scene: rd.Scene) -> rd.Patches:
    return rd.subdivide(scene, cells=3)


@pytest.fixture(scope="module")
def grouped() -> rd.Measurement:
    return rd.measure(cut(hall()), POINTS, groups=True, rays=1_500_000)


def test_groups_are_those_of_luminaires_and_names(grouped):
    assert sorted(grouped.parts) == ["panel", "row", "row b"]
    assert np.allclose(sum(grouped.parts.values()), grouped.values)


@pytest.mark.parametrize("levels", [(1, 1, 1), (0.5, 0, 1), (0, 0.25, 0), (1, 2, 0.1)])
def test_a_dimming_is_that_of_the_lights(grouped, levels):
    """Within both runs' errors, at alpha 1e-4; the run before has other lines."""
    found = grouped.dimmed(dict(zip(("row", "row b", "panel"), levels, strict=True)))
    before = rd.measure(cut(hall(*levels)), POINTS, rays=500_000, seed=9)
    error = np.hypot(found.standard_error, before.standard_error)
    assert (error < 0.01 * before.illuminance).all()
    assert (np.abs(found.illuminance - before.illuminance) < 6 * error).all()


def test_levels_that_make_no_sense(grouped):
    for levels, words in (({"rows": 1}, "called 'rows'; there are .*'row'"), ({"row": -1}, "level of 'row' is -1")):
        with pytest.raises(rd.MethodError, match=words):
            grouped.dimmed(levels)
    plain = rd.measure(cut(hall()), POINTS, rays=100_000)
    with pytest.raises(rd.MethodError, match="groups=True"):
        plain.dimmed({"row": 0.5})


def test_groups_by_patterns_hold_every_light_once():
    """What no group names is in others; a luminaire is known by its name and by its group."""
    parts = parts_of(hall(), {"first": ["row"], "flat": ["pan*"]})
    held = {name: [one.name for one in scene_of(part).lights.luminaires] for name, part in parts.items()}
    assert held == {"first": ["a", "b"], "flat": [], "others": ["row b"]}
    assert [bool(part.emission.any()) for part in parts.values()] == [False, True, False]
    with pytest.raises(rd.SceneError, match="light 'a' is in the groups 'x', 'y'"):
        parts_of(hall(), {"x": ["a"], "y": ["row"]})
    with pytest.raises(rd.SceneError, match="group 'x': no light is called 'c'"):
        parts_of(hall(), {"x": ["c"]})


def test_a_name_like_another_group_is_no_member_of_it():
    """The luminaire 'row b' is in the group 'a', and another one called 'a' is in 'row': each counts once."""
    lamps = (bulb((0, 0, 2), name="a", group="row"), bulb((1, 0, 2), name="row", group="a"))
    parts = parts_of(lit(luminaires=lamps, sky=overcast(1.0)), {})
    assert {name: len(scene_of(part).lights.all) for name, part in parts.items()} == {"row": 1, "a": 1, "sky": 1}


def test_own_emission_of_patches_is_grouped():
    patches = cut(hall())
    values = patches.emission * np.linspace(1, 2, len(patches))[:, None]
    parts = parts_of(replace(patches, own_emission=values), {})
    assert np.array_equal(sum(part.emission for part in parts.values()), values)


def test_groups_of_a_solution():
    """Several cannot be told apart; a single one is all of its light. Where it is dimmed to 0 words say that it is dark."""
    solution = rd.solve(cut(hall()), "gather", rays=50_000)
    with pytest.raises(rd.MethodError, match=r"all groups together \('.*give the scene or its patches"):
        rd.measure(solution, POINTS, groups=True)
    lamp = rd.solve(cut(lit(luminaires=(bulb((0, 0, 2), name="lamp"),))), "gather", rays=10_000)
    points = rd.Sensors.of([[0, 0, 0.5], [1, 0, 0.5]])
    found = rd.measure(lamp, points, groups=True, rays=20_000)
    half = found.dimmed({"lamp": 0.5})
    np.testing.assert_allclose(half.values, found.values / 2)
    told = found.dimmed({"lamp": 0}).report()
    assert "no light reaches any sensor of 'sensors'" in told
    assert " nan" not in told


def test_uniformity_has_an_interval():
    """20 replicates of three sensors: what lies in the intervals of U0 and U1 are the ratios of the means that they were drawn
    about, in 95 % of 400 sets; at alpha 1e-4 between 90.5 % and 98.5 %."""
    rng, truth, held = np.random.Generator(np.random.Philox(7)), np.array([50.0, 80, 120]), np.zeros(2)
    found = rd.measure(cut(lit(luminaires=(bulb((0, 0, 2)),))), rd.Sensors.of(np.eye(3) - np.array([0, 0, 3.0])), rays=5_000)
    for _ in range(400):
        (row,) = replace(found, values=rng.normal(truth, 2.0, (20, 3))[..., None]).table()
        wanted = (50 / truth.mean(), 50 / 120)
        held += [abs(row[name] - exact) <= row[f"{name} ±"] for name, exact in zip(("U0", "U1"), wanted, strict=True)]
    assert ((held / 400 > 0.905) & (held / 400 < 0.985)).all()


def test_a_daylight_factor_is_of_the_sky_alone():
    """Whatever its level; a plane that sees the whole sky has 1."""
    scene = lit(luminaires=(bulb((0, 0, 2)),), sky=overcast(100.0))
    found = rd.measure(cut(scene), rd.Sensors.of([0, 0, 1.0]), groups=True, rays=200_000)
    with pytest.raises(rd.MethodError, match="of the sky's light alone"):
        _ = found.daylight_factor
    for level in (1.0, 0.5):
        assert found.dimmed({"bulb": 0, "sky": level}).daylight_factor[0] == pytest.approx(1, rel=0.01)
    with pytest.raises(rd.MethodError, match="of the sky's light alone"):
        _ = found.dimmed({"sky": 0}).daylight_factor


@pytest.mark.parametrize(("groups", "rays"), [(False, 20_001), (True, 20_000)])
def test_lines_that_parts_cannot_share_evenly(groups, rays):
    """Half of the lines go to the solution, and each of three groups takes a third."""
    found = rd.measure(cut(hall()), POINTS, groups=groups, rays=rays)
    assert found.status == "complete"
    assert (found.illuminance > 0).all()
