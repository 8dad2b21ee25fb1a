"""Scenes of ``make bench-error``. Only public names are used: older commits of the package build them too."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scenes import STRANGERS

import radiosity as rd

OLD = "random-walk@59482bb"  # it cannot move
CONTROL_VARIATE = "stochastic-jacobi-control-variate/estimator=bidirectional"
# those that make references, by equation
METHODS = {
    "discrete": (OLD, CONTROL_VARIATE, "gather"),
    "continuous": ("particle-tracing@59482bb", "particle-tracing/numbers=sobol@59482bb", "photon-loop"),
}
CELLS = 16  # along the edges of each wall of the divided room
WALLS = ("west wall", "east wall", "south wall", "north wall", "floor", "ceiling")
BOXES = {"tall box": ((0.7, 0.6, 0.1), (1.7, 1.4, 1.3)), "low box": ((2.2, 1.5, 0.1), (3.4, 2.5, 0.8))}


@dataclass(frozen=True)
class Setting:
    """A scene of the benchmark.

    Attributes:
        make: returns its patches.
        discrete, continuous: lines of the runs that the references of these equations are made of, one a method of `METHODS`.
        exact: irradiance is exactly 1, by both equations.
        first: lines of the smallest run.
    """

    make: Callable[[], rd.Patches]
    discrete: tuple[float, ...] = ()
    continuous: tuple[float, ...] = ()
    exact: bool = False
    first: float = 1e5


def divided_room(reflectance: float, cells: int = CELLS) -> rd.Scene:
    """A closed room of 4 x 3 x 2.5 m with two floating boxes, each wall cut into cells x cells faces; a lamp in the ceiling."""
    corners, names, lamps = [], [], []
    middle = range(3 * cells // 8, 5 * cells // 8)
    for name, (low, high) in {"room": ((0, 0, 0), (4, 3, 2.5)), **BOXES}.items():
        for wall, (origin, first, second) in zip(WALLS, _sides(np.array(low, float), np.array(high, float)), strict=True):
            if name != "room":
                first, second = second, first  # normals point out of boxes
            for i in range(cells):
                for j in range(cells):
                    steps = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                    corners += [origin + first * a / cells + second * b / cells for a, b in steps]
                    lamps.append(name == "room" and wall == "ceiling" and i in middle and j in middle)
                    names.append("lamp" if lamps[-1] else wall if name == "room" else name)
    lamp, known = np.array(lamps), tuple(dict.fromkeys(names))
    return rd.Scene.from_arrays(
        np.array(corners),
        np.arange(len(corners)).reshape(-1, 4),
        np.where(lamp, 0.0, reflectance),
        np.where(lamp, 10.0, 0.0),
        surface=[known.index(name) for name in names],
        names=known,
        source=f"divided-room-{reflectance:g}",
    )


def _sides(low: np.ndarray, high: np.ndarray):
    """Origin and two edges of the six sides of a box; first x second points inwards."""
    size = np.diag(high - low)
    for axis in range(3):
        one, two = size[(axis + 1) % 3], size[(axis + 2) % 3]
        yield low, one, two
        yield low + size[axis], two, one


def labyrinth_with_a_lamp(reflectance: float) -> rd.Scene:
    """The labyrinth, where one face of the ceiling emits and nothing else."""
    scene = rd.load_scene(f"labyrinth-{reflectance:g}")
    emission = np.zeros_like(scene.emission)
    emission[-1] = 1.0
    return replace(scene, emission=emission, back_emission=np.zeros_like(scene.back_emission))


def _built_in(name: str, **cut) -> Callable[[], rd.Patches]:
    return lambda: rd.subdivide(rd.load_scene(name), **cut)


SETTINGS = {
    "room": Setting(_built_in("room"), (4e8, 1.6e9, 1e9)),
    "room-2592": Setting(_built_in("room", cells=12), (2e8, 6e8, 4e8)),
    "cornell-box": Setting(_built_in("cornell-box"), (4e8, 1e9, 1e9)),
    "studio": Setting(_built_in("studio"), (4e8, 1e9, 1e9)),
    "labyrinth-0.5": Setting(_built_in("labyrinth-0.5", cells=8), exact=True, first=2.5e4),
    "labyrinth-0.9": Setting(_built_in("labyrinth-0.9", cells=8), exact=True, first=2.5e4),
    "labyrinth-lamp-0.5": Setting(lambda: rd.subdivide(labyrinth_with_a_lamp(0.5), cells=8), (2e8, 2e8, 4e8)),
    "labyrinth-lamp-0.9": Setting(lambda: rd.subdivide(labyrinth_with_a_lamp(0.9), cells=8), (2e8, 2e8, 4e8)),
    "divided-room-0.5": Setting(lambda: rd.subdivide(divided_room(0.5), cells=1), (2e8, 6e8, 4e8), (1.2e9, 1.2e9, 2e8)),
    "divided-room-0.9": Setting(lambda: rd.subdivide(divided_room(0.9), cells=1), (2e8, 6e8, 4e8), (1.2e9, 2.2e9, 2e8)),
    "soda": Setting(_built_in(str(STRANGERS / "soda.mgf")), (4e8, 0, 1e9), first=4e5),
    "office2": Setting(_built_in(str(STRANGERS / "office2" / "office2.mgf")), (1e9, 0, 1e9)),
}
FILES = {"soda": STRANGERS / "soda.mgf", "office2": STRANGERS / "office2" / "office2.mgf"}


def missing(name: str) -> str:
    """The reason why a scene cannot be had here, or an empty text."""
    file = FILES.get(name)
    return "" if file is None or file.exists() else f"no file {file.name} in ../shared/scenes beside this checkout"
