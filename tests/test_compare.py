"""`compare`: differences of two solutions, whether their errors explain them, and its files."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli import main
from radiosity.comparison.outputs import picture
from radiosity.comparison.pairing import places
from radiosity.comparison.report import bin_name
from radiosity.comparison.significance import chi_square, welch

ROOM = rd.load_scene("room")
BRIGHTER = replace(ROOM, emission=1.05 * ROOM.emission, back_emission=1.05 * ROOM.back_emission)


def solved(scene=ROOM, cells=2, rays=100_000, **options) -> rd.Solution:
    return rd.solve(rd.subdivide(scene, cells=cells), rays=rays, **options)


@pytest.fixture(scope="module")
def one():
    return solved(seed=1)


@pytest.fixture(scope="module")
def brighter():
    return solved(BRIGHTER, seed=2)


def test_a_solution_agrees_with_itself_and_with_other_seeds(one):
    same = rd.compare(one, one)
    assert same.agrees
    assert (same.rms, same.relative, same.largest, same.chance) == (0.0, 0.0, 0.0, 1.0)
    assert "same seed" in same.report()
    other = rd.compare(one, solved(seed=2))
    assert other.agrees
    assert 0.5 < other.relative / other.expected < 1.5  # errors explain the differences, no more and no less
    assert sum(row["count"] for row in other.histogram()) == other.by_patch.tested.sum()


def test_equal_values_have_a_bin_of_their_own(one):
    """Scores below and above zero fall in bins of the same sizes."""
    rows = rd.compare(one, one).histogram()
    assert [(row["from"], row["to"]) for row in rows if row["count"]] == [(0.0, 0.0)]
    ahead, behind = (rd.compare(*pair).histogram() for pair in ((one, solved(seed=2)), (solved(seed=2), one)))
    assert [row["count"] for row in ahead] == [row["count"] for row in reversed(behind)]
    assert [row["expected"] for row in ahead] == [row["expected"] for row in reversed(behind)]
    assert [bin_name(row) for row in rows[3:8]] == ["-2 to -1", "-1 to 0", "equal", "0 to +1", "+1 to +2"]
    assert (bin_name(rows[0]), bin_name(rows[-1])) == ("below -4", "above +4")


def test_five_percent_more_light_is_found_everywhere(one, brighter):
    found = rd.compare(brighter, one)
    assert found.agrees is False
    assert found.chance < 1e-9
    assert found.relative == pytest.approx(0.05, rel=0.2)
    for row in found.surfaces:
        error = np.hypot(row["first error"], row["second error"])
        assert abs(row["first"] - 1.05 * row["second"]) < 4 * error, row["surface"]
    assert "emission of 'light'" in found.report()


@pytest.mark.parametrize(
    ("within", "of", "agrees"), [(0.09, "patches", True), (0.03, "patches", False), (0.03, "surfaces", False)]
)
def test_a_tolerance_decides_where_there_is_one(one, brighter, within, of, agrees):
    assert rd.compare(brighter, one, within=within, of=of).agrees is agrees


def test_errors_that_are_not_known_decide_nothing(one):
    single = solved(seed=3, replicates=1)
    found = rd.compare(single, one)
    assert found.agrees is None
    assert np.isnan(found.chance)
    assert rd.compare(single, one, within=0.2).agrees
    assert rd.compare(one, single).agrees is None
    assert rd.compare(one, single, reference=True).agrees is not None


def test_chi_square_counts_correlated_means_as_few():
    """With alpha = 5 % about 5 % of 400 trials are rejected; if all means counted as independent it would be over 12 %."""
    random = np.random.default_rng(0)
    mix = random.normal(size=(3, 20)) + 0.1 * random.normal(size=(3, 20))  # 20 means of 3 numbers: far from independent
    rejected, naive = 0, 0
    for _ in range(400):
        values = [random.normal(size=(8, 3)) @ mix + 0.3 * random.normal(size=(8, 20)) for _ in range(2)]
        means, errors = [v.mean(axis=0) for v in values], [v.std(axis=0, ddof=1) / 8**0.5 for v in values]
        test = welch(means[0] - means[1], errors, (8, 8))
        mean, nu, chance = chi_square(test.score, np.hypot(*errors), values)
        assert 1 <= nu < 8
        rejected += chance < 0.05
        naive += mean > 31.41 / 20  # the 95 % quantile of 20 independent ones
    assert 0.02 <= rejected / 400 <= 0.09
    assert naive / 400 > 0.12


TRIANGLE = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.5, 1.0, two_sided=True)


@pytest.mark.parametrize("scene", [ROOM, TRIANGLE], ids=["room", "triangle"])
def test_points_lie_in_the_patches_of_both_cuts(scene):
    a, b = (solved(scene, cells, 20_000) for cells in (2, 3))
    place = places(a, b)
    assert not place.equal
    assert len(place.patches) == len(b.patches)
    for one, patch in ((a, place.first), (b, place.second)):
        corners, points = one.patches.corners[patch], place.patches.centroid
        ends = np.roll(corners, -1, axis=1)
        inside = np.einsum("nkj,nj->nk", np.cross(ends - corners, points[:, None] - corners), one.patches.normal[patch])
        assert (inside >= -1e-9).all()  # to the left of each edge
        assert (one.patches.surface[patch] == place.patches.surface).all()
        assert (one.patches.is_back[patch] == place.patches.is_back).all()


def test_a_mesh_that_follows_the_light_is_compared_with_a_plain_one(one):
    cut = rd.solve(rd.subdivide(ROOM, patches=150), rays=20_000, seed=4)
    for pair in ((cut, one), (one, cut)):
        place = places(*pair)
        assert place.patches is cut.patches
        which = place.second if pair[0] is cut else place.first
        corners, points = one.patches.corners[which], place.patches.centroid
        assert (points >= corners.min(axis=1) - 1e-9).all()
        assert (points <= corners.max(axis=1) + 1e-9).all()
        assert one.patches.normal[which] @ [0, 0, 1] == pytest.approx(place.patches.normal @ [0, 0, 1])
        assert (one.patches.surface[which] == place.patches.surface).all()
        assert rd.compare(*pair, within=0.5).agrees


def test_other_patches_and_other_faces_are_compared_by_surface(one):
    finer = rd.compare(one, solved(cells=3, seed=5), within=0.2, of="surfaces")
    assert finer.agrees
    assert not finer.by_patch.equal
    turned = replace(ROOM, vertices=ROOM.vertices[:, [1, 0, 2]] * [1, -1, 1])  # the room turned about its upright
    found = rd.compare(one, solved(turned, seed=6))
    assert found.by_patch is None
    assert found.agrees
    with pytest.raises(rd.OutputError, match="same faces"):
        picture(found)


@pytest.mark.parametrize(
    ("other", "says"),
    [
        (lambda: solved(rd.load_scene("cornell-box"), 1, 20_000), "bands"),
        (lambda: solved(replace(ROOM, photometric=True), 1, 20_000), "lm/m²"),
        (lambda: solved(replace(ROOM, names=tuple(f"x{name}" for name in ROOM.names)), 1, 20_000), "no surface in common"),
    ],
)
def test_what_cannot_be_compared_is_refused(one, other, says):
    with pytest.raises(rd.SceneError, match=says):
        rd.compare(one, other())


@pytest.mark.parametrize("wrong", [{"within": -1.0}, {"of": "all"}, {"alpha": 0.0}, {"quantity": "power"}])
def test_values_out_of_range_are_refused(one, wrong):
    with pytest.raises(rd.MethodError):
        rd.compare(one, one, **wrong)


def test_a_missing_library_is_named_before_any_work(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("radiosity.image.output.find_spec", lambda name: None if name == "PIL" else name)
    assert main(["compare", "a.npz", "b.npz", "-o", str(tmp_path / "d.png")]) == 2
    assert "d.png: writing PNG needs 'PIL', which is not installed" in capsys.readouterr().err


def test_the_command_writes_files_and_tells_by_its_status(one, brighter, tmp_path, capsys):
    one.save(tmp_path / "one.npz")
    brighter.save(tmp_path / "brighter.npz")
    first, second = (str(tmp_path / f"{name}.npz") for name in ("brighter", "one"))
    files = [str(tmp_path / f"d.{suffix}") for suffix in ("json", "csv", "svg", "png")]
    assert main(["compare", first, second, "--width", "40", "-o", *files]) == 1
    assert "they DIFFER" in capsys.readouterr().out
    found = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))
    assert found["agrees"] is False
    assert len(found["surfaces"]) == len(one.surface_table())
    with (tmp_path / "d.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == found["patches"]
    assert float(rows[0]["first [W/m²]"]) == pytest.approx(brighter.irradiance[int(rows[0]["patch"]), 0])
    from PIL import Image

    colours = np.asarray(Image.open(tmp_path / "d.png"), int)[:, :40]
    assert (colours[..., 0] >= colours[..., 2]).mean() > 0.9  # red: the first is larger
    assert main(["compare", second, second]) == 0
    assert main(["compare", first, second, "--within", "20%"]) == 0
    assert main(["compare", first, str(tmp_path / "no.npz")]) == 2
    solved(seed=3, replicates=1).save(tmp_path / "single.npz")
    assert main(["compare", str(tmp_path / "single.npz"), second]) == 2
    assert "no error" in capsys.readouterr().err
