"""Meshes that follow the light: cuts along contact lines, cuts where light varies, and what takes such meshes."""

from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli.app import run as command
from radiosity.patches.ahead import mean_over, quarters_of, within_halves
from radiosity.patches.cells_as_faces import cells_as_faces, turned
from radiosity.patches.contact import cut_at_contacts
from radiosity.patches.contact.convex import cut, parts, width
from radiosity.patches.halves import BRIGHT, Halves
from radiosity.patches.model import Patches
from radiosity.patches.variation import Variation
from radiosity.scene.paint import Paint
from radiosity.scene.shapes import box
from radiosity.solution.lattice import Lattice

TURN = 0.4  # radians, of the block on the floor


def block_on_floor(height=0.0, two_sided=False) -> rd.Scene:
    """A room of 4 x 4 x 3 m, whose ceiling is a lamp, and a turned block of 1 x 1 x 1 m that stands on the floor, or in it."""
    outer, inner = np.concatenate(box((0, 0, 0), (4, 4, 3), inward=True)), np.concatenate(box((-0.5, -0.5, 0), (0.5, 0.5, 1)))
    c, s = np.cos(TURN), np.sin(TURN)
    inner = inner @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + (2.1, 1.8, height)
    corners = np.concatenate([outer, inner])
    quads = np.arange(48).reshape(12, 4)
    up = np.array([np.cross(corners[q[1]] - corners[q[0]], corners[q[3]] - corners[q[0]])[2] for q in quads])
    names = ["floor" if k < 6 and z > 0 else "ceiling" if k < 6 and z < 0 else f"face {k}" for k, z in enumerate(up)]
    emission = [float(name == "ceiling") for name in names]
    return rd.Scene.from_arrays(corners, quads, 0.5, emission, surface=range(12), names=names, two_sided=two_sided)


def under_block(points: np.ndarray) -> np.ndarray:
    """How far points lie within the block's outline, in metres; below zero outside."""
    c, s = np.cos(TURN), np.sin(TURN)
    offset = (points[..., :2] - (2.1, 1.8)) @ np.array([[c, -s], [s, c]])
    return 0.5 - np.abs(offset).max(axis=-1)


def floor_of(patches: Patches) -> np.ndarray:
    return np.flatnonzero(patches.surface == patches.scene.names.index("floor"))


@pytest.mark.parametrize("height", [0.0, -0.3])
def test_a_face_is_cut_where_a_block_touches_or_pierces_it(height):
    scene = block_on_floor(height)
    patches = rd.subdivide(cut_at_contacts(scene, 1000, 100), cells=1)
    rows = floor_of(patches)
    within = under_block(patches.corners[rows])
    covered = (within > -1e-9).all(axis=1)
    assert (covered | (within < 1e-9).all(axis=1)).all()
    assert patches.area[rows][covered].sum() == pytest.approx(1, abs=1e-9)
    assert patches.area.sum() == pytest.approx(scene.area.sum())
    assert len(np.unique(patches.scene.cut.region[patches.face[rows]])) == 5  # the covered part, and one beside each edge
    assert (np.diff(patches.scene.cut.face) >= 0).all()
    assert patches.scene.is_cut_of(scene)


def test_no_light_leaks_under_a_block():
    """Of patches that lie half under a block some lines end on its inside. Cut along the contact line, none does."""
    scene = block_on_floor()
    lost, dark = [], []
    for patches in (rd.subdivide(scene, cells=6), rd.subdivide(cut_at_contacts(scene, 216, 50), size=0.67)):
        solution = rd.solve(patches, "random-walk", rays=60_000)
        lost.append(solution.books[0]["lost"])
        rows = floor_of(patches)
        dark.append(solution.arrivals[rows[(under_block(patches.corners[rows]) > -1e-9).all(axis=1)]].sum())
    assert lost[0] > 0
    assert lost[1] == 0
    assert dark[1] == 0


def area(polygon: np.ndarray) -> float:
    """The area of a counterclockwise polygon, (k, 2)."""
    after = np.roll(polygon, -1, axis=0)
    return (polygon[:, 0] @ after[:, 1] - polygon[:, 1] @ after[:, 0]) / 2


def test_polygons_are_cut_and_put_together_again(random):
    outline = np.array([[0.0, 0], [3, 0], [3, 2], [0, 2]])
    polygons = [outline]
    for _ in range(6):
        angle = random.uniform(0, np.pi)
        cuts = [cut(p, random.uniform(0.5, 1.5, 2), np.array([np.cos(angle), np.sin(angle)]), 1e-6) for p in polygons]
        polygons = [half for p, two in zip(polygons, cuts, strict=True) for half in (two or (p,))]
    pieces = [piece for p in polygons for piece in parts(p)]
    assert len(polygons) > 6
    assert sum(map(area, pieces)) == pytest.approx(6)
    assert min(map(area, pieces)) > 0
    assert {len(piece) for piece in pieces} <= {3, 4}
    assert [len(part) for part in parts(outline)] == [4]
    assert width([0, 0], [1, 0], [0.5, 0.75**0.5]) == pytest.approx(0.75**0.5)


@pytest.mark.parametrize("corners", [4, 3])
def test_parts_of_painted_faces_have_the_same_reflectance(corners, random):
    """Colours of corners, bilinear over a parallelogram: the means over cells are those of the face cut at once."""
    square = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], float)[:corners]
    scene = rd.Scene.from_arrays(square, [range(corners)], 0.8, 1.0)
    paint = Paint((), np.full(1, -1, np.int32), np.zeros((1, 4, 2), np.float32), random.random((1, 4, 1)))
    painted = replace(scene, reflectance_paint=paint)
    twice = cells_as_faces(rd.subdivide(cells_as_faces(rd.subdivide(turned(painted), cells=2)), cells=3))
    assert twice.n_faces == (36 if corners == 4 else 21)
    once, patches = rd.subdivide(painted, cells=60), rd.subdivide(twice, cells=1)
    for moment in (np.ones(3), (1, 0, 0), (0, 1, 0)):  # of the reflectance: points of a part are where they were
        weights = [
            (p.area * (0.1 + p.centroid @ np.array(moment))) @ p.reflectance for p in (once, rd.subdivide(twice, cells=12))
        ]
        assert weights[0] == pytest.approx(weights[1], rel=1e-5)
    assert patches.area @ patches.reflectance == pytest.approx(once.area @ once.reflectance, rel=1e-6)
    assert twice.cut.face.tolist() == [0] * twice.n_faces
    assert twice.cut.whole == painted.hash


def halves_of(two_sided=False) -> Halves:
    """Four unit squares beside each other, and a triangle."""
    corners = [[x, y, 0] for x in range(5) for y in (0, 1)] + [[9, 0, 0], [10, 0, 0], [9, 1, 0]]
    faces = [[2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1] for i in range(4)] + [[10, 11, 12, -1]]
    return Halves.of(rd.Scene.from_arrays(corners, faces, 0.5, 1.0, two_sided=two_sided), 0.0)


def test_faces_are_cut_across_the_gradient():
    """Light that rises along the first, second and both edges, along none, and over a triangle."""
    halves = halves_of()
    point, face = halves.fine.centroid, halves.fine.face
    x, y = point[:, 0] % 1, point[:, 1]
    light = np.select([face == 0, face == 1, face == 2, face == 3], [x, y, x + y, 0.7], 0.3 * x)
    found = halves.variation(np.stack([light[:, None]] * 4))
    assert found.along == pytest.approx([0.25 / 16, 0, 0.25 / 16, 0, 0])  # (reflectance x half the step)²
    assert found.across == pytest.approx([0, 0.25 / 16, 0.25 / 16, 0, 0])
    columns, rows = halves.chosen(found, 100)
    assert columns.tolist() == [2, 1, 2, 1, 2]
    assert rows.tolist() == [1, 2, 2, 1, 2]
    columns, rows = halves.chosen(found, 2)  # the best two of them alone
    assert (columns * rows).sum() == 7
    assert columns[4] == columns[3] == rows[4] == 1


def test_a_strip_is_cut_along_its_length():
    """Beside a tube light varies across a strip of 3 x 0.1 m alone: cuts that gain nothing need not come first."""
    strip = rd.Scene.from_arrays([[0, 0, 0], [3, 0, 0], [3, 0.1, 0], [0, 0.1, 0]], [[0, 1, 2, 3]], 0.5, 1.0)
    halves = Halves.of(strip, 0.0)
    across = halves.fine.centroid[:, 1]
    columns, rows = halves.chosen(halves.variation(np.stack([across[:, None]] * 4)), 10)
    assert (columns[0], rows[0]) == (1, 2)


@pytest.mark.parametrize("edge", [0, 1])
def test_a_strip_that_is_dark_at_both_ends_is_cut(edge):
    """Halves along an edge are alike, and a cut between them gains nothing, but the next two gain as much as three others do."""
    halves = halves_of()
    quarters = quarters_of(halves)
    assert len(quarters) == 4 * len(halves.fine)
    place = quarters.centroid[:, edge] % 1
    light = np.where((quarters.face == 1) & (abs(place - 0.5) < 0.25), 3.0, 1.0)
    irradiance = np.stack([light[:, None]] * 4)
    within = within_halves(halves, quarters, irradiance)
    assert within[edge] == pytest.approx([0, 0.25, 0, 0, 0])  # (reflectance x half the step)²
    assert within[1 - edge] == pytest.approx(0)
    fine = mean_over(quarters, irradiance, halves.fine)
    columns, rows = halves.chosen(halves.variation(fine), 1)
    assert (columns * rows).tolist() == [1, 1, 1, 1, 1]
    columns, rows = halves.chosen(halves.variation(fine, within), 1)
    assert (columns.tolist(), rows.tolist())[edge] == [1, 2, 1, 1, 1]
    assert (columns * rows).sum() == 6


@pytest.mark.parametrize("two_sided", [False, True])
def test_means_over_larger_cells_are_those_of_a_linear_field(two_sided):
    halves = halves_of(two_sided)
    quarters = quarters_of(halves)
    field = [one.centroid @ np.array([[2.0], [3], [0]]) + 5.0 * one.is_back[:, None] for one in (quarters, halves.fine)]
    assert mean_over(quarters, field[0][None], halves.fine)[0] == pytest.approx(field[1])


def test_errors_of_bright_insides_count_less():
    """One of four squares is seventy times as bright as the others, and has the largest step: one of the others is cut."""
    halves = halves_of()
    x, face = halves.fine.centroid[:, 0] % 1, halves.fine.face
    light = np.where(face == 0, 100 + 1.05 * x, 1 + x)
    irradiance = np.stack([light[:, None]] * 4)
    weights, found = halves.weights(irradiance), halves.variation(irradiance)
    mean = np.bincount(face, halves.fine.area * light) / halves.coarse.area
    assert weights == pytest.approx(1 / (1 + (mean / np.average(mean, weights=halves.coarse.area) / BRIGHT) ** 2))
    assert halves.chosen(found, 1)[0].tolist() == [2, 1, 1, 1, 1]
    assert halves.chosen(found, 1, weights)[0].tolist() == [1, 2, 1, 1, 1]


def test_noise_is_not_taken_for_light(random):
    """Noise alone, 100 times over four squares: its mean square is left out, to within 4 standard errors."""
    halves = halves_of(two_sided=True)
    found = [halves.variation(random.normal(1, 0.1, (4, len(halves.fine), 1))).along[:4] for _ in range(100)]
    noise = 2 * (0.5 * 0.1) ** 2 / 4 / 4  # of two sides; half the difference of means of two cells, each of four replicates
    error = np.std(found) / np.sqrt(400)
    assert abs(np.mean(found)) < 4 * error
    assert error < noise / 4


def test_what_is_lost_in_noise_is_expected_from_before():
    one = np.ones(3)
    scene = halves_of().coarse.scene.take([0, 1, 4])  # two parallelograms and a triangle
    parts, quads = np.array([0, 0, 1, 2, 2, 2]), np.array([True, True, True, True, False, False])
    before = Variation(4 * one, one, 8 * one, one, 4 * one, one)
    before = before.after(scene, np.array([2, 1, 2]), np.array([1, 1, 2]), parts, quads)
    assert before.along.tolist()[:4] == [1, 1, 4, 1]
    assert before.across.tolist()[:4] == [1, 1, 1, 1]
    assert before.rest.tolist() == [2, 2, 8, 0, 2, 2]
    assert before.within_along.tolist()[:4] == [1, 1, 4, 1]
    noise = np.array([1e-6, 1e6, 1.0])
    now = Variation(np.array([2.0, -5.0, 50.0]), np.zeros(3), np.zeros(3), noise, np.zeros(3), np.zeros(3))
    best = now.given(Variation(one, 0 * one, 0 * one, one, 0 * one, 0 * one))
    assert best.along == pytest.approx([2, 1, 50], rel=1e-3)  # measured; expected; far above its noise
    assert best.across.tolist() == [0, 0, 0]


@pytest.fixture(scope="module")
def adapted():
    return rd.adapt(block_on_floor(), 120, seed=3)


def test_a_mesh_follows_scene_number_and_seed(adapted):
    scene = block_on_floor()
    assert 110 < len(adapted) <= 120
    assert adapted.area.sum() == pytest.approx(scene.area.sum())
    assert rd.adapt(scene, 120, seed=3).scene.hash == adapted.scene.hash


@pytest.mark.slow
def test_patches_are_small_near_a_lamp():
    """A floor of 10 x 10 m, half a metre below a point light: its light is known. What patches miss of it, by points of each,
    falls by at least 3 against equal squares of the same number."""
    floor = [[-4, -3, 0], [6, -3, 0], [6, 7, 0], [-4, 7, 0]]
    scene = rd.Scene.from_arrays(floor, [[0, 1, 2, 3]], 0.5, 0.0, photometric=True)
    lit = scene.with_lights([rd.point_light(position=(0, 0, 0.5), lumens=400)])
    at = (np.arange(6) + 0.5) / 6

    def missed(patches):
        origin, first, second = (
            edge[:, None] for edge in (patches.corners[:, 0], *np.diff(patches.corners[:, :3], axis=1).swapaxes(0, 1))
        )
        u, v = (x.ravel()[:, None] for x in np.meshgrid(at, at))
        points = origin + u * first + v * second
        light = ((points - (0, 0, 0.5)) ** 2).sum(axis=2) ** -1.5
        return float((patches.area * light.var(axis=1)).sum() ** 0.5)

    even, follows = rd.subdivide(lit, cells=14), rd.subdivide(lit, patches=196)
    assert len(follows) <= 196
    assert missed(even) > 3 * missed(follows)


def test_runs_on_such_meshes_go_on_from_files(adapted, tmp_path):
    scene = block_on_floor()
    whole = rd.solve(adapted, "random-walk", quanta=8192, replicates=2)
    rd.solve(adapted, "random-walk", quanta=2048, replicates=2).save(tmp_path / "part.npz")
    part = rd.load_solution(tmp_path / "part.npz")
    assert part.patches.scene.is_cut_of(scene)
    assert np.array_equal(part.patches.scene.cut.region, adapted.scene.cut.region)
    more = rd.solve(scene, "random-walk", quanta=8192, replicates=2, resume=part)  # the mesh is that of the solution
    assert np.array_equal(more.arrivals, whole.arrivals)


def test_a_mesh_with_other_light_is_no_cut_of_the_scene():
    """A run on it does not stand for one of the scene, and a comparison tells that the light differs."""
    scene = block_on_floor()
    mesh = Patches(cells_as_faces(rd.subdivide(scene, cells=2)), *[np.ones(48, np.int32)] * 2)
    lines = rd.trace_lines(mesh, quanta=2000, replicates=2)
    assert lines.solve().patches.scene.is_cut_of(scene)
    dimmed = lines.solve(emission={"ceiling": 0.5})
    assert not dimmed.patches.scene.is_cut_of(scene)
    part = rd.solve(dimmed.patches, "random-walk", quanta=1024, replicates=2)
    with pytest.raises(rd.MethodError, match="cannot go on from a solution of 48 patches"):
        rd.solve(scene, "random-walk", quanta=2048, replicates=2, resume=part)
    whole = rd.trace_lines(rd.subdivide(scene, cells=1), quanta=2000, replicates=2).solve()
    for pair in ((dimmed, whole), (whole, dimmed)):
        notes = rd.compare(*pair).notes
        assert any("differ in the emission of 'ceiling'" in note for note in notes)


def test_parts_on_one_mesh_are_merged_and_other_meshes_refused(adapted, tmp_path):
    run = {"method": "random-walk", "quanta": 1024}
    for first in (0, 2):
        rd.solve(adapted, **run, replicates=2, first_replicate=first).save(tmp_path / f"{first}.npz")
    parts = [rd.load_solution(tmp_path / f"{first}.npz") for first in (0, 2)]
    assert np.array_equal(rd.merge(parts).arrivals, rd.solve(adapted, **run, replicates=4).arrivals)
    whole = block_on_floor()
    other = Patches(cells_as_faces(rd.subdivide(whole, cells=2)), *[np.ones(48, np.int32)] * 2)
    with pytest.raises(rd.MethodError, match="the meshes of one scene"):
        rd.merge([parts[0], rd.solve(other, **run, replicates=2, first_replicate=2)])


def test_line_sets_on_such_meshes_go_on_and_solve(adapted):
    """Lines are counted on the mesh, also where the scene is given with lines to go on from; they solve as a run does."""
    part = rd.trace_lines(adapted, quanta=2048, replicates=2)
    more = rd.trace_lines(block_on_floor(), quanta=65_536, replicates=2, resume=part)
    assert more.patches.scene.hash == adapted.scene.hash
    found, run = more.solve(), rd.solve(adapted, "random-walk", rays=400_000)
    mean = [one.patches.area @ one.irradiance / one.patches.area.sum() for one in (found, run)]
    assert mean[0] == pytest.approx(mean[1], rel=0.02)


def test_smoothing_does_not_cross_contact_lines():
    """Where patches under a block and beside it are congruent, they are no neighbours."""
    corners = np.concatenate([np.concatenate(box((0, 0, 0), (4, 4, 3), inward=True)), np.concatenate(box((1, 1, 0), (2, 2, 1)))])
    scene = rd.Scene.from_arrays(corners, np.arange(48).reshape(12, 4), 0.5, 1.0, surface=range(12))
    patches = rd.subdivide(cut_at_contacts(scene, 1000, 100), size=0.25)
    after, middle = Lattice.of(patches).after[:2], patches.centroid
    covered = (np.abs(middle - (1.5, 1.5, 0)) < (0.5, 0.5, 1e-9)).all(axis=1) & (patches.normal[:, 2] > 0.5)
    assert covered.sum() == 16
    for way in after:
        here = np.flatnonzero(way >= 0)
        assert (covered[here] == covered[way[here]]).all()
        assert covered[here].sum() == 12


SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("global-multipath-first-shot", "stochastic-jacobi", "gather")]


@pytest.mark.parametrize("method", ["full-matrix", *SLOW])
def test_methods_take_such_meshes(adapted, method):
    budget = {} if method == "full-matrix" else {"rays": 100_000}
    solution = rd.solve(adapted, method, **budget)
    rows = floor_of(adapted)
    covered = under_block(adapted.centroid[rows]) > 0
    power = (solution.irradiance[:, 0] * adapted.area)[rows]
    assert power[covered].sum() < 1e-3 * power[~covered].sum()
    assert 0.3 < power[~covered].sum() / adapted.area[rows][~covered].sum() < 1.5


def test_what_makes_no_sense_is_refused():
    scene = block_on_floor()
    with pytest.raises(rd.SceneError, match="11 patches are fewer than its 12 sides"):
        rd.adapt(scene, 11)
    with pytest.raises(rd.MethodError, match="takes a Scene, not Patches"):
        rd.adapt(rd.subdivide(scene, cells=1), 100)
    with pytest.raises(rd.SceneError, match="leave out size"):
        rd.subdivide(scene, patches=100, cells=2)
    with pytest.raises(rd.MethodError, match="refines its patches by itself"):
        rd.solve(scene, "hierarchical", adaptive=True)
    cut_scene = Patches(cut_at_contacts(scene, 1000, 100), *[np.ones(16, np.int32)] * 2)
    with pytest.raises(rd.MethodError, match="refines its patches by itself"):
        rd.solve(cut_scene, "hierarchical")


@pytest.mark.slow
def test_the_command_line_cuts_solves_and_goes_on(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert command(["solve", "room", "--patches", "60", "--rays", "20k", "-o", "a.npz"]) == 0
    patches = rd.load_solution("a.npz").patches
    assert 50 < len(patches) <= 60
    assert patches.scene.is_cut_of(rd.load_scene("room"))
    assert command(["solve", "room", "--resume", "a.npz", "--rays", "40k", "-o", "b.npz"]) == 0
    assert len(rd.load_solution("b.npz").patches) == len(patches)


def test_the_command_line_counts_lines_on_such_meshes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert command(["lines", "room", "--patches", "50", "--rays", "20k", "--replicates", "2", "-o", "c.npz"]) == 0
    patches = rd.load_lines("c.npz").patches
    assert 40 < len(patches) <= 50
    assert patches.scene.is_cut_of(rd.load_scene("room"))
    assert command(["lines", "room", "--resume", "c.npz", "--rays", "30k", "--replicates", "2", "-o", "d.npz"]) == 0
    assert rd.load_lines("d.npz").patches.scene.hash == patches.scene.hash
    capsys.readouterr()


def test_the_command_line_refuses_what_does_not_go_together(capsys):
    for name in ("solve", "lines"):
        assert command([name, "room", "--patches", "200", "--cells", "2", "-o", "e.npz"]) == 2
        assert "leave out --patch-size" in capsys.readouterr().err
    assert command(["solve", "room", "--patches", "200", "--powers-of-two"]) == 2
    assert "leave out --powers-of-two" in capsys.readouterr().err
    assert command(["solve", "room", "--adaptive", "--method", "hierarchical"]) == 2
    assert "refines its patches by itself" in capsys.readouterr().err
