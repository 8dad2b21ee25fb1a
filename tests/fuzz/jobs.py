"""Random commands, and the small scenes that they are run on. Job k of a seed is the same on every machine."""

from dataclasses import dataclass
from random import Random

import radiosity as rd
from radiosity.method.model import CHOICES
from radiosity.method.schemes import FACTORS, REFINEMENTS, SOLVERS

FACES = {
    "low": "0 0 0, 1 0 0, 1 1 0, 0 1 0",
    "high": "0 0 1, 0 1 1, 1 1 1, 1 0 1",
    "south": "0 0 0, 0 0 1, 1 0 1, 1 0 0",
    "north": "0 1 0, 1 1 0, 1 1 1, 0 1 1",
    "west": "0 0 0, 0 1 0, 0 1 1, 0 0 1",
    "east": "1 0 0, 1 0 1, 1 1 1, 1 1 0",
    "half": "0 0 0, 1 0 0, 0 1 0",
    "sail": "0.2 0.3 0.2, 0.8 0.3 0.3, 0.5 0.7 0.8",
    "table": "0.3 0.3 0.5, 0.7 0.3 0.5, 0.7 0.7 0.5, 0.3 0.7 0.5",
}
CUBE = ("low", "high", "south", "north", "west", "east")
SHAPES = (
    ("half",),
    ("low",),
    ("low", "high"),
    ("half", "sail"),
    ("low", "high", "sail"),
    CUBE,
    CUBE,
    (*CUBE, "table"),
    (*CUBE, "table", "sail"),
)
BUILT_IN = ("room", "cornell-box", "labyrinth", "labyrinth-0.9")
GREY, WHITE = "0.5 0.5 0.5", "3 3 3"
BACKS = ("absorbs", "radiates", "passes")
SUFFIXES = (".glb", ".ply", ".vtp", ".csv", ".png", ".exr")
QUANTITIES = ("radiosity", "irradiance", "standard_error", "irradiance_standard_error", "relative_error")
SWITCHES = {"control_variate": True, "warm_up": True, "coherent": True, "first_shot": 0.25, "reconstruction": "local-linear"}


@dataclass(frozen=True)
class Job:
    """Commands that are run one after the other in a folder of their own.

    Attributes:
        files: texts by name, that lie in the folder before.
        commands: the words after ``radiosity``.
    """

    files: dict[str, str]
    commands: list[list[str]]


def job(seed: int, number: int) -> Job:
    """Solve a scene in some way; then perhaps go on from it, look at it, or check it."""
    random = Random(f"{seed} {number}")
    files, scene = _scene(random)
    if random.random() < 0.12:
        return Job(files, [["check", scene]])
    words, choices, baseline = _method(random)
    cut = _cut(random, choices)
    replicates = [] if random.random() < 0.3 else ["--replicates", str(random.choice((1, 1, 2, 3, 8, 9)))]
    seeded = [] if random.random() < 0.7 else ["--seed", str(random.randrange(2**20))]
    same = [*words, *replicates, *seeded]
    refine = ["--refine-check"] if not baseline and random.random() < 0.1 else []
    first = ["solve", scene, *cut, *same, *refine, *_amount(random, baseline), *_outputs(random)]
    commands = [first]
    if "o.npz" in first and not refine:
        if random.random() < 0.4:
            commands.append(["solve", scene, *same, "--resume", "o.npz", *_amount(random, baseline, more=2), "-o", "o.npz"])
        if random.random() < 0.4:
            commands.append(["render", "o.npz", *_picture(random)])
    return Job(files, commands)


def near(random: Random, least: int, most: int) -> int:
    """A power of two from 2^least to 2^most, one less or one more; at least 1."""
    return max(1, 2 ** random.randint(least, most) + random.choice((-1, 0, 1)))


def _scene(random: Random) -> tuple[dict[str, str], str]:
    if random.random() < 0.25:
        return {}, random.choice(BUILT_IN)
    names = random.choice(SHAPES)
    lamp, grey = random.choice(names), random.random() < 0.6
    bands = [_bands(random, grey, most) for most in (0.9, 0.94, 9.0)]
    if random.random() < 0.15:
        return scene_files(names, lamp, None, *bands), "a.obj"
    backs = {"*": random.choice(BACKS)} | ({"*/lamp": random.choice(BACKS)} if random.random() < 0.5 else {})
    return scene_files(names, lamp, backs, *bands), "a.toml"


def scene_files(names, lamp: str, backs: dict[str, str] | None, lit=GREY, wall=GREY, light=WHITE) -> dict[str, str]:
    """A scene of some of the `FACES`, as texts by name of file.

    Args:
        lamp: the face that emits.
        backs: of surfaces (FACE/lamp and FACE/wall) by pattern, in ``a.toml``; None: no such file, and ``a.obj`` alone.
        lit, wall, light: reflectance of the lamp and of the other faces, and emission; three numbers each.
    """
    lines = ["mtllib a.mtl"]
    for name in names:
        corners = FACES[name].split(", ")
        lines += [f"o {name}", *(f"v {corner}" for corner in corners), f"usemtl {'lamp' if name == lamp else 'wall'}"]
        lines += ["f " + " ".join(str(i - len(corners)) for i in range(len(corners)))]
    mtl = f"newmtl lamp\nKd {lit}\nKe {light}\nnewmtl wall\nKd {wall}\n"
    files = {"a.obj": "\n".join(lines) + "\n", "a.mtl": mtl}
    if backs is None:
        return files
    surfaces = [f'[[surface]]\nname = "{name}"\nback = "{back}"\n' for name, back in backs.items()]
    return files | {"a.toml": 'geometry = ["a.obj"]\n' + "".join(surfaces)}


def _bands(random: Random, grey: bool, most: float) -> str:
    values = [0.01 + random.random() * most for _ in range(1 if grey else 3)]
    return " ".join(f"{value:.3g}" for value in (values * 3)[:3])


def _method(random: Random) -> tuple[list[str], dict, bool]:
    """Words of the command line, the choices, and whether the matrix is formed. Three of four make sense together."""
    anything = random.random() < 0.05
    for _ in range(100):
        name = random.choice([*rd.PRESETS, *rd.PRESETS, *rd.BASELINES])
        baseline, choices = name in rd.BASELINES, {}
        if baseline:
            own = {
                "factors": list(FACTORS),
                "solver": list(SOLVERS),
                "refinement": list(REFINEMENTS),
                "reciprocal": [True],
                "resolution": [2, 4, 16],
                "rotated": [False],
                "samples": [1, 4, 15],
                "ambient": [True],
                "overshooting": [True],
                "epsilon": [1e-3, 0.1],
            }
            choices = {key: random.choice(values) for key, values in own.items() if random.random() < 0.2}
        else:
            choices = {axis: random.choice(values) for axis, values in CHOICES.items() if random.random() < 0.25}
            choices |= {key: value for key, value in SWITCHES.items() if random.random() < 0.1}
            if random.random() < 0.6:
                choices["numbers"] = random.choice(CHOICES["numbers"])
        try:
            rd.method.resolve(name, **choices)
        except rd.RadiosityError:
            if not anything:
                continue
        return ["--method", name, *_words(choices)], choices, baseline
    return [], {}, False


def _words(choices: dict) -> list[str]:
    words = []
    for key, value in choices.items():
        option = key.replace("_", "-")
        words += [f"--{option}" if value else f"--no-{option}"] if isinstance(value, bool) else [f"--{option}", str(value)]
    return words


def _cut(random: Random, choices: dict) -> list[str]:
    chance = random.random()
    if chance < 0.05:
        return ["--patch-size", random.choice(("50cm", "1", "2m"))]
    return [] if chance < 0.08 else ["--cells", str(random.choice((1, 1, 1, 2, 2, 3, 4, 7)))]


def _amount(random: Random, baseline: bool, more: int = 0) -> list[str]:
    """How far to go."""
    if baseline and random.random() < 0.6:
        return []
    kind = random.choice(("rays", "rays", "rays", "quanta", "quanta", "error", "seconds"))
    amounts = {
        "rays": lambda: near(random, more, 16 + more),
        "quanta": lambda: near(random, more, 12 + more),
        "error": lambda: f"{random.choice((10, 20, 60))}%",
        "seconds": lambda: random.choice(("0.01", "0.2")),
    }
    return [f"--{kind}", str(amounts[kind]())]


def _outputs(random: Random) -> list[str]:
    found = (["o.npz"] if random.random() < 0.85 else []) + [f"o{s}" for s in SUFFIXES if random.random() < 0.15]
    random.shuffle(found)
    return ["-o", *found] if found else []


def _picture(random: Random) -> list[str]:
    words = ["-o", random.choice(("p.png", "p.png", "p.exr"))]
    if random.random() < 0.9:
        words += ["--width", str(random.choice((1, 2, 3, 16, 33))), "--height", str(random.choice((1, 1, 2, 16, 31)))]
    if random.random() < 0.5:
        words += ["--origin", "0.5,0.5,0.5", "--target", random.choice(("0.5,0.9,0.4", "0,0,0", "0.5,0.5,1"))]
    if random.random() < 0.3:
        words += ["--quantity", random.choice(QUANTITIES)]
    if random.random() < 0.3:
        words += ["--false-color", *(["--log"] if random.random() < 0.3 else [])]
    return [*words, "--no-smooth"] if random.random() < 0.3 else words
