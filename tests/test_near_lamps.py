"""Lamps just below a ceiling: their upper sides light what they cover, and meshes that are cut along them hold that light."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli.app import run as command
from radiosity.diagnostics.near_lamps import near_lamps
from radiosity.patches.contact import cut_at_contacts
from radiosity.patches.contact.lines import Boxes, ContactLines, contact_lines, faces_beside
from radiosity.scene.box_pairs import box_pairs

GAP, RHO = 1e-3, 0.5


def ceiling_and_lamp(gap=GAP, two_sided=True, triangles=False, turn=0.0, side=1.0) -> rd.Scene:
    """A ceiling of 4 x 4 m, which nothing closes, and a black square lamp below it, which emits 1 W/m² a side."""
    ceiling = np.array([[-2, -2, 0], [-2, 2, 0], [2, 2, 0], [2, -2, 0]], float)
    c, s = np.cos(turn), np.sin(turn)
    lamp = side / 4 * ceiling @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + (0.13, 0.21, -gap)
    quads = [[0, 1, 2, 3], *([[4, 5, 6, -1], [4, 6, 7, -1]] if triangles else [[4, 5, 6, 7]])]
    rest = len(quads) - 1
    return rd.Scene.from_arrays(
        np.concatenate([ceiling, lamp]),
        quads,
        [RHO, *[0.0] * rest],
        [0.0, *[1.0] * rest],
        surface=[0, *[1] * rest],
        names=["ceiling", "lamp"],
        two_sided=two_sided,
    )


def seen(gap: float) -> float:
    """The form factor of two equal squares of side 1 across a gap."""
    x, y = 1 / gap, np.sqrt(1 + 1 / gap**2)
    return float(
        2 / (np.pi * x**2) * (np.log(y**2 / np.sqrt(1 + 2 * x**2)) + 2 * x * y * np.arctan(x / y) - 2 * x * np.arctan(x))
    )


def leaks(patches: rd.Patches) -> float:
    """What the ceiling gives back to elsewhere than the lamp, of what the lamp sends up."""
    solution = rd.solve(patches, "random-walk", rays=200_000, seed=1)
    ceiling = patches.surface == 0
    power = solution.irradiance[:, 0] * patches.area
    return float(RHO * power[ceiling].sum() - (power[~ceiling].sum()))


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_a_mesh_cut_along_a_lamp_holds_its_light(turn):
    """The ceiling receives all light that goes up. What it gives back meets the lamp, but for 2 (1 - F) of it at most: that which
    leaves through the gap before and after."""
    scene = ceiling_and_lamp(turn=turn)
    even, cut = rd.subdivide(scene, cells=8), rd.subdivide(cut_at_contacts(scene, 100, 50), about=100)
    exact = 2 * RHO * (1 - seen(GAP))
    with pytest.warns(rd.RadiosityWarning, match=r"'lamp at ceiling': lamps shine on a face near them \(0.001 m\).*--contacts"):
        assert leaks(even) > 0.1
    assert 0 <= leaks(cut) < exact + 1e-3
    assert exact < 3e-3


def lines_of_first(scene: rd.Scene, size: float) -> ContactLines:
    """The contact lines of the first face, with patches of a size."""
    boxes = Boxes.of(scene)
    (others,) = faces_beside(boxes, np.array([0]), np.array([size]))
    return contact_lines(scene, boxes, 0, others, size)


def test_lines_are_those_of_outlines_that_are_near():
    """The diagonal of a lamp of two triangles is none. Farther lamps and sides that do not radiate have none."""
    for scene, expected in (
        (ceiling_and_lamp(), 4),
        (ceiling_and_lamp(triangles=True), 4),
        (ceiling_and_lamp(gap=0.11), 0),
        (ceiling_and_lamp(gap=-GAP), 4),
        (ceiling_and_lamp(gap=-GAP, two_sided=False), 0),
    ):
        found = lines_of_first(scene, 0.5)
        assert len(found.ends) == expected
        assert found.of_lamps.all()
    dark = ceiling_and_lamp(two_sided=False)  # the lamp shines down; its upper side hides the ceiling as a mat hides a floor
    assert not lines_of_first(dark, 0.5).of_lamps.any()
    assert [len(lines_of_first(dark, size).ends) for size in (0.5, 0.04)] == [4, 0]


def test_check_tells_of_lamps_whose_light_patches_spread():
    def told(scene):
        return [finding.message for finding in rd.check(scene).findings if finding.kind == "near lamps"]

    (text,) = told(ceiling_and_lamp(side=0.05))
    assert text.startswith("'lamp at ceiling': lamps shine on a face near them (0.001 m)")
    assert told(ceiling_and_lamp(side=0.05, two_sided=False)) == []
    assert told(ceiling_and_lamp(side=0.05, gap=0.02)) == []


def test_boxes_that_overlap_are_found(random):
    one, two = ((low, low + random.random((80, 3)) ** 3) for low in random.random((2, 80, 3)))
    found = np.concatenate([np.stack(part, axis=1) for part in box_pairs(one, two)])
    every = ((one[0][:, None] <= two[1]) & (one[1][:, None] >= two[0])).all(axis=2)
    assert sorted(map(tuple, found.tolist())) == list(map(tuple, np.argwhere(every).tolist()))
    assert len(found) > 50


def test_the_command_line_cuts_along_lamps(tmp_path, monkeypatch, capsys):
    """Such a mesh holds the light of lamps without a word; it goes on from its file, and is refused where parts are."""
    scene = ceiling_and_lamp(side=0.05)
    monkeypatch.chdir(tmp_path)
    rd.save_scene(scene, "lamp.toml")
    run = ["solve", "lamp.toml", "--patch-size", "0.5", "--contacts", "--method", "random-walk"]
    assert command([*run, "--rays", "20k", "-o", "a.npz"]) == 0
    patches = rd.load_solution("a.npz").patches
    assert near_lamps(rd.subdivide(scene, size=0.5)) is not None
    assert near_lamps(patches) is None
    assert patches.scene.is_cut_of(rd.load_scene("lamp.toml"))
    assert patches.sizes.max() <= 0.5
    assert command([*run, "--cells", "2"]) == 2
    assert "--contacts cuts faces into parts of unlike size" in capsys.readouterr().err
    with pytest.raises(rd.SceneError, match="leave cells out"):
        rd.subdivide(scene, cells=2, contacts=True)
