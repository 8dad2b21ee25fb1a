"""Commands in fresh processes: what an earlier run of the same process has made on the device hides faults of the first one.

An array that was made within a recorded loop ended the process where its length was 1, or the loop's number of lanes
(`device.recorded`). So lines, quanta and sizes here are such that some loop has as many lanes as a table has entries.
"""

import os
import sys
from itertools import count
from pathlib import Path

import pytest

import radiosity as rd
from radiosity.sampling.numbers import NUMBERS

FUZZ = Path(__file__).resolve().parent / "fuzz"
sys.path.insert(0, str(FUZZ))
from commands import Forks, judged  # noqa: E402
from jobs import CUBE, scene_files  # noqa: E402

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")

ONE = ("low",)  # face


def scenes(passes: str = "passes") -> dict[str, dict[str, str]]:
    """Files of each scene, by its name.

    Args:
        passes: what backs do that let lines pass.
    """
    return {
        "one, absorbs": scene_files(ONE, "low", {"*": "absorbs"}),
        "one, radiates": scene_files(ONE, "low", {"*": "radiates"}),
        "one, passes": scene_files(ONE, "low", {"*": passes}),
        "triangle": scene_files(("half",), "half", {"*": passes}),
        "plates": scene_files(("low", "high"), "high", {"*": "radiates"}),
        "cube": scene_files(CUBE, "high", {"*": passes, "*/lamp": "radiates"}),
        "coloured": scene_files((*CUBE, "table"), "high", {"*": "absorbs", "*/lamp": passes}, wall="0.7 0.4 0.2"),
    }


SCENES, SHUT = scenes(), scenes(passes="absorbs")
IN_SHUT_ONES = ("gather",)  # refuses backs that let lines pass
ONE_REPLICATE = "--cells 1 --replicates 1"
CASES = {
    "tables of four words": ("", [f"solve room {ONE_REPLICATE} --numbers sobol --quanta 1024"]),
    "tables of digits": ("", [f"solve room {ONE_REPLICATE} --numbers scrambled-halton --quanta 6875"]),
    "tables in base 5": ("", [f"solve room {ONE_REPLICATE} --numbers faure --order depth-first --quanta 75000"]),
    "one pixel": (
        "one, passes",
        ["solve a.toml --rays 1k -o o.npz", "render o.npz -o p.png --width 1 --height 1 --origin 0.5,0.5,3 --target 0.5,0.5,0"],
    ),
    "as many pixels as faces": (
        "cube",
        [
            "solve a.toml --cells 1 --quanta 64 -o o.npz",
            "render o.npz -o p.png --width 3 --height 1 --origin 0.5,0.5,0.5 --target 0.5,0.9,0.4",
        ],
    ),
    "crossings of spans": ("cube", [f"solve a.toml {ONE_REPLICATE} --method global-form-factors --lines spans --quanta 96"]),
    "crossings of chords": ("plates", [f"solve a.toml {ONE_REPLICATE} --method global-form-factors --quanta 58"]),
    "one face that lines pass": ("triangle", ["check a.toml"]),
    **{
        f"lines of {scene}": (
            scene,
            [f"lines a.toml --cells 1 --quanta {quanta} --replicates 1 -o l.npz", "relight l.npz --set *.emission=1 -o o.csv"],
        )
        for scene, quanta in (("one, radiates", 1), ("one, passes", 64), ("plates", 58), ("cube", 96), ("coloured", 1024))
    },
    **{
        f"heat of {scene}": (
            scene,
            [
                f"exchange a.toml --cells 1 --rays {rays} --temperature *=300 --emissivity *=0.5 --surroundings 280 -o o.csv",
                f"exchange a.toml --cells 1 --rays {rays} --adiabatic * --emissivity *=0.5 --surroundings 280 --replicates 1",
            ],
        )
        for scene, rays in (("one, absorbs", 8), ("one, radiates", 64), ("plates", 1000))
    },
}


@pytest.fixture(scope="module")
def forks():
    start = Forks()
    yield start
    start.close()


def run(forks, folder: Path, scene: str, commands, files: dict[str, dict[str, str]] = SCENES) -> list[str]:
    """What each command came to: done, refused or suspicious; anything else fails."""
    found = []
    for name, text in files.get(scene, {}).items():
        (folder / name).write_text(text)
    for command in commands:
        what, wrong = judged(command.split(), *forks(command.split(), folder))
        assert wrong is None, f"{scene}: {command}: {wrong}"
        found.append(what)
    return found


# other lines are counted, and other heat is exchanged, in the cases beside them
LONGER = ("lines of one, passes", "lines of plates", "lines of coloured", "heat of one, absorbs")


@pytest.mark.parametrize("case", [pytest.param(case, marks=pytest.mark.slow) if case in LONGER else case for case in CASES])
def test_cases_that_ended_the_process(forks, tmp_path, case):
    scene, commands = CASES[case]
    assert set(run(forks, tmp_path, scene, commands)) <= {"done", "suspicious"}


AMOUNTS = [
    f"--{kind} {2**power + more}"
    for power in (0, 3, 6, 10, 13)
    for kind in ("rays", "quanta")
    for more in (-1, 0, 1)
    if 2**power + more > 0
]
PICTURES = ("--width 1 --height 1", "--width 3 --height 2", "--width 16 --height 16 --false-color")


@pytest.mark.slow
@pytest.mark.parametrize("method", rd.PRESETS)
def test_every_method_and_numbers_with_lines_about_powers_of_two(forks, tmp_path, method):
    """Each in the next scene, with the next amount: solved, gone on with, looked at, checked for its mesh. An upload within a
    loop is found at any length, since it is a fault of the program where it did no harm by luck, too."""
    turn, found = count(13 * list(rd.PRESETS).index(method)), []
    names = list(SCENES)
    for numbers in NUMBERS:
        for replicates in (1, 2):
            k = next(turn)
            folder = tmp_path / f"{numbers} {replicates}"
            folder.mkdir()
            same = f"a.toml --method {method} --numbers {numbers} --replicates {replicates}"
            commands = [
                f"solve {same} --cells {1 + k % 3 // 2} {AMOUNTS[k % len(AMOUNTS)]} -o o.npz",
                f"solve {same} --resume o.npz --quanta {2 ** (k % 5 + 7)} -o o.npz",
                f"render o.npz -o p.png {PICTURES[k % len(PICTURES)]}",
            ]
            if replicates == 2:
                commands.append(f"solve {same} --cells 1 {AMOUNTS[(k + 5) % len(AMOUNTS)]} --refine-check")
            found += run(forks, folder, names[k % len(names)], commands, SHUT if method in IN_SHUT_ONES else SCENES)
    assert found.count("done") > len(found) / 2


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
def test_baselines_and_checks_of_small_scenes(forks, tmp_path, scene):
    commands = ["check a.toml"]
    for method in rd.BASELINES:
        commands += [f"solve a.toml --method {method} --cells {cells} -o o.npz" for cells in (1, 2)]
        commands.append("render o.npz -o p.png --width 3 --height 1")
    found = run(forks, tmp_path, scene, commands)
    assert found.count("done") > len(found) / 2
