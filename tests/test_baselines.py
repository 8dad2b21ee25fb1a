"""Full matrix and progressive refinement: closed forms, agreement with the random walk, shots, budgets and refusals.

Bounds of what is sampled are stated beside each comparison; all seeds are fixed.
"""

import numpy as np
import pytest
from enclosures import cube, parallel_squares
from methods import critical
from replicates import difference, powers

import radiosity as rd
from radiosity.algorithms import estimate
from radiosity.algorithms.progressive import recent
from radiosity.device import memory
from radiosity.method.schemes import SOLVERS

# coarse hemicubes and few samples say that they are off; one test looks for it
pytestmark = [
    pytest.mark.filterwarnings("ignore:.*out of balance:radiosity.RadiosityWarning"),
    pytest.mark.filterwarnings("ignore:.*lamps shine on a face near:radiosity.RadiosityWarning"),
]

FACTORS = ("polygons", "hemicube", "lines")
SCHEMES = ("full-matrix", "progressive")


@pytest.fixture(scope="module")
def room():
    """162 patches, and their solution by random walks (0.4 %)."""
    patches = rd.subdivide(rd.load_scene("room"), cells=3)
    return patches, rd.solve(patches, "random-walk", rays=2_500_000, seed=99)


@pytest.fixture(scope="module")
def box():
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=4)
    return patches, rd.solve(patches, "random-walk", rays=2_500_000, seed=99)


def error(solution: rd.Solution, reference: rd.Solution) -> float:
    """Area-weighted relative RMS of irradiance, the worst band."""
    area = reference.patches.area[:, None]
    squares = (area * (solution.irradiance - reference.irradiance) ** 2).sum(axis=0)
    return float(np.sqrt(squares / (area * reference.irradiance**2).sum(axis=0)).max())


# ---- closed forms ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("factors", FACTORS)
@pytest.mark.parametrize("mean_reflectance", [pytest.param("0.1", marks=pytest.mark.slow), "0.5", "0.9"])
def test_furnace(scheme, factors, mean_reflectance):
    """Rows of lines and hemicubes sum to one, so B = 1 whatever they are, but for what progressive refinement leaves unshot
    (1e-4 of the emitted power, over 1 - rho); polygons' rows are off by what 16 lines a pair leave open."""
    patches = rd.subdivide(rd.load_scene(f"labyrinth-{mean_reflectance}"), cells=1)
    solution = rd.solve(patches, rd.Baseline(scheme, factors=factors, **({"resolution": 16} if factors == "hemicube" else {})))
    off = np.sqrt(np.average((solution.radiosity[:, 0] - 1) ** 2, weights=patches.area))
    rest = 1e-4 / (1 - float(mean_reflectance))
    if factors == "polygons":
        assert off < 0.05
    elif scheme == "full-matrix":
        assert off < 1e-9
    else:  # F_ij as patch i sees j sends light that A_j F_ji would not: the furnace is met in the mean over patches alone
        mean = np.average(solution.radiosity[:, 0], weights=patches.area)
        assert mean == pytest.approx(1, abs=0.02 + 10 * rest)


@pytest.mark.parametrize("solver", SOLVERS)
def test_three_surface_enclosure(solver):
    """A cube of a bright floor, a grey ceiling and four walls, a patch a side: floor, ceiling and walls are three surfaces with
    exact view factors (opposite squares and adjoining ones, by closed form)."""
    reflectance, emission = [[0.3]] * 4 + [[0.8], [0.5]], [[0.0]] * 4 + [[1.0], [0.0]]
    patches = rd.subdivide(cube(reflectance, emission), cells=1)
    root = np.sqrt(3)  # opposite unit squares, Howell C-11
    across = 2 / np.pi * (np.log(2 / root) + 2 * np.sqrt(2) * np.arctan(1 / np.sqrt(2)) - np.pi / 2)
    factors = np.array([[0, across, 1 - across], [across, 0, 1 - across], [(1 - across) / 4, (1 - across) / 4, (1 + across) / 2]])
    exact = np.linalg.solve(np.eye(3) - np.array([[0.8], [0.5], [0.3]]) * factors, [1.0, 0.0, 0.0])
    solution = rd.solve(patches, "full-matrix", solver=solver)
    assert solution.radiosity[:, 0] == pytest.approx(exact[[2, 2, 2, 2, 0, 1]], rel=1e-6)
    assert solution.history[-1, 1] < 1e-9


# ---- against the random walk -------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["room", "box"])
def test_full_matrix_of_lines_agrees_with_the_random_walk_within_errors(scene, request):
    patches, _ = request.getfixturevalue(scene)
    expected = powers(rd.solve(patches, "random-walk", rays=20_000_000, replicates=16, seed=98))
    solution = rd.solve(patches, rd.Baseline(factors="lines"), replicates=16)
    received = solution.state["received"][..., 0]
    found = np.stack([np.bincount(patches.surface, row) for row in received])
    # the light's light that comes back along counts of its own lines: a bias of one over lines, below a tenth of the bound
    assert np.abs(difference(found, expected)).max() < critical(16, found.shape[1]) * 1.1


@pytest.mark.parametrize("scene", [pytest.param("room", marks=pytest.mark.slow), "box"])
@pytest.mark.parametrize(
    ("method", "bound"),
    [
        (rd.Baseline(samples=64), 0.015),  # 64 lines a half hidden pair
        (rd.Baseline("progressive", samples=64), 0.015),
        (rd.Baseline("progressive", factors="lines"), 0.06),
        (rd.Baseline("progressive", factors="hemicube", resolution=64), 0.08),  # near patches seen from the middle alone
    ],
    ids=str,
)
def test_agrees_with_the_random_walk(scene, method, bound, request):
    patches, reference = request.getfixturevalue(scene)
    solution = rd.solve(patches, method)
    assert error(solution, reference) < bound
    for book in solution.books:
        assert abs(book["rounding"]) < 0.02 * book["emitted"]
        total = book["absorbed"] + book["escaped"] + book["lost"]
        assert book["emitted"] + book["rounding"] == pytest.approx(total, rel=1e-9)


@pytest.mark.filterwarnings("ignore:.*standard errors of hemicubes")
@pytest.mark.parametrize("factors", FACTORS)
def test_replicates_of_a_matrix_are_not_alike(factors):
    """Whatever is drawn for one is drawn anew for the next, or their error would be a certain zero."""
    method = rd.Baseline(factors=factors, **({"resolution": 16} if factors == "hemicube" else {"samples": 3}))
    solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), method, replicates=2)
    assert (solution.irradiance_standard_error > 0)[solution.irradiance > 0].all()


@pytest.mark.slow
def test_errors_fall_with_samples_and_with_patches_for_hemicubes(room):
    patches, reference = room
    errors = [error(rd.solve(patches, rd.Baseline(samples=samples)), reference) for samples in (4, 32, 256)]
    assert errors[0] > 1.5 * errors[1] > 2 * errors[2]
    coarse, fine = (
        error(rd.solve(cut, "progressive-refinement", resolution=128), rd.solve(cut, "random-walk", rays=30_000_000))
        for cut in (rd.subdivide(patches.scene, cells=cells) for cells in (2, 8))
    )
    assert fine < 0.6 * coarse  # near patches get farther away in patch sizes, except those that touch


def test_reciprocity_is_restored_on_request(room):
    """Of few lines of small patches, a light among them, far better: each pair is counted at both ends."""
    patches, reference = room
    plain, restored = (rd.solve(patches, rd.Baseline(factors="lines", reciprocal=flag)) for flag in (False, True))
    assert error(restored, reference) < 0.5 * error(plain, reference)


@pytest.mark.parametrize(
    "choices",
    [*({"scheme": s, "factors": f} for s in SCHEMES for f in FACTORS), {"scheme": "hierarchical"}],
    ids=lambda choices: "/".join(choices.values()),
)
def test_what_lands_on_backs_is_lost_and_what_passes_them_escapes(choices):
    """A square of 1 W over a square whose back absorbs; the form factor is in Howell's catalogue. Errors of 16 lines a pair or
    link and of hemicubes stay below a hundredth."""
    scene, exact = parallel_squares()
    turned = scene.faces.copy()
    turned[1] = turned[1, ::-1]
    scene = rd.Scene.from_arrays(scene.vertices, turned, 0.0, [1.0, 0.0], surface=[0, 1], names=["lamp", "plate"])
    (book,) = rd.solve(rd.subdivide(scene, cells=4), rd.Baseline(**choices)).books
    assert book["emitted"] == pytest.approx(1)
    assert book["lost"] == pytest.approx(exact, abs=0.01)
    assert book["escaped"] == pytest.approx(1 - exact, abs=0.01)


def test_backs_that_let_light_pass():
    """Light goes the way of the lines; reciprocity does not hold, and is refused."""
    from dataclasses import replace

    scene = rd.load_scene("room")
    scene = replace(scene, back=np.full_like(scene.back, int(rd.Back.PASSES)))
    patches = rd.subdivide(scene, cells=3)
    reference = rd.solve(patches, "random-walk", rays=4_000_000)
    assert error(rd.solve(patches, rd.Baseline("progressive", samples=64)), reference) < 0.04
    assert error(rd.solve(patches, rd.Baseline(samples=64)), reference) < 0.04
    with pytest.raises(rd.MethodError, match="no reciprocity to restore"):
        rd.solve(patches, rd.Baseline(reciprocal=True))


# ---- progressive refinement --------------------------------------------------------------------------------------------


def test_shots_converge_to_the_matrix_of_the_same_rows(room):
    patches, _ = room
    matrix, shots = (rd.solve(patches, rd.Baseline(scheme)) for scheme in SCHEMES)
    assert error(shots, matrix) < 1e-3
    steps, unshot = shots.history.T
    assert unshot[0] == 1
    assert (np.diff(unshot) < 0).all()
    assert unshot[-1] <= 1.2e-4
    assert shots.quanta >= steps[-1]


@pytest.mark.parametrize("overshooting", [False, True])
@pytest.mark.parametrize("factors", ["polygons", "hemicube", "lines"])
def test_the_first_shot_is_that_of_the_most_power(factors, overshooting):
    """Area times emission, all bands together: neither the brightest patch nor the largest one, nor the most of one band."""
    emission = [[1.0, 1.0], [0.0, 0.0], [3.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]]
    scene = rd.Scene.from_arrays(
        [(0, 0, 0), (1, 0, 0), (1, 3, 0), (0, 3, 0), (0, 0, 2), (1, 0, 2), (1, 3, 2), (0, 3, 2)],
        [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)],
        0.3 if overshooting else 0.0,
        emission,
        surface=range(6),
        names=list("abcdef"),
    )
    power = scene.area[:, None] * scene.emission
    assert power.sum(axis=1).argmax() == 0
    assert power[:, 0].argmax() == 2
    assert scene.area.argmax() == 3
    method = rd.Baseline("progressive", factors, overshooting=overshooting)
    one, two = (rd.solve(rd.subdivide(scene, cells=1), method, quanta=shots) for shots in (1, 2))
    assert one.irradiance[0] == pytest.approx([0, 0], abs=1e-12)  # its own light: a plane does not see itself
    assert (one.irradiance[[1, 2, 3, 4, 5]] > 0).all()
    assert (two.irradiance[:, 0] - one.irradiance[:, 0])[[0, 1, 3, 4, 5]].min() > 0  # then that of c, in one band
    if not overshooting:
        assert np.array_equal(two.irradiance[:, 1], one.irradiance[:, 1])
        for solution, shot in ((one, power[0]), (two, power[0] + power[2])):
            assert solution.patches.area @ solution.irradiance == pytest.approx(shot, rel=0.02)


def test_ambient_light_is_there_from_the_start(room):
    patches, reference = room
    few = [rd.solve(patches, rd.Baseline("progressive", ambient=ambient), quanta=20) for ambient in (False, True)]
    mean = [np.average(solution.irradiance[:, 0], weights=patches.area) for solution in (*few, reference)]
    assert mean[0] < 0.8 * mean[2]
    assert mean[1] == pytest.approx(mean[2], rel=0.1)


def test_overshooting_takes_fewer_shots_to_the_same_end(room):
    patches, _ = room
    usual, over = (rd.solve(patches, rd.Baseline("progressive", overshooting=flag)) for flag in (False, True))
    assert over.quanta < 0.75 * usual.quanta
    assert error(over, usual) < 1e-3


def test_rows_that_are_forgotten_change_nothing(room, monkeypatch):
    patches, _ = room
    method = rd.Baseline("progressive", factors="lines", samples=256)
    kept = rd.solve(patches, method)
    monkeypatch.setattr(recent, "MOST_ENTRIES", 1000)
    forgotten = rd.solve(patches, method)
    assert np.array_equal(kept.irradiance, forgotten.irradiance)
    assert forgotten.rays > kept.rays


def test_lines_of_forgotten_rows_still_count_after_an_interruption(monkeypatch):
    """Rows that are made again to go on are no new lines, and take the place of none."""
    monkeypatch.setattr(recent, "MOST_ENTRIES", 300)
    patches, method = rd.subdivide(rd.load_scene("room"), cells=2), rd.Baseline("progressive", factors="lines", samples=64)
    some = rd.solve(patches, method, quanta=100)
    assert 0 < len(some.state["recent"]) < some.rays / 64 / 2
    more = rd.solve(patches, method, quanta=101, resume=some)
    assert some.rays <= more.rays <= some.rays + 64 * recent.AHEAD


def test_shots_go_on_to_the_same_bits(room):
    patches, _ = room
    for method in (rd.Baseline("progressive"), rd.Baseline("progressive", factors="hemicube", resolution=16)):
        few = rd.solve(patches, method, quanta=100)
        assert few.quanta == 100
        more = rd.solve(patches, method, quanta=300, resume=few)
        once = rd.solve(patches, method, quanta=300)
        assert np.array_equal(more.irradiance, once.irradiance)
        assert np.array_equal(more.history, once.history)


# ---- what users meet ---------------------------------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore:.*on this machine:radiosity.RadiosityWarning")  # which may be busy
@pytest.mark.parametrize("name", [name for name, preset in rd.BASELINES.items()])
def test_a_name_solves_a_scene_and_files_keep_it(name, tmp_path):
    solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=2, powers_of_two=True), name)
    assert solution.status == "complete"
    assert np.isnan(solution.irradiance_standard_error).all()
    assert "error     unknown" in solution.report()
    assert "steps" in solution.report()
    solution.save(tmp_path / "run.npz")
    loaded = rd.load_solution(tmp_path / "run.npz")
    assert np.array_equal(loaded.history, solution.history)
    assert loaded.report() == solution.report()


@pytest.mark.parametrize("name", rd.BASELINES)
def test_equal_seeds_give_equal_bits_and_a_single_face_is_solved(name):
    patches = rd.subdivide(rd.load_scene("room"), cells=1)
    one, other = (rd.solve(patches, name, seed=5) for _ in range(2))
    assert np.array_equal(one.irradiance, other.irradiance)
    face = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.5, 1.0)
    alone = rd.solve(rd.subdivide(face, cells=1), name)
    assert alone.radiosity == 1


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"rays": 1000}, "made whole or not at all"),
        ({"seconds": 3}, "made whole or not at all"),
        ({"error": 0.01}, "cannot go on to a target"),
        ({"numbers": "sobol"}, "'numbers' is no choice of full-matrix"),
        ({"ambient": True}, "not a choice of full-matrix"),
        ({"factors": "guesses"}, "known are polygons, hemicube, lines"),
        ({"resolution": 32}, "take --factors hemicube"),
        ({"factors": "hemicube", "resolution": 15}, "must be even"),
        ({"factors": "hemicube", "samples": 15}, "give its resolution"),
        ({"samples": 0}, "whole number from 1"),
        ({"epsilon": 1e-5}, "not a choice of full-matrix"),
        ({"epsilon": 0.5}, "not a choice of full-matrix"),
    ],
)
def test_senseless_choices_are_refused_with_the_reason(options, reason):
    with pytest.raises(rd.MethodError, match=reason):
        rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), "full-matrix", **options)


@pytest.mark.parametrize("scheme", ["progressive", "hierarchical"])
def test_sequences_of_decisions_have_no_replicates(scheme):
    with pytest.raises(rd.MethodError, match="no replicates"):
        rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), rd.Baseline(scheme), replicates=2)


def test_what_does_not_fit_is_refused_with_numbers_and_the_way_out(room, monkeypatch):
    monkeypatch.setattr(memory, "free", lambda: 1e6)
    with pytest.raises(rd.MethodError, match=r"iB of memory, and .* MiB are free; take larger patches"):
        rd.solve(room[0], "full-matrix")
    with pytest.raises(rd.MethodError, match=r"iB of memory.*take larger patches"):
        rd.solve(room[0], "progressive-refinement")


def test_faces_that_are_too_many_for_links_are_refused_at_once(room, monkeypatch):
    from radiosity.algorithms.hierarchical import roots

    monkeypatch.setattr(roots, "MOST_PAIRS", 10)
    with pytest.raises(rd.MethodError, match="merge small faces"):
        rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), "hierarchical")


def test_what_takes_long_is_told_beforehand(room, monkeypatch):
    monkeypatch.setattr(estimate, "LONG", 0.0)
    for name in ("full-matrix", "progressive-refinement"):
        with pytest.warns(rd.RadiosityWarning, match="minutes on this machine"):
            rd.solve(room[0], name)
    from radiosity.algorithms.hierarchical import roots

    monkeypatch.setattr(roots, "LONG", 0.0)
    with pytest.warns(rd.RadiosityWarning, match="begins with .* pairs of radiating sides"):
        rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), "hierarchical")


def test_replicates_of_hemicubes_say_what_their_errors_leave_out(room):
    with pytest.warns(rd.RadiosityWarning, match="one point stands for a patch"):
        solution = rd.solve(room[0], "full-matrix-hemicube", resolution=16, replicates=3)
    assert 0 < solution.error < error(solution, room[1])  # they agree with each other more than with the truth


@pytest.fixture(scope="module")
def cove():
    """A lamp 5 mm below the ceiling of a unit cube, and shining up: little of a patch of the ceiling sees it."""
    from radiosity.scene.shapes import box, join, quad

    lamp = [quad((0.35, 0.35, 0.995), (0.3, 0, 0), (0, 0.3, 0))]
    walls = box((0, 0, 0), (1, 1, 1), inward=True)
    scene = join([("walls", 0.6, 0.0, walls), ("lamp", 0.3, 10.0, lamp)], source="cove", backs={"lamp": 0.3})
    patches = rd.subdivide(scene, cells=8)
    return patches, rd.solve(patches, "random-walk", rays=4_000_000)


@pytest.mark.parametrize("name", ["hierarchical", "hierarchical-error-control", "full-matrix"])
def test_a_lamp_close_to_the_ceiling(cove, name):
    assert error(rd.solve(cove[0], name), cove[1]) < 0.02


def test_hemicubes_are_blind_for_it_and_say_so(cove):
    with pytest.warns(rd.RadiosityWarning, match="take factors polygons"):
        solution = rd.solve(cove[0], "full-matrix-hemicube")
    assert error(solution, cove[1]) > 0.05


def test_rays_and_seconds_stop_shots_early(room):
    some = rd.solve(room[0], "progressive-refinement", rays=30_000, resolution=16)
    short = rd.solve(room[0], "progressive-refinement", seconds=1e-3, resolution=16)
    assert 15_000 < some.rays < 90_000
    assert some.history[-1, 1] > 0.01
    assert short.quanta == 64  # the first stage is completed whatever it takes


@pytest.mark.parametrize("method", ["progressive-refinement", "hierarchical"])
def test_runs_that_end_too_early_say_what_is_missing(method):
    patches = rd.subdivide(rd.load_scene("room"), size=1, powers_of_two=True)
    with pytest.warns(rd.RadiosityWarning, match=rf"ended before {method.split('-')[0]} radiosity was done: \d"):
        solution = rd.solve(patches, method, seconds=1e-6)
    book = solution.books[0]
    assert abs(book["rounding"]) > 0.01 * book["emitted"] or method == "hierarchical"
    assert any("ended before" in text for text in solution.warnings)
