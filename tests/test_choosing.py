"""`method="auto"`: what it chooses by each rule, and that its runs come again to the bit."""

import numpy as np
import pytest
from enclosures import cube

import radiosity as rd
from radiosity.algorithms.gather.pilot import LINES
from radiosity.run import choice as choice_module
from radiosity.run import solve as solve_module
from radiosity.scene.shapes import quad

pytestmark = pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning")  # of few lines
ROOM, FURNACE = (rd.subdivide(rd.load_scene(name), cells=cells) for name, cells in (("room", 4), ("labyrinth-0.5", 2)))
CONTROL = "stochastic-jacobi-control-variate"


def chosen(patches: rd.Patches, **options) -> dict:
    return rd.solve(patches, seed=3, **options).provenance["auto"]


@pytest.mark.parametrize(("patches", "name"), [(ROOM, "gather"), (FURNACE, CONTROL)])
def test_the_least_predicted_error_is_taken_and_told(patches, name):
    solution = rd.solve(patches, rays=200 * len(patches))
    told = solution.provenance["auto"]
    assert told["chosen"] == name
    assert told["why"].startswith(f"predicted errors for equal work: {name} 1, ")
    assert f"chosen    {name}: {told['why']}" in solution.report()
    assert solution.provenance["choices"]["order"] == rd.PRESETS[name].method.order


def test_few_lines_go_to_the_walk_without_a_pilot(monkeypatch):
    monkeypatch.setattr(choice_module.pilot.Pilot, "of", None)
    told = chosen(ROOM, rays=63 * len(ROOM))
    assert (told["chosen"], told["pilot_lines"]) == ("random-walk", 0)
    assert "fewer than 64 lines a patch" in told["why"]


def test_a_pilot_of_much_work_is_left_out(monkeypatch):
    monkeypatch.setattr(choice_module, "ENTRY", 1e5)
    assert chosen(ROOM, rays=200 * len(ROOM))["chosen"] == "random-walk"
    monkeypatch.setattr(choice_module, "ENTRY", 1e9)
    assert "a pilot would take the work of" in chosen(ROOM, error=0.5)["why"]


def test_backs_that_let_lines_pass_go_to_the_walk():
    corners = np.concatenate([quad((0, 0, z), (1, 0, 0), (0, 1, 0)) for z in (0.0, 1.0, 0.5)])
    faces = np.arange(12).reshape(-1, 4)
    scene = rd.Scene.from_arrays(corners, faces, 0.5, [1.0, 0.0, 0.0], back=[rd.Back.PASSES] * 3)
    assert "lines pass through some backs" in chosen(rd.subdivide(scene, cells=3), rays=20_000)["why"]


@pytest.mark.parametrize(
    ("patches", "basis", "lines", "name"),
    [(ROOM, "linear", 400, "gather"), (FURNACE, "linear", 400, CONTROL), (ROOM, "linear", 100, "particle-tracing")],
)
def test_a_basis_goes_to_a_method_that_takes_it(patches, basis, lines, name):
    solution = rd.solve(patches, basis=basis, rays=lines * len(patches), seed=3)
    assert solution.provenance["auto"]["chosen"] == name
    assert solution.basis.name == basis
    if name == "gather":  # particles erred 1.5 times as much at equal lines; if hits told one number each it would be 1.2
        told = solution.provenance["auto"]["why"].split("particle-tracing ")[1].split(",")[0]
        assert 1.5 < float(told) < 3
    again = rd.solve(patches, rd.Method(**solution.provenance["choices"]), seed=3, quanta=solution.quanta)
    assert np.array_equal(solution.irradiance_coefficients, again.irradiance_coefficients)
    with pytest.raises(rd.MethodError, match="and the solution to go on from has basis"):
        rd.solve(patches, basis="quadratic" if basis == "linear" else "linear", seed=3, rays=1e6, resume=solution)


def test_a_basis_and_lights_go_to_a_gather_where_it_runs():
    corners = np.concatenate([quad((0, 0, z), (1, 0, 0), (0, 1, 0)) for z in (0.0, 1.0)])
    globe = rd.point_light(position=(0.5, 0.5, 0.5), lumens=100, name="globe")
    for back in (rd.Back.ABSORBS, rd.Back.PASSES):
        scene = rd.Scene.from_arrays(corners, np.arange(8).reshape(-1, 4), 0.5, 0.0, back=[back] * 2, photometric=True)
        patches = rd.subdivide(scene.with_lights([globe]), cells=2)
        if back == rd.Back.ABSORBS:
            told = chosen(patches, rays=4_000, basis="linear")
            assert (told["chosen"], told["pilot_lines"]) == ("gather", 0)
        else:
            with pytest.raises(rd.MethodError, match="no method takes both with basis 'linear': leave basis out"):
                rd.solve(patches, rays=4_000, basis="linear")


def test_choices_besides_a_basis_ask_for_a_method():
    with pytest.raises(rd.MethodError, match="take one of these, or leave basis out"):
        rd.solve(ROOM, basis="linear", numbers="sobol", rays=1_000)
    with pytest.raises(rd.MethodError, match="basis 'cubic' does not exist; known are constant, linear, quadratic"):
        rd.solve(ROOM, basis="cubic", rays=1_000)


def test_lamps_of_very_few_units_go_to_the_walk():
    """A lamp of 0.1 mm in a cube of 1 m: a gather found half of its light, and stated so. A closed form: 1 W on 6 m²."""
    walls, small = cube(0.5, 0.0), 1e-4
    lamp = quad((0.5, 0.5, 0.9), (0, small, 0), (small, 0, 0))
    corners, faces = np.concatenate([walls.vertices, lamp]), np.concatenate([walls.faces, [[24, 25, 26, 27]]])
    emission = np.append(np.zeros(6), 1 / small**2)
    patches = rd.subdivide(rd.Scene.from_arrays(corners, faces, np.append(np.full(6, 0.5), 0.0), emission), cells=1)
    solution = rd.solve(patches, rays=20_000, seed=3)
    assert solution.provenance["auto"]["chosen"] == "random-walk"
    assert "would round the light by" in solution.provenance["auto"]["why"]
    assert solution.irradiance[:6].mean() == pytest.approx(1 / 3, rel=0.01)


def test_black_scenes_go_to_the_walk():
    corners = np.concatenate([quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, 1), (0, 1, 0), (1, 0, 0))])
    scene = rd.Scene.from_arrays(corners, np.arange(8).reshape(-1, 4), 0.0, [1.0, 0.0])
    told = chosen(rd.subdivide(scene, cells=3), rays=20_000)
    assert (told["chosen"], told["pilot_lines"]) == ("random-walk", 18 * LINES)


@pytest.mark.parametrize("patches", [ROOM, FURNACE], ids=["room", "furnace"])
@pytest.mark.parametrize("budget", [{"rays": 50}, {"rays": 65}, {"rays": 200}, {"error": 0.3}], ids=str)
def test_what_was_chosen_replays_to_the_bit(patches, budget):
    """Also near the border of the rules, where `auto` itself may choose otherwise by quanta."""
    options = {name: value * len(patches) if name == "rays" else value for name, value in budget.items()}
    solution = rd.solve(patches, seed=3, **options)
    again = rd.solve(patches, rd.Method(**solution.provenance["choices"]), seed=3, quanta=solution.quanta)
    assert np.array_equal(solution.irradiance, again.irradiance)


def test_a_run_that_goes_on_keeps_its_method():
    first = rd.solve(FURNACE, seed=3, rays=50 * len(FURNACE))
    assert first.provenance["auto"]["chosen"] == "random-walk"
    on = rd.solve(FURNACE, seed=3, quanta=20 * first.quanta, resume=first)
    assert on.provenance["choices"] == first.provenance["choices"]
    assert chosen(FURNACE, quanta=20 * first.quanta)["chosen"] == CONTROL


def test_lines_of_the_pilot_are_lines():
    """The control variate does not count them itself; of so many lines its iterations take 5 % more or less."""
    rays = 1000 * len(FURNACE)
    solution = rd.solve(FURNACE, seed=3, rays=rays)
    assert solution.provenance["auto"]["pilot_lines"] == LINES * len(FURNACE)
    assert solution.rays <= 1.05 * rays


def test_seconds_of_the_pilot_are_seconds_of_the_run(monkeypatch):
    """By a clock that says a hundred of them passed."""
    clock = iter([0.0, 100.0])
    monkeypatch.setattr(solve_module, "perf_counter", lambda: next(clock))
    solution = rd.solve(ROOM, seconds=50)
    assert 100 <= solution.seconds < 150
