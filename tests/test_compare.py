"""`compare`: differences of two solutions, whether their errors explain them, and its files."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli import main
from radiosity.comparison import clipping
from radiosity.comparison.outputs import picture
from radiosity.comparison.refinement import refined
from radiosity.comparison.report import bin_name
from radiosity.comparison.significance import chi_square, welch
from radiosity.patches.cells_as_faces import cells_as_faces
from radiosity.patches.model import Patches
from radiosity.scene.shapes import box

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


def meshes(scene, *cells):
    """Meshes of a scene that are cut twice, so that each is a cut scene; a number alone is cut once."""
    return [
        rd.subdivide(cells_as_faces(rd.subdivide(scene, cells=one[0])), cells=one[1])
        if isinstance(one, tuple)
        else rd.subdivide(scene, cells=one)
        for one in cells
    ]


def check_lies_within(pieces, patches, at):
    corners, points = patches.corners[at], pieces.corners
    ends = np.roll(corners, -1, axis=1)
    for point in np.moveaxis(points, 1, 0):  # to the left of each edge
        assert (np.einsum("nkj,nj->nk", np.cross(ends - corners, point[:, None] - corners), patches.normal[at]) >= -1e-9).all()
    assert (patches.surface[at] == pieces.surface).all()
    assert (patches.is_back[at] == pieces.is_back).all()
    assert np.bincount(at, pieces.area, len(patches)) == pytest.approx(patches.area)  # each patch is made up of its pieces


@pytest.mark.parametrize("scene", [ROOM, TRIANGLE], ids=["room", "triangle"])
@pytest.mark.parametrize("cells", [(2, 3), (2, (2, 2)), ((2, 2), 3), ((2, 2), (3, 1))], ids=str)
def test_pieces_lie_within_the_patches_of_both_meshes(scene, cells):
    one, two = meshes(scene, *cells)
    place = refined(one, two)
    check_lies_within(place.patches, one, place.first)
    check_lies_within(place.patches, two, place.second)
    if scene is ROOM and cells == (2, 3):
        assert len(place.patches) == 16 * len(rd.subdivide(ROOM, cells=1))


def test_two_cut_meshes_are_compared_where_their_patches_overlap(random):
    """The RMS is the integral over what each pair of patches has in common: of boxes along the axes that is a product."""
    faces = np.arange(24).reshape(6, 4)
    whole = rd.Scene.from_arrays(np.concatenate(box((0, 0, 0), (4, 3, 2), inward=True)), faces, 0.5, [1, 0, 0, 0, 0, 0])
    cuts = [Patches(whole, *random.integers(1, 4, (2, 6), np.int32)) for _ in range(2)]
    a, b = (
        rd.solve(rd.subdivide(cells_as_faces(cut), cells=1), "random-walk", rays=20_000, seed=seed)
        for seed, cut in enumerate(cuts)
    )
    found = rd.compare(a, b)
    ends = [(one.patches.corners.min(axis=1), one.patches.corners.max(axis=1)) for one in (a, b)]
    shared = np.minimum(ends[0][1][:, None], ends[1][1]) - np.maximum(ends[0][0][:, None], ends[1][0])
    facing = (a.patches.normal @ b.patches.normal.T > 0.5) & (shared > -1e-9).all(axis=2)
    overlap = np.where(facing, np.sort(np.clip(shared, 0, None), axis=2)[:, :, 1:].prod(axis=2), 0)
    assert overlap.sum() == pytest.approx(a.patches.area.sum())
    counted = ~a.sides.left_out[:, None] & ~b.sides.left_out
    square = (a.irradiance - b.irradiance.T) ** 2
    assert found.rms == pytest.approx(np.sqrt((overlap * square)[counted].sum() / overlap[counted].sum()))
    noise = np.hypot(a.irradiance_standard_error, b.irradiance_standard_error.T) ** 2
    light = (overlap * b.irradiance.T**2)[counted].sum()
    assert found.expected == pytest.approx(np.sqrt((overlap * noise)[counted].sum() / light))
    assert "overlaps" in found.report()
    assert not any("differ in" in note for note in found.notes)


def test_other_light_on_another_mesh_is_told_and_other_faces_are_not_taken_for_these():
    """Meshes of a scene with other light are of other scenes by their hashes, and of the same faces by their places."""
    bright, plain = (rd.solve(meshes(scene, (2, 1))[0], "random-walk", rays=20_000, seed=2) for scene in (BRIGHTER, ROOM))
    other = rd.solve(meshes(ROOM, (1, 3))[0], "random-walk", rays=20_000, seed=3)
    found = rd.compare(bright, other)
    assert found.by_patch is not None
    assert any("emission of 'light'" in note for note in found.notes)
    assert rd.compare(plain, other).by_patch is not None
    moved = replace(other.patches.scene, vertices=other.patches.scene.vertices * [1, 1, 1.01])
    assert refined(plain.patches, rd.subdivide(moved, cells=1)) is None


@pytest.mark.parametrize("shift", [0.0, 0.3, 0.8, 1.2])
def test_polygons_are_cut_by_each_other(shift):
    """A square, moved along a diagonal over a triangle with legs of 2: areas of what they share by hand."""
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + shift
    triangle = np.array([[0.0, 0], [2, 0], [0, 2], [0, 2]])
    common = clipping.intersections(square[None], triangle[None])
    corner, end = 1 - shift, min(2 * shift, 2.0)  # the square's low corner is left of the line x + y = 2 by 2 corner
    expected = {True: 0.0, False: 1 - max(end, 0) ** 2 / 2 if shift <= 0.5 else (2 * corner) ** 2 / 2}[corner <= 0]
    assert clipping.areas(common)[0] == pytest.approx(expected, abs=1e-12)
    pieces, owner = clipping.parts(common)
    assert clipping.areas(pieces).sum() == pytest.approx(expected, abs=1e-12)
    assert (owner == 0).all()
    assert len(pieces) == {0.0: 1, 0.3: 3, 0.8: 1, 1.2: 0}[shift]


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
